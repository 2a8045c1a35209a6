// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/certify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "survey/accuracy/not_tested.h"
#include "survey/accuracy/statement.h"
#include "survey/control/block_extract.h"
#include "survey/geometry/rigid_fit.h"

namespace survey {
namespace {

constexpr int kFewestForRelative = 3;

const NamedFeature* FindReference(const std::vector<NamedFeature>& features, const std::string& name) {
  const auto found = std::find_if(features.begin(), features.end(), [&](const auto& f) { return f.name == name; });
  return found == features.end() ? nullptr : &*found;
}

// Null when the block's map does not show it.
const MapFeature* FindInMap(const CertifiedBlock& block, const std::string& name) {
  const auto found = std::find_if(block.features.begin(), block.features.end(),
                                  [&](const MapFeature& f) { return f.found && f.name == name; });
  return found == block.features.end() ? nullptr : &*found;
}

double Rms(const std::vector<Eigen::Vector2d>& errors) {
  double sum = 0.0;
  for (const Eigen::Vector2d& error : errors) sum += error.squaredNorm();
  return errors.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

double PathLength(const std::vector<SolvedScan>& scans) {
  double length = 0.0;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    length += (scans[i].site_from_scan.Translation() - scans[i - 1].site_from_scan.Translation()).norm();
  }
  return length;
}

class Certifier {
 public:
  explicit Certifier(const CertifyInput& input) : input_(input) {}

  Certificate Run() {
    certificate_.site = input_.site;
    certificate_.frame = input_.network.frame;
    certificate_.class_m = input_.class_m;
    certificate_.points = input_.network.points;
    certificate_.control_adjustment = input_.network.adjustment;
    certificate_.control_remarks = input_.network.remarks;
    CollectFit();
    for (const CertifiedBlock& block : input_.blocks) {
      if (block.solution.tied) CollectChecks(block);
    }
    for (const CertifiedBlock& block : input_.blocks) certificate_.blocks.push_back(Summary(block));
    TestSite(CheckKind::kPoint, &certificate_.points_test, &certificate_.points_analysis);
    TestSite(CheckKind::kFeature, &certificate_.features_test, &certificate_.features_analysis);
    certificate_.cross_validation = CrossValidate(certificate_.reliability, input_.network);
    FlagBlunders();
    CompareBlocks();
    MakeStatement();
    certificate_.not_tested = ListNotTested(input_, certificate_);
    return std::move(certificate_);
  }

 private:
  void CollectFit() {
    for (const CertifiedBlock& block : input_.blocks) {
      if (!block.solution.tied) continue;
      certificate_.tied = true;
      certificate_.reliability.push_back(ReliabilityOf(block.name, block.solution));
      for (const SolvedMark& mark : block.solution.marks) {
        if (!mark.used) continue;
        certificate_.fit.push_back({.block = block.name,
                                    .point = mark.point,
                                    .given = mark.position_in_site - mark.residual,
                                    .residual = mark.residual,
                                    .rigid_residual = mark.rigid_residual});
      }
    }
  }

  std::optional<double> DistanceToControl(const Eigen::Vector2d& position) const {
    std::optional<double> nearest;
    for (const FitResidual& control : certificate_.fit) {
      const double distance = (control.given - position).norm();
      nearest = std::min(nearest.value_or(distance), distance);
    }
    return nearest;
  }

  void AddCheck(CheckKind kind, const std::string& block, const std::string& name, const Eigen::Vector2d& in_map,
                const Eigen::Vector2d& reference, const Eigen::Matrix2d& covariance) {
    certificate_.checks.push_back({.kind = kind,
                                   .block = block,
                                   .name = name,
                                   .in_map = in_map,
                                   .reference = reference,
                                   .error = in_map - reference,
                                   .reference_covariance = covariance,
                                   .distance_to_control = DistanceToControl(reference)});
  }

