// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/apply_edits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "survey/edits/masked_beams.h"
#include "survey/review/edit_request.h"

namespace survey {
namespace {

// 40 x 30 cells of 0.1 m from (0, 0), all free.
SiteRaster Field() {
  SiteRaster raster{.cell_size_m = 0.1, .min_column = 0, .min_row = 0, .width = 40, .height = 30};
  raster.log_odds.assign(40 * 30, -1.0F);
  return raster;
}

MapEdit Square(const std::string& uid, EditKind kind, const std::string& who, const std::string& when) {
  MapEdit edit{.uid = uid, .kind = kind, .parts = {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}}};
  edit.frame = EditFrame::kSite;
  edit.basis = {{"A", "60de"}};
  edit.who = who;
  edit.when = when;
  return edit;
}

BlockEdits Apply(const std::vector<MapEdit>& edits, SiteRaster* grid, const std::string& block = "A") {
  return ApplyEdits(block, EditsOfBlock(block, edits, {}), {}, grid);
}

constexpr const char* kEarly = "2026-11-28T10:00:00Z";
constexpr const char* kLate = "2026-11-28T11:00:00Z";

TEST(ApplyEdits, OccupiedComesAfterFreeAndUnknownAndTheLaterLast) {
  SiteRaster grid = Field();
  const BlockEdits result =
      Apply({Square("wall", EditKind::kAreaOccupied, "AB", kEarly), Square("later", EditKind::kAreaFree, "AB", kLate),
             Square("gone", EditKind::kAreaUnknown, "AB", kEarly)},
            &grid);
  ASSERT_EQ(result.edits.size(), 3U);
  EXPECT_EQ(result.edits[0].edit.uid, "gone");
  EXPECT_EQ(result.edits[1].edit.uid, "later");
  EXPECT_EQ(result.edits[2].edit.uid, "wall");
  EXPECT_EQ(grid.At(15, 15), kEditedLogOdds);
  EXPECT_EQ(result.edits[2].changed_cells, 100);
  EXPECT_EQ(result.edited_cells, 100);
  EXPECT_TRUE(result.findings.empty()) << "one person may change his mind";
}

TEST(ApplyEdits, ThePartUnderTheEditsIsEnough) {
  MapEdit line = Square("line", EditKind::kLineOccupied, "AB", kLate);
  line.parts = {{{2.5, 0.5}, {3.5, 2.5}}};
  MapEdit beyond = Square("beyond", EditKind::kAreaFree, "AB", kLate);
  beyond.parts = {{{3, 2}, {9, 2}, {9, 9}, {3, 9}}};
  const auto edits = EditsOfBlock("A", {Square("wall", EditKind::kAreaOccupied, "AB", kEarly), line, beyond}, {});
  const SiteRaster field = Field();
  SiteRaster whole = field;
  const BlockEdits expected = ApplyEdits("A", edits, {}, &whole);
  SiteRaster part = PartUnder(edits, StripsOf(field));
  EXPECT_LT(part.log_odds.size(), whole.log_odds.size());
  const BlockEdits result = ApplyEdits("A", edits, {}, &part);
  EXPECT_EQ(result.edited_cells, expected.edited_cells);
  EXPECT_GT(result.edited_cells, 100);
  const RasterStrips edited = WithPart(StripsOf(field), part);
  EXPECT_EQ(WholeOf(edited).log_odds, whole.log_odds);
  EXPECT_EQ(edited.read(7, 13).log_odds,
            std::vector<float>(whole.log_odds.begin() + 7 * 40, whole.log_odds.begin() + 20 * 40));
  const RasterStrips unedited = WithPart(StripsOf(field), PartUnder({}, StripsOf(field)));
  EXPECT_EQ(WholeOf(unedited).log_odds, field.log_odds);
}

TEST(ApplyEdits, TwoPeopleWhoContradictAreNamedUnlessOneSupersedes) {
  SiteRaster grid = Field();
  MapEdit wall = Square("wall", EditKind::kAreaOccupied, "AB", kEarly);
  const MapEdit gone = Square("gone", EditKind::kAreaFree, "CD", kLate);
  const BlockEdits result = Apply({wall, gone}, &grid);
  ASSERT_EQ(result.findings.size(), 1U);
  EXPECT_EQ(result.findings[0].kind, FindingKind::kConflict);
  EXPECT_EQ(result.findings[0].uids, (std::vector<std::string>{"gone", "wall"}));
  EXPECT_NE(result.findings[0].message.find("in 100 cells"), std::string::npos) << result.findings[0].message;
  wall.supersedes = {"gone"};
  EXPECT_TRUE(Apply({wall, gone}, &grid).findings.empty());
}

TEST(ApplyEdits, NewerScansThatContradictAnEditAreNamed) {
  const MapEdit wall = Square("wall", EditKind::kAreaOccupied, "AB", kEarly);
  const MapEdit erased = Square("erased", EditKind::kAreaFree, "AB", kEarly);
  SiteRaster free = Field();
  EXPECT_TRUE(Apply({wall}, &free).findings.empty()) << "block A was there when the wall was drawn";
  free = Field();
  const BlockEdits stale = Apply({wall}, &free, "B");
  ASSERT_EQ(stale.findings.size(), 1U);
  EXPECT_EQ(stale.findings[0].kind, FindingKind::kStale);
  EXPECT_NE(stale.findings[0].message.find("the newer scans of B contradict it in 100 of 100"), std::string::npos);
  SiteRaster taken = Field();
  EXPECT_TRUE(Apply({erased}, &taken, "B").findings.empty());
  taken = Field();
  for (int column = 12; column < 16; ++column) taken.At(column, 14) = 2.0F;
  EXPECT_EQ(Apply({erased}, &taken, "B").findings.at(0).kind, FindingKind::kStale);
}

TEST(ApplyEdits, AnEditDrawnOnTheMapConcernsTheBlocksThatDrewIt) {
  MapEdit edit = Square("a", EditKind::kAreaFree, "AB", kEarly);
  edit.frame = EditFrame::kMap;
  edit.basis = {{"A", "1"}, {"B", "2"}};
  edit.anchors["A"] = {EditAnchor{7, {1, 1}}, EditAnchor{7, {2, 1}}, EditAnchor{7, {2, 2}}, EditAnchor{7, {1, 2}}};
  const BlockPoses moved{.stamps = {7}, .site_from_scan = {{0.5, 0, 0}}};
  ASSERT_EQ(EditsOfBlock("A", {edit}, moved).size(), 1U);
  EXPECT_NEAR(EditsOfBlock("A", {edit}, moved)[0].edit.parts[0][0].x(), 1.5, 1e-12);
  EXPECT_TRUE(EditsOfBlock("B", {edit}, moved).empty()) << "B had a map, but not there";
  EXPECT_EQ(EditsOfBlock("C", {edit}, moved).size(), 1U) << "C came later";
}

TEST(ApplyEdits, PoorRefitsAreToBeLookedAt) {
  MapEdit edit = Square("a", EditKind::kAreaFree, "AB", kEarly);
  edit.frame = EditFrame::kMap;
  edit.anchors["A"] = {EditAnchor{7, {1, 1}}, EditAnchor{8, {2, 1}}, EditAnchor{8, {2, 2}}, EditAnchor{7, {1, 2}}};
  const auto findings = [&](const BlockPoses& poses) {
    SiteRaster grid = Field();
    return ApplyEdits("A", EditsOfBlock("A", {edit}, poses), {}, &grid).findings;
  };
  EXPECT_TRUE(findings({.stamps = {7, 8}, .site_from_scan = {{0.5, 0, 0}, {0.55, 0, 0}}}).empty());
  const auto stretched = findings({.stamps = {7, 8}, .site_from_scan = {{0, 0, 0}, {0.12, 0, 0}}});
  ASSERT_EQ(stretched.size(), 1U);
  EXPECT_EQ(stretched[0].message, "area_free a (AB, 2026-11-28T10:00:00Z): its area changed by +12 %");
  const auto torn = findings({.stamps = {7, 8}, .site_from_scan = {{0, 0, 0}, {0, 0.6, 0}}});
  EXPECT_NE(torn.at(0).message.find("was bent by 0."), std::string::npos) << torn[0].message;
  const auto lost = findings({.stamps = {7, 9}, .site_from_scan = {{0, 0, 0}, {0, 0, 0}}});
  EXPECT_NE(lost.at(0).message.find("the scans under 2 of 4 vertices are gone"), std::string::npos) << lost[0].message;
}

// An edit that two blocks have moved: asked about once, where it fits worse. A mask's beams hold, whatever moved.
TEST(ApplyEdits, EditsInDoubtAreAskedAboutOnce) {
  MapEdit edit = Square("a", EditKind::kAreaFree, "AB", kEarly);
  edit.frame = EditFrame::kMap;
  for (const char* block : {"A", "B"})
    edit.anchors[block] = {EditAnchor{7, {1, 1}}, EditAnchor{8, {2, 1}}, EditAnchor{8, {2, 2}}, EditAnchor{7, {1, 2}}};
  MapEdit mask = edit;
  mask.uid = "mask";
  mask.kind = EditKind::kMaskReturns;
  mask.beams = {{"A", {{7, 0, 1}}}, {"B", {{7, 0, 1}}}};
  std::vector<BlockEdits> doubtful;
  for (const auto& [block, shift] : {std::pair("A", 0.8), std::pair("B", 2.0), std::pair("C", 0.0)}) {
    const BlockPoses poses{.stamps = {7, 8}, .site_from_scan = {{0, 0, 0}, {0, shift, 0}}};
    SiteRaster grid = Field();
    doubtful.push_back(Doubtful(ApplyEdits(block, EditsOfBlock(block, {edit, mask}, poses), {}, &grid)));
  }
  EXPECT_TRUE(doubtful[2].edits.empty());
  const std::vector<EditRequest> requests = MakeEditRequests(doubtful);
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].block, "B");
  EXPECT_EQ(requests[0].applied.drawn, edit.parts);
  EXPECT_EQ(requests[0].causes.at(0).cause, "edit_review");
  EXPECT_GT(requests[0].score_m, 0.15);
  EXPECT_NEAR(requests[0].score_m, requests[0].applied.residual_m, 1e-12);
}

