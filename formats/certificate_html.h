// SPDX-License-Identifier: Apache-2.0
//
// The certificate as one self-contained HTML page for A4: statement, verdict, figures, tables and the provenance chain.
// Where no block is tied to control it is a map report and says so; it is never titled a certificate then.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "formats/map_thumbnail.h"
#include "formats/provenance.h"
#include "survey/accuracy/certificate.h"

namespace formats {

struct BlockTrajectory {
  std::string block;
  std::vector<Eigen::Vector2d> positions_in_site;
};

// What the map shows about a check feature.
struct FeatureWindow {
  std::string name;
  MapThumbnail picture;
};

struct CertificatePage {
  survey::Certificate certificate;
  Provenance provenance;  // of the page: its chain ends at the raw logs
  std::optional<MapThumbnail> map;
  std::vector<FeatureWindow> features;
  std::vector<BlockTrajectory> trajectories;  // of tied blocks
};

std::string CertificateHtml(const CertificatePage& page);

}  // namespace formats