  void CollectChecks(const CertifiedBlock& block) {
    const Eigen::Matrix2d centring = Eigen::Matrix2d::Identity() * input_.centring_sigma_m * input_.centring_sigma_m;
    for (const SolvedMark& mark : block.solution.marks) {
      const ControlPoint* point = FindPoint(input_.network, mark.point);
      if (point == nullptr || point->role != PointRole::kCheck || mark.used) continue;
      AddCheck(CheckKind::kPoint, block.name, mark.point, mark.position_in_site, point->position_in_site,
               point->covariance + centring);
    }
    for (const MapFeature& feature : block.features) {
      const NamedFeature* reference = FindReference(input_.reference_features, feature.name);
      if (!feature.found || reference == nullptr) continue;
      AddCheck(CheckKind::kFeature, block.name, feature.name, feature.position_in_site, reference->position_in_site,
               reference->covariance + feature.reading);
    }
  }

  // The test over one block, or over all with null.
  AccuracyTest Test(CheckKind kind, const std::string* block, std::optional<int> num_independent = {}) const {
    std::map<std::string, int> points;
    std::vector<PositionError> errors;
    for (const TestedCheck& check : certificate_.checks) {
      if (check.kind != kind || (block != nullptr && check.block != *block)) continue;
      const int point = points.emplace(check.name, static_cast<int>(points.size())).first->second;
      errors.push_back({.point = point, .error = check.error, .reference_covariance = check.reference_covariance});
    }
    AccuracyTest test{.statistics = Summarize(errors, num_independent)};
    if (input_.class_m) test.verdict = JudgeClass(errors, test.statistics, *input_.class_m);
    return test;
  }

  std::vector<PlacedError> PlacedErrors(CheckKind kind) const {
    std::map<std::string, int> points, blocks;
    std::vector<PlacedError> errors;
    for (const TestedCheck& check : certificate_.checks) {
      if (check.kind != kind) continue;
      errors.push_back({.point = points.emplace(check.name, static_cast<int>(points.size())).first->second,
                        .block = blocks.emplace(check.block, static_cast<int>(blocks.size())).first->second,
                        .position = check.reference,
                        .error = check.error});
    }
    return errors;
  }

  // Where blocks have errors of their own, the bounds count blocks instead of points.
  void TestSite(CheckKind kind, AccuracyTest* test, CheckAnalysis* analysis) {
    const std::vector<PlacedError> errors = PlacedErrors(kind);
    std::vector<int> outliers;
    *analysis = AnalyseErrors(errors, &outliers);
    std::optional<int> num_independent;
    if (analysis->block_effect && analysis->block_effect->p_value < kClustered) {
      num_independent = analysis->block_effect->num_blocks;
    }
    *test = Test(kind, nullptr, num_independent);
    analysis->classes = JudgeClasses(test->statistics, input_.classes);
    std::vector<Eigen::Vector2d> checks;
    for (const PlacedError& error : errors) checks.push_back(error.position);
    analysis->spread = DescribeSpread(checks, TiedPaths(), UsedControl());
    int index = 0;
    for (TestedCheck& check : certificate_.checks) {
      if (check.kind != kind) continue;
      check.outlier = std::find(outliers.begin(), outliers.end(), index++) != outliers.end();
    }
  }

  std::vector<Eigen::Vector2d> TiedPaths() const {
    std::vector<Eigen::Vector2d> places;
    for (const CertifiedBlock& block : input_.blocks) {
      if (!block.solution.tied) continue;
      for (const SolvedScan& scan : block.solution.scans) places.push_back(scan.site_from_scan.Translation());
    }
    return places;
  }

  // Of the site, or of one block.
  std::vector<Eigen::Vector2d> UsedControl(const std::string* block = nullptr) const {
    std::vector<Eigen::Vector2d> control;
    for (const FitResidual& fit : certificate_.fit) {
      if (block == nullptr || fit.block == *block) control.push_back(fit.given);
    }
    return control;
  }

