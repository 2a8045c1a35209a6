// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_html.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "formats/accuracy_classes_file.h"
#include "formats/atomic_file.h"
#include "formats/html.h"
#include "survey/accuracy/certify.h"
#include "survey/stats/philox.h"

namespace {

using survey::RandomStream;

// A site with three blocks of 40 x 25 m in a row, the last one in its local frame.
survey::CertifyInput Site(bool tied) {
  const RandomStream random(3, 0, 0);
  std::uint64_t draw = 0;
  const auto noise = [&](double sigma) {
    const auto [a, b] = random.Normals(draw++);
    return Eigen::Vector2d(sigma * a, sigma * b);
  };
  survey::CertifyInput input{
      .site = "Parking <garage> & ramp", .network = {.frame = {.crs = "EPSG:25832"}}, .class_m = 0.05};
  const Eigen::Vector2d origin(690000, 5334000);
  const Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity() * 4e-6;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d p = origin + Eigen::Vector2d(10.0 * i, 5 + 13.0 * (i % 2));
    const auto role = i % 4 == 3 ? survey::PointRole::kCheck : survey::PointRole::kControl;
    input.network.points.push_back(
        {.name = "C" + std::to_string(i), .role = role, .position_in_site = p, .covariance = covariance});
    input.reference_features.push_back(
        {.name = "F" + std::to_string(i), .position_in_site = p + Eigen::Vector2d(4, -3), .covariance = covariance});
  }
  for (int block = 0; block < 3; ++block) {
    survey::CertifiedBlock each{.name = "B" + std::to_string(block + 1)};
    each.solution.tied = tied && block < 2;
    each.solution.frame = input.network.frame;
    each.solution.statistics.sigma_zero = 1.04;
    for (int s = 0; s < 200; ++s) {
      const double t = 6.2831853 * s / 200;
      each.solution.scans.push_back(
          {.site_from_scan = {origin.x() + 20 + 40 * block + 22 * std::cos(t), origin.y() + 12 + 9 * std::sin(t), t}});
    }
    for (int i = 4 * block; i < std::min(12, 4 * block + 5); ++i) {
      const survey::ControlPoint& point = input.network.points[static_cast<std::size_t>(i)];
      const bool used = point.role == survey::PointRole::kControl;
      const Eigen::Vector2d residual = noise(used ? 0.003 : 0.02);
      each.solution.marks.push_back({.point = point.name,
                                     .used = used,
                                     .position_in_site = point.position_in_site + residual,
                                     .residual = residual,
                                     .rigid_residual = noise(0.05)});
      if (used) {
        each.solution.marks.back().test = survey::MarkTest{
            .redundancy = 0.612, .t = 2.5, .detectable = 0.0353, .largest_shift = 0.017, .left_out = {0.0014, -0.0025}};
      }
      const survey::NamedFeature& feature = input.reference_features[static_cast<std::size_t>(i)];
      each.features.push_back({.name = feature.name,
                               .found = true,
                               .position_in_site = feature.position_in_site + noise(0.015),
                               .covariance = feature.covariance});
    }
    input.blocks.push_back(each);
  }
  return input;
}

formats::CertificatePage Page(bool tied) {
  formats::CertificatePage page;
  survey::CertifyInput input = Site(tied);
  input.classes = formats::StandardAccuracyClasses(input.class_m);
  page.certificate = survey::Certify(input);
  const formats::ProvenanceRecord ingest{
      .stage = "ingest", .version = "0.1.0", .inputs = {{"raw field.log", std::string(64, 'a'), false, ""}}};
  const formats::ProvenanceRecord adjust{.stage = "adjust",
                                         .version = "0.1.0",
                                         .options = {{"loop-huber-m", "0.1"}},
                                         .inputs = {{"session", std::string(64, 'b'), false, ingest.Id()}}};
  const formats::ProvenanceRecord report{
      .stage = "report", .version = "0.1.0", .inputs = {{"solution B1", std::string(64, 'c'), false, adjust.Id()}}};
  page.provenance.records = {report, adjust, ingest};
  for (const auto& block : Site(tied).blocks) {
    if (!block.solution.tied) continue;
    page.trajectories.push_back({block.name, {}});
    for (const auto& scan : block.solution.scans)
      page.trajectories.back().positions_in_site.push_back(scan.site_from_scan.Translation());
  }
  return page;
}

