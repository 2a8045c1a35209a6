// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/control_reliability.h"

namespace survey {

BlockReliability ReliabilityOf(const std::string& block, const Solution& solution) {
  BlockReliability result{
      .block = block, .verdict = solution.control, .components = solution.components, .findings = solution.findings};
  for (const SolvedMark& mark : solution.marks) {
    if (!mark.test) continue;
    MarkReliability row{.point = mark.point,
                        .used = mark.used,
                        .redundancy = mark.test->redundancy,
                        .t = mark.test->t,
                        .detectable = mark.test->detectable,
                        .largest_shift = mark.test->largest_shift,
                        .left_out = mark.left_out};
    if (mark.test->detectable) {
      row.left_out_residual = mark.test->left_out;
      row.left_out_covariance = mark.test->left_out_covariance;
    }
    result.marks.push_back(std::move(row));
  }
  return result;
}

}  // namespace survey