  BlockCertificate Summary(const CertifiedBlock& block) const {
    const Solution& solution = block.solution;
    BlockCertificate summary{.name = block.name,
                             .tied = solution.tied,
                             .num_scans = static_cast<int>(solution.scans.size()),
                             .path_length = PathLength(solution.scans),
                             .num_loops = solution.statistics.num_loops,
                             .rigid_scale = solution.rigid_scale,
                             .sigma_zero = solution.statistics.sigma_zero,
                             .degrees_of_freedom = solution.statistics.degrees_of_freedom};
    std::vector<Eigen::Vector2d> residuals, rigid_residuals;
    std::set<std::string> points;
    for (const FitResidual& fit : certificate_.fit) {
      if (fit.block != block.name) continue;
      points.insert(fit.point);
      residuals.push_back(fit.residual);
      rigid_residuals.push_back(fit.rigid_residual);
    }
    summary.num_control_points = static_cast<int>(points.size());
    summary.num_control_marks = static_cast<int>(residuals.size());
    summary.fit_rms = Rms(residuals);
    summary.rigid_fit_rms = Rms(rigid_residuals);
    summary.points = Test(CheckKind::kPoint, &block.name);
    summary.features = Test(CheckKind::kFeature, &block.name);
    summary.relative = Relative(block);
    const NavigationSummary& navigation = solution.navigation;
    summary.navigated = {navigation.inertial_s, navigation.odometry_s, navigation.constant_velocity_s,
                         navigation.unmatched_s};
    for (const TrackBreak& gap : solution.breaks) {
      summary.breaks.push_back("scan " + std::to_string(gap.scan.value) + ": " + gap.message);
    }
    summary.review = block.review;
    return summary;
  }

  std::optional<RelativeAccuracy> Relative(const CertifiedBlock& block) const {
    std::vector<Eigen::Vector2d> in_map, reference;
    for (const NamedFeature& reference_feature : input_.reference_features) {
      const MapFeature* feature = FindInMap(block, reference_feature.name);
      if (feature == nullptr) continue;
      in_map.push_back(feature->position_in_site);
      reference.push_back(reference_feature.position_in_site);
    }
    if (in_map.size() < kFewestForRelative) return std::nullopt;
    const std::optional<RigidFit> fit = FitRigid(in_map, reference);
    if (!fit) return std::nullopt;
    return RelativeAccuracy{static_cast<int>(in_map.size()), fit->rms_m, fit->similarity_scale};
  }

  void FlagBlunders() {
    for (const CheckKind kind : {CheckKind::kPoint, CheckKind::kFeature}) {
      const AccuracyTest& test = kind == CheckKind::kPoint ? certificate_.points_test : certificate_.features_test;
      if (!test.verdict) continue;
      int index = 0;
      for (TestedCheck& check : certificate_.checks) {
        if (check.kind != kind) continue;
        const std::vector<int>& blunders = test.verdict->blunders;
        check.blunder = std::find(blunders.begin(), blunders.end(), index++) != blunders.end();
      }
    }
  }

  void CompareBlocks() {
    StitchingAccuracy& stitching = certificate_.stitching;
    std::vector<Eigen::Vector2d> differences;
    for (std::size_t a = 0; a < input_.blocks.size(); ++a) {
      for (std::size_t b = a + 1; b < input_.blocks.size(); ++b) {
        if (!input_.blocks[a].solution.tied || !input_.blocks[b].solution.tied) continue;
        for (const MapFeature& in_a : input_.blocks[a].features) {
          const MapFeature* in_b = in_a.found ? FindInMap(input_.blocks[b], in_a.name) : nullptr;
          if (in_b == nullptr) continue;
          differences.push_back(in_a.position_in_site - in_b->position_in_site);
          stitching.pairs.push_back({input_.blocks[a].name, input_.blocks[b].name, in_a.name, differences.back()});
          stitching.max = std::max(stitching.max, differences.back().norm());
        }
      }
    }
    stitching.rms = Rms(differences);
    stitching.seams = input_.seams;
  }

