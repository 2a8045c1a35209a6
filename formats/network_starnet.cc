// SPDX-License-Identifier: Apache-2.0
//
// STAR*NET data files [STARNET]: C CH E A D V DV B M BM T TB TE DB DN DM DE L and the inline options that shape them.
// The order of coordinates, the unit of length and 2D or 3D are project settings of STAR*NET; here the file itself must
// state them (.ORDER, .UNITS, .2D or .3D). Angles are degrees, d-m-s; standard deviations of angles are arc seconds.
// In the place of a standard deviation: ! fixed, * free, & the default.
#include <array>
#include <optional>
#include <utility>

#include "formats/errors.h"
#include "formats/line_reader.h"
#include "formats/network_cluster.h"
#include "formats/network_file.h"
#include "formats/starnet_settings.h"
#include "formats/starnet_stations.h"
#include "formats/starnet_weights.h"
#include "formats/text_encoding.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

using survey::ObservationKind;

constexpr double kKmPerMile = 1.609344;

class StarnetReader {
 public:
  StarnetReader(const std::filesystem::path& file, const StarnetSigmas& sigmas) : file_(file), defaults_(sigmas) {}

  NetworkFile Read() {
    ReadLines();
    if (in_set_) Fail("the direction set is not ended by DE");
    if (num_sideshots_ > 0) {
      result_.warnings.push_back(file_.string() + ": " + std::to_string(num_sideshots_) +
                                 " sideshots (SS) are left out: they take no part in the adjustment");
    }
    result_.angle_unit = AngleUnit::kDegrees;
    result_.network.sigma_zero = 1.0;
    result_.network.use_sigma_a_posteriori = false;
    stations_.Settle();
    clusters_.MoveInto(&result_.network, &result_.warnings);
    return std::move(result_);
  }

 private:
  [[noreturn]] void Fail(const std::string& rule) const { line_.Fail(rule); }
  double Length(const std::string& what) { return line_.Number(what) * settings_.metres_per_unit; }
  bool Is3D() const { return settings_.dimensions == 3; }

  void ReadLines() {
    LineReader lines(file_);
    bool latin = false;
    for (std::string_view line; !settings_.ended && lines.Next(&line);) {
      std::string text(line);
      if (!IsUtf8(text)) {
        text = Utf8OfLatin1(text);
        latin = true;
      }
      line_ = StarnetLine(lines.Where() + ": ", std::move(text));
      ReadLine();
    }
    if (latin) result_.warnings.push_back(file_.string() + ": is not UTF-8; read as Latin-1");
  }

  void ReadLine() {
    if (!line_.More()) return;
    const std::string code = Upper(line_.Word("the type"));
    if (code.starts_with(".")) {
      settings_.Read(code, &line_);
    } else if (settings_.data_on) {
      ReadData(code);
    } else {
      return;
    }
    line_.RefuseMore(code);
  }

