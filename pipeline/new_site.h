// SPDX-License-Identifier: Apache-2.0
//
// `plumbline new`: the folder of a new site from field data and a control list.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/site_config.h"

namespace pipeline {

// A --block: NAME=FILE (a log or bag) or NAME=FOLDER (logs, bags or CSV files, with marks.csv).
struct NewBlock {
  std::string name;
  std::filesystem::path source;
};

struct NewSite {
  std::filesystem::path site;
  std::string crs;                 // empty: the control's own plane
  std::filesystem::path control;   // empty: no control
  std::string control_order;       // pnezd or penzd, of a control list without a header
  std::filesystem::path features;  // check features with independent coordinates; empty: none
  std::vector<NewBlock> blocks;
  bool link = false;  // link to the files instead of copying them
};

// "NAME=PATH"; UsageError otherwise.
NewBlock BlockFromText(const std::string& text);

// Checks everything, then makes the folder in one step: on an error there is no folder. Returns remarks for the user
// (files of a block's folder that are not field data).
std::vector<std::string> MakeSite(const NewSite& request, const GraphStages& stages);

}  // namespace pipeline