  // Features test the map itself, so they carry the statement where there are any; the verdict needs every test.
  void MakeStatement() {
    Statement& statement = certificate_.statement;
    if (!certificate_.tied) return;
    const bool on_features = certificate_.features_test.statistics.num_points > 0;
    const AccuracyTest& test = on_features ? certificate_.features_test : certificate_.points_test;
    StatementInput wording{.num_points = test.statistics.num_points, .class_m = input_.class_m};
    if (wording.num_points > 0) {
      statement.tested_on = on_features ? "check features" : "check points";
      wording.rmse_product = test.statistics.rmse_product;
      wording.nssda_95 = test.statistics.nssda_95;
    }
    statement.num_points = wording.num_points;
    statement.asprs = AsprsStatement(wording);
    statement.nssda = NssdaStatement(wording);
    for (const AccuracyTest* each : {&certificate_.features_test, &certificate_.points_test}) {
      if (!each->verdict) continue;
      statement.meets = statement.meets.value_or(true) && each->verdict->meets;
      statement.demonstrated = statement.demonstrated.value_or(true) && each->verdict->demonstrated;
    }
    // A track that may have come apart is not demonstrated to meet anything, whatever the checks say.
    const bool broken = std::any_of(certificate_.blocks.begin(), certificate_.blocks.end(),
                                    [](const auto& block) { return block.tied && !block.breaks.empty(); });
    // Neither is a map that contradicts its control.
    const bool contradicted = std::any_of(certificate_.reliability.begin(), certificate_.reliability.end(),
                                          [](const auto& block) { return block.verdict.contradicted; });
    if ((broken || contradicted) && statement.demonstrated) statement.demonstrated = false;
  }

  const CertifyInput& input_;
  Certificate certificate_;
};

// Reference features that all lie far from all control are in another system, in other units, or exchanged.
std::optional<std::string> OtherSystem(const CertifyInput& input) {
  constexpr double kFar_m = 5000.0;
  double nearest_m = std::numeric_limits<double>::max();
  for (const NamedFeature& feature : input.reference_features) {
    for (const ControlPoint& point : input.network.points)
      nearest_m = std::min(nearest_m, (feature.position_in_site - point.position_in_site).norm());
  }
  if (input.reference_features.empty() || input.network.points.empty() || nearest_m < kFar_m) return std::nullopt;
  return "the check features lie " + std::to_string(std::llround(nearest_m / 1000.0)) + " km from all control, " +
         input.reference_features.front().name +
         " the first of them: another coordinate system, other units, or northing and easting exchanged";
}

}  // namespace

std::vector<std::string> FindContradictions(const CertifyInput& input) {
  std::vector<std::string> found;
  for (const CertifiedBlock& block : input.blocks) {
    if (block.solution.tied && block.solution.frame.crs != input.network.frame.crs) {
      found.push_back("the solution of block " + block.name + " is in \"" + block.solution.frame.crs +
                      "\", the control in \"" + input.network.frame.crs + "\"");
    }
    for (const SolvedMark& mark : block.solution.marks) {
      const ControlPoint* point = FindPoint(input.network, mark.point);
      if (!mark.used || (point != nullptr && point->role == PointRole::kControl)) continue;
      found.push_back("point " + mark.point + " was used as control in the solution of block " + block.name +
                      (point == nullptr ? " but is not in the control list"
                                        : " but its role is " + std::string(Name(point->role))) +
                      ": a check must not be control; adjust the block again");
    }
  }
  std::set<std::string> names;
  for (const NamedFeature& feature : input.reference_features) {
    if (!names.insert(feature.name).second) found.push_back("feature " + feature.name + " is listed twice");
    const ControlPoint* point = FindPoint(input.network, feature.name);
    if (point != nullptr && point->role != PointRole::kExcluded) {
      found.push_back("check feature " + feature.name + " bears the name of a point of the control list");
    }
  }
  if (const auto other_system = OtherSystem(input)) found.push_back(*other_system);
  return found;
}

Certificate Certify(const CertifyInput& input) { return Certifier(input).Run(); }

}  // namespace survey
