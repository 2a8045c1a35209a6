// SPDX-License-Identifier: Apache-2.0
#include "formats/artefact_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/artefact_file.h"
#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "formats/errors.h"
#include "formats/network_report.h"
#include "formats/raster_facts.h"
#include "formats/reliability_text.h"
#include "formats/table_text.h"
#include "formats/text_table.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetres = 1000.0;

std::string Mm(double metres) { return Number(kMillimetres * metres, "%.1f"); }

void PrintProvenance(const Provenance& provenance, std::ostream& out) {
  for (const ProvenanceRecord& record : provenance.records) {
    out << (&record == &provenance.Own() ? "made by " : "from ") << record.stage << " " << record.version << ", record "
        << ShortId(record.Id()) << "\n";
    for (const ProvenanceInput& input : record.inputs) {
      out << "    input " << OneLine(input.role) << ": sha256 " << ShortId(input.sha256)
          << (input.comments_ignored ? " (without comments)" : "")
          << (input.record_id.empty() ? "" : ", record " + ShortId(input.record_id)) << "\n";
    }
    for (const auto& [name, value] : record.options) out << "    " << name << " = " << OneLine(value) << "\n";
  }
}

void PrintMarks(const survey::Solution& solution, std::ostream& out) {
  out << "\nmarks: adjusted places and residuals (mm; adjusted minus given)\n";
  TextTable(
      {"point", "scan", "role", "easting", "northing", "sigma E", "sigma N", "res E", "res N", "rigid E", "rigid N"})
      .Print(out, [&](const auto& row) {
        for (const survey::SolvedMark& mark : solution.marks) {
          const auto residual = [&](double metres) { return mark.used ? Mm(metres) : "-"; };
          row({OneLine(mark.point), std::to_string(mark.scan.value),
               mark.used   ? "control"
               : mark.test ? "left out"
                           : "position only",
               Number(mark.position_in_site.x(), "%.4f"), Number(mark.position_in_site.y(), "%.4f"),
               Mm(std::sqrt(mark.covariance(0, 0))), Mm(std::sqrt(mark.covariance(1, 1))), residual(mark.residual.x()),
               residual(mark.residual.y()), residual(mark.rigid_residual.x()), residual(mark.rigid_residual.y())});
        }
      });
}

void PrintPoints(const survey::ControlNetwork& network, std::ostream& out) {
  out << "\npoints (m; sigmas mm)\n";
  TextTable({"name", "role", "easting", "northing", "sigma E", "sigma N", "elevation", "description", "reason"})
      .Print(out, [&](const auto& row) {
        for (const survey::ControlPoint& point : network.points) {
          row({OneLine(point.name), std::string(Name(point.role)), Number(point.position_in_site.x(), "%.4f"),
               Number(point.position_in_site.y(), "%.4f"), Mm(std::sqrt(point.covariance(0, 0))),
               Mm(std::sqrt(point.covariance(1, 1))),
               point.elevation_m ? Number(*point.elevation_m, "%.4f") : std::string("-"), OneLine(point.description),
               OneLine(point.reason)});
        }
      });
}

void PrintSqlite(const fs::path& file, std::ostream& out) {
  const std::vector<std::string> problems = ExamineArtefact(file);
  if (!problems.empty()) throw DataError(problems.front());
  const ArtefactKind kind = KindOfArtefact(file);
  const ArtefactFormat& format = FormatOf(kind);
  out << file.string() << ": " << format.name << ", format version " << format.version << ", sha256 "
      << ShortId(Sha256OfFile(file)) << "\n";
  PrintProvenance(ReadProvenance(file), out);
  if (kind == ArtefactKind::kSolution) {
    const survey::Solution solution = ReadSolution(file);
    PrintMarks(solution, out);
    PrintReliability(solution, out);
  }
  if (kind == ArtefactKind::kControl) {
    const survey::ControlNetwork network = ReadControl(file);
    PrintPoints(network, out);
    PrintNetworkReport(network, out);
  }
  Database database = Database::OpenForReading(file);
  PrintTables(database, out);
}

void PrintGeoTiff(const fs::path& file, std::ostream& out) {
  const RasterFacts facts = ReadRasterFacts(file);
  const double cells = static_cast<double>(facts.width) * facts.height;
  out << file.string() << ": " << facts.content << ", sha256 " << ShortId(Sha256OfFile(file)) << "\n"
      << "size       " << facts.width << " x " << facts.height << " cells of " << Number(facts.cell_size_m, "%.9g")
      << " m, " << facts.data_type << ", " << facts.num_overviews << " overviews\n"
      << "extent     east " << Number(facts.west, "%.3f") << " to " << Number(facts.east, "%.3f") << ", north "
      << Number(facts.south, "%.3f") << " to " << Number(facts.north, "%.3f") << "\n"
      << "origin     " << Number(facts.west, "%.3f") << " " << Number(facts.north, "%.3f") << " (upper left corner)\n"
      << "crs        " << OneLine(facts.crs) << "\n"
      << "label      " << (facts.tied == "yes" ? "tied to control" : "not tied to control") << "\n"
      << "values     " << facts.num_known << " known cells ("
      << Number(100.0 * static_cast<double>(facts.num_known) / cells, "%.1f") << " %), " << Number(facts.min, "%.3f")
      << " to " << Number(facts.max, "%.3f") << ", mean " << Number(facts.mean, "%.3f") << "\n";
  if (facts.sigma_m)
    out << "sigma      " << Number(facts.sigma_m->min, "%.4f") << " to " << Number(facts.sigma_m->max, "%.4f")
        << " m, mean " << Number(facts.sigma_m->mean, "%.4f") << " (1 sigma in the worst direction)\n";
  PrintProvenance(ReadProvenance(file), out);
}

void PrintJson(const fs::path& file, std::ostream& out) {
  const auto json = nlohmann::ordered_json::parse(ReadWholeFile(file), nullptr, false);
  if (json.is_discarded()) throw DataError(file.string() + ": not valid JSON (truncated?)");
  out << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
}

}  // namespace

void PrintArtefact(const fs::path& file, std::ostream& out) {
  switch (KindOfFile(file)) {
    case FileKind::kSqlite:
      return PrintSqlite(file, out);
    case FileKind::kGeoTiff:
      return PrintGeoTiff(file, out);
    case FileKind::kJson:
      return PrintJson(file, out);
    case FileKind::kOther:
      throw DataError(file.string() + ": not an artefact (neither SQLite, GeoTIFF nor JSON)");
  }
}

}  // namespace formats
