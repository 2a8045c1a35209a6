// SPDX-License-Identifier: Apache-2.0
//
// GNU Gama's input [Gama, chapter 2]. Values in metres and gon (or d-m-s); standard deviations in mm and cc (1e-4 gon,
// or arc seconds beside d-m-s). axes-xy names what x and y point at; angles are clockwise unless "right-handed".
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "formats/adjusted_gama.h"
#include "formats/angle_text.h"
#include "formats/errors.h"
#include "formats/network_cluster.h"
#include "formats/network_file.h"
#include "formats/text_numbers.h"
#include "formats/xml_stream.h"

namespace formats {
namespace {

using survey::CoordinateUse;
using survey::Observation;
using survey::ObservationKind;

constexpr double kMm = 1e-3;
constexpr double kSigmaApr = 10.0;  // where the file does not say
constexpr double kCc = 1e-4 * kRadPerGon;
constexpr double kArcSecond = kRadPerDegree / 3600.0;

// "5", or "5 3 1" for a + b D^c with D in km: mm.
struct DistanceSigma {
  double constant_mm = 0.0, per_km_mm = 0.0, exponent = 1.0;
};

class GkfReader {
 public:
  explicit GkfReader(const std::filesystem::path& file) : file_(file) { result_.network.sigma_zero = kSigmaApr; }

  NetworkFile Read() {
    const XmlHandlers handlers = {.start = [this](XmlElement& element) { Start(element); },
                                  .end = [this](const std::string& name, const std::string& text,
                                                const std::string& where) { End(name, text, where); }};
    ReadXml(file_, handlers, &result_.warnings);
    if (!seen_network_) throw DataError(file_.string() + ": holds no <network>");
    clusters_.MoveInto(&result_.network, &result_.warnings);
    if (any_dms_) result_.angle_unit = AngleUnit::kDegrees;
    return std::move(result_);
  }

 private:
  void Start(XmlElement& element) {
    const std::string& name = element.name();
    if (depth_++ == 0 && name != "gama-local" && name != "gama-xml") {
      element.Fail("is no GNU Gama network; expected <gama-local>");
    }
    if (name == "network") return StartNetwork(element);
    if (name == "parameters") return ReadParameters(element);
    if (name == "points-observations") return ReadDefaults(element);
    if (name == "point") return in_coordinates_ ? AddCoordinates(element) : AddPoint(element);
    if (name == "obs" || name == "coordinates" || name == "height-differences" || name == "vectors") {
      return StartCluster(element);
    }
    const bool in_cluster = name == "cov-mat" || name == "vec" || name == "dh" || KindOf(name);
    if (in_cluster && !in_cluster_) element.Fail("stands outside of a group of observations");
    if (name == "cov-mat") {
      covariance_size_ = element.NeededCount("dim");
      covariance_band_ = element.NeededCount("band");
      return element.RefuseOthers();
    }
    if (name == "vec") return AddVector(element);
    if (name == "dh") return AddHeightDifference(element);
    if (const std::optional<ObservationKind> kind = KindOf(name)) return AddObservation(*kind, element);
    if (name != "gama-local" && name != "gama-xml" && name != "description") element.Fail("unknown element");
  }

  void End(const std::string& name, const std::string& text, const std::string& where) {
    --depth_;
    if (name == "description") result_.network.description = std::string(Trimmed(text));
    if (name == "cov-mat") clusters_.SetCovariance(NumbersOf(text, where), covariance_size_, covariance_band_, where);
    if (name == "obs" || name == "coordinates" || name == "height-differences" || name == "vectors") {
      in_coordinates_ = in_cluster_ = false;
      clusters_.End();
    }
  }

  void StartNetwork(XmlElement& element) {
    if (seen_network_) element.Fail("a file holds one network");
    seen_network_ = true;
    const std::string axes = element.Has("axes-xy") ? element.Text("axes-xy") : "ne";
    if (!ParsePlaneAxes(axes, axes_)) {
      element.Fail("axes-xy = \"" + axes + "\": must be one of ne, sw, es, wn, en, nw, se, ws");
    }
    const std::string angles = element.Has("angles") ? element.Text("angles") : "left-handed";
    if (angles != "left-handed" && angles != "right-handed") {
      element.Fail("angles = \"" + angles + "\": must be left-handed (clockwise) or right-handed");
    }
    clockwise_ = angles == "left-handed" ? 1.0 : -1.0;
    element.Number("epoch", 0.0);
    element.RefuseOthers();
  }

