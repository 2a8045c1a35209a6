// SPDX-License-Identifier: Apache-2.0
//
// What people get wrong, in a site that was up to date: the run fails with exit status 1 (2 for a configuration) and a
// message that names file, row, value and rule, and every result stays as it was; after the repair nothing more runs
// than what had failed.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "formats/atomic_file.h"
#include "tests/support/job_site.h"

namespace {

namespace fs = std::filesystem;
using test_support::AppendToFile;
using test_support::CommandResult;
using test_support::Differences;
using test_support::JobSite;

using Lines = std::vector<std::string>;

// Changes the lines of a text file; row 1 is lines[0].
void EditLines(const fs::path& file, const std::function<void(Lines&)>& edit) {
  Lines lines;
  std::istringstream in(formats::ReadWholeFile(file));
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  edit(lines);
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  formats::WriteFileAtomically(file, text);
}

std::function<void(Lines&)> Replaced(std::size_t row, const std::string& from, const std::string& to) {
  return [=](Lines& lines) {
    const std::size_t at = lines.at(row - 1).find(from);
    ASSERT_NE(at, std::string::npos) << lines[row - 1];
    lines[row - 1].replace(at, from.size(), to);
  };
}

void WithoutLastField(std::string* line) { line->resize(line->rfind(',')); }

struct Mistake {
  std::string file;
  std::function<void(Lines&)> edit;
  int status;
  Lines told;  // parts of the message
};

class BadInputTest : public testing::Test {
 protected:
  void ExpectTold(const Mistake& mistake) {
    SCOPED_TRACE(mistake.file + ": " + mistake.told.front());
    const fs::path file = site_ / mistake.file;
    const std::string good = formats::ReadWholeFile(file);
    EditLines(file, mistake.edit);
    const CommandResult run = site_.Run();
    EXPECT_EQ(run.status, mistake.status) << run.err;
    for (const std::string& part : mistake.told) EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find("internal error"), std::string::npos) << run.err;
    EXPECT_EQ(Differences(site_.Results(), before_), Lines{});
    formats::WriteFileAtomically(file, good);
  }

  JobSite site_ = JobSite::Processed();
  std::map<std::string, std::string> before_ = site_.Results();
};

TEST_F(BadInputTest, Control) {
  const std::string file = "control/points.csv";
  for (const Mistake& mistake : std::initializer_list<Mistake>{
           {file, [](Lines& lines) { WithoutLastField(&lines[2]); }, 1, {"points.csv:3: 7 fields, expected 8"}},
           {file, Replaced(3, "5600202.0014", "nan"), 1, {"points.csv:3: northing = \"nan\": must be a finite number"}},
           {file,
            Replaced(3, "0.002,0.002", "-0.002,0.002"),
            1,
            {"points.csv:3: sigma_n = -0.002", "must be positive"}},
           {file,
            [](Lines& lines) { lines.push_back("2,5600203.0014,500105.9996,112.400,0.002,0.002,,control"); },
            1,
            {"points.csv:10: point 2 is already in row 3 with other coordinates", "5600203.0014"}},
           {file,
            Replaced(3, "5600202.0014,500105.9996", "500105.9996,5600202.0014"),
            1,
            {"points.csv:3: point 2: northing and easting look exchanged"}},
           {file, Replaced(3, "control", "kontrol"), 1, {"points.csv:3: ", "kontrol"}},
           {file, [](Lines& lines) { lines.clear(); }, 1, {"points.csv"}}}) {
    ExpectTold(mistake);
  }
  EXPECT_EQ(site_.StagesOfRun(), Lines{"network"});
}

TEST_F(BadInputTest, Marks) {
  const std::string file = "blocks/A/marks.csv";
  for (const Mistake& mistake : std::initializer_list<Mistake>{
           {file,
            Replaced(2, "1006.804,1007.204", "5006.804,5007.204"),
            1,
            {"marks.csv:2: mark on 2 from 5006.804", "lies outside the log"}},
           {file,
            Replaced(3, "1017.352", "1007.0"),
            1,
            {"marks.csv:3: mark on 3 from 1007.0", "overlaps with the mark on 2"}},
           {file,
            Replaced(3, "1017.352,1017.752", "1017.752,1017.352"),
            1,
            {"marks.csv:3: end = \"1017.352\": must come after start"}},
           {file, Replaced(3, "1017.352", "soon"), 1, {"marks.csv:3: start = \"soon\""}},
           {file, [](Lines& lines) { WithoutLastField(&lines[2]); }, 1, {"marks.csv:3: 2 fields, expected 3"}}}) {
    ExpectTold(mistake);
  }
}

