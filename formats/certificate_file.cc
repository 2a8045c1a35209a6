// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_file.h"

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/joint_json.h"
#include "formats/json_text.h"
#include "formats/json_values.h"

// The members of the value types under their own names.
namespace survey {

using nlohmann::json;

NLOHMANN_JSON_SERIALIZE_ENUM(PointRole, {{PointRole::kControl, "control"},
                                         {PointRole::kCheck, "check"},
                                         {PointRole::kTie, "tie"},
                                         {PointRole::kExcluded, "excluded"}})
NLOHMANN_JSON_SERIALIZE_ENUM(CheckKind, {{CheckKind::kPoint, "check point"}, {CheckKind::kFeature, "check feature"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SiteFrame, crs, wkt2)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ControlPoint, name, role, position_in_site, covariance, elevation_m,
                                   elevation_sigma_m, description, reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AdjustmentSummary, software, description, num_observations, num_unknowns, defect,
                                   degrees_of_freedom, sigma_zero_a_priori, sigma_zero, degrees, scaled, confidence,
                                   chi_square, chi_square_lower, chi_square_upper, critical_w, largest_w,
                                   num_uncontrolled, num_suspected)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Bounds, low, high)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BiasTest, t_squared, p_value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(QuantileEstimate, value, upper_95)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ErrorStatistics, num_errors, num_points, num_independent, mean, rmse_by_axis, rmse,
                                   rmse_survey, rmse_product, max, nssda_95, length_68, length_95, covariance, nmad,
                                   ce95, effective_dof, rmse_bounds_95, rmse_upper_95, rmse_product_upper_95, bias)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ClassVerdict, class_m, meets, demonstrated, bias_within, bias_power, blunders,
                                   num_beyond_95, largest_rate_beyond_95)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FitResidual, block, point, given, residual, rigid_residual)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ControlVerdict, free_sigma_zero, rigid_rms, scale_deviation, scale_sigma, chi_square,
                                   degrees_of_freedom, chi_square_lower, chi_square_upper, critical_t, rejection_t,
                                   contradicted)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(VarianceComponent, kind, count, redundancy, factor)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MarkReliability, point, used, redundancy, t, detectable, largest_shift,
                                   left_out_residual, left_out_covariance, left_out)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BlockReliability, block, verdict, components, marks, findings)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CrossValidation, statistics, normalised_square, sentence)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TestedCheck, kind, block, name, in_map, reference, error, reference_covariance,
                                   distance_to_control, blunder, outlier)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AccuracyTest, statistics, verdict)
NLOHMANN_JSON_SERIALIZE_ENUM(ClassStatistic, {{ClassStatistic::kRmseHorizontal, "rmse-h"},
                                              {ClassStatistic::kRmseAxis, "rmse-axis"},
                                              {ClassStatistic::kCircle95, "ce95"},
                                              {ClassStatistic::kNssda95, "nssda-95"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(NormalityTest, w, p_by_axis, skewness, skewness_p, kurtosis, kurtosis_p)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BlockEffect, num_blocks, wilks_lambda, f, p_value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MoranTest, i, p_value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CheckSpread, hull_share, quadrant_shares, nearest_control_min,
                                   nearest_control_median, nearest_control_max)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AccuracyClass, standard, name, source, statistic, confidence, limit_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ClassResult, accuracy_class, value_m, upper_95, meets, demonstrated)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CheckAnalysis, normality, num_outliers, block_effect, moran, spread, classes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RelativeAccuracy, num_features, rms, scale)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(NavigatedTimes, inertial, odometry, constant_velocity, unmatched)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BlockReview, num_requests, num_answered, num_skipped, num_open, num_answers,
                                   cells_compared, cells_contradicted)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BlockCertificate, name, tied, num_scans, path_length, num_loops, num_control_points,
                                   num_control_marks, rigid_scale, sigma_zero, degrees_of_freedom, fit_rms,
                                   rigid_fit_rms, points, features, relative, navigated, breaks, review)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StitchingPair, block_a, block_b, feature, difference)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SeamSummary, block_a, block_b, overlap_area_m2, num_windows, rms, contradicted_share,
                                   sigmas, contradicts)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StitchingAccuracy, pairs, rms, max, seams)
NLOHMANN_JSON_SERIALIZE_ENUM(PointFate, {{PointFate::kMoved, "moved"},
                                         {PointFate::kAdded, "added"},
                                         {PointFate::kRemoved, "removed"},
                                         {PointFate::kOtherRole, "other role"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DeliveredPoint, name, role, position)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ControlChange, name, fate, before, now, shift, map_shift)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BlockChange, name, num_poses, mean_shift, rms_shift, max_shift, place_of_max)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DeliveryChanges, control, blocks)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EditedBlock, block, num_edits, edited_cells, max_shift_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EditSummary, num_edits, num_forbidden, num_masks, blocks, findings)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Statement, tested_on, num_points, asprs, nssda, meets, demonstrated)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Certificate, site, frame, metric, class_m, tied, statement, points,
                                   control_adjustment, control_remarks, blocks, fit, reliability, cross_validation,
                                   checks, points_test, features_test, points_analysis, features_analysis, stitching,
                                   joint, since_delivery, edits, not_tested)

}  // namespace survey

namespace formats {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "plumbline-certificate";
constexpr int kVersion = 6;

}  // namespace

void WriteCertificate(const std::filesystem::path& file, const survey::Certificate& certificate,
                      const Provenance& provenance) {
  json document = certificate;
  document["format"] = kFormat;
  document["format_version"] = kVersion;
  document["provenance"] = ToJson(provenance);
  WriteJson(file, document);
}

survey::Certificate ReadCertificate(const std::filesystem::path& file, Provenance* provenance) {
  const json document = JsonOrDiscarded(ReadWholeFile(file));
  if (!document.is_object() || document.value("format", "") != kFormat) {
    throw DataError(file.string() + ": is not a certificate (or was cut off)");
  }
  if (document.value("format_version", 0) != kVersion) {
    throw DataError(file.string() + ": was written by another version; make it again");
  }
  try {
    if (provenance != nullptr) *provenance = ProvenanceFromJson(document.at("provenance"));
    return document.get<survey::Certificate>();
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": " + error.what());
  }
}

}  // namespace formats
