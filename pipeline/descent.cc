// SPDX-License-Identifier: Apache-2.0
#include "pipeline/descent.h"

#include <algorithm>

#include "formats/errors.h"
#include "formats/provenance.h"

namespace pipeline {

void RequireDescent(const std::filesystem::path& file, const std::filesystem::path& ancestor) {
  const std::string id = formats::ReadProvenance(ancestor).Own().Id();
  const formats::Provenance chain = formats::ReadProvenance(file);
  const bool descends = std::any_of(chain.records.begin(), chain.records.end(),
                                    [&](const formats::ProvenanceRecord& record) { return record.Id() == id; });
  if (!descends)
    throw formats::DataError(file.string() + ": was not made from " + ancestor.string() + "; run the stages between");
}

}  // namespace pipeline
