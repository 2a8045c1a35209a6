// SPDX-License-Identifier: Apache-2.0
//
// A person's answers on disk, blocks/B/answers/*.json, as the page reads and writes them: one for each scan. Two people
// cannot overwrite each other: whoever writes says which state he has seen.
#pragma once

#include <filesystem>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

#include "stages/review/written.h"

namespace review {

class AnswerStore {
 public:
  explicit AnswerStore(std::filesystem::path site) : site_(std::move(site)) {}

  // {"B1": {"1048200000000": {"tag": ..., "answer": {...}}}}: by block and stamp of the scan. Stamps are texts.
  nlohmann::json All() const;

  // `seen`: the tag of the answer that it takes the place of, empty when there was none.
  Written Put(const std::string& block, const std::string& stamp, nlohmann::json answer, const std::string& seen);
  Written Remove(const std::string& block, const std::string& stamp, const std::string& seen);

 private:
  struct Entry {
    std::filesystem::path file;
    std::string tag;
  };
  bool HasBlock(const std::string& block) const;
  Entry Find(const std::string& block, const std::string& stamp) const;
  void Check(const std::string& block, const std::filesystem::path& file,
             const std::filesystem::path& in_place_of) const;

  std::filesystem::path site_;
  std::mutex mutex_;
};

}  // namespace review