TEST_F(BadInputTest, FieldData) {
  const std::string scans = "blocks/A/raw/scans.csv";
  const std::string odometry = "blocks/A/raw/odometry.csv";
  const auto late_row = [](Lines& lines) { std::swap(lines[99], lines[102]); };
  for (const Mistake& mistake : std::initializer_list<Mistake>{
           {scans,
            [](Lines& lines) { WithoutLastField(&lines[99]); },
            1,
            {"scans.csv:100: wrong beam count: found 270 ranges, expected 271"}},
           {scans, late_row, 1, {"scans.csv:101: t = ", "time stamps must grow"}},
           {scans, [](Lines& lines) { lines.resize(1); }, 1, {"scans.csv: a log without scans"}},
           {scans, [](Lines& lines) { lines.clear(); }, 1, {"scans.csv"}},
           {odometry, [](Lines& lines) { WithoutLastField(&lines[29]); }, 1, {"odometry.csv:30: 3 fields, expected 4"}},
           {odometry, late_row, 1, {"odometry.csv:101: t = ", "time stamps must grow"}},
           {"blocks/A/raw/imu.csv",
            [](Lines& lines) {
              WithoutLastField(&lines[29]);
              lines[29] += ",inf";
            },
            1,
            {"imu.csv:30: az = \"inf\": must be a finite number"}}}) {
    ExpectTold(mistake);
  }
}

// Only the network knows the points; the map and the certificate stay as they were.
TEST_F(BadInputTest, AMarkOnAnUnknownPoint) {
  EditLines(site_ / "blocks/A/marks.csv", Replaced(2, "2,", "77,"));
  const CommandResult run = site_.Run();
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("blocks/A/marks.csv:2: point 77 is not in the control list"), std::string::npos) << run.err;
  for (const std::string& file : Differences(site_.Results(), before_))
    EXPECT_TRUE(file.starts_with("work/A/")) << file;
}

TEST_F(BadInputTest, ATruncatedFile) {
  fs::resize_file(site_ / "blocks/A/raw/scans.csv", 200000);
  const CommandResult run = site_.Run();
  EXPECT_EQ(run.status, 1);
  for (const char* part : {"blocks/A/raw/scans.csv:", "wrong beam count", "the file ends here: cut off?"}) {
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  }
  EXPECT_EQ(Differences(site_.Results(), before_), Lines{});
}

TEST_F(BadInputTest, AMissingFile) {
  fs::remove(site_ / "blocks/A/raw/scans.csv");
  const CommandResult run = site_.Run();
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("a log without scans"), std::string::npos) << run.err;
  EXPECT_EQ(Differences(site_.Results(), before_), Lines{});
}

TEST_F(BadInputTest, Configuration) {
  const auto appended = [](const std::string& line) { return [=](Lines& lines) { lines.push_back(line); }; };
  for (const Mistake& mistake : std::initializer_list<Mistake>{
           {"blocks/A/block.toml",
            appended("[track]\npoint-spacng-m = 3"),
            2,
            {"block.toml:", "point-spacng-m: unknown key"}},
           {"site.toml", appended("[trak]\n"), 2, {"site.toml:", "trak", "did you mean"}},
           {"blocks/A/block.toml", appended("[grid]\nmax-range-m = \"far\""), 2, {"block.toml:", "max-range-m"}},
           {"blocks/A/block.toml",
            appended("[grid]\nmax-range-m = -3"),
            2,
            {"block.toml:6", "max-range-m", "at least 1"}}}) {
    ExpectTold(mistake);
  }
}

// A point alone fixes the place but not the direction: refused unless asked for.
TEST_F(BadInputTest, OneMarkAlone) {
  EditLines(site_ / "blocks/A/marks.csv", [](Lines& lines) { lines.resize(2); });
  const CommandResult run = site_.Run();
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_NE(run.err.find("marks.csv stands on one control point only, "), std::string::npos) << run.err;
  AppendToFile(site_ / "blocks/A/block.toml", "[adjust]\nallow-single-point = true\n");
  const CommandResult asked = site_.Run();
  EXPECT_EQ(asked.status, 0) << asked.err;
}

TEST_F(BadInputTest, UnknownOptions) {
  const std::string site = site_.path().string();
  for (const auto& [command, told] :
       std::initializer_list<std::pair<Lines, std::string>>{{{"plumbline", "run", site, "--jbs", "3"}, "--jbs"},
                                                            {{"plumbline", "new", "s", "--cntrl", "x"}, "--cntrl"},
                                                            {{"plumbline", "track", "--sesion", "x"}, "--sesion"}}) {
    const CommandResult result = test_support::RunCommand(command, site);
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find(told), std::string::npos) << result.err;
  }
}

// Without a control list, and without any marks, no block has a place on a common map.
TEST_F(BadInputTest, TwoBlocksWithoutControl) {
  fs::remove(site_ / "control/points.csv");
  for (const char* what : {"no control", "no marks either"}) {
    SCOPED_TRACE(what);
    const CommandResult run = site_.Run();
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_NE(run.err.find("no block is tied to control: nothing is certified"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(site_ / "out/site.tif"));
    EXPECT_TRUE(fs::exists(site_ / "out/local/A.tif"));
    const std::string page = formats::ReadWholeFile(site_ / "out/certificate.html");
    EXPECT_NE(page.find("not tied to control"), std::string::npos);
    EXPECT_EQ(site_.StagesOfRun(), Lines{});
    fs::remove(site_ / "blocks/A/marks.csv");
    fs::remove(site_ / "blocks/B/marks.csv");
  }
}

}  // namespace
