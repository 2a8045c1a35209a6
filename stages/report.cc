// SPDX-License-Identifier: Apache-2.0
//
// The certificate as a page for people, and what it knows as layers for GIS and CAD.
#include <algorithm>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/certificate_file.h"
#include "formats/certificate_html.h"
#include "formats/edit_layers.h"
#include "formats/feature_pictures.h"
#include "formats/qgis_project.h"
#include "formats/raster_file.h"
#include "formats/site_vectors.h"
#include "formats/vector_files.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"

namespace {

constexpr int kMapPixels = 1600;

std::vector<formats::BlockTrajectory> ReadTrajectories(const std::vector<pipeline::NamedFile>& solutions) {
  std::vector<formats::BlockTrajectory> trajectories;
  for (const pipeline::NamedFile& file : solutions) {
    const survey::Solution solution = formats::ReadSolution(file.file);
    // A lone block is drawn in its local frame; among others only tied ones share a frame.
    if (!solution.tied && solutions.size() > 1) continue;
    trajectories.push_back({.block = file.name, .positions_in_site = {}});
    for (const survey::SolvedScan& scan : solution.scans) {
      trajectories.back().positions_in_site.push_back(scan.site_from_scan.Translation());
    }
  }
  return trajectories;
}

// Those that hold and those that were taken back.
std::vector<survey::SiteEdit> ReadEdits(const std::vector<pipeline::NamedFile>& edits,
                                        const std::filesystem::path& ledger,
                                        std::vector<pipeline::NamedFile> solutions) {
  std::vector<survey::SiteEdit> all = survey::SiteEdits(pipeline::ReadBlockEdits(edits));
  if (ledger.empty()) return all;
  std::erase_if(solutions, [&](const pipeline::NamedFile& solution) {  // of blocks that are not on the map
    return std::none_of(edits.begin(), edits.end(), [&](const auto& each) { return each.name == solution.name; });
  });
  for (survey::SiteEdit& edit : pipeline::RetiredEdits(ledger, solutions)) all.push_back(std::move(edit));
  return all;
}

std::vector<formats::VectorLayer> LayersOf(const formats::CertificatePage& page,
                                           const std::vector<survey::SiteEdit>& edits) {
  std::vector<formats::VectorLayer> layers = formats::SiteVectorLayers(page.certificate, page.trajectories);
  for (formats::VectorLayer& layer : formats::EditLayers(edits)) layers.push_back(std::move(layer));
  return layers;
}

void WriteProject(const std::filesystem::path& file, const std::filesystem::path& site_map,
                  const std::filesystem::path& geopackage, const survey::Certificate& certificate,
                  const std::vector<formats::VectorLayer>& layers) {
  if (geopackage.empty()) throw formats::UsageError("--project needs --geopackage, which holds its layers");
  formats::QgisProject project{.title = certificate.site,
                               .frame = certificate.frame,
                               .map = site_map,
                               .map_frame = {},
                               .geopackage = geopackage,
                               .layers = layers};
  formats::RasterLabel label;
  if (!site_map.empty()) project.map_frame = formats::ReadRasterFrame(site_map, &label);
  formats::WriteQgisProject(file, project);
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage(
      "report",
      "Write the certificate as a self-contained HTML page, and its points, vectors and tracks for GIS and CAD.",
      "plumbline report --certificate out/certificate.json --site-map out/site.tif --solution "
      "B1=work/B1/solution.sqlite --geopackage out/site.gpkg --project out/site.qgs --dxf out/site.dxf --output "
      "out/certificate.html");
  std::filesystem::path certificate, site_map, ledger, output, geopackage, project, dxf;
  std::vector<pipeline::NamedFile> solutions, edits;
  stage.Input("certificate", &certificate, "certificate.json");
  stage.OptionalInput("site-map", &site_map, "site.tif, for the figures");
  stage.NamedInputs("solution", &solutions, "solution.sqlite of each block, for the figures", false);
  stage.NamedInputs("edits", &edits, "edits.json of each block on the map, for the layers", false);
  stage.OptionalInput("ledger", &ledger, "the site's ledger of edits, for those that were taken back");
  stage.Output("output", &output, "certificate.html to write");
  stage.OptionalOutput("geopackage", &geopackage, "site.gpkg to write: control, checks, error vectors, tracks");
  stage.OptionalOutput("project", &project, "site.qgs to write: the map and the layers of --geopackage for QGIS");
  stage.OptionalOutput("dxf", &dxf, "site.dxf to write: the same for CAD");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    formats::CertificatePage page{.certificate = formats::ReadCertificate(certificate),
                                  .trajectories = ReadTrajectories(solutions)};
    if (!site_map.empty()) {
      page.map = formats::ReadMapThumbnail(site_map, kMapPixels);
      page.features = formats::ReadFeatureWindows(site_map, page.certificate);
    }
    page.provenance = run.Provenance();
    formats::WriteFileAtomically(output, formats::CertificateHtml(page));
    std::vector<survey::SiteEdit> site_edits = ReadEdits(edits, ledger, solutions);
    const std::vector<formats::VectorLayer> layers = LayersOf(page, site_edits);
    const formats::RasterLabel label{.frame = page.certificate.frame, .tied = page.certificate.tied};
    if (!geopackage.empty()) formats::WriteGeoPackage(geopackage, layers, label, run.Provenance());
    if (!project.empty()) WriteProject(project, site_map, geopackage, page.certificate, layers);
    // CAD would draw what was taken back like the rest.
    std::erase_if(site_edits, [](const auto& edit) { return edit.state == survey::EditState::kRetired; });
    if (!dxf.empty()) formats::WriteDxf(dxf, LayersOf(page, site_edits));
  });
}
