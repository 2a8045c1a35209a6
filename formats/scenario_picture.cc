// SPDX-License-Identifier: Apache-2.0
#include "formats/scenario_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace formats {
namespace {

using Eigen::Vector2d;

constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates
constexpr double kMargin = 2.0;
constexpr double kLongestSide = 2400.0;

const cv::Scalar kWall(40, 40, 40);
const cv::Scalar kCar(190, 190, 190);
const cv::Scalar kGlass(220, 160, 0);
const cv::Scalar kPerson(160, 120, 200);
const cv::Scalar kControl(0, 0, 220);
const cv::Scalar kCheck(0, 140, 0);
const cv::Scalar kFeature(200, 0, 200);
const std::array<cv::Scalar, 6> kRoutes = {cv::Scalar(210, 90, 30),  cv::Scalar(20, 130, 240), cv::Scalar(60, 170, 60),
                                           cv::Scalar(150, 60, 160), cv::Scalar(120, 120, 20), cv::Scalar(60, 60, 160)};

class Canvas {
 public:
  Canvas(const Vector2d& low, const Vector2d& high)
      : low_(low - Vector2d::Constant(kMargin)), high_(high + Vector2d::Constant(kMargin)) {
    const Vector2d size = high_ - low_;
    scale_ = std::min(kLongestSide / size.maxCoeff(), 40.0);
    image_.create(static_cast<int>(size.y() * scale_), static_cast<int>(size.x() * scale_), CV_8UC3);
    image_.setTo(cv::Scalar::all(255));
  }

  void Line(const Vector2d& a, const Vector2d& b, const cv::Scalar& colour, int thickness = 1) {
    cv::line(image_, Pixel(a), Pixel(b), colour, thickness, cv::LINE_AA, kShift);
  }
  void Way(const survey::Polyline& way, const cv::Scalar& colour, int thickness = 1) {
    for (std::size_t i = 0; i + 1 < way.size(); ++i) Line(way[i], way[i + 1], colour, thickness);
  }
  void Circle(const Vector2d& centre, double radius_m, const cv::Scalar& colour, int thickness = 1) {
    const auto radius = static_cast<int>(std::lround(radius_m * scale_ * (1 << kShift)));
    cv::circle(image_, Pixel(centre), radius, colour, thickness, cv::LINE_AA, kShift);
  }
  void Word(const Vector2d& at, const std::string& text, const cv::Scalar& colour) {
    const cv::Point p = Pixel(at);
    cv::putText(image_, text, {(p.x >> kShift) + 5, (p.y >> kShift) - 5}, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1,
                cv::LINE_AA);
  }
  const cv::Mat& image() const { return image_; }

 private:
  cv::Point Pixel(const Vector2d& p) const {
    const double unit = scale_ * (1 << kShift);
    return {static_cast<int>(std::lround((p.x() - low_.x()) * unit)),
            static_cast<int>(std::lround((high_.y() - p.y()) * unit))};
  }

  Vector2d low_;
  Vector2d high_;
  double scale_ = 1.0;
  cv::Mat image_;
};

}  // namespace

void WriteScenarioPicture(const std::filesystem::path& file, const survey::Scenario& scenario,
                          const survey::FloorPlan& plan, const std::vector<DrawnRoute>& routes) {
  Vector2d low = scenario.blocks.front().waypoints.front().position;
  Vector2d high = low;
  const auto include = [&](const Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const survey::Face& face : plan.solid_faces) {
    include(face.a);
    include(face.b);
  }
  for (const DrawnRoute& route : routes) {
    for (const Vector2d& p : route.way) include(p);
  }

  Canvas canvas(low, high);
  for (const survey::Face& face : plan.car_faces) canvas.Line(face.a, face.b, kCar, 2);
  for (const survey::Disc& disc : plan.car_discs) canvas.Circle(disc.centre, disc.radius_m, kCar);
  for (const survey::Person& person : scenario.people) canvas.Way(person.path, kPerson);
  for (const survey::Pane& pane : plan.panes) canvas.Line(pane.a, pane.b, kGlass, 3);
  for (const survey::Face& face : plan.solid_faces) canvas.Line(face.a, face.b, kWall, 2);
  for (const survey::Disc& disc : plan.pillar_discs) canvas.Circle(disc.centre, disc.radius_m, kWall, 2);
  for (std::size_t i = 0; i < routes.size(); ++i) {
    const cv::Scalar& colour = kRoutes[i % kRoutes.size()];
    canvas.Way(routes[i].way, colour, 2);
    canvas.Word(routes[i].way.front(), routes[i].name, colour);
  }
  for (const survey::FeaturePoint& feature : scenario.features) canvas.Circle(feature.position, 0.25, kFeature);
  for (const survey::LandmarkPoint& point : scenario.points) {
    const cv::Scalar& colour = point.role == survey::PointRole::kCheck ? kCheck : kControl;
    canvas.Circle(point.position, 0.3, colour, 2);
    canvas.Word(point.position, point.name, colour);
  }

  AtomicFile out(file);
  if (!cv::imwrite(out.temporary().string(), canvas.image()))
    throw DataError(file.string() + ": the picture could not be written (disk full, or not a .png name?)");
  out.Commit();
}

}  // namespace formats