  void ReadParameters(XmlElement& element) {
    survey::Network& network = result_.network;
    network.sigma_zero = element.Number("sigma-apr", kSigmaApr);
    if (network.sigma_zero <= 0.0) element.Fail("sigma-apr must be positive");
    network.confidence = element.Number("conf-pr", 0.95);
    if (network.confidence <= 0.0 || network.confidence >= 1.0) element.Fail("conf-pr must lie between 0 and 1");
    const std::string used = element.Text("sigma-act");
    if (!used.empty() && used != "apriori" && used != "aposteriori") {
      element.Fail("sigma-act = \"" + used + "\": must be apriori or aposteriori");
    }
    network.use_sigma_a_posteriori = used != "apriori";
    for (const char* reduction : {"latitude", "ellipsoid"}) {
      if (!element.Text(reduction).empty()) {
        result_.warnings.push_back(element.where() + reduction +
                                   " is not used: observations must be free of the Earth's curvature");
      }
    }
    // How another program computes and prints.
    for (const char* other : {"tol-abs", "algorithm", "cov-band", "language", "encoding", "angular", "angles",
                              "iterations", "update-constrained-coordinates", "epoch"}) {
      element.Text(other);
    }
    element.RefuseOthers();
  }

  void ReadDefaults(XmlElement& element) {
    if (element.Has("distance-stdev")) {
      const std::vector<double> numbers = NumbersOf(element.Text("distance-stdev"), element.where());
      if (numbers.empty() || numbers.size() > 3) element.Fail("distance-stdev takes one to three numbers");
      distance_sigma_ =
          DistanceSigma{numbers[0], numbers.size() > 1 ? numbers[1] : 0.0, numbers.size() > 2 ? numbers[2] : 1.0};
    }
    const auto angular = [&](const char* attribute, ObservationKind kind) {
      if (element.Has(attribute)) angular_sigma_cc_[kind] = element.NeededNumber(attribute);
    };
    angular("direction-stdev", ObservationKind::kDirection);
    angular("angle-stdev", ObservationKind::kAngle);
    angular("zenith-angle-stdev", ObservationKind::kZenithAngle);
    angular("azimuth-stdev", ObservationKind::kAzimuth);
    element.RefuseOthers();
  }

  // Coordinates of the file in east and north.
  void PlaneCoordinates(XmlElement& element, Eigen::Vector3d* position) const {
    const double xy[2] = {element.NeededNumber("x"), element.NeededNumber("y")};
    for (int k = 0; k < 2; ++k) (*position)[axes_[k].component] = axes_[k].sign * xy[k];
  }

  static CoordinateUse UseOf(const std::string& fixed, const std::string& adjusted, char small, char capital) {
    if (fixed.find(small) != std::string::npos || fixed.find(capital) != std::string::npos) {
      return CoordinateUse::kFixed;
    }
    if (adjusted.find(capital) != std::string::npos) return CoordinateUse::kConstrained;
    return adjusted.find(small) != std::string::npos ? CoordinateUse::kAdjusted : CoordinateUse::kUnused;
  }

  // What fix and adj say; nothing where neither is there.
  bool ReadUse(XmlElement& element, survey::NetworkPoint* point) const {
    const std::string fixed = element.Text("fix"), adjusted = element.Text("adj");
    for (const std::string& which : {fixed, adjusted}) {
      if (which.find_first_not_of("xyzXYZ") != std::string::npos) {
        element.Fail("\"" + which + "\": must be made of x, y and z (capitals: constrained)");
      }
    }
    point->plane = UseOf(fixed, adjusted, 'x', 'X');
    point->height = UseOf(fixed, adjusted, 'z', 'Z');
    return !fixed.empty() || !adjusted.empty();
  }

