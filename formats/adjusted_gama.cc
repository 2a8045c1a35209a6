// SPDX-License-Identifier: Apache-2.0
#include "formats/adjusted_gama.h"

#include <map>
#include <utility>

#include "formats/control_limits.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"
#include "formats/xml_stream.h"

namespace formats {
namespace {

class GamaAdjustmentReader {
 public:
  explicit GamaAdjustmentReader(const std::filesystem::path& file) : file_(file) {}

  AdjustedNetworkFile Read() {
    ReadXml(file_,
            {.start = [this](XmlElement& element) { Start(element); },
             .end = [this](const std::string& name, const std::string& text,
                           const std::string& where) { End(name, std::string(Trimmed(text)), where); }},
            &result_.warnings);
    if (result_.points.empty()) throw DataError(file_.string() + ": holds no points");
    if (result_.sigma_zero_a_priori <= 0.0 || !(result_.confidence > 0.0 && result_.confidence < 1.0)) {
      throw DataError(file_.string() + ": does not state sigma zero a priori and the probability of its tests");
    }
    SpreadCovariance();
    return std::move(result_);
  }

 private:
  void Start(XmlElement& element) {
    const std::string& name = element.name();
    if (path_.empty() && name != "gama-local-adjustment") {
      element.Fail("is no GNU Gama adjustment; expected <gama-local-adjustment>");
    }
    path_.push_back(name);
    if (name == "network-general-parameters") {
      const std::string axes = element.NeededText("axes-xy");
      if (!ParsePlaneAxes(axes, axes_)) element.Fail("axes-xy = \"" + axes + "\": is not known");
      // Where the hands of axes and angles differ Gama computes with the mirrored y, and prints the covariances of
      // that.
      const bool left_handed_axes = (axes_[0].component == 1) == (axes_[0].sign == axes_[1].sign);
      const bool left_handed_angles = element.NeededText("angles") == "left-handed";
      y_sign_ = left_handed_axes == left_handed_angles ? 1.0 : -1.0;
      result_.software = "GNU Gama " + element.Text("gama-local-version");
    }
    if (name == "point") point_ = {};
  }

  bool In(const std::string& element) const {
    for (const std::string& open : path_) {
      if (open == element) return true;
    }
    return false;
  }

  double NumberOf(const std::string& text, const std::string& where) const {
    const std::optional<double> value = ParseNumber(text);
    if (!value) throw DataError(where + "\"" + text + "\": " + WhyNotANumber(text));
    return *value;
  }

  int CountOf(const std::string& text, const std::string& where) const {
    const double value = NumberOf(text, where);
    if (!(value >= 0.0 && value <= 1e7 && value == static_cast<int>(value))) {
      throw DataError(where + "\"" + text + "\": must be a whole number");
    }
    return static_cast<int>(value);
  }

  void End(const std::string& name, const std::string& text, const std::string& where) {
    path_.pop_back();
    if (name == "description" && path_.size() == 1) result_.description = text;
    if (In("network-processing-summary")) return ReadSummary(name, text, where);
    if (!In("coordinates") || In("approximate")) return;
    if (In("point")) return ReadPoint(name, text, where);
    if (name == "point") {
      if (point_.name.empty()) throw DataError(where + "a point has no id");
      point_.fixed = In("fixed");
      result_.points.push_back(point_);
      RequireAtMost(kMostControlPoints, result_.points.size(), "points", where);
    }
    if (In("cov-mat")) {
      if (name == "dim") size_ = CountOf(text, where);
      if (name == "band") band_ = CountOf(text, where);
      if (name == "flt") numbers_.push_back(NumberOf(text, where));
    }
  }

  void ReadSummary(const std::string& name, const std::string& text, const std::string& where) {
    if (name == "equations") result_.num_observations = CountOf(text, where);
    if (name == "unknowns") result_.num_unknowns = CountOf(text, where);
    if (name == "degrees-of-freedom") result_.degrees_of_freedom = CountOf(text, where);
    if (name == "defect") result_.defect = CountOf(text, where);
    if (name == "apriori") result_.sigma_zero_a_priori = NumberOf(text, where);
    if (name == "aposteriori") result_.sigma_zero_a_posteriori = NumberOf(text, where);
    if (name == "used") result_.sigma_used_is_a_posteriori = text == "aposteriori";
    if (name == "probability") result_.confidence = NumberOf(text, where);
  }

