// SPDX-License-Identifier: Apache-2.0
#include "formats/filter_checkpoint.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "formats/answers_file.h"
#include "formats/atomic_file.h"
#include "formats/digest.h"

namespace formats {
namespace {

using survey::FilterUpdate;

constexpr std::size_t kDigestLength = 64;

template <typename T>
concept Plain = std::is_trivially_copyable_v<T>;

// Values one after another as the machine has them; lists and texts begin with their lengths.
class Writer {
 public:
  template <Plain T>
  void operator()(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <Plain T>
  void operator()(const std::vector<T>& list) {
    Length(list);
    for (const T& value : list) (*this)(value);
  }
  void operator()(const std::string& text) {
    Length(text);
    bytes_ += text;
  }
  template <typename Container>
  void Length(const Container& list) {
    (*this)(std::uint64_t{list.size()});
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Reads bytes whose digest was found right.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <Plain T>
  void operator()(T& value) {
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
  }
  template <Plain T>
  void operator()(std::vector<T>& list) {
    Length(list);
    for (T& value : list) (*this)(value);
  }
  void operator()(std::string& text) {
    Length(text);
    text = bytes_.substr(0, text.size());
    bytes_.remove_prefix(text.size());
  }
  template <typename Container>
  void Length(Container& list) {
    std::uint64_t length = 0;
    (*this)(length);
    list.resize(length);
  }

 private:
  std::string_view bytes_;
};

constexpr auto kAnswer = [](auto& bytes, auto& answer) {
  bytes(answer.from);
  bytes(answer.meaning);
};
constexpr auto kUpdate = [](auto& bytes, auto& update) {
  bytes(update.scan);
  bytes(update.poses);
  bytes(update.parents);
  bytes(update.log_weights);
  bytes(update.evidence);
  bytes(update.effective_size);
  bytes(update.resampled);
  bytes(update.lost);
  bytes(update.spread);
};
constexpr auto kCheckpoint = [](auto& bytes, auto& checkpoint) {
  bytes(checkpoint.key);
  bytes.Length(checkpoint.answers);
  for (auto& answer : checkpoint.answers) kAnswer(bytes, answer);
  bytes.Length(checkpoint.tree);
  for (auto& update : checkpoint.tree) kUpdate(bytes, update);
};

survey::ScanId FirstDifference(const std::vector<FilterAnswer>& before, const std::vector<FilterAnswer>& after) {
  survey::ScanId first{std::numeric_limits<int>::max()};
  const auto missing_in = [&first](const auto& answers, const auto& others) {
    for (const FilterAnswer& answer : answers) {
      if (std::find(others.begin(), others.end(), answer) == others.end()) first = std::min(first, answer.from);
    }
  };
  missing_in(before, after);
  missing_in(after, before);
  return first;
}

}  // namespace

std::vector<FilterAnswer> AnswersInFilter(const survey::Answers& answers) {
  std::vector<FilterAnswer> in_filter;
  for (const survey::Answer& answer : answers) {
    if (answer.ActsInFilter()) {
      // Its reference becomes an update; the first scan is one anyway.
      const survey::ScanId from = answer.reference == survey::ScanId{0} ? answer.scan : answer.reference;
      in_filter.push_back({from, CanonicalLine(answer)});
    } else if (answer.decision == survey::Decision::kRejectStretch) {
      in_filter.push_back({answer.scan, CanonicalLine(answer)});
    }
  }
  return in_filter;
}

survey::TrajectoryTree UpdatesThatHold(const FilterCheckpoint& checkpoint, const std::vector<FilterAnswer>& answers) {
  const survey::ScanId first = FirstDifference(checkpoint.answers, answers);
  const auto end = std::find_if(checkpoint.tree.begin(), checkpoint.tree.end(),
                                [first](const FilterUpdate& update) { return !(update.scan < first); });
  return {checkpoint.tree.begin(), end};
}

void WriteCheckpoint(const std::filesystem::path& file, const FilterCheckpoint& checkpoint) {
  Writer bytes;
  kCheckpoint(bytes, checkpoint);
  WriteFileAtomically(file, Sha256(bytes.bytes()) + bytes.bytes());
}

std::optional<FilterCheckpoint> ReadCheckpoint(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  const std::string content = ReadWholeFile(file);
  if (content.size() < kDigestLength) return std::nullopt;
  const std::string_view bytes = std::string_view(content).substr(kDigestLength);
  if (Sha256(bytes) != content.substr(0, kDigestLength)) return std::nullopt;
  FilterCheckpoint checkpoint;
  Reader reader(bytes);
  kCheckpoint(reader, checkpoint);
  return checkpoint;
}

}  // namespace formats
