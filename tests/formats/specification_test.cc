// SPDX-License-Identifier: Apache-2.0
//
// The specification quotes the schemas: a schema that changes changes it too.
#include <gtest/gtest.h>

#include "formats/artefact_formats.h"
#include "formats/atomic_file.h"
#include "tests/support/paths.h"

namespace formats {
namespace {

TEST(Specification, QuotesEverySchema) {
  const std::string text = ReadWholeFile(test_support::SourceFolder() / "formats/README.md");
  EXPECT_NE(text.find("```sql" + std::string(kCommonSchema)), std::string::npos);
  for (const ArtefactFormat& format : AllFormats()) {
    EXPECT_NE(text.find("```sql" + std::string(format.schema) + "```"), std::string::npos)
        << "formats/README.md does not quote the schema of " << format.name << " as it is in the code";
    EXPECT_NE(text.find("| " + std::string(format.name) + " | " + std::to_string(format.UserVersion()) + " |"),
              std::string::npos)
        << format.name;
  }
}

}  // namespace
}  // namespace formats
