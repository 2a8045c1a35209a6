// SPDX-License-Identifier: Apache-2.0
//
// Equal inputs give equal bytes: whatever the folder, the number of jobs and of threads.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/job_site.h"

namespace {

using test_support::JobSite;

TEST(DeterminismTest, JobsAndThreadsDoNotShowInTheResults) {
  const auto expected = JobSite::Processed().Results();
  ASSERT_TRUE(expected.contains("out/certificate.html"));
  const test_support::ScratchFolder elsewhere;
  int runs = 0;
  for (const auto& [jobs, threads] : {std::pair{"-j1", "1"}, std::pair{"-j8", "2"}, std::pair{"-j1", "8"}}) {
    setenv("PLUMBLINE_THREADS", threads, 1);
    const JobSite site(elsewhere / ("folder " + std::to_string(++runs)) / "a site of another name");
    EXPECT_EQ(site.Run({jobs}).status, 0);
    const auto results = site.Results();
    unsetenv("PLUMBLINE_THREADS");
    EXPECT_EQ(test_support::Differences(results, expected), std::vector<std::string>{}) << jobs;
  }
}

}  // namespace
