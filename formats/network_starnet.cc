// SPDX-License-Identifier: Apache-2.0
//
// STAR*NET data files [STARNET]: C CH E A D V DV B M BM T TB TE DB DN DM DE L and the inline options that shape them.
// The order of coordinates, the unit of length and 2D or 3D are project settings of STAR*NET; here the file itself must
// state them (.ORDER, .UNITS, .2D or .3D). Angles are degrees, d-m-s; standard deviations of angles are arc seconds.
// In the place of a standard deviation: ! fixed, * free, & the default.
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "formats/angle_text.h"
#include "formats/errors.h"
#include "formats/line_reader.h"
#include "formats/network_cluster.h"
#include "formats/network_file.h"
#include "formats/starnet_line.h"
#include "formats/text_encoding.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

using survey::CoordinateUse;
using survey::ObservationKind;

constexpr double kArcSecond = kRadPerDegree / 3600.0;
constexpr double kFixedSigma = 1e-7;  // of an observation marked !, m or rad
constexpr double kMetresPerFoot = 0.3048;
constexpr double kMetresPerUsFoot = 1200.0 / 3937.0;
constexpr double kKmPerMile = 1.609344;

std::string Upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

class StarnetReader {
 public:
  StarnetReader(const std::filesystem::path& file, const StarnetSigmas& sigmas) : file_(file), defaults_(sigmas) {}

  NetworkFile Read() {
    LineReader lines(file_);
    bool latin = false;
    for (std::string_view line; !ended_ && lines.Next(&line);) {
      std::string text(line);
      if (!IsUtf8(text)) {
        text = Utf8OfLatin1(text);
        latin = true;
      }
      line_ = StarnetLine(lines.Where() + ": ", std::move(text));
      ReadLine();
    }
    if (latin) result_.warnings.push_back(file_.string() + ": is not UTF-8; read as Latin-1");
    if (in_set_) Fail("the direction set is not ended by DE");
    if (num_sideshots_ > 0) {
      result_.warnings.push_back(file_.string() + ": " + std::to_string(num_sideshots_) +
                                 " sideshots (SS) are left out: they take no part in the adjustment");
    }
    result_.angle_unit = AngleUnit::kDegrees;
    result_.network.sigma_zero = 1.0;
    result_.network.use_sigma_a_posteriori = false;
    // A station that is only levelled has no place in the plane.
    for (const auto& [name, has_plane] : has_plane_) {
      if (!has_plane) clusters_.Point(name)->plane = CoordinateUse::kUnused;
    }
    clusters_.MoveInto(&result_.network, &result_.warnings);
    return std::move(result_);
  }

 private:
  [[noreturn]] void Fail(const std::string& rule) const { line_.Fail(rule); }
  double Length(const std::string& what) { return line_.Number(what) * metres_per_unit_; }

  void ReadLine() {
    if (!line_.More()) return;
    const std::string code = Upper(line_.Word("the type"));
    if (code.starts_with(".")) {
      ReadOption(code);
    } else if (data_on_) {
      ReadData(code);
    } else {
      return;
    }
    line_.RefuseMore(code);
  }

  // A standard deviation in `unit`, or the default; nothing for a free one (*).
  std::optional<double> Sigma(double default_sigma, double unit, const std::string& option) {
    if (line_.More() && line_.Peek().find('/') == std::string::npos) {
      const std::string text = line_.Peek();
      if (text != "!" && text != "*" && text != "&") {
        const double sigma = line_.Number("standard deviation");
        if (sigma <= 0.0) Fail("standard deviation = " + text + ": must be positive");
        return sigma * unit;
      }
      line_.Word("standard deviation");
      if (text == "!") return kFixedSigma;
      if (text == "*") return std::nullopt;
    }
    if (default_sigma <= 0.0) Fail("has no standard deviation, and the option " + option + " gives no default");
    return default_sigma;
  }

