// SPDX-License-Identifier: Apache-2.0
//
// Equal inputs give equal bytes: whatever the folder, the number of jobs and of threads, the day, the place and the
// language.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "tests/support/job_site.h"

namespace {

namespace fs = std::filesystem;
using test_support::JobSite;
using Environment = std::map<std::string, std::string>;

class ChangedEnvironment {
 public:
  explicit ChangedEnvironment(const Environment& values) : values_(values) {
    for (const auto& [name, value] : values_) setenv(name.c_str(), value.c_str(), 1);
  }
  ~ChangedEnvironment() {
    for (const auto& [name, value] : values_) unsetenv(name.c_str());
  }
  ChangedEnvironment(const ChangedEnvironment&) = delete;
  ChangedEnvironment& operator=(const ChangedEnvironment&) = delete;

 private:
  Environment values_;
};

// A day two years from now for every program that asks the clock; file times stay as they are. Empty without
// libfaketime.
Environment AnotherDay() {
  const std::string library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1";
  if (!fs::exists(library)) return {};
  return {{"LD_PRELOAD", library}, {"FAKETIME", "+730d"}, {"NO_FAKE_STAT", "1"}, {"FAKETIME_DONT_FAKE_MONOTONIC", "1"}};
}

// All that a site can do is switched on: its blocks are adjusted together.
std::map<std::string, std::string> ResultsOf(const JobSite& site, const std::string& jobs) {
  test_support::ReplaceInFile(site / "site.toml", "# joint = false", "joint = true");
  const test_support::CommandResult run = site.Run({jobs});
  EXPECT_EQ(run.status, 0) << run.err;
  return site.Results();
}

TEST(DeterminismTest, CircumstancesDoNotShowInTheResults) {
  const auto expected = ResultsOf(JobSite(), "-j2");
  ASSERT_TRUE(expected.contains("out/certificate.html"));
  ASSERT_TRUE(expected.contains("work/joint.json"));
  const test_support::ScratchFolder elsewhere;
  Environment abroad = {{"PLUMBLINE_THREADS", "2"}, {"TZ", "Asia/Tokyo"}, {"LC_ALL", "C.UTF-8"}};
  abroad.merge(AnotherDay());
  const std::vector<std::pair<std::string, Environment>> circumstances = {
      {"-j1", {{"PLUMBLINE_THREADS", "1"}}}, {"-j8", abroad}, {"-j1", {{"PLUMBLINE_THREADS", "8"}}}};
  for (std::size_t i = 0; i < circumstances.size(); ++i) {
    const auto& [jobs, environment] = circumstances[i];
    const JobSite site(elsewhere / ("folder " + std::to_string(i)) / "a site of another name");
    const ChangedEnvironment changed(environment);
    EXPECT_EQ(test_support::Differences(ResultsOf(site, jobs), expected), std::vector<std::string>{}) << i;
  }
}

}  // namespace
