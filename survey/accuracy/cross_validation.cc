// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/cross_validation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <map>

#include "survey/control/block_extract.h"

namespace survey {
namespace {

bool MarkedOnce(const BlockReliability& block, const std::string& point) {
  return std::count_if(block.marks.begin(), block.marks.end(),
                       [&](const MarkReliability& mark) { return mark.used && mark.point == point; }) == 1;
}

std::string SentenceOf(const ErrorStatistics& statistics) {
  char text[240];
  std::snprintf(text, sizeof text,
                "Cross-validated, not tested: %d control point%s, each against where all others of its block put it, "
                "RMSE_H = %.1f (cm), largest %.1f (cm).",
                statistics.num_points, statistics.num_points == 1 ? "" : "s", 100.0 * statistics.rmse_product,
                100.0 * statistics.max);
  return text;
}

}  // namespace

std::optional<CrossValidation> CrossValidate(const std::vector<BlockReliability>& blocks,
                                             const ControlNetwork& network) {
  std::vector<PositionError> errors;
  std::map<std::string, int> index_of;
  double squares = 0.0;
  int num_squares = 0;
  for (const BlockReliability& block : blocks) {
    for (const MarkReliability& mark : block.marks) {
      if (!mark.used || !mark.left_out_residual || !MarkedOnce(block, mark.point)) continue;
      const ControlPoint* point = FindPoint(network, mark.point);
      const int index = index_of.emplace(mark.point, static_cast<int>(index_of.size())).first->second;
      errors.push_back(
          {index, *mark.left_out_residual, point == nullptr ? Eigen::Matrix2d::Zero() : point->covariance});
      if (!(mark.left_out_covariance->determinant() > 0.0)) continue;
      squares += mark.left_out_residual->dot(mark.left_out_covariance->inverse() * *mark.left_out_residual) / 2.0;
      ++num_squares;
    }
  }
  if (errors.empty()) return std::nullopt;
  CrossValidation result{.statistics = Summarize(errors)};
  if (num_squares > 0) result.normalised_square = squares / num_squares;
  result.sentence = SentenceOf(result.statistics);
  return result;
}

}  // namespace survey
