// SPDX-License-Identifier: Apache-2.0
//
// However a run ends, the next one reaches the same bytes as a run that nothing disturbed.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/statvfs.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "tests/support/job_site.h"

namespace {

namespace fs = std::filesystem;
using test_support::CommandResult;
using test_support::Differences;
using test_support::JobSite;
using test_support::ScratchFolder;

constexpr unsigned kSeed = 20;
constexpr int kKillsPerSite = 5;

// A test of hours instead of seconds: PLUMBLINE_KILLS=200 PLUMBLINE_FULL_DISKS=50.
int FromEnvironment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

TEST(RecoveryTest, KilledAtRandomMoments) {
  const auto undisturbed = JobSite::Processed().Results();
  const JobSite timed;
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(timed.Run({"-j2"}).status, 0);
  const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - began);

  std::mt19937 random(kSeed);
  const auto moment = [&] { return std::chrono::milliseconds(random() % static_cast<unsigned>(whole.count() / 2)); };
  const int wanted = FromEnvironment("PLUMBLINE_KILLS", 20);
  int sites = 0;
  for (int kills = 0; kills < wanted;) {
    ASSERT_LT(sites++, wanted) << "runs end before they are killed";
    const JobSite site;
    // A run that ended first counts for nothing: what is done cannot be disturbed any more.
    for (int k = 0; k < kKillsPerSite && kills < wanted && site.RunAndKillAfter(moment()); ++k) ++kills;
    const CommandResult run = site.Run({"-j2"});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(Differences(site.Results(), undisturbed),
              std::vector<std::string>{});  // nothing else stayed behind either
    EXPECT_EQ(site.StagesOfRun(), std::vector<std::string>{});
  }
}

// A file system of its own; unmounted at the end.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& folder) : folder_(folder) {
    fs::create_directories(folder_);
    mounted_ = mount("none", folder_.c_str(), "tmpfs", 0, "size=64m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }
  // Leaves so many bytes to whoever writes next, by a file that takes the rest.
  void LeaveFree(std::uintmax_t bytes) {
    std::uintmax_t available = fs::space(folder_).available;
    std::ofstream filler(folder_ / "filler", std::ios::binary);
    const std::string block(4096, 'x');
    for (; available > bytes; available -= std::min<std::uintmax_t>(available, block.size())) filler << block;
  }
  void MakeRoom() { fs::remove(folder_ / "filler"); }

 private:
  fs::path folder_;
  bool mounted_ = false;
};

TEST(RecoveryTest, DiskFull) {
  const ScratchFolder scratch;
  SmallDisk disk(scratch / "disk");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small tmpfs is not permitted here";
  const JobSite site(scratch / "disk/site");
  const auto undisturbed = JobSite::Processed().Results();
  std::mt19937 random(kSeed);
  const int wanted = FromEnvironment("PLUMBLINE_FULL_DISKS", 5);
  int runs = 0;
  for (int failures = 0; failures < wanted;) {
    ASSERT_LT(runs++, 10 * wanted) << "the disk is seldom full";
    // At first within the room that the whole site takes; then wherever the rest of it needs more.
    const std::uintmax_t bytes = random() % 1'500'000;
    const auto before = site.Results();
    disk.LeaveFree(bytes);
    const CommandResult run = site.Run();
    disk.MakeRoom();
    if (run.status == 0) fs::remove_all(site / "work");
    if (run.status == 0) continue;
    ++failures;
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_TRUE(run.err.starts_with("plumbline")) << run.err;
    EXPECT_EQ(run.err.find("internal error"), std::string::npos) << run.err;
    const auto after = site.Results();
    for (const auto& [file, digest] : before) EXPECT_TRUE(after.contains(file) && after.at(file) == digest) << file;
  }
  const CommandResult run = site.Run();
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(Differences(site.Results(), undisturbed), std::vector<std::string>{});
}

TEST(RecoveryTest, ReadOnlyOutputFolder) {
  const JobSite site = JobSite::Processed();
  const auto undisturbed = site.Results();
  fs::remove(site / "out/site.tif");
  // Root may write in any folder, so the folder is mounted read-only over itself.
  const std::string out = site / "out";
  const bool mounted = mount(out.c_str(), out.c_str(), "none", MS_BIND, nullptr) == 0 &&
                       mount("none", out.c_str(), "none", MS_BIND | MS_REMOUNT | MS_RDONLY, nullptr) == 0;
  if (!mounted) GTEST_SKIP() << "mounting read-only is not permitted here";
  const CommandResult refused = site.Run();
  umount2(out.c_str(), MNT_DETACH);
  EXPECT_EQ(refused.status, 1) << refused.err;
  EXPECT_NE(refused.err.find("plumbline-stitch: out: folder is not writable"), std::string::npos) << refused.err;
  EXPECT_EQ(refused.err.find("internal error"), std::string::npos) << refused.err;
  EXPECT_EQ(site.StagesOfRun(), (std::vector<std::string>{"report", "stitch"}));
  EXPECT_EQ(Differences(site.Results(), undisturbed), std::vector<std::string>{});
}

TEST(RecoveryTest, SecondMakeIsTold) {
  const JobSite site;
  CommandResult first;
  std::thread one([&] { first = site.Run(); });
  while (!fs::exists(site / "logs/A-ingest.log")) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const CommandResult second = site.Run();
  one.join();
  EXPECT_EQ(first.status, 0) << first.err;
  EXPECT_NE(second.status, 0);
  EXPECT_EQ(second.out, "");
  EXPECT_NE(second.err.find("another make (process "), std::string::npos) << second.err;
  EXPECT_EQ(site.StagesOfRun(), std::vector<std::string>{});
}

}  // namespace
