// SPDX-License-Identifier: Apache-2.0
//
// The certificate's page on paper: PDF/A through WeasyPrint, which is another program and may be missing.
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "pipeline/stage.h"
#include "pipeline/subprocess.h"

namespace {

constexpr int kNotFound = 127;  // what env says

// WeasyPrint numbers objects in the order of Python's hashes and dates its fonts: both are fixed here.
std::string PdfOf(const std::filesystem::path& page) {
  const pipeline::ProgramOutput print =
      pipeline::RunAndRead({"env", "PYTHONHASHSEED=0", "SOURCE_DATE_EPOCH=0", "weasyprint", "--quiet", "--pdf-variant",
                            "pdf/a-3b", page.string(), "-"});
  if (print.status == kNotFound) {
    throw formats::DataError("WeasyPrint is not installed (Debian package weasyprint); " + page.string() +
                             " can be printed by any browser instead");
  }
  if (print.status != 0 || !print.out.starts_with("%PDF-")) {
    throw formats::DataError(page.string() + ": WeasyPrint failed with status " + std::to_string(print.status));
  }
  return print.out;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("print", "Print the certificate's page as PDF/A (needs WeasyPrint).",
                        "plumbline print --page out/certificate.html --output out/certificate.pdf");
  std::filesystem::path page, output;
  stage.Input("page", &page, "certificate.html");
  stage.Output("output", &output, "certificate.pdf to write");
  return stage.Run(argc, argv, [&](pipeline::StageRun&) { formats::WriteFileAtomically(output, PdfOf(page)); });
}
