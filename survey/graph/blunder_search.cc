// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/blunder_search.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "survey/graph/control_tests.h"

namespace survey {
namespace {

// Of T of either mark after their exchange. No two other blunders come as near to each other's places as this, but one
// of the two may have an error of its own besides.
constexpr double kExchangeSignificance = 1e-6;

class Search {
 public:
  Search(const ControlMisfit& misfit, double family_significance) : misfit_(misfit) {
    result_.kept.resize(static_cast<std::size_t>(misfit.size()));
    std::iota(result_.kept.begin(), result_.kept.end(), 0);
    num_points_ = PointsAmong(result_.kept);
    const double suspects = std::max(1.0, static_cast<double>(Suspects(result_.kept).size()));
    result_.critical_t = std::max(CriticalT(TestLevel{}.significance, 2), CriticalT(family_significance / suspects, 2));
  }

  BlunderSearch Run() {
    while (!result_.contradicted && LeaveWorstOut()) {
    }
    if (!result_.contradicted && TwoThatDisagree()) GiveUp();
    if (!result_.contradicted) TakeBack();
    return std::move(result_);
  }

 private:
  using Marks = std::vector<int>;

  struct Suspect {
    Marks marks;
    double t = 0.0;
  };

  std::size_t PointsAmong(const Marks& marks) const {
    std::set<int> points;
    for (const int mark : marks) points.insert(misfit_.points[static_cast<std::size_t>(mark)]);
    return points.size();
  }

  // Each mark, and each point that has several.
  std::vector<Marks> Suspects(const Marks& marks) const {
    std::vector<Marks> suspects;
    std::map<int, Marks> of_point;
    for (const int mark : marks) {
      suspects.push_back({mark});
      of_point[misfit_.points[static_cast<std::size_t>(mark)]].push_back(mark);
    }
    for (const auto& [point, several] : of_point) {
      if (several.size() > 1) suspects.push_back(several);
    }
    return suspects;
  }

  Suspect Worst(const ControlTests& tests) const {
    Suspect worst;
    for (Marks& marks : Suspects(result_.kept)) {
      const ErrorTest test = tests.Test(marks, {});
      if (test.degrees_of_freedom == 2 && test.t > worst.t) worst = {std::move(marks), test.t};
    }
    return worst;
  }

  // Two marks whose exchange explains more than leaving out the worst one would; without any free parameter.
  std::optional<std::pair<int, int>> BestExchange(const ControlTests& tests, double worst_t) const {
    const double limit = std::max(result_.critical_t, CriticalT(kExchangeSignificance, 2));
    std::optional<std::pair<int, int>> best;
    double least = tests.chi_square() - worst_t;
    for (const int a : result_.kept) {
      for (const int b : result_.kept) {
        if (b <= a || misfit_.points[static_cast<std::size_t>(a)] == misfit_.points[static_cast<std::size_t>(b)])
          continue;
        const ControlTests::Exchange exchange = tests.IfExchanged(a, b);
        if (exchange.chi_square >= least || std::max(exchange.t_a, exchange.t_b) > limit) continue;
        least = exchange.chi_square;
        best = {a, b};
      }
    }
    return best;
  }

  void LeaveOut(int mark) {
    std::erase(result_.kept, mark);
    result_.excluded.push_back(mark);
  }

  // False when nothing is beyond the critical value any more.
  bool LeaveWorstOut() {
    const ControlTests tests(misfit_, result_.kept);
    if (!tests.usable()) return false;
    const Suspect worst = Worst(tests);
    if (worst.t <= result_.critical_t) return false;
    if (const auto exchange = BestExchange(tests, worst.t)) {
      LeaveOut(exchange->first);
      LeaveOut(exchange->second);
      result_.exchanged.push_back(*exchange);
    } else {
      for (const int mark : worst.marks) LeaveOut(mark);
    }
    const std::size_t left = PointsAmong(result_.kept);
    if (left < 2 || 2 * left < num_points_) GiveUp();
    return true;
  }

  // By the global test, for no mark of two points can be tested by itself.
  bool TwoThatDisagree() const {
    if (PointsAmong(result_.kept) != 2) return false;
    const ControlTests tests(misfit_, result_.kept);
    return tests.usable() && tests.chi_square() > CriticalT(TestLevel{}.significance, tests.degrees_of_freedom());
  }

  void GiveUp() {
    result_.kept.insert(result_.kept.end(), result_.excluded.begin(), result_.excluded.end());
    std::sort(result_.kept.begin(), result_.kept.end());
    result_.excluded.clear();
    result_.exchanged.clear();
    result_.contradicted = true;
  }

  // One blunder may have put blame on its neighbours.
  void TakeBack() {
    for (bool again = true; again;) {
      again = false;
      double least = result_.critical_t;
      int innocent = -1;
      for (const int mark : result_.excluded) {
        if (std::any_of(result_.exchanged.begin(), result_.exchanged.end(),
                        [&](const auto& pair) { return pair.first == mark || pair.second == mark; }))
          continue;
        Marks with = result_.kept;
        with.insert(std::upper_bound(with.begin(), with.end(), mark), mark);
        const ControlTests tests(misfit_, with);
        const double t = tests.Test(std::span(&mark, 1), {}).t;
        if (!tests.usable() || t > least) continue;
        least = t;
        innocent = mark;
      }
      if (innocent < 0) break;
      std::erase(result_.excluded, innocent);
      result_.kept.insert(std::upper_bound(result_.kept.begin(), result_.kept.end(), innocent), innocent);
      again = true;
    }
  }

  const ControlMisfit& misfit_;
  std::size_t num_points_ = 0;
  BlunderSearch result_;
};

}  // namespace

BlunderSearch SearchBlunders(const ControlMisfit& misfit, double family_significance) {
  return Search(misfit, family_significance).Run();
}

}  // namespace survey
