// SPDX-License-Identifier: Apache-2.0
//
// Accuracy classes as TOML: those of the standards, which come with the program (accuracy_classes.toml), and those that
// an office adds.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "survey/accuracy/accuracy_class.h"

namespace formats {

// Classes that are a multiple of the one asked for are left out when `class_m` is empty.
std::vector<survey::AccuracyClass> StandardAccuracyClasses(std::optional<double> class_m);

// DataError names file, class, key and rule.
std::vector<survey::AccuracyClass> ReadAccuracyClasses(const std::filesystem::path& file,
                                                       std::optional<double> class_m);

}  // namespace formats
