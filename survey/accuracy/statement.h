// SPDX-License-Identifier: Apache-2.0
//
// The fixed wording of accuracy statements, chosen from the number of check points: [ASPRS24] section 7.16 and [NSSDA].
// A number that is missing prints as ___. Where the class is not met the standards have no wording; ours says so.
#pragma once

#include <optional>
#include <string>

namespace survey {

struct StatementInput {
  int num_points = 0;                  // independent check points tested
  std::optional<double> class_m;       // RMSE_H of the class
  std::optional<double> rmse_product;  // RMSE_H found; with num_points > 0
  std::optional<double> nssda_95;      // with num_points > 0
};

std::string AsprsStatement(const StatementInput& input);
std::string NssdaStatement(const StatementInput& input);

}  // namespace survey