  std::optional<double> DistanceSigma(double distance) {
    const double sigma =
        defaults_.distance_m > 0.0 ? defaults_.distance_m + 1e-6 * defaults_.distance_ppm * distance : 0.0;
    return Sigma(sigma, metres_per_unit_, "starnet-distance-sigma-m");
  }
  std::optional<double> AngleSigma() {
    return Sigma(defaults_.angle_arcsec * kArcSecond, kArcSecond, "starnet-angle-sigma-arcsec");
  }
  std::optional<double> AzimuthSigma() {
    return Sigma(defaults_.azimuth_arcsec * kArcSecond, kArcSecond, "starnet-azimuth-sigma-arcsec");
  }
  std::optional<double> ZenithSigma() {
    return Sigma(defaults_.zenith_arcsec * kArcSecond, kArcSecond, "starnet-zenith-sigma-arcsec");
  }
  std::optional<double> LevelSigma(double length_km) {
    return Sigma(defaults_.levelling_m_per_sqrt_km * std::sqrt(length_km), metres_per_unit_,
                 "starnet-levelling-sigma-m-per-sqrt-km");
  }

  // "1.55/1.60": heights of instrument and target, at the line's end.
  void ReadHeights(std::vector<NamedObservation>* observations) {
    if (!line_.More() || line_.Peek().find('/') == std::string::npos) return;
    const std::string text = line_.Word("heights");
    const std::size_t slash = text.find('/');
    const std::optional<double> instrument = ParseNumber(text.substr(0, slash)),
                                target = ParseNumber(text.substr(slash + 1));
    if (!instrument || !target) Fail("\"" + text + "\": must be heights of instrument and target, as 1.55/1.60");
    for (NamedObservation& named : *observations) {
      named.observation.instrument_height = *instrument * metres_per_unit_;
      named.observation.target_height = *target * metres_per_unit_;
    }
  }

  // -------------------------------------------------------------------------------------------------- inline options

  void ReadOption(const std::string& code) {
    if (code == ".UNITS") return ReadUnits();
    if (code == ".ORDER") return ReadOrder();
    if (code == ".2D" || code == ".3D") {
      dimensions_ = code == ".2D" ? 2 : 3;
      return;
    }
    if (code == ".DELTA") {
      delta_ = OnOff();
    } else if (code == ".DATA") {
      data_on_ = OnOff();
    } else if (code == ".SEP" || code == ".SEPARATOR") {
      const std::string& text = line_.Word("the separator");
      if (text.size() != 1) Fail("\"" + text + "\": the separator is one character");
      separator_ = text[0];
    } else if (code == ".END") {
      ended_ = true;
    } else {
      Fail("the inline option " + code +
           " is not known here; known are .UNITS, .ORDER, .2D, .3D, .DELTA, .DATA, .SEP, "
           ".END");
    }
  }

  bool OnOff() {
    const std::string text = Upper(line_.Word("ON or OFF"));
    if (text != "ON" && text != "OFF") Fail("\"" + text + "\": must be ON or OFF");
    return text == "ON";
  }

  void ReadUnits() {
    static const std::map<std::string, double> kLengths = {{"METERS", 1.0},
                                                           {"METRES", 1.0},
                                                           {"FEET", kMetresPerFoot},
                                                           {"INTERNATIONALFEET", kMetresPerFoot},
                                                           {"USFEET", kMetresPerUsFoot}};
    while (line_.More()) {
      const std::string text = Upper(line_.Word("a word"));
      if (const auto found = kLengths.find(text); found != kLengths.end()) {
        metres_per_unit_ = found->second;
        units_known_ = true;
      } else if (text != "DMS") {
        Fail("unit \"" + text + "\": must be METERS, FEET (international), USFEET or DMS");
      }
    }
  }

  void ReadOrder() {
    while (line_.More()) {
      const std::string text = Upper(line_.Word("a word"));
      if (text == "NE" || text == "EN") {
        north_first_ = text == "NE";
      } else if (text == "ATFROMTO" || text == "FROMATTO") {
        at_first_ = text == "ATFROMTO";
      } else {
        Fail("order \"" + text + "\": must be NE, EN, ATFROMTO or FROMATTO");
      }
    }
  }

  // ------------------------------------------------------------------------------------------------------ data lines

