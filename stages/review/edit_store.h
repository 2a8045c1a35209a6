// SPDX-License-Identifier: Apache-2.0
//
// The ledger of map edits as the page reads it and appends to it. Two people cannot write past each other: whoever
// writes says which head of the ledger he has seen.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

#include "stages/review/written.h"

namespace review {

class EditStore {
 public:
  explicit EditStore(std::filesystem::path site) : site_(std::move(site)) {}

  // {"head", "edits", "findings"}: the edits that count, each with its members as README.md of the formats names them
  // and `shown`, its geometry where the last run has put it; and what that run found about them.
  nlohmann::json All() const;

  // `body`: {"operations": [{"op": "add", ...}, {"op": "modify", ...}, {"op": "retire", ...}]}, all or none.
  Written Append(const nlohmann::json& body, const std::string& seen) const;

 private:
  std::filesystem::path site_;
};

}  // namespace review
