// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_html.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "formats/certificate_analysis.h"
#include "formats/certificate_changes.h"
#include "formats/certificate_control.h"
#include "formats/certificate_edits.h"
#include "formats/certificate_figures.h"
#include "formats/certificate_joint.h"
#include "formats/certificate_style.h"
#include "formats/feature_pictures.h"
#include "formats/html.h"
#include "formats/reliability_html.h"

namespace formats {
namespace {

using survey::AccuracyTest;
using survey::BlockCertificate;
using survey::Certificate;
using survey::ErrorStatistics;

std::string Mm(const std::optional<double>& metres) { return metres ? Millimetres(*metres) : kDash; }

std::string Coordinate(double metres) { return Fixed(metres, 3); }

std::string CrsText(const Certificate& c) {
  if (!c.tied) return "local frames of the blocks";
  return c.frame.crs.empty() ? "the control's own plane (engineering system)" : Escaped(c.frame.crs);
}

// The tested numbers, one column a kind of check.
class StatisticsTable {
 public:
  explicit StatisticsTable(const Certificate& c) : features_(c.features_test), points_(c.points_test) {}

  std::string Text() {
    Row("checks n (errors)", [](const AccuracyTest& t) {
      return std::to_string(t.statistics.num_points) + " (" + std::to_string(t.statistics.num_errors) + ")";
    });
    Number("RMSE<sub>H1</sub>, map &minus; check", [](const ErrorStatistics& s) { return Mm(s.rmse); });
    Number("RMSE<sub>H2</sub>, of the checks", [](const ErrorStatistics& s) { return Mm(s.rmse_survey); });
    Number("<b>RMSE<sub>H</sub> = &radic;(H1&sup2; + H2&sup2;)</b> [1]",
           [](const ErrorStatistics& s) { return "<b>" + Mm(s.rmse_product) + "</b>"; });
    Number("RMSE east / north",
           [](const ErrorStatistics& s) { return Mm(s.rmse_by_axis.x()) + " / " + Mm(s.rmse_by_axis.y()); });
    Number("RMSE<sub>H1</sub>, 95 % interval", [](const ErrorStatistics& s) {
      return s.rmse_bounds_95 ? Mm(s.rmse_bounds_95->low) + " to " + Mm(s.rmse_bounds_95->high) : kDash;
    });
    Number("RMSE<sub>H</sub>, upper 95 % bound", [](const ErrorStatistics& s) { return Mm(s.rmse_product_upper_95); });
    Number("95 % circle CE95, exact", [](const ErrorStatistics& s) { return Mm(s.ce95); });
    Number("95 % circle, NSSDA [2]", [](const ErrorStatistics& s) { return Mm(s.nssda_95); });
    Number("mean error east / north", [](const ErrorStatistics& s) { return Mm(s.mean.x()) + " / " + Mm(s.mean.y()); });
    Number("bias test, p",
           [](const ErrorStatistics& s) { return s.bias ? Fixed(s.bias->p_value, 3) : std::string(kDash); });
    Number("NMAD east / north (robust)",
           [](const ErrorStatistics& s) { return s.nmad ? Mm(s.nmad->x()) + " / " + Mm(s.nmad->y()) : kDash; });
    Number("lengths of errors, 68.3 % / 95 %",
           [](const ErrorStatistics& s) { return Mm(s.length_68.value) + " / " + Mm(s.length_95.value); });
    Number("largest error", [](const ErrorStatistics& s) { return Mm(s.max); });
    if (features_.verdict || points_.verdict) Verdicts();
    return table_.Text();
  }

