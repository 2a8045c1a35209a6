// SPDX-License-Identifier: Apache-2.0
#include "pipeline/new_site.h"

#include <unistd.h>

#include <algorithm>
#include <set>

#include "formats/atomic_file.h"
#include "formats/control_csv.h"
#include "formats/control_source.h"
#include "formats/errors.h"
#include "formats/raster_file.h"
#include "pipeline/nearest.h"
#include "pipeline/site_layout.h"
#include "pipeline/site_template.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;
using formats::UsageError;

bool IsFieldData(const fs::path& file) {
  static const std::set<std::string> kNames = {"scans.csv", "imu.csv", "odometry.csv"};
  static const std::set<std::string> kExtensions = {".log", ".clf", ".bag"};
  return kNames.contains(file.filename().string()) || kExtensions.contains(file.extension().string());
}

// A file to bring into the site.
struct Delivery {
  fs::path from;
  fs::path to;  // relative to the site
};

void CheckIsFile(const fs::path& file) {
  if (!fs::exists(file)) throw DataError(file.string() + ": no such file");
  if (!fs::is_regular_file(file)) throw DataError(file.string() + ": not a file");
  if (access(file.c_str(), R_OK) != 0) throw DataError(file.string() + ": cannot be read");
}

void DeliverFolder(const NewBlock& block, const fs::path& target, std::vector<Delivery>* deliveries,
                   std::vector<std::string>* remarks) {
  bool any = false;
  for (const fs::directory_entry& entry : fs::directory_iterator(block.source)) {
    const fs::path name = entry.path().filename();
    if (name == "marks.csv") {
      deliveries->push_back({entry.path(), target / name});
    } else if (IsFieldData(name)) {
      deliveries->push_back({entry.path(), target / "raw" / name});
      any = true;
    } else {
      remarks->push_back(entry.path().string() + ": not field data, left out");
    }
  }
  if (!any) {
    throw DataError(block.source.string() +
                    ": no field data in this folder; expected scans.csv (with imu.csv, odometry.csv), *.log, *.clf or "
                    "*.bag");
  }
}

void DeliverBlock(const NewBlock& block, std::vector<Delivery>* deliveries, std::vector<std::string>* remarks) {
  const fs::path target = fs::path("blocks") / block.name;
  if (fs::is_directory(block.source)) {
    DeliverFolder(block, target, deliveries, remarks);
    return;
  }
  CheckIsFile(block.source);
  if (!IsFieldData(block.source)) {
    throw DataError(block.source.string() +
                    ": not field data; expected *.log or *.clf (CARMEN), *.bag (ROS 1), scans.csv, or a folder");
  }
  deliveries->push_back({block.source, target / "raw" / block.source.filename()});
}

void CheckRequest(const NewSite& request, const GraphStages& stages) {
  if (request.site.empty()) throw UsageError("SITE is required: the folder to make");
  std::error_code error;
  if (fs::exists(request.site, error) && !(fs::is_directory(request.site) && fs::is_empty(request.site))) {
    throw UsageError(request.site.string() + ": exists already and is not overwritten");
  }
  if (request.blocks.empty()) throw UsageError("--block NAME=FILE is required, once for each block");
  std::set<std::string> names;
  for (const NewBlock& block : request.blocks) {
    CheckBlockName(block.name, stages.Names());
    if (!names.insert(block.name).second) throw UsageError("--block " + block.name + ": given twice");
  }
  formats::Wkt2OfCrs(request.crs);
  if (!request.control.empty()) {
    CheckIsFile(request.control);
    if (!formats::IsControlSource(request.control)) {
      throw DataError(request.control.string() + ": control must be a .csv, .txt, .gkf, .dat or .xml file");
    }
    if (formats::IsPointList(request.control)) {
      formats::ReadControlCsv(request.control, {.order = request.control_order, .crs = request.crs});
    }
  }
  if (!request.features.empty()) CheckIsFile(request.features);
}

// Lists are all called points.csv or points.txt; what another program wrote keeps its name.
fs::path ControlName(const fs::path& control) {
  const fs::path folder = "control";
  return formats::IsPointList(control) ? (folder / "points").concat(control.extension().string())
                                       : folder / control.filename();
}

std::vector<Delivery> Deliveries(const NewSite& request, std::vector<std::string>* remarks) {
  std::vector<Delivery> deliveries;
  if (!request.control.empty()) deliveries.push_back({request.control, ControlName(request.control)});
  if (!request.features.empty()) deliveries.push_back({request.features, "control/features.csv"});
  for (const NewBlock& block : request.blocks) DeliverBlock(block, &deliveries, remarks);
  std::sort(remarks->begin(), remarks->end());
  for (const Delivery& delivery : deliveries) {
    CheckIsFile(delivery.from);
    const std::string name = delivery.to.filename().string();
    if (!IsPlainName(name)) {
      throw DataError(delivery.from.string() +
                      ": rename it, please: only letters, digits and _ . - + , @ can be handled in names");
    }
  }
  return deliveries;
}

void Deliver(const Delivery& delivery, const fs::path& folder, bool link) {
  const fs::path target = folder / delivery.to;
  fs::create_directories(target.parent_path());
  if (link) {
    fs::create_symlink(fs::canonical(delivery.from), target);
  } else {
    fs::copy_file(delivery.from, target);
  }
}

}  // namespace

NewBlock BlockFromText(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw UsageError("--block " + text + ": expected NAME=FILE or NAME=FOLDER");
  }
  fs::path source = text.substr(equals + 1);
  if (!source.has_filename()) source = source.parent_path();  // "folder/"
  return {text.substr(0, equals), source};
}

std::vector<std::string> MakeSite(const NewSite& request, const GraphStages& stages) {
  CheckRequest(request, stages);
  std::vector<std::string> remarks;
  const std::vector<Delivery> deliveries = Deliveries(request, &remarks);

  fs::path site = fs::absolute(request.site).lexically_normal();
  if (!site.has_filename()) site = site.parent_path();
  const fs::path unfinished =
      site.parent_path() / (".tmp-" + std::to_string(getpid()) + "-" + site.filename().string());
  try {
    fs::create_directories(unfinished / "edits");
    for (const Delivery& delivery : deliveries) Deliver(delivery, unfinished, request.link);
    formats::WriteFileAtomically(unfinished / "Makefile", MakefileText());
    formats::WriteFileAtomically(unfinished / "site.toml", SiteToml(request.crs, request.control_order, stages));
    for (const NewBlock& block : request.blocks) {
      formats::WriteFileAtomically(unfinished / "blocks" / block.name / "block.toml", BlockToml(block.name, stages));
    }
    fs::rename(unfinished, site);
  } catch (...) {
    std::error_code error;
    fs::remove_all(unfinished, error);
    throw;
  }
  return remarks;
}

}  // namespace pipeline
