// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/particle_filter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "survey/particles/update_motion.h"
#include "survey/particles/weights.h"
#include "survey/sensors/scan_points.h"
#include "survey/stats/philox.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

// Of an answer that does not move particles, against the poses of its reference and its scan.
double SquaredNormalisedResidual(const Answer& answer, const Pose2& reference, const Pose2& scan) {
  if (answer.walls) return SquaredNormalisedResidual(*answer.walls, answer.wall_sigma, reference, scan);
  const Pose2 shown = Between(reference, scan);
  const Pose2& confirmed = answer.reference_from_scan;
  const Eigen::Vector3d error(shown.x - confirmed.x, shown.y - confirmed.y,
                              NormalizeAngle(shown.theta - confirmed.theta));
  return error.cwiseQuotient(answer.sigma).squaredNorm();
}

enum class Purpose : std::uint32_t { kProposal = 0x70660001U, kResampling, kAnswer };

struct Particle {
  Pose2 pose;
  double evidence = 0.0;
  ParticleMap map;
};

class Filter {
 public:
  Filter(const Session& session, const Track& track, const Answers& answers, const TrackOptions& tracking,
         const ParticleFilterOptions& options)
      : session_(session),
        track_(track),
        answers_(answers),
        tracking_(tracking),
        options_(options),
        projector_(session.geometries, tracking.max_range_m, 0.0),
        particles_(static_cast<std::size_t>(options.particles),
                   Particle{.map = {SurfaceMap(tracking.map.surface_cell_size_m),
                                    SurfaceMap(tracking.map.coarse_surface_cell_size_m)}}),
        log_weights_(particles_.size(), -std::log(static_cast<double>(options.particles))) {}

  // `answer` may be null.
  void Update(ScanId scan, const Answer* answer) {
    Prepare(scan);
    FilterUpdate update{.scan = scan};
    if (tree_.empty()) {
      Begin(scan);
    } else if (answer != nullptr && answer->MovesParticles()) {
      SeedAround(*answer);
    } else {
      Propagate(scan);
      if (answer != nullptr) Weigh(*answer);
    }
    update.lost = !NormalizeLogWeights(&log_weights_);
    update.effective_size = EffectiveSampleSize(log_weights_);
    update.spread = Spread();
    update.resampled = update.effective_size < options_.resampling_share * static_cast<double>(options_.particles);
    update.parents = update.resampled ? Resample(scan) : Unchanged();
    Draw();
    for (const Particle& particle : particles_) {
      update.poses.push_back(particle.pose);
      update.evidence.push_back(particle.evidence);
    }
    update.log_weights = log_weights_;
    tree_.push_back(std::move(update));
  }