 private:
  template <typename Cell>
  void Row(const std::string& name, Cell cell) {
    table_.Row({name, cell(features_), cell(points_)});
  }
  template <typename Cell>
  void Number(const std::string& name, Cell cell) {
    Row(name, [&](const AccuracyTest& test) {
      return test.statistics.num_points > 0 ? std::string(cell(test.statistics)) : std::string(kDash);
    });
  }
  template <typename Cell>
  void Verdict(const std::string& name, Cell cell) {
    Row(name,
        [&](const AccuracyTest& test) { return test.verdict ? std::string(cell(*test.verdict)) : std::string(kDash); });
  }
  void Verdicts() {
    using survey::ClassVerdict;
    Verdict("meets the class", [](const ClassVerdict& v) { return v.meets ? "yes" : "no"; });
    Verdict("demonstrated at 95 %", [](const ClassVerdict& v) { return v.demonstrated ? "yes" : "no"; });
    Verdict("mean &lt; 25 % of class per axis [1]", [](const ClassVerdict& v) { return v.bias_within ? "yes" : "no"; });
    Verdict("power to find such a bias east / north", [](const ClassVerdict& v) {
      if (!v.bias_power) return std::string(kDash);
      return Fixed(100.0 * v.bias_power->x(), 0) + " / " + Fixed(100.0 * v.bias_power->y(), 0) + " %";
    });
    Verdict("errors &gt; 3 &times; class per axis [1]",
            [](const ClassVerdict& v) { return std::to_string(v.blunders.size()); });
    Verdict("checks &gt; 1.7308 &times; class; rate below (95 %)", [](const ClassVerdict& v) {
      return std::to_string(v.num_beyond_95) + "; " + Fixed(100 * v.largest_rate_beyond_95, 0) + " %";
    });
  }

