// SPDX-License-Identifier: Apache-2.0
#include "formats/request_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "formats/atomic_file.h"

namespace formats {
namespace {

using Eigen::Vector2d;

constexpr double kSide_m = 12.0;
constexpr double kMargin = 1.3;  // of an edit that is wider
constexpr int kPixels = 480;
constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates

// Blue, green, red.
const cv::Scalar kUnknown(236, 236, 236);
const cv::Scalar kWay(190, 150, 60);
const cv::Scalar kEstimate(40, 40, 220);
const cv::Scalar kReference(60, 150, 40);
const std::array<cv::Scalar, 3> kModes = {cv::Scalar(220, 120, 0), cv::Scalar(180, 0, 180), cv::Scalar(0, 140, 240)};

// Light, so that what is drawn over the map can be read.
cv::Scalar Shade(float log_odds) {
  if (std::isnan(log_odds)) return kUnknown;
  const double occupied =
      std::clamp(2.0 * static_cast<double>(survey::ProbabilityFromLogOdds(log_odds)) - 1.0, 0.0, 1.0);
  return cv::Scalar::all(255.0 - 175.0 * occupied);
}

class Canvas {
 public:
  explicit Canvas(const Vector2d& centre, double side_m = kSide_m)
      : side_m_(side_m), north_west_(centre + 0.5 * side_m * Vector2d(-1.0, 1.0)) {
    image_.create(kPixels, kPixels, CV_8UC3);
    image_.setTo(kUnknown);
  }

  void Map(const survey::RasterStrips& map) {
    const survey::SiteRaster& frame = map.frame;
    const auto row_of = [&](double y) { return static_cast<std::int64_t>(std::floor(y / frame.cell_size_m)); };
    const std::int64_t first = std::max(row_of(north_west_.y() - side_m_), frame.min_row);
    const std::int64_t end = std::min(row_of(north_west_.y()) + 1, frame.min_row + frame.height);
    if (first >= end) return;
    const survey::SiteRaster rows = map.read(first, static_cast<int>(end - first));
    for (int y = 0; y < kPixels; ++y) {
      for (int x = 0; x < kPixels; ++x) {
        const auto cell = rows.CellOf(north_west_ + Vector2d(x + 0.5, -(y + 0.5)) * (side_m_ / kPixels));
        if (!rows.Contains(cell.x(), cell.y())) continue;
        const cv::Scalar shade = Shade(rows.At(static_cast<int>(cell.x()), static_cast<int>(cell.y())));
        image_.at<cv::Vec3b>(y, x) = cv::Vec3b::all(static_cast<std::uint8_t>(shade[0]));
      }
    }
  }

  void Line(const Vector2d& a, const Vector2d& b, const cv::Scalar& colour, int thickness) {
    cv::line(image_, Pixel(a), Pixel(b), colour, thickness, cv::LINE_AA, kShift);
  }

  // The lidar's place and where it looks.
  void Lidar(const survey::Pose2& pose, const cv::Scalar& colour) {
    cv::circle(image_, Pixel(pose.Translation()), 6 << kShift, colour, 2, cv::LINE_AA, kShift);
    Line(pose.Translation(), pose * Vector2d(0.6, 0.0), colour, 2);
  }

  void Scan(const survey::Pose2& pose, const std::vector<Eigen::Vector2f>& points, const cv::Scalar& colour) {
    for (const Eigen::Vector2f& p : points)
      cv::circle(image_, Pixel(pose * Vector2d(p.cast<double>())), 2 << kShift, colour, cv::FILLED, cv::LINE_AA,
                 kShift);
    Lidar(pose, colour);
  }

  // The lines, rings or arrows of an edit.
  void Edit(const survey::MapEdit& edit, const cv::Scalar& colour, int thickness) {
    for (const std::vector<Vector2d>& part : edit.parts) {
      for (std::size_t i = 0; i + 1 < part.size(); ++i) Line(part[i], part[i + 1], colour, thickness);
      if (IsArea(edit.kind)) Line(part.back(), part.front(), colour, thickness);
      if (edit.kind == survey::EditKind::kAdjust)
        cv::circle(image_, Pixel(part.back()), 5 << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
    }
  }

  void Write(const std::filesystem::path& file) const {
    std::vector<std::uint8_t> png;
    cv::imencode(".png", image_, png);
    WriteFileAtomically(file, {reinterpret_cast<const char*>(png.data()), png.size()});
  }

 private:
  cv::Point Pixel(const Vector2d& p) const {
    const Vector2d offset = (p - north_west_) * (kPixels / side_m_) * (1 << kShift);
    return {static_cast<int>(std::lround(offset.x())), static_cast<int>(std::lround(-offset.y()))};
  }

  double side_m_;
  Vector2d north_west_;
  cv::Mat image_;
};

}  // namespace

void WriteRequestPicture(const std::filesystem::path& file, const survey::RasterStrips& map,
                         const RequestPicture& picture) {
  Canvas canvas(picture.estimate.Translation());
  canvas.Map(map);
  for (std::size_t i = 0; i + 1 < picture.way.size(); ++i) canvas.Line(picture.way[i], picture.way[i + 1], kWay, 2);
  for (std::size_t i = picture.modes.size(); i-- > 0;)
    canvas.Scan(picture.modes[i], picture.points, kModes[i % kModes.size()]);
  canvas.Scan(picture.estimate, picture.points, kEstimate);
  if (picture.reference) canvas.Lidar(*picture.reference, kReference);
  canvas.Write(file);
}

void WriteEditPicture(const std::filesystem::path& file, const survey::RasterStrips& map,
                      const survey::AppliedEdit& edit) {
  const survey::MapEdit drawn = AsDrawn(edit);
  Eigen::AlignedBox2d box;
  for (const survey::MapEdit* each : {&edit.edit, &drawn}) {
    for (const std::vector<Vector2d>& part : each->parts) {
      for (const Vector2d& p : part) box.extend(p);
    }
  }
  Canvas canvas(box.center(), std::max(kSide_m, kMargin * box.sizes().maxCoeff()));
  canvas.Map(map);
  canvas.Edit(drawn, kReference, 2);
  canvas.Edit(edit.edit, kEstimate, 3);
  canvas.Write(file);
}

}  // namespace formats
