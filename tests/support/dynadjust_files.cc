// SPDX-License-Identifier: Apache-2.0
#include "tests/support/dynadjust_files.h"

#include <Eigen/Dense>
#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>

#include "survey/network/observation_equation.h"
#include "tests/support/dynadjust_geoid.h"
#include "tests/support/dynadjust_text.h"

namespace test_support {
namespace {

using survey::CoordinateUse;
using survey::Observation;
using survey::ObservationKind;

constexpr double kArcSecond = M_PI / 180.0 / 3600.0;
constexpr double kMeanRadius = 6.37e6;
constexpr double kLastDigit = 1e-4 / 3.46;  // sigma of a length printed to 0.1 mm (m)

const GeographicLib::Geocentric& Earth() { return GeographicLib::NormalGravity::GRS80().Earth(); }

// Latitude and longitude (deg) of a place in a southern UTM zone.
Eigen::Vector2d PlaceOfGrid(double easting, double northing, int zone) {
  static const GeographicLib::TransverseMercator kUtm(Earth().EquatorialRadius(), Earth().Flattening(), 0.9996);
  Eigen::Vector2d place;
  kUtm.Reverse(6.0 * zone - 183.0, easting - 5e5, northing - 1e7, place.x(), place.y());
  return place;
}

Eigen::Vector3d Geocentric(const Eigen::Vector2d& place, double height) {
  Eigen::Vector3d p;
  Earth().Forward(place.x(), place.y(), height, p.x(), p.y(), p.z());
  return p;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& folder) : folder_(folder) {}

  DynAdjustNetwork Read() {
    result_.network.geometry.geocentric = true;
    result_.network.use_sigma_a_posteriori = false;
    ReadExpected();
    ReadStations();
    FindGeoid();
    ReadMeasurements();
    ReadConstraints();
    return std::move(result_);
  }