TEST(MaskedBeams, AreThoseThatEndInTheArea) {
  Session session;
  session.geometries = {{.angle_min_rad = 0, .angle_increment_rad = 0.1, .range_max_m = 30, .num_beams = 5}};
  session.scans = {{.stamp_ns = 3, .ranges_m = {2, 2, 2, kNoReturn, 2}}, {.stamp_ns = 4, .ranges_m = {9, 9, 9, 9, 9}}};
  const MapEdit area{.kind = EditKind::kMaskReturns, .parts = {{{11, 4}, {13, 4}, {13, 5.3}, {11, 5.3}}}};
  const auto beams = BeamsInside(area, session, {{10, 5, 0}, {10, 5, 0}});
  EXPECT_EQ(beams, (std::vector<MaskedBeams>{{3, 0, 1}}));
  for (const auto& [from, until, kept] : {std::tuple(3, 3, true), std::tuple(4, 9, false), std::tuple(1, 2, false)}) {
    MapEdit for_a_while = area;
    for_a_while.from_ns = from;
    for_a_while.until_ns = until;
    EXPECT_EQ(BeamsInside(for_a_while, session, {{10, 5, 0}, {10, 5, 0}}).empty(), !kept) << from;
  }
  EXPECT_EQ(DropBeams(beams, &session), 2U);
  EXPECT_TRUE(std::isnan(session.scans[0].ranges_m[1]));
  EXPECT_EQ(session.scans[0].ranges_m[2], 2.0F);
  EXPECT_EQ(DropBeams(std::vector<MaskedBeams>{{5, 0, 1}, {4, 4, 99}}, &session), 1U) << "cut to what there is";
}

}  // namespace
}  // namespace survey
