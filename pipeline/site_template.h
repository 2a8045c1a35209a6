// SPDX-License-Identifier: Apache-2.0
//
// The texts of a new site's files. Every key that a stage knows stands there as a comment with its default and meaning,
// so the files can hold no key that does not exist.
#pragma once

#include <string>

#include "pipeline/site_config.h"

namespace pipeline {

std::string MakefileText();
std::string SiteToml(const std::string& crs, const std::string& control_order, const GraphStages& stages);
std::string BlockToml(const std::string& block, const GraphStages& stages);

}  // namespace pipeline
