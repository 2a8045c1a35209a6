// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/statement.h"

#include <cstdio>

#include "survey/accuracy/error_statistics.h"

namespace survey {
namespace {

constexpr int kAsprsMinimum = 30;  // [ASPRS24] section 7.13
constexpr int kNssdaMinimum = 20;
constexpr const char* kStandard =
    "ASPRS Positional Accuracy Standards for Digital Geospatial Data, Edition 2, Version 2 (2024)";

std::string Centimetres(const std::optional<double>& metres) {
  if (!metres) return "___ (cm)";
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.1f (cm)", *metres * 100.0);
  return buffer;
}

std::string Metres(const std::optional<double>& metres) {
  if (!metres) return "___ meters";
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3f meters", *metres);
  return buffer;
}

std::string NotMet(const StatementInput& input) {
  return "This data set was tested as required by " + std::string(kStandard) + ", using " +
         std::to_string(input.num_points) + " checkpoint" + (input.num_points == 1 ? "" : "s") +
         ". The tested horizontal positional accuracy was found to be RMSE_H = " + Centimetres(input.rmse_product) +
         ", which DOES NOT MEET a " + Centimetres(input.class_m) + " RMSE_H Horizontal Positional Accuracy Class.";
}

}  // namespace

std::string AsprsStatement(const StatementInput& input) {
  const std::string class_text = Centimetres(input.class_m) + " RMSE_H Horizontal Positional Accuracy Class.";
  const std::string found =
      " The tested horizontal positional accuracy was found to be RMSE_H = " + Centimetres(input.rmse_product);
  if (input.num_points == 0) {
    return "This data set was produced to meet " + std::string(kStandard) + " for a " + class_text;
  }
  if (input.class_m && input.rmse_product && *input.rmse_product > *input.class_m) return NotMet(input);
  if (input.num_points >= kAsprsMinimum) {
    return "This data set was tested to meet " + std::string(kStandard) + " for a " + class_text + found + ".";
  }
  return "This data set was tested as required by " + std::string(kStandard) +
         ". Although the Standards call for a minimum of thirty (30) checkpoints, this test was performed using ONLY " +
         std::to_string(input.num_points) + " checkpoint" + (input.num_points == 1 ? "" : "s") +
         ". This data set was produced to meet a " + class_text + found + " using the reduced number of checkpoints.";
}

std::string NssdaStatement(const StatementInput& input) {
  const std::string at_95 = " horizontal accuracy at 95% confidence level";
  if (input.num_points >= kNssdaMinimum) return "Tested " + Metres(input.nssda_95) + at_95 + ".";
  const std::optional<double> class_95 =
      input.class_m ? std::optional<double>(kNssdaFactor * *input.class_m) : std::nullopt;
  if (input.num_points == 0) return "Compiled to meet " + Metres(class_95) + at_95 + ".";
  return "No NSSDA statement: it needs at least " + std::to_string(kNssdaMinimum) + " check points, " +
         std::to_string(input.num_points) + (input.num_points == 1 ? " was" : " were") + " tested.";
}

}  // namespace survey