  void ReadData(const std::string& code) {
    RequireSettings();
    if (code == "C" || code == "CH") return ReadCoordinates();
    if (code == "E" || code == "EH") return ReadElevation();
    if (code == "A") return ReadAngle();
    if (code == "D") return ReadBetween(true, false, false);
    if (code == "V") return ReadBetween(false, true, false);
    if (code == "DV") return ReadBetween(true, true, false);
    if (code == "B") return ReadBetween(false, false, true);
    if (code == "BM") return ReadBetween(true, dimensions_ == 3, true);
    if (code == "M") return ReadMeasured(Three());
    if (code == "L") return ReadLevelled();
    if (code == "TB" || code == "T" || code == "TE") return ReadTraverse(code);
    if (code == "DB" || code == "DN" || code == "DM" || code == "DE") return ReadSet(code);
    if (code == "SS") {
      ++num_sideshots_;
      line_.SkipRest();
      return;
    }
    Fail("lines of type " + code + " are not known here");
  }

  void RequireSettings() const {
    if (!units_known_) Fail("the file must state its unit of length before the first data line: .UNITS METERS");
    if (dimensions_ == 0) Fail("the file must state .2D or .3D before the first data line");
  }

  survey::NetworkPoint& PointOf(const std::string& name) {
    if (!clusters_.HasPoint(name)) {
      survey::NetworkPoint point{.name = name, .plane = CoordinateUse::kAdjusted};
      if (dimensions_ == 3) point.height = CoordinateUse::kAdjusted;
      clusters_.AddPoint(point, line_.where());
      has_plane_.emplace(name, false);
    }
    return *clusters_.Point(name);
  }

  // The state that !, *, & or a number in the place of a coordinate's standard deviation says; a number is returned.
  std::optional<double> CoordinateSigma(CoordinateUse* use) {
    if (!line_.More()) return std::nullopt;
    const std::string& text = line_.Word("standard deviation");
    if (text == "!") *use = CoordinateUse::kFixed;
    if (text == "!" || text == "*" || text == "&") return std::nullopt;
    const std::optional<double> sigma = ParseNumber(text);
    if (!sigma || *sigma <= 0.0) Fail("standard deviation = \"" + text + "\": must be !, *, & or a positive number");
    return *sigma * metres_per_unit_;
  }

  void ObserveComponent(const std::string& name, int component, double value, double sigma) {
    NamedObservation named{.from = name};
    named.observation.kind = ObservationKind::kCoordinate;
    named.observation.component = component;
    named.observation.value = value;
    named.observation.sigma = sigma;
    Add({named});
  }

  void ReadCoordinates() {
    if (!north_first_) {
      const std::string name = line_.Word("the station"), a = line_.Word("a coordinate"),
                        b = line_.Word("a coordinate");
      Fail("the order of coordinates must be told: station " + name + " has north " + a + ", east " + b +
           " with .ORDER NE, or north " + b + ", east " + a + " with .ORDER EN");
    }
    const std::string name = line_.Word("the station");
    const double first = Length("the first coordinate"), second = Length("the second coordinate");
    survey::NetworkPoint& point = PointOf(name);
    if (point.plane_known) Fail("station " + name + " has coordinates already");
    point.position.head<2>() = *north_first_ ? Eigen::Vector2d(second, first) : Eigen::Vector2d(first, second);
    point.plane_known = has_plane_[name] = true;
    if (dimensions_ == 3) {
      point.position.z() = Length("the elevation");
      point.height_known = true;
    }
    CoordinateUse use[3] = {CoordinateUse::kAdjusted, CoordinateUse::kAdjusted, CoordinateUse::kAdjusted};
    const Eigen::Vector3d given = point.position;
    for (int k = 0; k < dimensions_; ++k) {
      const int component = k == 2 ? 2 : (*north_first_ ? 1 - k : k);
      const std::optional<double> sigma = CoordinateSigma(&use[component]);
      if (sigma) ObserveComponent(name, component, given[component], *sigma);
    }
    if ((use[0] == CoordinateUse::kFixed) != (use[1] == CoordinateUse::kFixed)) {
      Fail("station " + name + ": north and east must both be fixed, or neither");
    }
    survey::NetworkPoint& settled = *clusters_.Point(name);
    settled.plane = use[0];
    if (dimensions_ == 3) settled.height = use[2];
  }