  void AddPoint(XmlElement& element) {
    survey::NetworkPoint point{.name = element.NeededText("id")};
    ReadUse(element, &point);
    if (element.Has("x") || element.Has("y")) {
      PlaneCoordinates(element, &point.position);
      point.plane_known = true;
    }
    if (element.Has("z")) {
      point.position.z() = element.NeededNumber("z");
      point.height_known = true;
    }
    if (point.plane == CoordinateUse::kFixed && !point.plane_known) {
      element.Fail("point " + point.name + " is fixed but has no coordinates");
    }
    if (point.height == CoordinateUse::kFixed && !point.height_known) {
      element.Fail("point " + point.name + " is fixed but has no height");
    }
    element.RefuseOthers();
    clusters_.AddPoint(point, element.where());
  }

  void StartCluster(XmlElement& element) {
    const std::string& name = element.name();
    if (in_cluster_) element.Fail("stands inside of another group of observations");
    in_cluster_ = true;
    in_coordinates_ = name == "coordinates";
    station_ = element.Text("from");
    station_height_ = element.Number("from_dh", 0.0);
    element.Text("orientation");  // an approximate value, found anew
    element.RefuseOthers();
    clusters_.Begin();
  }

  static std::optional<ObservationKind> KindOf(const std::string& name) {
    static const std::map<std::string, ObservationKind> kKinds = {
        {"direction", ObservationKind::kDirection},      {"distance", ObservationKind::kDistance},
        {"s-distance", ObservationKind::kSlopeDistance}, {"z-angle", ObservationKind::kZenithAngle},
        {"azimuth", ObservationKind::kAzimuth},          {"angle", ObservationKind::kAngle}};
    const auto found = kKinds.find(name);
    return found == kKinds.end() ? std::nullopt : std::optional(found->second);
  }

  // Value in rad, clockwise where horizontal; sets the unit in which the file states the sigma.
  double Angle(XmlElement& element, bool horizontal, double* sigma_unit) {
    const std::string text = element.NeededText("val");
    std::optional<double> value = ParseNumber(text);
    *sigma_unit = kCc;
    if (value) {
      *value *= kRadPerGon;
    } else {
      value = ParseDms(text);
      if (!value) element.Fail("val = \"" + text + "\": must be gon (123.4567) or degrees (123-45-06.7)");
      *sigma_unit = kArcSecond;
      any_dms_ = true;
    }
    return horizontal ? clockwise_ * *value : *value;
  }

  void AddObservation(ObservationKind kind, XmlElement& element) {
    NamedObservation named;
    Observation& o = named.observation;
    o.kind = kind;
    named.from = element.Has("from") ? element.Text("from") : station_;
    if (named.from.empty()) element.Fail("attribute from is missing, here and in <obs>");
    if (kind == ObservationKind::kDirection && element.Has("from")) {
      element.Fail("a direction belongs to the station of its <obs>");
    }
    named.to = element.NeededText(kind == ObservationKind::kAngle ? "bs" : "to");
    if (kind == ObservationKind::kAngle) named.fore = element.NeededText("fs");
    o.instrument_height = element.Number("from_dh", station_height_);
    o.target_height = element.Number("to_dh", 0.0);
    double unit = kMm;
    if (survey::IsAngular(kind)) {
      o.value = Angle(element, kind != ObservationKind::kZenithAngle, &unit);
    } else {
      o.value = element.NeededNumber("val");
      if (o.value <= 0.0) element.Fail("val = " + NumberText(o.value) + ": a distance must be positive");
    }
    named.covariance_unit =
        unit * (survey::IsAngular(kind) && kind != ObservationKind::kZenithAngle ? clockwise_ : 1.0);
    o.sigma = Sigma(element, kind, o.value, unit);
    for (const char* other : {"extern", "bs_dh", "fs_dh"}) element.Text(other);
    element.RefuseOthers();
    clusters_.Add(named, element.where());
  }

