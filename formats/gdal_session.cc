// SPDX-License-Identifier: Apache-2.0
#include "formats/gdal_session.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>

#include "formats/errors.h"
#include "formats/provenance.h"

namespace formats {
namespace {

[[maybe_unused]] const bool kReadsProvenance = (SetGeoTiffProvenanceReader(&ProvenanceOfGeoTiff), true);

constexpr GIntBig kCacheBytes = 128 << 20;  // of GDAL for decoded tiles; its own default grows with the machine

void CPL_STDCALL Collect(CPLErr kind, CPLErrorNum, const char* message) {
  if (kind == CE_Failure || kind == CE_Fatal)
    static_cast<GdalSession*>(CPLGetErrorHandlerUserData())->AddFailure(message);
}

}  // namespace

GdalSession::GdalSession() {
  [[maybe_unused]] static const bool registered = (GDALAllRegister(), GDALSetCacheMax64(kCacheBytes), true);
  CPLPushErrorHandlerEx(&Collect, this);
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
  CPLSetThreadLocalConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");
}

GdalSession::~GdalSession() {
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", nullptr);
  CPLSetThreadLocalConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", nullptr);
  CPLPopErrorHandler();
}

void GdalSession::AddFailure(const std::string& message) {
  if (failure_.empty()) failure_ = message;
}

void GdalSession::ThrowIfFailed(const std::filesystem::path& file, const std::string& rule) const {
  if (!failure_.empty()) Throw(file, rule);
}

void GdalSession::Throw(const std::filesystem::path& file, const std::string& rule) const {
  throw DataError(file.string() + ": " + rule + (failure_.empty() ? "" : ": " + failure_));
}

}  // namespace formats