 private:
  // Columns of the expected output: type, three stations, ignored, component, six values.
  void ReadExpected() {
    std::ifstream in(folder_ / "urban.phased.adj.expected");
    enum class Part { kHead, kMeasurements, kStations } part = Part::kHead;
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("Chi squared")) result_.chi_square = std::stod(Words(line).back());
      if (line.starts_with("Degrees of freedom")) result_.degrees_of_freedom = std::stoi(Words(line).back());
      if (line.starts_with("M Station 1")) part = Part::kMeasurements;
      if (line.starts_with("Station      ")) part = Part::kStations;
      if (line.size() < 100 || line.starts_with("M Station") || line.starts_with("Station  ") || line.front() == '-') {
        continue;
      }
      if (part == Part::kMeasurements) AddExpected(line);
      if (part == Part::kStations) AddStation(line);
    }
  }

  void AddExpected(const std::string& line) {
    ExpectedMeasurement m{.type = line.front()};
    for (const std::size_t at : {std::size_t{2}, std::size_t{22}, std::size_t{42}}) {
      const std::string station = Field(line, at, 20);
      if (!station.empty()) m.stations.push_back(station);
    }
    m.component = Field(line, 65, 2);
    const bool angular =
        std::string("AKBVZ").find(m.type) != std::string::npos || m.component == "P" || m.component == "L";
    m.measured = Value(line.substr(67, 19), angular);
    m.adjusted = Value(line.substr(86, 19), angular);
    const std::vector<std::string> rest = Words(line.substr(105));
    m.correction = std::stod(rest.at(0));
    m.sigma_adjusted = std::stod(rest.at(2));
    m.sigma_correction = std::stod(rest.at(3));
    m.n_statistic = std::stod(rest.at(4));
    m.before = std::stod(rest.at(6));
    by_key_[Key(m.type, m.stations, m.component)].push_back(m);
  }

  static std::string Key(char type, const std::vector<std::string>& stations, const std::string& component) {
    std::string key(1, type);
    for (const std::string& station : stations) key += " " + station;
    return key + "/" + component;
  }

  void AddStation(const std::string& line) {
    const std::vector<std::string> words = Words(line);
    index_[words.at(0)] = static_cast<int>(result_.network.points.size());
    // Geocentric coordinates have 0.1 mm as their last digit, latitude and longitude 0.3 mm.
    const double x = std::stod(words.at(6)), y = std::stod(words.at(7)), z = std::stod(words.at(8));
    const CoordinateUse use = words.at(1) == "CCC" ? CoordinateUse::kFixed : CoordinateUse::kAdjusted;
    result_.network.points.push_back(
        {.name = words.at(0), .plane = use, .height = use, .plane_known = true, .height_known = true});
    result_.expected_positions.emplace_back(x, y, z);
    result_.expected_sigmas.emplace_back(std::stod(words.at(9)), std::stod(words.at(10)), std::stod(words.at(11)));
    constraints_.push_back(words.at(1));
    geoid_heights_.push_back(std::stod(words.at(5)) - std::stod(words.at(4)));
  }

  // Where each station was before the adjustment, in the grid and above the geoid.
  void ReadStations() {
    places_.resize(index_.size());
    levels_.resize(index_.size());
    std::ifstream in(folder_ / "urban-network.stn");
    for (std::string line; std::getline(in, line);) {
      if (line.front() == '!' || line.front() == '*') continue;
      const std::vector<std::string> words = Words(line);
      const auto station = static_cast<std::size_t>(index_.at(words.at(0)));
      places_[station] = PlaceOfGrid(std::stod(words.at(3)), std::stod(words.at(4)), std::stoi(words.at(6)));
      levels_[station] = std::stod(words.at(5));
    }
  }

  const Eigen::Vector2d& PlaceOf(const std::string& station) const {
    return places_[static_cast<std::size_t>(index_.at(station))];
  }

  // From all that the expected output tells of it; then the stations have their coordinates before the adjustment.
  void FindGeoid() {
    for (std::size_t i = 0; i < places_.size(); ++i)
      geoid_.AddHeight(places_[i], geoid_heights_[i], std::sqrt(2.0) * kLastDigit);
    for (const auto& [key, measurements] : by_key_) {
      for (const ExpectedMeasurement& m : measurements) {
        if (m.type == 'L')
          geoid_.AddRise(PlaceOf(m.stations[0]), PlaceOf(m.stations[1]), m.before, kLastDigit);
        else if (m.type == 'H' || m.component == "H")
          geoid_.AddHeight(PlaceOf(m.stations[0]), m.before, kLastDigit);
      }
    }
    result_.geoid_misfit = geoid_.Fit();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const double height = levels_[i] + geoid_.Height(places_[i]);
      result_.network.points[i].position = Geocentric(places_[i], height);
    }
  }

  // The expected measurement that belongs to one of the file: of several between the same stations the one with that
  // value.
  ExpectedMeasurement Take(char type, const std::vector<std::string>& stations, const std::string& component,
                           double measured) {
    std::vector<ExpectedMeasurement>& all = by_key_[Key(type, stations, component)];
    for (auto it = all.begin(); it != all.end(); ++it) {
      if (std::abs(it->measured - measured) > 1.1e-4) continue;
      ExpectedMeasurement found = *it;
      all.erase(it);
      return found;
    }
    throw std::runtime_error("no expected measurement for " + Key(type, stations, component));
  }

  void ReadMeasurements() {
    std::ifstream in(folder_ / "urban-network.msr");
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      if (line.front() == '*' || line.size() < 3 || line[1] == '*') continue;
      if (line.front() == 'G') {
        ReadBaseline(line, in);
      } else if (line.front() == 'Y') {
        ReadPointCluster(line, in);
      } else {
        ReadSingle(line);
      }
    }
  }

  void Add(const Observation& observation, const ExpectedMeasurement& expected) {
    result_.network.observations.push_back(observation);
    result_.expected.push_back(expected);
  }

  void ReadSingle(const std::string& line) {
    const char type = line.front();
    std::vector<std::string> stations;
    for (const std::size_t at : {std::size_t{2}, std::size_t{22}, std::size_t{42}}) {
      const std::string station = Field(line, at, 20);
      if (!station.empty() && (at < 42 || type == 'A')) stations.push_back(station);
    }
    const bool angular = std::string("AKBVZ").find(type) != std::string::npos;
    const std::vector<std::string> words = Words(line.substr(62));
    const double measured = Value(line.substr(62), angular);
    const std::size_t next = angular ? 3 : 1;
    const ExpectedMeasurement expected = Take(type, stations, "", measured);
    Observation o{.from = index_.at(stations[0])};
    if (stations.size() > 1) o.to = index_.at(stations[1]);
    if (stations.size() > 2) o.fore = index_.at(stations[2]);
    o.sigma = std::stod(words.at(next)) * (angular ? kArcSecond : 1.0);
    if (words.size() > next + 2) {
      o.instrument_height = std::stod(words[next + 1]);
      o.target_height = std::stod(words[next + 2]);
    }
    SetKind(type, measured, expected.before, &o);
    Add(o, expected);
  }

  double GeoidUnder(int station) const { return geoid_.Height(places_[static_cast<std::size_t>(station)]); }

  // DynAdjust puts the target's height on the vertical of the instrument, for slope distances only; upright targets
  // lean away from each other by the height over the Earth's radius, 0.25 mm per kilometre. What to add to its
  // distances.
  double LeanOfTarget(const Observation& o) const {
    const Eigen::Vector3d& from = result_.expected_positions[static_cast<std::size_t>(o.from)];
    const Eigen::Vector3d& to = result_.expected_positions[static_cast<std::size_t>(o.to)];
    const Eigen::Vector3d up = survey::LevelledAxes(from).row(2);
    const Eigen::Vector3d up_at_target = survey::LevelledAxes(to).row(2);
    const Eigen::Vector3d from_instrument = to - from - o.instrument_height * up;
    return (from_instrument + o.target_height * up_at_target).norm() - (from_instrument + o.target_height * up).norm();
  }

  // Heights of the geoid are added; deflections of the vertical are taken off.
  void SetKind(char type, double measured, double before, Observation* o) const {
    const double angle = (measured - before) * kArcSecond;
    o->value = measured;
    switch (type) {
      case 'A':
        o->kind = ObservationKind::kAngle;
        o->value = angle;
        break;
      case 'K':
      case 'B':
        o->kind = ObservationKind::kAzimuth;
        o->value = angle;
        break;
      case 'V':
        o->kind = ObservationKind::kZenithAngle;
        o->value = angle;
        break;
      case 'Z':
        o->kind = ObservationKind::kZenithAngle;
        o->value = M_PI / 2 - angle;
        break;
      case 'S':
        o->kind = ObservationKind::kSlopeDistance;
        o->value = measured + LeanOfTarget(*o);
        break;
      case 'M': {  // at sea level; here in the height of the station
        o->kind = ObservationKind::kDistance;
        const Eigen::Vector3d& p = result_.expected_positions[static_cast<std::size_t>(o->from)];
        o->value = measured * (1.0 + (survey::EllipsoidalHeight(p) - GeoidUnder(o->from)) / kMeanRadius);
        break;
      }
      case 'H':
        o->kind = ObservationKind::kHeight;
        o->value = measured + GeoidUnder(o->from);
        break;
      case 'L':
        o->kind = ObservationKind::kHeightDifference;
        o->value = measured + GeoidUnder(o->to) - GeoidUnder(o->from);
        break;
      default:
        throw std::runtime_error(std::string("unknown measurement type ") + type);
    }
  }

  void ReadBaseline(const std::string& line, std::ifstream& in) {
    const std::vector<std::string> stations = {Field(line, 2, 20), Field(line, 22, 20)};
    Eigen::Matrix3d covariance;
    const std::size_t first = result_.network.observations.size();
    for (int row = 0; row < 3; ++row) {
      std::string values;
      std::getline(in, values);
      const std::vector<double> numbers = Decimals(values);
      for (int column = 0; column <= row; ++column) {
        covariance(row, column) = covariance(column, row) = numbers.at(static_cast<std::size_t>(column) + 1);
      }
      Observation o{.kind = ObservationKind::kDifference,
                    .from = index_.at(stations[0]),
                    .to = index_.at(stations[1]),
                    .component = row,
                    .value = numbers.at(0)};
      o.sigma = std::sqrt(covariance(row, row));
      Add(o, Take('G', stations, std::string(1, "XYZ"[row]), numbers.at(0)));
    }
    result_.network.correlated.push_back({first, covariance});
  }

  // Latitudes, longitudes and heights of some stations with their whole covariance (rad, m), as geocentric coordinates.
  void ReadPointCluster(std::string line, std::ifstream& in) {
    const int count = std::stoi(Words(line.substr(40)).at(0));
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    const std::size_t first = result_.network.observations.size();
    for (int k = 0; k < count; ++k) {
      if (k > 0) std::getline(in, line);
      const std::string station = Field(line, 2, 20);
      double values[3];
      for (int row = 0; row < 3; ++row) {
        std::getline(in, line);
        const std::vector<double> numbers = Decimals(line);
        values[row] = numbers.at(0);
        for (int column = 0; column <= row; ++column) {
          covariance(3 * k + row, 3 * k + column) = covariance(3 * k + column, 3 * k + row) =
              numbers.at(static_cast<std::size_t>(column) + 1);
        }
      }
      for (int other = k + 1; other < count; ++other) {
        for (int row = 0; row < 3; ++row) {
          std::getline(in, line);
          const std::vector<double> numbers = Decimals(line);
          for (int column = 0; column < 3; ++column) {
            covariance(3 * k + row, 3 * other + column) = covariance(3 * other + column, 3 * k + row) =
                numbers.at(static_cast<std::size_t>(column));
          }
        }
      }
      AddPosition(station, values, 3 * k, &jacobian);
    }
    result_.network.correlated.push_back({first, jacobian * covariance * jacobian.transpose()});
    for (std::size_t i = 0; i < static_cast<std::size_t>(3 * count); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      result_.network.observations[first + i].sigma = std::sqrt(result_.network.correlated.back().covariance(row, row));
    }
  }

  void AddPosition(const std::string& station, const double packed[3], int place, Eigen::MatrixXd* jacobian) {
    char latitude_text[40], longitude_text[40];
    std::snprintf(latitude_text, sizeof latitude_text, "%.12f", packed[0]);
    std::snprintf(longitude_text, sizeof longitude_text, "%.12f", packed[1]);
    const double latitude = PackedDegrees(latitude_text), longitude = PackedDegrees(longitude_text);
    ExpectedMeasurement expected[3] = {Take('Y', {station}, "P", latitude * 3600.0),
                                       Take('Y', {station}, "L", longitude * 3600.0),
                                       Take('Y', {station}, "H", packed[2])};
    const double height = packed[2] + GeoidUnder(index_.at(station));
    const auto position = [&](double d_latitude, double d_longitude, double d_height) {
      return Geocentric(Eigen::Vector2d(latitude, longitude) + Eigen::Vector2d(d_latitude, d_longitude) * 180.0 / M_PI,
                        height + d_height);
    };
    constexpr double kStep = 1e-6;
    jacobian->block<3, 1>(place, place) = (position(kStep, 0, 0) - position(-kStep, 0, 0)) / (2 * kStep);
    jacobian->block<3, 1>(place, place + 1) = (position(0, kStep, 0) - position(0, -kStep, 0)) / (2 * kStep);
    jacobian->block<3, 1>(place, place + 2) = position(0, 0, 0.5) - position(0, 0, -0.5);
    const Eigen::Vector3d p = position(0, 0, 0);
    for (int row = 0; row < 3; ++row) {
      Add({.kind = ObservationKind::kCoordinate, .from = index_.at(station), .component = row, .value = p[row]},
          expected[row]);
    }
  }

  // Stations that are constrained in some of east, north and up are observed there, with 10 micrometres, and in the
  // others with the 10 m that DynAdjust gives to free stations, at the coordinates that they had before.
  void ReadConstraints() {
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      if (constraints_[i] == "FFF" || constraints_[i] == "CCC") continue;
      const Eigen::Vector3d& given = result_.network.points[i].position;
      const Eigen::Matrix3d axes = survey::LevelledAxes(given);
      Eigen::Vector3d sigmas;
      for (int k = 0; k < 3; ++k) {
        const bool constrained = constraints_[i][static_cast<std::size_t>(k)] == 'C';
        sigmas[k] = constrained ? 1e-5 : 10.0;
        if (!constrained) ++result_.num_loose_constraints;
      }
      const std::size_t first = result_.network.observations.size();
      for (int k = 0; k < 3; ++k) {
        result_.network.observations.push_back({.kind = ObservationKind::kCoordinate,
                                                .from = static_cast<int>(i),
                                                .component = k,
                                                .value = given[k],
                                                .sigma = 1});
      }
      result_.network.correlated.push_back({first, axes.transpose() * sigmas.cwiseAbs2().asDiagonal() * axes});
    }
  }

  const std::filesystem::path& folder_;
  DynAdjustNetwork result_;
  std::map<std::string, int> index_;
  std::vector<std::string> constraints_;
  std::vector<double> geoid_heights_;    // printed, of each station
  std::vector<Eigen::Vector2d> places_;  // of each station: latitude and longitude before the adjustment (deg)
  std::vector<double> levels_;           // above the geoid (m)
  GeoidSurface geoid_;
  std::map<std::string, std::vector<ExpectedMeasurement>> by_key_;
};

}  // namespace

DynAdjustNetwork ReadDynAdjust(const std::filesystem::path& folder) { return Reader(folder).Read(); }

}  // namespace test_support
