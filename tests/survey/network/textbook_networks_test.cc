// SPDX-License-Identifier: Apache-2.0
//
// The networks of tests/networks, which say themselves what must come out (see the README there), by both solvers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "formats/network_file.h"
#include "survey/network/adjustment.h"
#include "survey/network/approximations.h"
#include "survey/network/network_checks.h"
#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> Files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(test_support::SourceFolder() / "tests/networks")) {
    if (entry.path().extension() == ".dat") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct Expectations {
  formats::StarnetSigmas sigmas;
  std::vector<std::vector<std::string>> lines;  // words of the other lines
  std::string refusal;
};

Expectations ReadExpectations(const fs::path& file) {
  Expectations expectations;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("#>")) continue;
    std::istringstream text(line.substr(2));
    std::vector<std::string> words;
    for (std::string word; text >> word;) words.push_back(word);
    formats::StarnetSigmas& sigmas = expectations.sigmas;
    if (words.at(0) == "refuse") {
      expectations.refusal = line.substr(line.find("refuse ") + 7);
    } else if (words[0] != "sigma") {
      expectations.lines.push_back(words);
    } else if (words.at(1) == "distance") {
      sigmas.distance_m = std::stod(words.at(2));
      sigmas.distance_ppm = std::stod(words.at(4));
    } else {
      double& sigma = words[1] == "angle"     ? sigmas.angle_arcsec
                      : words[1] == "azimuth" ? sigmas.azimuth_arcsec
                      : words[1] == "zenith"  ? sigmas.zenith_arcsec
                                              : sigmas.levelling_m_per_sqrt_km;
      sigma = std::stod(words.at(2));
    }
  }
  return expectations;
}

class Checker {
 public:
  Checker(const survey::Network& network, const survey::NetworkAdjustment& adjustment)
      : network_(network), adjustment_(adjustment) {}

  void Check(const std::vector<std::string>& words) {
    if (words.at(0) == "tolerance") {
      ASSERT_EQ(words.at(2), "mm");
      tolerance_m_ = std::stod(words[1]) / 1000.0;
      return;
    }
    ASSERT_EQ(words[0], "expect");
    const std::string& what = words.at(1);
    const double expected = std::stod(words.back());
    if (what == "dof" || what == "defect") {
      EXPECT_EQ(what == "dof" ? adjustment_.degrees_of_freedom : adjustment_.defect, static_cast<int>(expected));
      return;
    }
    if (what == "chi_square") {
      EXPECT_NEAR(adjustment_.chi_square, expected, 1e-4 * expected);
      return;
    }
    if (what == "w" || what == "redundancy") {
      const survey::ObservationResult& o = adjustment_.observations.at(std::stoul(words.at(2)) - 1);
      EXPECT_NEAR(what == "w" ? o.w : o.redundancy, expected, 1e-3) << what << " " << words[2];
      return;
    }
    CheckPoint(what, words.at(2), expected);
  }

 private:
  void CheckPoint(const std::string& what, const std::string& name, double expected) {
    const bool deviation = what.starts_with("sd_");
    const std::string axis = deviation ? what.substr(3) : what;
    const int component = axis == "east" ? 0 : axis == "north" ? 1 : 2;
    ASSERT_TRUE(component < 2 || axis == "height") << what;
    for (std::size_t i = 0; i < network_.points.size(); ++i) {
      if (network_.points[i].name != name) continue;
      const survey::PointResult& point = adjustment_.points[i];
      if (deviation) {
        EXPECT_NEAR(1000.0 * std::sqrt(point.covariance(component, component)), expected, 1000.0 * tolerance_m_)
            << what << " " << name;
      } else {
        EXPECT_NEAR(point.position[component], expected, tolerance_m_) << what << " " << name;
      }
      return;
    }
    FAIL() << "no point " << name;
  }

  const survey::Network& network_;
  const survey::NetworkAdjustment& adjustment_;
  double tolerance_m_ = 0.0;
};

class TextbookNetworkTest : public testing::TestWithParam<fs::path> {};

TEST_P(TextbookNetworkTest, ComesOutAsTheFileSays) {
  const Expectations expectations = ReadExpectations(GetParam());
  survey::Network network = formats::ReadStarnet(GetParam(), expectations.sigmas).network;
  std::string refusal;
  for (const survey::NetworkDefect& defect : CheckNetwork(network)) refusal += defect.message + "; ";
  if (refusal.empty()) {
    ASSERT_TRUE(ComputeApproximations(&network).empty());
    for (const auto solver : {survey::NetworkSolver::kSparse, survey::NetworkSolver::kDense}) {
      SCOPED_TRACE(solver == survey::NetworkSolver::kSparse ? "sparse" : "dense");
      const survey::NetworkAdjustment adjustment = AdjustNetwork(network, {.solver = solver});
      if (!expectations.refusal.empty()) {
        EXPECT_FALSE(adjustment.usable);
        if (solver == survey::NetworkSolver::kSparse) refusal = adjustment.message;
        continue;
      }
      ASSERT_TRUE(adjustment.usable) << adjustment.message;
      Checker checker(network, adjustment);
      for (const std::vector<std::string>& words : expectations.lines) checker.Check(words);
    }
  }
  EXPECT_EQ(refusal.empty(), expectations.refusal.empty());
  EXPECT_NE(refusal.find(expectations.refusal), std::string::npos) << refusal;
}

INSTANTIATE_TEST_SUITE_P(Networks, TextbookNetworkTest, testing::ValuesIn(Files()),
                         [](const auto& info) { return info.param.stem().string(); });

}  // namespace
