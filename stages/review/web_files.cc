// SPDX-License-Identifier: Apache-2.0
#include "stages/review/web_files.h"

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "formats/errors.h"
#include "formats/html.h"
#include "formats/json_text.h"
#include "stages/review/text.h"

namespace review {
namespace fs = std::filesystem;

WebFiles::WebFiles(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw formats::DataError(folder.string() + ": no such folder; is Plumbline whole?");
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file())
      files_[entry.path().lexically_relative(folder).generic_string()] = formats::ReadWholeFile(entry.path());
  }
  std::string digests;
  for (const auto& [path, bytes] : files_) digests += path + " " + formats::Sha256(bytes) + "\n";
  build_ = formats::Sha256(digests).substr(0, 16);
}

const std::string* WebFiles::Find(const std::string& path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

std::string WebFiles::TypeOf(const std::string& path) {
  static const std::map<std::string, std::string> kTypes = {{".html", "text/html; charset=utf-8"},
                                                            {".js", "text/javascript; charset=utf-8"},
                                                            {".css", "text/css; charset=utf-8"},
                                                            {".png", "image/png"},
                                                            {".svg", "image/svg+xml"}};
  const auto found = kTypes.find(fs::path(path).extension().string());
  return found == kTypes.end() ? "text/plain; charset=utf-8" : found->second;
}

// Our modules are named by their path, so that the same text works from a server and from inside the page.
std::string WebFiles::ImportsOf(bool inlined) const {
  nlohmann::json imports;
  for (const auto& [path, text] : files_) {
    const bool ours = path.starts_with("review/") || path.starts_with("shared/");
    if (!path.ends_with(".js") || !(ours || (!inlined && !path.starts_with("vendor/ol/")))) continue;
    imports[path] = inlined ? "data:text/javascript;base64," + formats::Base64(text) : "/" + path;
  }
  return formats::JsonText(nlohmann::json{{"imports", imports}});
}

std::string WebFiles::Page(const std::string& path, const std::string& nonce, bool inlined) const {
  const std::string page = ReplacedAll(ReplacedAll(files_.at(path), "@BUILD@", build_), "@NONCE@", nonce);
  return ReplacedAll(page, "@IMPORTS@", ImportsOf(inlined));
}

}  // namespace review