bool Has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(CertificateHtmlTest, SaysWhatTheCertificateSays) {
  const std::string html = formats::CertificateHtml(Page(true));
  if (const char* folder = std::getenv("PLUMBLINE_KEEP_PAGES")) {
    formats::WriteFileAtomically(std::string(folder) + "/certificate.html", html);
    formats::WriteFileAtomically(std::string(folder) + "/report.html", formats::CertificateHtml(Page(false)));
  }
  EXPECT_TRUE(Has(html, "<h1>Accuracy certificate</h1>"));
  EXPECT_TRUE(Has(html, "using ONLY 9 checkpoints"));
  EXPECT_TRUE(Has(html, "not an accuracy"));
  for (const std::string section : {"Classes of standards", "Appendices", "Behaviour of the errors", "Q&ndash;Q plot",
                                    "OGL2", "1.7308 RMSE", "Shapiro&ndash;Wilk", "<ellipse"}) {
    EXPECT_TRUE(Has(html, section)) << section;
  }
  EXPECT_TRUE(Has(html, "NOT TIED TO CONTROL: block B3"));
  EXPECT_TRUE(Has(html, "Reliability of the control"));
  EXPECT_TRUE(Has(html, "No mark was left out"));
  for (const char* number : {">0.612<", ">2.5<", ">35.3<", ">17.0<", ">1.4<", ">-2.5<"}) EXPECT_TRUE(Has(html, number));
  EXPECT_TRUE(Has(html, "<td>B1</td><td>ingest 0.1.0</td>"));
  EXPECT_TRUE(Has(html, std::string(64, 'a')));
}

// Errors (30, 0), (-10, 20), (10, -20), (10, 40) mm at checks of 14.1 mm an axis. By hand: sums of squares 1200 and
// 2400, nu = 4 * 90^2 / (30^2 + 60^2) = 7.2, T2 = 3; quantiles of chi-square and the circle by numerical integration.
TEST(CertificateHtmlTest, PrintsTheNumbersThatAHandComputes) {
  survey::CertifyInput input{.site = "s", .network = {.frame = {.crs = "EPSG:25832"}}, .class_m = 0.1};
  survey::CertifiedBlock block{.name = "B1"};
  block.solution.tied = true;
  block.solution.frame = input.network.frame;
  const Eigen::Vector2d errors[] = {{0.03, 0}, {-0.01, 0.02}, {0.01, -0.02}, {0.01, 0.04}};
  for (const Eigen::Vector2d& error : errors) {
    const std::string name = "F" + std::to_string(block.features.size());
    const Eigen::Vector2d place(7.0 * static_cast<double>(block.features.size()), 5);
    input.reference_features.push_back(
        {.name = name, .position_in_site = place, .covariance = 2e-4 * Eigen::Matrix2d::Identity()});
    block.features.push_back({.name = name, .found = true, .position_in_site = place + error});
  }
  input.blocks.push_back(block);
  formats::CertificatePage page;
  page.certificate = survey::Certify(input);
  page.provenance.records = {{.stage = "report", .version = "1"}};
  const std::string html = formats::CertificateHtml(page);
  for (const auto& [name, number] : {std::pair{"map &minus; check", "30.0"},
                                     {"of the checks", "20.0"},
                                     {"H2&sup2;)</b> [1]", "<b>36.1</b>"},
                                     {"RMSE east / north", "17.3 / 24.5"},
                                     {"95 % interval", "19.9 to 60.2"},
                                     {"upper 95 % bound", "57.0"},
                                     {"CE95, exact", "58.6"},
                                     {"NSSDA [2]", "51.9"},
                                     {"mean error east / north", "10.0 / 10.0"},
                                     {"bias test, p", "0.500"},
                                     {"(robust)", "14.8 / 29.7"},
                                     {"68.3 % / 95 %", "30.6 / 39.5"},
                                     {"largest error", "41.2"}})
    EXPECT_TRUE(Has(html, std::string(name) + "</td><td class=\"num\">" + number + "</td>")) << name;
}

TEST(CertificateHtmlTest, StandsAloneAndEscapes) {
  const std::string html = formats::CertificateHtml(Page(true));
  EXPECT_TRUE(Has(html, "Parking &lt;garage&gt; &amp; ramp"));
  EXPECT_FALSE(Has(html, "<garage>"));
  for (const std::string external : {"http://", "https://", "<script", "<link", "url(", ">nan", ">inf", "\"nan"}) {
    EXPECT_FALSE(Has(html, external)) << external;
  }
}

TEST(CertificateHtmlTest, WithoutControlItIsNoCertificate) {
  const std::string html = formats::CertificateHtml(Page(false));
  EXPECT_TRUE(Has(html, "<h1>Map report</h1>"));
  EXPECT_FALSE(Has(html, "Accuracy certificate"));
  EXPECT_TRUE(Has(html, "NOT TIED TO CONTROL: all blocks"));
  EXPECT_FALSE(Has(html, "blockquote>"));
  EXPECT_FALSE(Has(html, "signature\">"));
}

TEST(HtmlTest, Pieces) {
  EXPECT_EQ(formats::Base64("light work."), "bGlnaHQgd29yay4=");
  EXPECT_EQ(formats::Base64("light work"), "bGlnaHQgd29yaw==");
  EXPECT_EQ(formats::Base64(std::string("\xFF\0\xFE", 3)), "/wD+");
  EXPECT_EQ(formats::Fixed(-0.001, 2), "0.00");
  EXPECT_EQ(formats::Fixed(-0.006, 2), "-0.01");
  EXPECT_EQ(formats::Millimetres(0.01234), "12.3");
  EXPECT_EQ(formats::Escaped("a<b>&\"c\""), "a&lt;b&gt;&amp;&quot;c&quot;");
}

}  // namespace
