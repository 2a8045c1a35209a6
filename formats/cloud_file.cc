// SPDX-License-Identifier: Apache-2.0
#include "formats/cloud_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "formats/errors.h"

namespace formats {
namespace {

static_assert(std::endian::native == std::endian::little, "binary clouds are read as they lie in memory");

using Take = std::function<void(const CloudPoint&)>;

constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr const char* kIntensities[] = {"intensity", "scalar_Intensity", "reflectance"};
constexpr std::size_t kLargestRecord = 4096;  // bytes
constexpr std::int64_t kBatch = 16384;        // points read at once

// A value within a record.
struct Property {
  std::string name;
  std::size_t size = 4;   // bytes
  bool real = true;       // float or double; else an integer
  std::size_t count = 1;  // PCD: values of this name
};

struct CloudLayout {
  bool ascii = false;
  std::int64_t num_points = 0;
  std::vector<Property> properties;
};

class CloudParser {
 public:
  explicit CloudParser(const std::filesystem::path& file) : file_(file), in_(file, std::ios::binary) {
    if (!in_) Fail("cannot be read");
  }

  CloudCount Read(const Take& take) {
    const std::string first = Line();
    if (first == "ply") {
      ReadPlyHeader();
    } else if (first.starts_with("#") || first.starts_with("VERSION")) {
      ReadPcdHeader(first);
    } else {
      Fail("is neither PLY nor PCD");
    }
    for (const char* axis : kAxes) FindReal(axis);
    CloudCount count = layout_.ascii ? ReadAscii(take) : ReadBinary(take);
    if (count.num_points == 0) Fail("holds no finite point");
    return count;
  }

 private:
  [[noreturn]] void Fail(const std::string& rule) const { throw DataError(file_.string() + ": " + rule); }

  std::string Line() {
    std::string line;
    if (!std::getline(in_, line)) Fail("was cut off");
    if (line.ends_with('\r')) line.pop_back();
    return line;
  }

  std::int64_t Count(const std::string& text) const {
    if (text.empty() || text.size() > 12 || text.find_first_not_of("0123456789") != std::string::npos) {
      Fail("\"" + text + "\" is no number of points");
    }
    return std::stoll(text);
  }

  Property PlyProperty(std::istringstream* words) const {
    std::string type, name;
    *words >> type >> name;
    const auto is = [&](std::initializer_list<const char*> names) {
      return std::find(names.begin(), names.end(), type) != names.end();
    };
    if (is({"float", "float32"})) return {name, 4, true};
    if (is({"double", "float64"})) return {name, 8, true};
    if (is({"char", "uchar", "int8", "uint8"})) return {name, 1, false};
    if (is({"short", "ushort", "int16", "uint16"})) return {name, 2, false};
    if (is({"int", "uint", "int32", "uint32"})) return {name, 4, false};
    Fail("property " + name + ": a " + type + " cannot be read in vertices");
  }

  void ReadPlyHeader() {
    bool in_vertices = false, any_element = false;
    for (std::string line = Line(); line != "end_header"; line = Line()) {
      std::istringstream words(line);
      std::string keyword, what, value;
      words >> keyword;
      if (keyword == "format") {
        words >> what;
        if (what != "ascii" && what != "binary_little_endian") Fail("format " + what + ": write it little-endian");
        layout_.ascii = what == "ascii";
      } else if (keyword == "element") {
        words >> what >> value;
        in_vertices = what == "vertex";
        if (in_vertices && any_element) Fail("vertices must be the first element");
        any_element = true;
        if (in_vertices) layout_.num_points = Count(value);
      } else if (keyword == "property" && in_vertices) {
        layout_.properties.push_back(PlyProperty(&words));
      }
    }
  }

  static std::vector<std::string> Words(std::istringstream* line) {
    std::vector<std::string> words;
    for (std::string word; *line >> word;) words.push_back(word);
    return words;
  }

  void ReadPcdHeader(std::string line) {
    for (;; line = Line()) {
      std::istringstream rest(line);
      std::string keyword;
      rest >> keyword;
      const std::vector<std::string> words = Words(&rest);
      if (keyword == "FIELDS") layout_.properties.resize(words.size());
      const bool by_field = keyword == "FIELDS" || keyword == "SIZE" || keyword == "TYPE" || keyword == "COUNT";
      if (by_field && words.size() != layout_.properties.size()) Fail(keyword + ": must have a word for each field");
      for (std::size_t i = 0; by_field && i < words.size(); ++i) {
        Property& property = layout_.properties[i];
        if (keyword == "FIELDS") property.name = words[i];
        if (keyword == "SIZE") property.size = static_cast<std::size_t>(Count(words[i]));
        if (keyword == "TYPE") property.real = words[i] == "F";
        if (keyword == "COUNT") property.count = static_cast<std::size_t>(Count(words[i]));
      }
      if (keyword == "POINTS" && !words.empty()) layout_.num_points = Count(words[0]);
      if (keyword != "DATA") continue;
      if (words.empty() || (words[0] != "ascii" && words[0] != "binary")) Fail("DATA must be ascii or binary");
      for (const Property& property : layout_.properties) {
        if (property.size > 8 || property.count > 1000) Fail("field " + property.name + " is too large to be read");
      }
      layout_.ascii = words[0] == "ascii";
      return;
    }
  }