  // An update that was computed before: the same maps without the matching.
  void Replay(const FilterUpdate& update) {
    Prepare(update.scan);
    if (update.resampled) CopyParticles(update.parents);
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      particles_[i].pose = update.poses[i];
      particles_[i].evidence = update.evidence[i];
    }
    log_weights_ = update.log_weights;
    Draw();
    tree_.push_back(update);
  }

  TrajectoryTree Finish() { return std::move(tree_); }

 private:
  const Pose2& Tracked(std::size_t i) const { return track_.scans[i].local_from_scan; }

  void Prepare(ScanId scan) {
    const auto index = static_cast<std::size_t>(scan.value);
    projector_.Project(session_, index,
                       TwistOfScan(
                           session_.scans, [this](std::size_t i) { return Tracked(i); }, index),
                       &points_);
    SurfacePointsOfScan(points_.hits, tracking_.map.point_spacing_m, static_cast<std::size_t>(tracking_.map.max_points),
                        &surfaces_);
  }

  void Begin(ScanId scan) {
    for (Particle& particle : particles_) particle.pose = Tracked(static_cast<std::size_t>(scan.value));
  }

  // Augmented resampling, [AS] eq. (4)-(5): every particle is moved to the answered pose in its own map (the reference
  // scan stands elsewhere in each), blurred by the answer's sigmas, matched and weighted.
  // The match begins near: walls that were drawn displaced stand a little farther off and must not catch it.
  void SeedAround(const Answer& answer) {
    const std::size_t reference = UpdateAt(answer.reference);
    tbb::parallel_for(std::size_t{0}, particles_.size(), [&](std::size_t i) {
      const Pose2 map_from_reference = PoseOfAncestor(tree_, i, reference);
      const Pose2 answered = map_from_reference * answer.reference_from_scan;
      const Eigen::Matrix3d covariance =
          RotatedCovariance(answer.sigma.cwiseAbs2().asDiagonal(), map_from_reference.theta);
      const Pose2 start = SamplePose(answered, covariance, Normals(Purpose::kAnswer, answer.scan, i));
      Move(i, answer.scan,
           ProposePose(particles_[i].map, surfaces_, start, Start::kNear, answered, covariance, options_.proposal));
    });
  }

  // What a person confirmed, or knows of two walls, in each particle's own map.
  void Weigh(const Answer& answer) {
    const std::size_t reference = UpdateAt(answer.reference);
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const double log_weight =
          -0.5 * SquaredNormalisedResidual(answer, PoseOfAncestor(tree_, i, reference), particles_[i].pose);
      particles_[i].evidence += log_weight;
      log_weights_[i] += log_weight;
    }
  }

  std::size_t UpdateAt(ScanId scan) const {
    const auto found = std::lower_bound(tree_.begin(), tree_.end(), scan,
                                        [](const FilterUpdate& update, ScanId id) { return update.scan < id; });
    return static_cast<std::size_t>(found - tree_.begin());
  }

  void Move(std::size_t i, ScanId scan, const Proposal& proposal) {
    particles_[i].pose = SamplePose(proposal.mean, proposal.covariance, Normals(Purpose::kProposal, scan, i));
    particles_[i].evidence += proposal.log_weight;
    log_weights_[i] += proposal.log_weight;
  }

  // Pose propagation, scan matching and importance weighting of [AS] section III.
  void Propagate(ScanId scan) {
    const UpdateMotion motion = MotionBetween(track_, tree_.back().scan, scan, answers_, options_);
    tbb::parallel_for(std::size_t{0}, particles_.size(), [&](std::size_t i) {
      const Particle& particle = particles_[i];
      const Pose2 predicted = particle.pose * motion.motion;
      Move(i, scan,
           ProposePose(particle.map, surfaces_, predicted, Start::kPredicted, predicted,
                       RotatedCovariance(motion.covariance, particle.pose.theta), options_.proposal));
    });
  }

  Eigen::Vector3d Normals(Purpose purpose, ScanId scan, std::size_t particle) const {
    const RandomStream stream(static_cast<std::uint64_t>(options_.seed), static_cast<std::uint32_t>(purpose),
                              static_cast<std::uint32_t>(particle));
    const std::uint64_t index = 2 * static_cast<std::uint64_t>(scan.value);
    const auto [a, b] = stream.Normals(index);
    return {a, b, stream.Normal(index + 1)};
  }

  std::vector<int> Resample(ScanId scan) {
    const RandomStream stream(static_cast<std::uint64_t>(options_.seed),
                              static_cast<std::uint32_t>(Purpose::kResampling), 0);
    std::vector<int> parents =
        SystematicResampling(log_weights_, stream.Uniform(static_cast<std::uint64_t>(scan.value)));
    CopyParticles(parents);
    std::fill(log_weights_.begin(), log_weights_.end(), -std::log(static_cast<double>(options_.particles)));
    return parents;
  }

  void CopyParticles(const std::vector<int>& parents) {
    std::vector<Particle> chosen;
    chosen.reserve(particles_.size());
    for (const int parent : parents) chosen.push_back(particles_[static_cast<std::size_t>(parent)]);
    particles_ = std::move(chosen);
  }

  std::vector<int> Unchanged() const {
    std::vector<int> parents;
    for (int i = 0; i < options_.particles; ++i) parents.push_back(i);
    return parents;
  }

  void Draw() {
    tbb::parallel_for(std::size_t{0}, particles_.size(),
                      [&](std::size_t i) { particles_[i].map.Insert(particles_[i].pose, surfaces_); });
  }

  // Weighted standard deviations about the weighted mean.
  Pose2 Spread() const {
    const Pose2& origin = particles_.front().pose;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const Pose2& pose = particles_[i].pose;
      const Eigen::Vector3d d(pose.x - origin.x, pose.y - origin.y, NormalizeAngle(pose.theta - origin.theta));
      sum += std::exp(log_weights_[i]) * d;
      squares += std::exp(log_weights_[i]) * d.cwiseProduct(d);
    }
    return Pose2::FromVector((squares - sum.cwiseProduct(sum)).cwiseMax(0.0).cwiseSqrt());
  }

  const Session& session_;
  const Track& track_;
  const Answers& answers_;
  const TrackOptions& tracking_;
  const ParticleFilterOptions& options_;
  ScanProjector projector_;
  std::vector<Particle> particles_;
  std::vector<double> log_weights_;
  TrajectoryTree tree_;
  ScanPoints points_;  // of the scan at hand
  std::vector<SurfacePoint> surfaces_;
};

}  // namespace

std::vector<ScanId> ScansForUpdates(const Track& track, const Answers& answers, const ParticleFilterOptions& options) {
  constexpr double kSooner = 0.2;
  std::vector<bool> answered(track.scans.size(), false);
  for (const Answer& answer : answers) {
    if (!answer.ActsInFilter()) continue;
    answered[static_cast<std::size_t>(answer.scan.value)] = true;
    answered[static_cast<std::size_t>(answer.reference.value)] = true;
  }
  std::vector<ScanId> scans;
  double usual_score = 0.5;
  Pose2 last;
  for (const TrackedScan& scan : track.scans) {
    const Pose2 motion = Between(last, scan.local_from_scan);
    const double part = std::max(motion.Translation().norm() / options.update_distance_m,
                                 std::abs(motion.theta) / options.update_angle_rad);
    const bool poor = scan.matched && static_cast<double>(scan.score) < options.poor_score_ratio * usual_score;
    if (scan.matched) usual_score += 0.02 * (static_cast<double>(scan.score) - usual_score);
    // Without a match there is nothing to weight or draw: the motion goes on to where matches begin again.
    const bool due = scan.matched && part >= (poor ? kSooner : 1.0);
    if (!scans.empty() && !due && !answered[static_cast<std::size_t>(scan.scan.value)]) continue;
    scans.push_back(scan.scan);
    last = scan.local_from_scan;
  }
  return scans;
}

TrajectoryTree RunParticleFilter(const Session& session, const Track& track, const Answers& answers,
                                 const TrackOptions& tracking, const ParticleFilterOptions& options,
                                 const std::function<void(std::size_t)>& progress, const TrajectoryTree& known) {
  Filter filter(session, track, answers, tracking, options);
  std::size_t done = 0;
  auto answer = answers.begin();
  for (const ScanId scan : ScansForUpdates(track, answers, options)) {
    while (answer != answers.end() && answer->scan < scan) ++answer;
    if (done < known.size()) {
      filter.Replay(known[done]);
    } else {
      filter.Update(scan, answer != answers.end() && answer->scan == scan ? &*answer : nullptr);
    }
    ++done;
    if (progress) progress(done);
  }
  return filter.Finish();
}

}  // namespace survey