  void ReadElevation() {
    const std::string name = line_.Word("the station");
    survey::NetworkPoint& point = PointOf(name);
    point.position.z() = Length("the elevation");
    point.height_known = true;
    CoordinateUse use = CoordinateUse::kAdjusted;
    const double elevation = point.position.z();
    if (const std::optional<double> sigma = CoordinateSigma(&use)) ObserveComponent(name, 2, elevation, *sigma);
    clusters_.Point(name)->height = use;
  }

  // At, from, to in the order of the file.
  std::array<std::string, 3> Three() {
    std::vector<std::string> names = line_.Names(3, separator_);
    if (!at_first_) std::swap(names[0], names[1]);
    return {names[0], names[1], names[2]};
  }

  static NamedObservation Named(ObservationKind kind, const std::string& from, const std::string& to, double value) {
    NamedObservation named{.from = from, .to = to};
    named.observation.kind = kind;
    named.observation.value = value;
    return named;
  }

  void Weigh(std::optional<double> sigma, NamedObservation named, std::vector<NamedObservation>* observations) {
    if (!sigma) return;
    named.observation.sigma = *sigma;
    observations->push_back(std::move(named));
  }

  void Add(const std::vector<NamedObservation>& observations) {
    for (const NamedObservation& named : observations) {
      for (const std::string& name : {named.from, named.to, named.fore}) {
        if (name.empty()) continue;
        PointOf(name);
        const bool height_only =
            named.observation.kind == ObservationKind::kHeightDifference ||
            (named.observation.kind == ObservationKind::kCoordinate && named.observation.component == 2);
        if (!height_only) has_plane_[name] = true;
      }
    }
    if (!in_set_) clusters_.Begin();
    for (const NamedObservation& named : observations) clusters_.Add(named, line_.where());
    if (!in_set_) clusters_.End();
  }

  NamedObservation Distance(const std::string& from, const std::string& to) {
    const double value = Length("the distance");
    if (value <= 0.0) Fail("a distance must be positive");
    const bool slope = dimensions_ == 3 && !delta_;
    return Named(slope ? ObservationKind::kSlopeDistance : ObservationKind::kDistance, from, to, value);
  }

  NamedObservation Vertical(const std::string& from, const std::string& to) {
    if (delta_) return Named(ObservationKind::kHeightDifference, from, to, Length("the difference of height"));
    return Named(ObservationKind::kZenithAngle, from, to, line_.Angle("the zenith angle"));
  }

  std::optional<double> VerticalSigma() { return delta_ ? LevelSigma(1.0) : ZenithSigma(); }

  // D, V, DV, B, BM: values first, then their standard deviations, then heights.
  void ReadBetween(bool with_distance, bool with_vertical, bool with_bearing) {
    if (with_vertical && dimensions_ == 2) Fail("vertical observations need .3D");
    const std::vector<std::string> names = line_.Names(2, separator_);
    std::vector<NamedObservation> values;
    if (with_bearing)
      values.push_back(Named(ObservationKind::kAzimuth, names[0], names[1], line_.Bearing("the bearing")));
    if (with_distance) values.push_back(Distance(names[0], names[1]));
    if (with_vertical) values.push_back(Vertical(names[0], names[1]));
    AddWithSigmas(std::move(values));
  }

  void AddWithSigmas(std::vector<NamedObservation> values) {
    std::vector<NamedObservation> observations;
    for (NamedObservation& named : values) {
      std::optional<double> sigma;
      switch (named.observation.kind) {
        case ObservationKind::kAzimuth:
          sigma = AzimuthSigma();
          break;
        case ObservationKind::kAngle:
        case ObservationKind::kDirection:
          sigma = AngleSigma();
          break;
        case ObservationKind::kDistance:
        case ObservationKind::kSlopeDistance:
          sigma = DistanceSigma(named.observation.value);
          break;
        default:
          sigma = VerticalSigma();
      }
      Weigh(sigma, std::move(named), &observations);
    }
    ReadHeights(&observations);
    Add(observations);
  }

  void ReadAngle() {
    const std::array<std::string, 3> names = Three();
    NamedObservation named = Named(ObservationKind::kAngle, names[0], names[1], line_.Angle("the angle"));
    named.fore = names[2];
    AddWithSigmas({named});
  }