  const Property& FindReal(const std::string& name) const {
    for (const Property& property : layout_.properties) {
      const bool size_fits = property.size == 4 || property.size == 8;
      if (property.name == name && property.real && property.count == 1 && size_fits) return property;
    }
    Fail("has no " + name + " as float or double");
  }

  std::size_t OffsetOf(const std::string& name) const {
    std::size_t offset = 0;
    for (const Property& property : layout_.properties) {
      if (property.name == name) break;
      offset += property.size * property.count;
    }
    return offset;
  }

  // Null when the cloud has none.
  const Property* FindIntensity() const {
    for (const Property& property : layout_.properties) {
      const bool named =
          std::find(std::begin(kIntensities), std::end(kIntensities), property.name) != std::end(kIntensities);
      if (named && property.count == 1 && (property.real ? property.size >= 4 : property.size <= 2)) return &property;
    }
    return nullptr;
  }

  static void Hand(const CloudPoint& point, const Take& take, CloudCount* count) {
    if (!point.position.allFinite()) {
      ++count->num_invalid;
      return;
    }
    ++count->num_points;
    take(point);
  }

  // A value of a record as it lies in memory.
  struct Place {
    std::size_t offset = 0;
    std::size_t size = 4;
    bool real = true;

    double Read(const char* record) const {
      if (real) return size == 8 ? As<double>(record) : static_cast<double>(As<float>(record));
      return size == 1 ? As<std::uint8_t>(record) : As<std::uint16_t>(record);
    }
    template <typename T>
    T As(const char* record) const {
      T value{};
      std::memcpy(&value, record + offset, sizeof value);
      return value;
    }
  };

  Place PlaceOf(const Property& property) const { return {OffsetOf(property.name), property.size, property.real}; }

  CloudCount ReadBinary(const Take& take) {
    std::size_t record = 0;
    for (const Property& property : layout_.properties) record += property.size * property.count;
    if (record > kLargestRecord) Fail("a point of " + std::to_string(record) + " bytes cannot be read");
    const std::array<Place, 3> places = {PlaceOf(FindReal("x")), PlaceOf(FindReal("y")), PlaceOf(FindReal("z"))};
    const Property* intensity = FindIntensity();
    const Place shade = intensity == nullptr ? Place{} : PlaceOf(*intensity);
    CloudCount count;
    std::vector<char> buffer(record * static_cast<std::size_t>(kBatch));
    for (std::int64_t done = 0; done < layout_.num_points;) {
      const std::int64_t batch = std::min<std::int64_t>(kBatch, layout_.num_points - done);
      const auto bytes = static_cast<std::streamsize>(record) * batch;
      in_.read(buffer.data(), bytes);
      if (in_.gcount() != bytes) Fail("was cut off");
      for (std::int64_t i = 0; i < batch; ++i) {
        const char* at = buffer.data() + static_cast<std::size_t>(i) * record;
        CloudPoint point{.position = {places[0].Read(at), places[1].Read(at), places[2].Read(at)}};
        if (intensity != nullptr) point.intensity = static_cast<float>(shade.Read(at));
        Hand(point, take, &count);
      }
      done += batch;
    }
    return count;
  }

  CloudCount ReadAscii(const Take& take) {
    CloudCount count;
    const Property* intensity = FindIntensity();
    for (std::int64_t i = 0; i < layout_.num_points; ++i) {
      std::istringstream line(Line());
      CloudPoint point{.position = Eigen::Vector3d::Constant(std::nan(""))};
      for (const Property& property : layout_.properties) {
        for (std::size_t k = 0; k < property.count; ++k) {
          std::string word;
          if (!(line >> word)) Fail("point " + std::to_string(i + 1) + " has too few values");
          const std::size_t axis = property.name.size() == 1 ? std::string("xyz").find(property.name[0]) : 3;
          if (axis < 3) point.position[static_cast<int>(axis)] = std::strtod(word.c_str(), nullptr);
          if (&property == intensity) point.intensity = std::strtof(word.c_str(), nullptr);
        }
      }
      Hand(point, take, &count);
    }
    return count;
  }

  const std::filesystem::path& file_;
  std::ifstream in_;
  CloudLayout layout_;
};

}  // namespace

CloudCount ReadCloudPoints(const std::filesystem::path& file, const std::function<void(const CloudPoint&)>& take) {
  return CloudParser(file).Read(take);
}

CloudCount ReadCloud(const std::filesystem::path& file, const std::function<void(const Eigen::Vector3d&)>& take) {
  return ReadCloudPoints(file, [&](const CloudPoint& point) { take(point.position); });
}

}  // namespace formats