  // m or rad; 0 when neither the element nor the defaults tell (then a cov-mat must).
  double Sigma(XmlElement& element, ObservationKind kind, double value, double unit) const {
    if (element.Has("stdev")) {
      const double sigma = element.NeededNumber("stdev");
      if (sigma <= 0.0) element.Fail("stdev = " + NumberText(sigma) + ": a standard deviation must be positive");
      return sigma * unit;
    }
    if (survey::IsAngular(kind)) {
      const auto found = angular_sigma_cc_.find(kind);
      return found == angular_sigma_cc_.end() ? 0.0 : found->second * unit;
    }
    if (!distance_sigma_) return 0.0;
    return kMm * (distance_sigma_->constant_mm +
                  distance_sigma_->per_km_mm * std::pow(value / 1000.0, distance_sigma_->exponent));
  }

  void AddHeightDifference(XmlElement& element) {
    NamedObservation named{.from = element.NeededText("from"), .to = element.NeededText("to"), .covariance_unit = kMm};
    named.observation.kind = ObservationKind::kHeightDifference;
    named.observation.value = element.NeededNumber("val");
    named.observation.sigma = Sigma(element, ObservationKind::kHeightDifference, 0.0, kMm);
    if (!element.Has("stdev")) {
      named.observation.sigma = 0.0;
      const double length_km = element.Number("dist", 0.0);
      if (length_km < 0.0) element.Fail("dist must not be negative (km)");
      named.observation.sigma = result_.network.sigma_zero * std::sqrt(length_km) * kMm;
    }
    for (const char* other : {"dist", "extern"}) element.Text(other);
    element.RefuseOthers();
    clusters_.Add(named, element.where());
  }

  void AddComponent(ObservationKind kind, const std::string& from, const std::string& to, int file_axis, double value,
                    const std::string& where) {
    const PlaneAxis axis = file_axis == 2 ? PlaneAxis{2, 1.0} : axes_[file_axis];
    NamedObservation named{.from = from, .to = to, .covariance_unit = axis.sign * kMm};
    named.observation.kind = kind;
    named.observation.component = axis.component;
    named.observation.value = axis.sign * value;
    clusters_.Add(named, where);
  }

  void AddVector(XmlElement& element) {
    const std::string from = element.NeededText("from"), to = element.NeededText("to");
    const double values[3] = {element.NeededNumber("dx"), element.NeededNumber("dy"), element.NeededNumber("dz")};
    for (const char* other : {"from_dh", "to_dh"}) {
      if (element.Number(other, 0.0) != 0.0)
        element.Fail(std::string(other) + ": heights above the points are not known here");
    }
    element.Text("extern");
    element.RefuseOthers();
    for (int axis = 0; axis < 3; ++axis) {
      AddComponent(ObservationKind::kDifference, from, to, axis, values[axis], element.where());
    }
  }

  // An observed point; where it says fix or adj it is thereby a point of the network.
  void AddCoordinates(XmlElement& element) {
    const std::string name = element.NeededText("id");
    survey::NetworkPoint point{.name = name};
    if (ReadUse(element, &point)) {
      if (survey::NetworkPoint* known = clusters_.Point(name)) {
        known->plane = point.plane;
        known->height = point.height;
      } else {
        clusters_.AddPoint(point, element.where());
      }
    }
    if (element.Has("x") || element.Has("y")) {
      const double x = element.NeededNumber("x"), y = element.NeededNumber("y");
      AddComponent(ObservationKind::kCoordinate, name, "", 0, x, element.where());
      AddComponent(ObservationKind::kCoordinate, name, "", 1, y, element.where());
    }
    if (element.Has("z")) {
      AddComponent(ObservationKind::kCoordinate, name, "", 2, element.NeededNumber("z"), element.where());
    }
    element.Text("extern");
    element.RefuseOthers();
  }

  const std::filesystem::path& file_;
  NetworkFile result_;
  NetworkClusters clusters_;
  int depth_ = 0;
  bool seen_network_ = false;
  bool in_cluster_ = false;
  bool in_coordinates_ = false;
  bool any_dms_ = false;
  PlaneAxis axes_[2];
  double clockwise_ = 1.0;
  std::string station_;
  double station_height_ = 0.0;
  int covariance_size_ = 0;
  int covariance_band_ = 0;
  std::optional<DistanceSigma> distance_sigma_;
  std::map<ObservationKind, double> angular_sigma_cc_;
};

}  // namespace

NetworkFile ReadGkf(const std::filesystem::path& file) { return GkfReader(file).Read(); }

}  // namespace formats