  // Constrained coordinates are in capitals.
  void ReadPoint(const std::string& name, const std::string& text, const std::string& where) {
    if (name == "id") {
      point_.name = text;
    } else if (name == "x" || name == "X" || name == "y" || name == "Y") {
      const PlaneAxis axis = axes_[name == "y" || name == "Y" ? 1 : 0];
      point_.position[axis.component] = axis.sign * NumberOf(text, where);
      point_.has_plane = true;
    } else if (name == "z" || name == "Z") {
      point_.position.z() = NumberOf(text, where);
      point_.has_height = true;
    }
  }

  // The band's unknowns are the adjusted coordinates in their order, x before y before z, then the orientations.
  void SpreadCovariance() {
    struct Place {
      Eigen::Index row;
      double sign;
    };
    std::vector<Place> places;
    for (std::size_t i = 0; i < result_.points.size(); ++i) {
      const AdjustedPoint& point = result_.points[i];
      if (point.fixed) continue;
      const auto row = static_cast<Eigen::Index>(3 * i);
      if (point.has_plane) {
        places.push_back({row + axes_[0].component, axes_[0].sign});
        places.push_back({row + axes_[1].component, axes_[1].sign * y_sign_});
      }
      if (point.has_height) places.push_back({row + 2, 1.0});
    }
    if (static_cast<std::size_t>(size_) < places.size()) {
      throw DataError(file_.string() + ": the covariance matrix has " + std::to_string(size_) + " rows for " +
                      std::to_string(places.size()) + " adjusted coordinates");
    }
    const auto coordinates = static_cast<Eigen::Index>(3 * result_.points.size());
    result_.covariance.setZero(coordinates, coordinates);
    std::size_t next = 0;
    for (int i = 0; i < size_; ++i) {
      for (int j = i; j <= std::min(size_ - 1, i + band_); ++j) {
        if (next == numbers_.size()) throw DataError(file_.string() + ": the covariance matrix is not complete");
        const double value = numbers_[next++] * 1e-6;  // mm2
        if (static_cast<std::size_t>(j) >= places.size() || static_cast<std::size_t>(i) >= places.size()) continue;
        const Place &a = places[static_cast<std::size_t>(i)], &b = places[static_cast<std::size_t>(j)];
        result_.covariance(a.row, b.row) = result_.covariance(b.row, a.row) = a.sign * b.sign * value;
      }
    }
    if (band_ + 1 < static_cast<int>(places.size())) {
      result_.warnings.push_back(file_.string() +
                                 ": holds only a band of the covariance matrix; what lies outside it "
                                 "counts as zero");
    }
  }

  const std::filesystem::path& file_;
  AdjustedNetworkFile result_;
  std::vector<std::string> path_;
  AdjustedPoint point_;
  PlaneAxis axes_[2];
  double y_sign_ = 1.0;
  int size_ = 0;
  int band_ = 0;
  std::vector<double> numbers_;
};

bool ParseAxis(char letter, PlaneAxis* axis) {
  switch (letter) {
    case 'e':
      *axis = {0, 1.0};
      return true;
    case 'w':
      *axis = {0, -1.0};
      return true;
    case 'n':
      *axis = {1, 1.0};
      return true;
    case 's':
      *axis = {1, -1.0};
      return true;
    default:
      return false;
  }
}

}  // namespace

bool ParsePlaneAxes(const std::string& axes_xy, PlaneAxis axes[2]) {
  return axes_xy.size() == 2 && ParseAxis(axes_xy[0], &axes[0]) && ParseAxis(axes_xy[1], &axes[1]) &&
         axes[0].component != axes[1].component;
}

AdjustedNetworkFile ReadGamaAdjustment(const std::filesystem::path& file) { return GamaAdjustmentReader(file).Read(); }

}  // namespace formats
