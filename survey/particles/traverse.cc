// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/traverse.h"

#include <algorithm>

#include "survey/particles/update_motion.h"

namespace survey {
namespace {

// From one update to the next, with the sums of the variances from the traverse's begin on.
struct Leg {
  Pose2 motion;
  double variance_m = 0.0;
  double variance_rad = 0.0;
};

class TraverseCloser {
 public:
  TraverseCloser(const Track& track, const TrajectoryTree& tree, const Answers& answers,
                 const ParticleFilterOptions& options, std::vector<Pose2>* trajectory)
      : track_(track), tree_(tree), answers_(answers), options_(options), trajectory_(*trajectory) {}

  void Run() {
    std::size_t known = 0;
    for (const Answer& answer : answers_) {
      if (!answer.HasRelativePose()) continue;
      const std::size_t at = UpdateAt(answer.scan);
      if (at == tree_.size() || tree_[at].scan != answer.scan) continue;  // confirmed between two updates
      if (answer.MovesParticles()) Close(std::max(known, UpdateAt(answer.reference)), at);
      known = at;
    }
  }

 private:
  std::size_t UpdateAt(ScanId scan) const {
    const auto found = std::lower_bound(tree_.begin(), tree_.end(), scan,
                                        [](const FilterUpdate& update, ScanId id) { return update.scan < id; });
    return static_cast<std::size_t>(found - tree_.begin());
  }

  // The last leg is that of the track: the filter's own step there is the correction.
  std::vector<Leg> Legs(std::size_t begin, std::size_t end) const {
    std::vector<Leg> legs;
    Leg leg;
    for (std::size_t k = begin + 1; k <= end; ++k) {
      const UpdateMotion motion = MotionBetween(track_, tree_[k - 1].scan, tree_[k].scan, answers_, options_);
      leg.motion = k == end ? motion.motion : Between(trajectory_[k - 1], trajectory_[k]);
      leg.variance_m += motion.covariance(0, 0);
      leg.variance_rad += motion.covariance(2, 2);
      legs.push_back(leg);
    }
    return legs;
  }

  // Headings first, then what remains of the positions.
  void Close(std::size_t begin, std::size_t end) {
    if (begin >= end) return;
    const std::vector<Leg> legs = Legs(begin, end);
    double turned = trajectory_[begin].theta;
    for (const Leg& leg : legs) turned += leg.motion.theta;
    const double turn = NormalizeAngle(trajectory_[end].theta - turned);
    std::vector<Pose2> way = {trajectory_[begin]};
    double share = 0.0;
    for (const Leg& leg : legs) {
      // The heading goes wrong along the leg: it moves in the direction of its middle.
      const double next = leg.variance_rad / legs.back().variance_rad;
      const Pose2& from = way.back();
      const Pose2 heading{from.x, from.y, from.theta + 0.5 * turn * (next - share)};
      way.push_back(heading * leg.motion);
      way.back().theta = NormalizeAngle(way.back().theta + 0.5 * turn * (next - share));
      share = next;
    }
    const Eigen::Vector2d shift = trajectory_[end].Translation() - way.back().Translation();
    for (std::size_t i = 0; i + 1 < legs.size(); ++i) {
      const Eigen::Vector2d part = shift * (legs[i].variance_m / legs.back().variance_m);
      trajectory_[begin + i + 1] = {way[i + 1].x + part.x(), way[i + 1].y + part.y(), way[i + 1].theta};
    }
  }

  const Track& track_;
  const TrajectoryTree& tree_;
  const Answers& answers_;
  const ParticleFilterOptions& options_;
  std::vector<Pose2>& trajectory_;
};

}  // namespace

void CloseTraverses(const Track& track, const TrajectoryTree& tree, const Answers& answers,
                    const ParticleFilterOptions& options, std::vector<Pose2>* trajectory) {
  TraverseCloser(track, tree, answers, options, trajectory).Run();
}

}  // namespace survey
