// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace review {

// The review page as a folder that works without a server: index.html with all modules in it, data.js with the site's
// documents, and every tile of the map. What people decide there they save as a file for `plumbline review --import`.
// Returns the number of tiles. DataError when the folder holds anything else than such a page.
int WriteStaticPage(const std::filesystem::path& site, const std::filesystem::path& web,
                    const std::filesystem::path& folder);

}  // namespace review