  const AccuracyTest& features_;
  const AccuracyTest& points_;
  HtmlTable table_{{"(mm)", "check features", "check points"}, 1};
};

std::string YesNo(const std::optional<bool>& answer, const std::string& question) {
  const std::string word = !answer ? "not tested" : *answer ? "yes" : "no";
  const std::string kind = !answer ? "open" : *answer ? "good" : "bad";
  return "<div class=\"verdict " + kind + "\"><span>" + question + "</span><b>" + word + "</b></div>\n";
}

std::string UntiedBanner(const Certificate& c) {
  std::string names;
  for (const BlockCertificate& block : c.blocks) {
    if (!block.tied) names += (names.empty() ? "" : ", ") + Escaped(block.name);
  }
  if (names.empty()) return "";
  return "<div class=\"untied\">NOT TIED TO CONTROL: " + (c.tied ? "block " + names : "all blocks (" + names + ")") +
         ". Maps in a local frame carry no site coordinates and are not certified.</div>\n";
}

std::string Head(const CertificatePage& page) {
  const Certificate& c = page.certificate;
  const std::string title = c.tied ? "Accuracy certificate" : "Map report";
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title + " " +
                     Escaped(c.site) + "</title>\n<style>" + kCertificateStyle + "</style></head><body>\n";
  html += "<header><div><h1>" + title + "</h1><p class=\"site\">" + Escaped(c.site) +
          "</p></div><div class=\"maker\">Plumbline " + Escaped(page.provenance.Own().version) + "</div></header>\n";
  HtmlTable facts({"coordinate system", "blocks (tied)", "control points used", "checks tested", "data-set id"}, 5);
  const auto tied = std::count_if(c.blocks.begin(), c.blocks.end(), [](const auto& block) { return block.tied; });
  std::set<std::string> control;
  for (const survey::FitResidual& fit : c.fit) control.insert(fit.point);
  facts.Row({CrsText(c), std::to_string(c.blocks.size()) + " (" + std::to_string(tied) + ")",
             std::to_string(control.size()),
             Count(c.features_test.statistics.num_points, "feature") + ", " +
                 Count(c.points_test.statistics.num_points, "point"),
             "<code>" + page.provenance.Own().Id().substr(0, 16) + "</code>"});
  return html + UntiedBanner(c) + facts.Text();
}

std::string StatementSection(const Certificate& c) {
  if (!c.tied) {
    return P(
        "No block of this site is tied to control. There are no site coordinates to test, so no accuracy is "
        "stated and no class is certified.");
  }
  std::string html = H2("Statement") + "<blockquote>" + Escaped(c.statement.asprs) + "</blockquote>\n<blockquote>" +
                     Escaped(c.statement.nssda) + "</blockquote>\n";
  html += P("Tested on: " + Escaped(c.statement.tested_on) +
                (c.statement.num_points > 0 ? " (n = " + std::to_string(c.statement.num_points) + ")" : "") +
                ". Wording after ASPRS Edition 2 Version 2 (2024) section 7.16 and FGDC-STD-007.3-1998, chosen from n; "
                "horizontal. " +
                Escaped(c.metric),
            "note");
  if (c.statement.num_points == 0 && c.cross_validation)
    html += "<blockquote>" + Escaped(c.cross_validation->sentence) + "</blockquote>\n";
  if (!c.class_m)
    return html + P("No accuracy class was asked for (accuracy-class-m), so there is no verdict.", "note");
  html += "<div class=\"verdicts\">" +
          YesNo(c.statement.meets, "Meets the class RMSE<sub>H</sub> " + Fixed(*c.class_m * 100, 1) + " cm?") +
          YesNo(c.statement.demonstrated, "Demonstrated at 95 % confidence?") + "</div>\n";
  return html +
         P("Two claims: the RMSE<sub>H</sub> found is within the class; the checks are enough to prove it. Each "
           "must hold for check features and for check points, where there are any. Check features are read in the "
           "ends of the rays that drew the maps: in a map itself a wall stands where its cells are.",
           "note");
}

std::string SignatureSection() {
  return "<div class=\"signature\"><div>responsible surveyor</div><div>place, date</div><div>signature</div></div>\n";
}

std::string NotTestedSection(const Certificate& c) {
  std::string items;
  for (const std::string& sentence : c.not_tested) items += "<li>" + Escaped(sentence) + "</li>";
  return H2("What was not tested") + "<ul>" + items + "</ul>\n";
}

std::string TestedSection(const Certificate& c) {
  if (c.checks.empty()) return "";
  return H2("Tested accuracy") + "<div class=\"pair\">" +
         Figure(ErrorScatterSvg(c),
                "Errors of the checks. Squares: features; circles: points; filled: beyond the "
                "blunder limit.") +
         "<div>" + StatisticsTable(c).Text() + "</div></div>\n";
}

std::string MapSection(const CertificatePage& page) {
  const std::string caption = page.certificate.tied
                                  ? "Red: errors at checks that the adjustment never saw. Blue: residuals at control "
                                    "that it used."
                                  : "Map in the block's local frame, not tied to control.";
  return H2(page.certificate.tied ? "Errors and residuals on the map" : "Map") + Figure(ResidualMapSvg(page), caption);
}

std::string ChecksSection(const Certificate& c) {
  if (c.checks.empty()) return "";
  HtmlTable table(
      {"check", "kind", "block", "east (m)", "north (m)", "dE", "dN", "d", "&sigma; check", "to control (m)"}, 3);
  for (const survey::TestedCheck& check : c.checks) {
    table.Row({Escaped(check.name) + (check.blunder   ? " <b>!</b>"
                                      : check.outlier ? " <b>?</b>"
                                                      : ""),
               check.kind == survey::CheckKind::kPoint ? "point" : "feature", Escaped(check.block),
               Coordinate(check.reference.x()), Coordinate(check.reference.y()), Millimetres(check.error.x()),
               Millimetres(check.error.y()), Millimetres(check.error.norm()),
               Millimetres(std::sqrt(check.reference_covariance.trace())),
               check.distance_to_control ? Fixed(*check.distance_to_control, 1) : kDash},
              check.blunder ? "flag" : "");
  }
  return H2("Checks (tested)") +
         P("d = map &minus; check, mm. &sigma; check: survey of the check and its picking or centring, both axes. "
           "Flagged (!) errors exceed 3 class/&radic;2 in an axis, others (?) do not belong to the rest: all stay in "
           "all "
           "numbers.",
           "note lead") +
         table.Text();
}

std::string RequestsText(const survey::BlockReview& review) {
  const int assumed = review.num_open + review.num_skipped;
  return std::to_string(review.num_requests) + " (" + std::to_string(assumed) + ")";
}

std::string ContradictedText(const survey::BlockReview& review) {
  return review.cells_compared > 0 ? Fixed(100.0 * review.ContradictedShare(), 1) + " %" : std::string(kDash);
}

std::string BlocksSection(const Certificate& c) {
  HtmlTable table({"block", "tied", "path (m)", "scans", "loops", "control (marks)", "&sigma;<sub>0</sub>",
                   "scale &minus; 1 (ppm)", "RMSE features (n)", "RMSE points (n)", "relative (n)", "navigated (s)",
                   "breaks", "requests (open)", "contradicted"},
                  2);
  const auto tested = [](const AccuracyTest& test) {
    return test.statistics.num_points == 0
               ? std::string(kDash)
               : Millimetres(test.statistics.rmse) + " (" + std::to_string(test.statistics.num_points) + ")";
  };
  for (const BlockCertificate& b : c.blocks) {
    table.Row(
        {Escaped(b.name), b.tied ? "yes" : "<b class=\"red\">NOT TIED</b>", Fixed(b.path_length, 0),
         std::to_string(b.num_scans), std::to_string(b.num_loops),
         std::to_string(b.num_control_points) + " (" + std::to_string(b.num_control_marks) + ")",
         Fixed(b.sigma_zero, 2), b.tied ? Fixed((b.rigid_scale - 1) * 1e6, 0) : kDash, tested(b.features),
         tested(b.points),
         b.relative ? Millimetres(b.relative->rms) + " (" + std::to_string(b.relative->num_features) + ")" : kDash,
         Fixed(b.navigated.inertial, 0) + " / " + Fixed(b.navigated.odometry, 0) + " / " +
             Fixed(b.navigated.constant_velocity, 0) + " (" + Fixed(b.navigated.unmatched, 1) + ")",
         b.breaks.empty() ? "none" : "<b class=\"red\">" + std::to_string(b.breaks.size()) + "</b>",
         b.review ? RequestsText(*b.review) : kDash, b.review ? ContradictedText(*b.review) : kDash});
  }
  return H2("Blocks") + table.Text() +
         P("RMSE<sub>H1</sub> in mm, absolute. Relative: common features after a rigid fit, mm. Scale: what a "
           "four-parameter fit on the control would have taken; it is never applied. Navigated: by IMU / by odometry / "
           "by "
           "constant velocity (of these without a scan match). Breaks: places where the track may have come apart. "
           "Requests: places that a person was asked about (open or skipped ones are assumed to be right). "
           "Contradicted: "
           "wall cells of one pass that another pass looked through.",
           "note");
}

std::string SigmasText(const survey::SeamSummary& seam) {
  if (!seam.contradicts) return kDash;
  const std::string sigmas = seam.sigmas ? Fixed(*seam.sigmas, 1) : kDash;
  return *seam.contradicts ? sigmas + " <b class=\"red\">contradiction</b>" : sigmas;
}

std::string SeamsText(const Certificate& c) {
  if (c.stitching.seams.empty()) return "";
  HtmlTable table({"blocks", "overlap (m&sup2;)", "places measured", "RMS offset (mm)", "sigmas", "walls contradicted"},
                  1);
  for (const survey::SeamSummary& seam : c.stitching.seams) {
    table.Row({Escaped(seam.block_a) + " &ndash; " + Escaped(seam.block_b), Fixed(seam.overlap_area_m2, 0),
               std::to_string(seam.num_windows), Mm(seam.rms), SigmasText(seam),
               Fixed(100 * seam.contradicted_share, 1) + " %"},
              seam.contradicts.value_or(false) ? "flag" : "");
  }
  return "<h3>Walls of overlapping maps</h3>" + table.Text() +
         P("Sigmas: the mean offset over its standard deviation by the two adjustments. Contradiction: it, or more "
           "places "
           "than clutter explains, is beyond their covariance (0.1 %).",
           "note");
}

std::string StitchingSection(const Certificate& c) {
  if (c.stitching.pairs.empty() && c.stitching.seams.empty()) return "";
  const std::string heading = H2("Stitching (agreement of neighbouring blocks)");
  if (c.stitching.pairs.empty()) return heading + SeamsText(c);
  struct PairOfBlocks {
    int count = 0;
    double sum = 0.0, max = 0.0;
  };
  std::map<std::string, PairOfBlocks> pairs;
  for (const survey::StitchingPair& pair : c.stitching.pairs) {
    PairOfBlocks& both = pairs[pair.block_a + " &ndash; " + pair.block_b];
    ++both.count;
    both.sum += pair.difference.squaredNorm();
    both.max = std::max(both.max, pair.difference.norm());
  }
  HtmlTable table({"blocks", "common features", "RMS (mm)", "largest (mm)"}, 1);
  for (const auto& [names, both] : pairs) {
    table.Row(
        {names, std::to_string(both.count), Millimetres(std::sqrt(both.sum / both.count)), Millimetres(both.max)});
  }
  table.Row({"<b>site</b>", std::to_string(c.stitching.pairs.size()), "<b>" + Millimetres(c.stitching.rms) + "</b>",
             Millimetres(c.stitching.max)});
  return heading + "<h3>Features that two blocks show</h3>" + table.Text() + SeamsText(c);
}

// Which block a record worked for: the names in the roles of the site's stages ("solution B1"), handed down to the
// inputs. Records that several blocks share belong to the site.
std::map<std::string, std::string> BlocksOfRecords(const Provenance& provenance) {
  std::map<std::string, const ProvenanceRecord*> by_id;
  for (const ProvenanceRecord& record : provenance.records) by_id[record.Id()] = &record;
  std::map<std::string, std::set<std::string>> owners;
  const auto own = [&](const auto& self, const std::string& id, const std::string& block) -> void {
    const auto record = by_id.find(id);
    if (record == by_id.end() || !owners[id].insert(block).second) return;
    for (const ProvenanceInput& input : record->second->inputs) self(self, input.record_id, block);
  };
  for (const ProvenanceRecord& record : provenance.records) {
    for (const ProvenanceInput& input : record.inputs) {
      const std::size_t space = input.role.find(' ');
      const std::string kind = input.role.substr(0, space);
      if (space == std::string::npos || (kind != "solution" && kind != "features" && kind != "map")) continue;
      own(own, input.record_id, input.role.substr(space + 1));
    }
  }
  std::map<std::string, std::string> blocks;
  for (const auto& [id, names] : owners) blocks[id] = names.size() == 1 ? *names.begin() : "site";
  return blocks;
}

int StageRank(const std::string& stage) {
  static const std::vector<std::string> kOrder = {"ingest", "track",    "loops",  "network", "adjust", "grid",
                                                  "edit",   "features", "stitch", "certify", "report"};
  return static_cast<int>(std::find(kOrder.begin(), kOrder.end(), stage) - kOrder.begin());
}

std::string InputsText(const ProvenanceRecord& record) {
  std::string text;
  for (const ProvenanceInput& input : record.inputs) {
    const std::string origin = input.record_id.empty() ? "file" : "record " + input.record_id.substr(0, 12);
    text += "<div>" + Escaped(input.role) + " &larr; " + origin + ", SHA-256 <code>" +
            (input.record_id.empty() ? input.sha256 : input.sha256.substr(0, 12)) + "</code>" +
            (input.comments_ignored ? " (without comments)" : "") + "</div>";
  }
  return text;
}

std::string ProvenanceSection(const Provenance& provenance) {
  const std::map<std::string, std::string> blocks = BlocksOfRecords(provenance);
  struct Entry {
    std::string block;
    int rank;
    const ProvenanceRecord* record;
  };
  std::vector<Entry> entries;
  for (const ProvenanceRecord& record : provenance.records) {
    const auto block = blocks.find(record.Id());
    entries.push_back({block == blocks.end() ? "site" : block->second, StageRank(record.stage), &record});
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::make_tuple(a.block == "site", a.block, a.rank) < std::make_tuple(b.block == "site", b.block, b.rank);
  });
  HtmlTable chain({"block", "stage", "record", "made from"}, 4);
  std::vector<std::pair<std::string, std::string>> option_rows;  // stage and options; blocks that share them
  std::map<std::pair<std::string, std::string>, std::string> blocks_of_options;
  for (const Entry& entry : entries) {
    chain.Row({Escaped(entry.block), Escaped(entry.record->stage) + " " + Escaped(entry.record->version),
               "<code>" + entry.record->Id().substr(0, 12) + "</code>", InputsText(*entry.record)});
    std::string text;
    for (const auto& [key, value] : entry.record->options) {
      text += (text.empty() ? "" : ", ") + Escaped(key) + " = " + (value.empty() ? "\"\"" : Escaped(value));
    }
    if (text.empty()) continue;
    std::string& sharing = blocks_of_options[{entry.record->stage, text}];
    if (sharing.empty()) option_rows.emplace_back(entry.record->stage, text);
    if ((", " + sharing + ",").find(", " + entry.block + ",") == std::string::npos) {
      sharing += (sharing.empty() ? "" : ", ") + entry.block;
    }
  }
  HtmlTable options({"block", "stage", "options"}, 3);
  for (const auto& row : option_rows) options.Row({Escaped(blocks_of_options[row]), Escaped(row.first), row.second});
  return H2("Provenance") +
         P("From the raw logs to the delivered map. A record names what a stage read, by content; the same inputs, "
           "options and version give the same bytes.",
           "note lead") +
         "<div class=\"small\">" + chain.Text() + "<h3>Options in effect</h3>" + options.Text() + "</div>\n";
}

std::string Formulas() {
  return H2("Formulas and sources") +
         "<p class=\"note\">d<sub>i</sub> = map &minus; check. RMSE<sub>E</sub>&sup2; = &Sigma;dE&sup2;/n; "
         "RMSE<sub>H1</sub>&sup2; = RMSE<sub>E</sub>&sup2; + RMSE<sub>N</sub>&sup2;; RMSE<sub>H2</sub>&sup2; = "
         "&Sigma; tr &Sigma;<sub>i</sub>/n over the checks' covariances. Bounds: RMSE "
         "&radic;(&nu;/&chi;&sup2;<sub>p,&nu;</sub>), &nu; = "
         "n(&lambda;<sub>1</sub>+&lambda;<sub>2</sub>)&sup2;/(&lambda;<sub>1</sub>&sup2;+&lambda;<sub>2</sub>&sup2;) "
         "of the second-moment matrix; n counts points, not errors. CE95 exact: radius that holds 95 % of the normal "
         "distribution with the errors' mean and covariance. Bias: Hotelling's T&sup2;. Rate: Clopper&ndash;Pearson. "
         "Classes: ellipse of the scatter 2.4477 &sigma;. "
         "[1] ASPRS Positional Accuracy Standards for Digital Geospatial Data, Edition 2, Version 2, 2024, sections "
         "7.2, 7.3, 7.11 and 7.16. [2] FGDC-STD-007.3-1998, NSSDA. Every number is in certificate.json.</p>\n";
}

}  // namespace

std::string CertificateHtml(const CertificatePage& page) {
  const Certificate& c = page.certificate;
  std::string html = Head(page) + StatementSection(c);
  if (c.tied) html += SignatureSection();
  html += TestedSection(c) + NotTestedSection(c) + MapSection(page);
  html += "<h1 class=\"appendices\">Appendices</h1>\n";
  if (c.since_delivery) html += ChangesSection(*c.since_delivery);
  if (c.edits) html += EditsSection(*c.edits);
  html += ClassesSection(c) + AnalysisSection(c) + ChecksSection(c) + FeaturePicturesSection(page) + BlocksSection(c) +
          StitchingSection(c) + (c.joint ? JointSection(*c.joint) : "") + ControlUsedSection(c) +
          ReliabilitySection(c.reliability) + ControlListSection(c) + ProvenanceSection(page.provenance);
  if (c.tied) html += Formulas();
  return html + "</body></html>\n";
}

}  // namespace formats