  void ReadData(const std::string& code) {
    settings_.RequireComplete(line_);
    if (in_set_ && code != "DB" && code != "DN" && code != "DM" && code != "DE")
      Fail("lines of type " + code + " have no place in a direction set");
    if (code == "C" || code == "CH") return stations_.ReadCoordinates(&line_);
    if (code == "E" || code == "EH") return stations_.ReadElevation(&line_);
    if (code == "A") return ReadAngle();
    if (code == "D") return ReadBetween(true, false, false);
    if (code == "V") return ReadBetween(false, true, false);
    if (code == "DV") return ReadBetween(true, true, false);
    if (code == "B") return ReadBetween(false, false, true);
    if (code == "BM") return ReadBetween(true, Is3D(), true);
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

  // At, from, to in the order of the file.
  std::array<std::string, 3> Three() {
    std::vector<std::string> names = line_.Names(3, settings_.separator);
    if (!settings_.at_first) std::swap(names[0], names[1]);
    return {names[0], names[1], names[2]};
  }

  static NamedObservation Named(ObservationKind kind, const std::string& from, const std::string& to, double value) {
    NamedObservation named{.from = from, .to = to};
    named.observation.kind = kind;
    named.observation.value = value;
    return named;
  }

  void Add(const std::vector<NamedObservation>& observations) {
    for (const NamedObservation& named : observations) {
      const bool height_only = named.observation.kind == ObservationKind::kHeightDifference;
      for (const std::string& name : {named.from, named.to, named.fore}) {
        if (!name.empty()) stations_.Name(name, !height_only, line_);
      }
    }
    if (!in_set_) clusters_.Begin();
    for (const NamedObservation& named : observations) clusters_.Add(named, line_.where());
    if (!in_set_) clusters_.End();
  }

  NamedObservation Distance(const std::string& from, const std::string& to) {
    const double value = Length("the distance");
    if (value <= 0.0) Fail("a distance must be positive");
    const bool slope = Is3D() && !settings_.delta;
    return Named(slope ? ObservationKind::kSlopeDistance : ObservationKind::kDistance, from, to, value);
  }

  NamedObservation Vertical(const std::string& from, const std::string& to) {
    if (settings_.delta) return Named(ObservationKind::kHeightDifference, from, to, Length("the difference of height"));
    return Named(ObservationKind::kZenithAngle, from, to, line_.Angle("the zenith angle"));
  }

  // D, V, DV, B, BM: values first, then their standard deviations, then heights.
  void ReadBetween(bool with_distance, bool with_vertical, bool with_bearing) {
    if (with_vertical && !Is3D()) Fail("vertical observations need .3D");
    const std::vector<std::string> names = line_.Names(2, settings_.separator);
    std::vector<NamedObservation> values;
    if (with_bearing)
      values.push_back(Named(ObservationKind::kAzimuth, names[0], names[1], line_.Bearing("the bearing")));
    if (with_distance) values.push_back(Distance(names[0], names[1]));
    if (with_vertical) values.push_back(Vertical(names[0], names[1]));
    AddWithSigmas(std::move(values));
  }

  // Free ones are left out.
  void AddWithSigmas(std::vector<NamedObservation> values) {
    std::vector<NamedObservation> observations;
    for (NamedObservation& named : values) {
      const std::optional<double> sigma = ReadStarnetSigma(named.observation, defaults_, settings_, &line_);
      if (!sigma) continue;
      named.observation.sigma = *sigma;
      observations.push_back(std::move(named));
    }
    ReadHeights(&observations);
    Add(observations);
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
      named.observation.instrument_height = *instrument * settings_.metres_per_unit;
      named.observation.target_height = *target * settings_.metres_per_unit;
    }
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
    if (Is3D()) values.push_back(Vertical(at_from_to[0], at_from_to[2]));
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
      stations_.Name(set_station_, false, line_);
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
      if (Is3D()) values.push_back(Vertical(set_station_, target));
    }
    AddWithSigmas(std::move(values));
  }

  // L from-to difference [length of the line in km (miles with feet)] [standard deviation]
  void ReadLevelled() {
    if (!Is3D()) Fail("levelled height differences need .3D");
    const std::vector<std::string> names = line_.Names(2, settings_.separator);
    NamedObservation named =
        Named(ObservationKind::kHeightDifference, names[0], names[1], Length("the difference of height"));
    double length_km = 1.0;
    if (line_.More()) {
      length_km = line_.Number("the length of the line") * (settings_.metres_per_unit == 1.0 ? 1.0 : kKmPerMile);
      if (length_km <= 0.0) Fail("the length of the line must be positive (km, or miles with feet)");
    }
    const std::optional<double> sigma = ReadStarnetLevelSigma(length_km, defaults_, settings_, &line_);
    if (!sigma) return;
    named.observation.sigma = *sigma;
    Add({named});
  }

  const std::filesystem::path& file_;
  const StarnetSigmas& defaults_;
  NetworkFile result_;
  StarnetSettings settings_;
  NetworkClusters clusters_;
  StarnetStations stations_{settings_, &clusters_};
  StarnetLine line_;
  bool in_set_ = false;
  std::string set_station_;
  std::string traverse_back_, traverse_at_;
  StarnetLine leg_;  // what was measured at traverse_at_
  int num_sideshots_ = 0;
};

}  // namespace

NetworkFile ReadStarnet(const std::filesystem::path& file, const StarnetSigmas& sigmas) {
  return StarnetReader(file, sigmas).Read();
}

}  // namespace formats
