// SPDX-License-Identifier: Apache-2.0
#include "pipeline/deliver_site.h"

#include "formats/artefacts.h"
#include "formats/delivery_csv.h"
#include "formats/errors.h"
#include "pipeline/site_layout.h"
#include "pipeline/site_status.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;

constexpr double kPoseSpacingM = 2.0;

void RequireUpToDate(const fs::path& site) {
  for (const RunStatus& status : SiteStatus(site, ReadGraph(site))) {
    // Whoever waits does so for a run that is named here.
    if (status.state == RunState::kDone || status.state == RunState::kWaiting) continue;
    throw formats::DataError(site.string() + ": " + status.run.Title() +
                             " is not up to date, so there is nothing to deliver; plumbline run first");
  }
}

}  // namespace

void DeliverSite(const fs::path& site) {
  RequireUpToDate(site);
  std::vector<survey::DeliveredPose> poses;
  for (const std::string& block : BlocksOf(site)) {
    const fs::path file = site / "work" / block / "solution.sqlite";
    const std::vector<survey::DeliveredPose> of_block =
        formats::PosesOfDelivery(block, formats::ReadSolution(file), formats::ReadScanStamps(file), kPoseSpacingM);
    poses.insert(poses.end(), of_block.begin(), of_block.end());
  }
  const survey::ControlNetwork control = formats::ReadControl(site / "work" / "control.sqlite");
  formats::WriteDeliveredPoses(site / "delivered" / "poses.csv", poses);
  formats::WriteDeliveredControl(site / "delivered" / "control.csv", formats::PointsOfDelivery(control));
}

}  // namespace pipeline
