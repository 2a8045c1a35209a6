// SPDX-License-Identifier: Apache-2.0
//
// The files of the review page, read once: what is not in here cannot be asked for, whatever a path says.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace review {

class WebFiles {
 public:
  // Reads the folder `web` that is installed beside the graph. DataError when it is not there.
  explicit WebFiles(const std::filesystem::path& folder);

  // By path inside the folder, "review/main.js"; null when there is none.
  const std::string* Find(const std::string& path) const;
  const std::map<std::string, std::string>& all() const { return files_; }

  // Digest of all files: a page that was loaded from other files must not write.
  const std::string& build() const { return build_; }

  // An HTML page with its marks replaced: @BUILD@, @NONCE@ and @IMPORTS@, the map that tells the browser where modules
  // lie. `inlined`: modules stand in the page itself, as pages without a server need it.
  std::string Page(const std::string& path, const std::string& nonce, bool inlined) const;

  static std::string TypeOf(const std::string& path);  // MIME

 private:
  std::string ImportsOf(bool inlined) const;

  std::map<std::string, std::string> files_;
  std::string build_;
};

}  // namespace review