  // Angle, distance and, in 3D, the vertical observation to a station.
  void ReadMeasured(const std::array<std::string, 3>& at_from_to) {
    NamedObservation angle = Named(ObservationKind::kAngle, at_from_to[0], at_from_to[1], line_.Angle("the angle"));
    angle.fore = at_from_to[2];
    std::vector<NamedObservation> values = {angle, Distance(at_from_to[0], at_from_to[2])};
    if (dimensions_ == 3) values.push_back(Vertical(at_from_to[0], at_from_to[2]));
    AddWithSigmas(std::move(values));
  }

  // TB names the backsight, each T the next station and what is measured there, TE closes on the last station.
  void ReadTraverse(const std::string& code) {
    if (code == "TB") {
      traverse_back_ = line_.Word("the backsight");
      traverse_at_.clear();
      return;
    }
    if (traverse_back_.empty()) Fail("a traverse begins with TB");
    const std::string station = line_.Word("the station");
    EndTraverseLeg(station);
    if (code == "TE") {
      if (line_.More()) {  // a closing angle to a foresight
        NamedObservation angle = Named(ObservationKind::kAngle, station, traverse_back_, line_.Angle("the angle"));
        angle.fore = line_.Word("the foresight");
        AddWithSigmas({angle});
      }
      traverse_back_.clear();
      return;
    }
    traverse_at_ = station;
    leg_ = line_;
    line_.SkipRest();
  }

  // What a T line measured can be told only when the next line names the station it went to.
  void EndTraverseLeg(const std::string& next_station) {
    if (traverse_at_.empty()) return;
    std::swap(line_, leg_);
    ReadMeasured({traverse_at_, traverse_back_, next_station});
    line_.RefuseMore("T");
    std::swap(line_, leg_);
    traverse_back_ = traverse_at_;
    traverse_at_.clear();
  }

  void ReadSet(const std::string& code) {
    if (code == "DB") {
      if (in_set_) Fail("the direction set before is not ended by DE");
      set_station_ = line_.Word("the station");
      PointOf(set_station_);
      clusters_.Begin();
      in_set_ = true;
      return;
    }
    if (!in_set_) Fail("a direction set begins with DB");
    if (code == "DE") {
      in_set_ = false;
      clusters_.End();
      return;
    }
    const std::string target = line_.Word("the target");
    std::vector<NamedObservation> values = {
        Named(ObservationKind::kDirection, set_station_, target, line_.Angle("the direction"))};
    if (code == "DM") {
      values.push_back(Distance(set_station_, target));
      if (dimensions_ == 3) values.push_back(Vertical(set_station_, target));
    }
    AddWithSigmas(std::move(values));
  }

  // L from-to difference [length of the line in km (miles with feet)] [standard deviation]
  void ReadLevelled() {
    if (dimensions_ == 2) Fail("levelled height differences need .3D");
    const std::vector<std::string> names = line_.Names(2, separator_);
    NamedObservation named =
        Named(ObservationKind::kHeightDifference, names[0], names[1], Length("the difference of height"));
    double length_km = 1.0;
    if (line_.More()) {
      length_km = line_.Number("the length of the line") * (metres_per_unit_ == 1.0 ? 1.0 : kKmPerMile);
      if (length_km <= 0.0) Fail("the length of the line must be positive (km, or miles with feet)");
    }
    std::vector<NamedObservation> observations;
    Weigh(LevelSigma(length_km), named, &observations);
    Add(observations);
  }

  const std::filesystem::path& file_;
  const StarnetSigmas& defaults_;
  NetworkFile result_;
  NetworkClusters clusters_;
  StarnetLine line_;
  bool ended_ = false;
  bool data_on_ = true;
  bool units_known_ = false;
  double metres_per_unit_ = 1.0;
  int dimensions_ = 0;
  std::optional<bool> north_first_;
  bool at_first_ = true;
  bool delta_ = false;
  char separator_ = '-';
  bool in_set_ = false;
  std::string set_station_;
  std::map<std::string, bool> has_plane_;
  std::string traverse_back_, traverse_at_;
  StarnetLine leg_;  // what was measured at traverse_at_
  int num_sideshots_ = 0;
};

}  // namespace

NetworkFile ReadStarnet(const std::filesystem::path& file, const StarnetSigmas& sigmas) {
  return StarnetReader(file, sigmas).Read();
}

}  // namespace formats
