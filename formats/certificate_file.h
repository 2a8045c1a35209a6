// SPDX-License-Identifier: Apache-2.0
//
// certificate.json: every number of the certificate with the provenance of the run that made it. Lengths in metres,
// vectors {"e", "n"}, covariances {"ee", "en", "nn"}; certificate.schema.json describes it.
#pragma once

#include <filesystem>

#include "formats/provenance.h"
#include "survey/accuracy/certificate.h"

namespace formats {

void WriteCertificate(const std::filesystem::path& file, const survey::Certificate& certificate,
                      const Provenance& provenance);

// DataError names the file when it is not a certificate of this version. `provenance` may be null.
survey::Certificate ReadCertificate(const std::filesystem::path& file, Provenance* provenance = nullptr);

}  // namespace formats
