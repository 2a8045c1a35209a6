// SPDX-License-Identifier: Apache-2.0
#include "formats/feature_pictures.h"

#include <algorithm>

#include "formats/html.h"
#include "formats/svg.h"

namespace formats {
namespace {

using Eigen::Vector2d;

constexpr double kHalfWidth_m = 0.8;
constexpr double kSide = 120.0;  // px
constexpr double kCross = 5.0;

std::string Cross(const Vector2d& at, const std::string& style) {
  return Line(at - Vector2d(kCross, 0.0), at + Vector2d(kCross, 0.0), style) +
         Line(at - Vector2d(0.0, kCross), at + Vector2d(0.0, kCross), style);
}

std::string Picture(const FeatureWindow& window, const survey::Certificate& certificate) {
  const double scale = kSide / window.picture.extent_m.x();
  const auto place = [&](const Vector2d& p) {
    const Vector2d from = scale * (p - window.picture.south_west);
    return Vector2d(from.x(), kSide - from.y());
  };
  std::string svg = BeginSvg({kSide, kSide}) + "<image width=\"" + Px(kSide) + "\" height=\"" + Px(kSide) +
                    "\" href=\"data:image/png;base64," + Base64(window.picture.png) + "\"/>\n";
  std::string blocks;
  double largest = 0.0;
  for (const survey::TestedCheck& check : certificate.checks) {
    if (check.kind != survey::CheckKind::kFeature || check.name != window.name) continue;
    if (blocks.empty())
      svg += Square(place(check.reference), 4.0, "fill=\"none\" stroke=\"#05a\" stroke-width=\"1.2\"");
    svg += Cross(place(check.in_map), std::string("stroke=\"") + kCheckColour + "\" stroke-width=\"1.2\"");
    blocks += (blocks.empty() ? "" : ", ") + check.block;
    largest = std::max(largest, check.error.norm());
  }
  return "<figure>" + svg + "</svg><figcaption>" + Escaped(window.name) + " (" + Escaped(blocks) + "), " +
         Millimetres(largest) + "</figcaption></figure>\n";
}

}  // namespace

std::vector<FeatureWindow> ReadFeatureWindows(const std::filesystem::path& map,
                                              const survey::Certificate& certificate) {
  std::vector<FeatureWindow> windows;
  std::vector<Vector2d> centres;
  for (const survey::TestedCheck& check : certificate.checks) {
    const bool known = std::any_of(windows.begin(), windows.end(),
                                   [&](const FeatureWindow& window) { return window.name == check.name; });
    if (check.kind != survey::CheckKind::kFeature || known) continue;
    windows.push_back({check.name, {}});
    centres.push_back(check.reference);
  }
  const std::vector<MapThumbnail> pictures = ReadMapWindows(map, centres, kHalfWidth_m);
  for (std::size_t i = 0; i < windows.size(); ++i) windows[i].picture = pictures[i];
  return windows;
}

std::string FeaturePicturesSection(const CertificatePage& page) {
  if (page.features.empty()) return "";
  std::string html;
  for (const FeatureWindow& window : page.features) html += Picture(window, page.certificate);
  return H2("Check features in the map") +
         P("1.6 m of the stitched map about each. Square: as surveyed; crosses: as read in the maps of the blocks "
           "named; "
           "the largest distance, mm.",
           "note lead") +
         "<div class=\"features\">" + html + "</div>\n";
}

}  // namespace formats
