// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>

#include "formats/sqlite.h"

namespace formats {

// The number of rows of each table, then each table as text, but not provenance and end marker. A table of one row
// stands as a list of its values. Columns *_ns are printed in seconds, blobs of ranges as a summary.
void PrintTables(Database& database, std::ostream& out);

}  // namespace formats
