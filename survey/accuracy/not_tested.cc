// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/not_tested.h"

#include <algorithm>
#include <cstdio>
#include <set>

namespace survey {
namespace {

std::string Metres(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.0f", value);
  return buffer;
}

class NotTestedList {
 public:
  NotTestedList(const CertifyInput& input, const Certificate& certificate) : input_(input), certificate_(certificate) {}

  std::vector<std::string> Run() {
    ListBlocks();
    for (const CertifiedBlock& block : input_.blocks) {
      ListUnseen(block);
      ListFarFromControl(block);
    }
    ListMissingChecks();
    ListWeakTest("check points", certificate_.points_test, certificate_.points_analysis);
    ListWeakTest("check features", certificate_.features_test, certificate_.features_analysis);
    list_.push_back("Heights were not tested: the map is plane.");
    return std::move(list_);
  }

 private:
  void ListBlocks() {
    for (const BlockCertificate& block : certificate_.blocks) {
      if (!block.tied) {
        list_.push_back("Block " + block.name +
                        " is not tied to control: it lies in its local frame and is not certified.");
      } else if (block.points.statistics.num_points + block.features.statistics.num_points == 0) {
        list_.push_back("Block " + block.name +
                        " holds no check point and no check feature: its accuracy was not tested.");
      }
    }
    for (const BlockCertificate& block : certificate_.blocks) {
      for (const std::string& gap : block.breaks) {
        list_.push_back("Block " + block.name + " may be broken at " + gap +
                        ". What lies behind may be displaced against what lies before; checks elsewhere do not tell.");
      }
      ListAssumed(block);
    }
  }

  void ListAssumed(const BlockCertificate& block) {
    if (!block.review) return;
    const int assumed = block.review->num_open + block.review->num_skipped;
    if (assumed == 0) return;
    list_.push_back("Block " + block.name + ": " + std::to_string(assumed) + " of " +
                    std::to_string(block.review->num_requests) +
                    " review requests have no answer; the poses there are assumed to be right.");
  }

  void ListMissingChecks() {
    std::set<std::string> found;
    for (const TestedCheck& check : certificate_.checks) found.insert(check.name);
    ListMissing("Check point", " was not occupied in any tied block.", found);
    for (const NamedFeature& feature : input_.reference_features) {
      if (found.contains(feature.name)) continue;
      list_.push_back("Check feature " + feature.name + " was not found in the map of any tied block" +
                      ReasonNotFound(feature.name) + ".");
    }
    if (certificate_.tied && certificate_.features_test.statistics.num_points == 0) {
      list_.push_back(
          "No check feature was measured in the maps: check points test where the platform stood, not the walls.");
    }
  }

  void ListUnseen(const CertifiedBlock& block) {
    const auto seen =
        std::count_if(block.features.begin(), block.features.end(), [](const auto& f) { return f.found; });
    const auto sought = static_cast<std::ptrdiff_t>(block.features.size());
    if (!block.solution.tied || seen == sought) return;
    list_.push_back("Block " + block.name + ": " + std::to_string(seen) + " of " + std::to_string(sought) +
                    " check features could be read in its map; the others were not tested there.");
  }

  // " (B1: hidden; B2: ...)", each reason once.
  std::string ReasonNotFound(const std::string& name) const {
    std::vector<std::string> reasons;
    std::string text;
    for (const CertifiedBlock& block : input_.blocks) {
      for (const MapFeature& feature : block.features) {
        const bool known = std::find(reasons.begin(), reasons.end(), feature.reason) != reasons.end();
        if (!block.solution.tied || feature.name != name || feature.reason.empty() || known) continue;
        reasons.push_back(feature.reason);
        text += (text.empty() ? "" : "; ") + block.name + ": " + feature.reason;
      }
    }
    return text.empty() ? "" : " (" + text + ")";
  }

  void ListMissing(const std::string& what, const std::string& why, const std::set<std::string>& found) {
    for (const ControlPoint& point : input_.network.points) {
      if (point.role == PointRole::kCheck && !found.contains(point.name))
        list_.push_back(what + " " + point.name + why);
    }
  }

  void ListFarFromControl(const CertifiedBlock& block) {
    std::vector<Eigen::Vector2d> path, control;
    for (const SolvedScan& scan : block.solution.scans) path.push_back(scan.site_from_scan.Translation());
    for (const FitResidual& fit : certificate_.fit) {
      if (fit.block == block.name) control.push_back(fit.given);
    }
    if (control.empty()) return;
    const std::optional<FarFromControl> far = FindFarFromControl(path, control, input_.far_from_control_m);
    if (!far) return;
    list_.push_back("Block " + block.name + ": " + Metres(far->path_length) + " m of its path lie farther than " +
                    Metres(input_.far_from_control_m) + " m from its control, the farthest place (E " +
                    Metres(far->farthest.x()) + ", N " + Metres(far->farthest.y()) + ") " + Metres(far->distance) +
                    " m: the map is extrapolated there.");
  }

  void ListWeakTest(const std::string& checks, const AccuracyTest& test, const CheckAnalysis& analysis) {
    const std::string kind = "The " + checks;
    if (analysis.spread && analysis.spread->Uneven()) {
      list_.push_back(kind + " are spread unevenly: a quarter of the mapped extent holds less than a fifth of them.");
    }
    if (test.statistics.num_independent < test.statistics.num_points) {
      list_.push_back(kind + " have errors that differ by block: the bounds rest on " +
                      std::to_string(test.statistics.num_independent) + " blocks, not on " +
                      std::to_string(test.statistics.num_points) + " independent checks.");
    }
    if (analysis.moran && analysis.moran->p_value < kClustered) {
      list_.push_back(kind + " near each other have like errors (Moran's I): they prove less than their number says.");
    }
    if (analysis.normality && analysis.normality->Rejected()) {
      list_.push_back(kind + " have errors that are not normal: the quantiles of the errors lead, not CE95.");
    }
  }

  const CertifyInput& input_;
  const Certificate& certificate_;
  std::vector<std::string> list_;
};

}  // namespace

std::vector<std::string> ListNotTested(const CertifyInput& input, const Certificate& certificate) {
  return NotTestedList(input, certificate).Run();
}

}  // namespace survey
