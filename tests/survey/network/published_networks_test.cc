// SPDX-License-Identifier: Apache-2.0
//
// The networks that GNU Gama is tested with (textbooks and real surveys), against its published results: coordinates,
// their whole covariance matrix, variance factor, and for each observation the adjusted value, its standard deviation
// and how far it is controlled. Each network is adjusted by both solvers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "formats/adjusted_gama.h"
#include "formats/network_file.h"
#include "formats/text_numbers.h"
#include "formats/xml_stream.h"
#include "survey/network/adjustment.h"
#include "survey/network/approximations.h"
#include "survey/network/observation_equation.h"
#include "tests/support/real_data.h"

namespace {

namespace fs = std::filesystem;
using survey::NetworkAdjustment;
using survey::NetworkSolver;

constexpr double kTenthMm = 1e-4;
constexpr double kVarianceFactor = 1e-4;

std::vector<fs::path> PublishedNetworks() {
  std::vector<fs::path> files;
  const auto folder = test_support::RealData("gama");
  if (!folder) return files;
  for (const auto& entry : fs::directory_iterator(*folder)) {
    fs::path result = entry.path();
    result.replace_extension(".xml");
    if (entry.path().extension() == ".gkf" && fs::exists(result)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The observations of a published result, in its order.
struct PublishedObservation {
  double observed = 0.0, adjusted = 0.0, stdev = 0.0, control = 0.0;
};

std::vector<PublishedObservation> ReadObservations(const fs::path& file) {
  std::vector<PublishedObservation> observations;
  bool inside = false;
  std::vector<std::string> warnings;
  formats::ReadXml(file,
                   {.start = [&](formats::XmlElement& e) { inside = inside || e.name() == "observations"; },
                    .end =
                        [&](const std::string& name, const std::string& text, const std::string&) {
                          if (!inside) return;
                          const double value = formats::ParseNumber(formats::Trimmed(text)).value_or(0.0);
                          if (name == "obs") observations.push_back({.observed = value});
                          if (name == "adj") observations.back().adjusted = value;
                          if (name == "stdev") observations.back().stdev = value;
                          if (name == "f") observations.back().control = value;
                        }},
                   &warnings);
  return observations;
}

class PublishedNetworkTest : public testing::TestWithParam<fs::path> {};

// Where axes and angles are of different hands Gama computes with y mirrored, but takes the covariances of observed
// vectors as they stand. To be comparable ours are mirrored.
void MirrorCovariances(const fs::path& file, survey::Network* network) {
  if (file.stem() != "Ghilani_GNSS_Baselines") return;
  for (survey::CorrelatedObservations& group : network->correlated) {
    for (Eigen::Index i = 0; i < group.covariance.rows(); ++i) {
      if (network->observations[group.first + static_cast<std::size_t>(i)].component != 1) continue;
      group.covariance.row(i) *= -1.0;
      group.covariance.col(i) *= -1.0;
    }
  }
}

void ExpectPublished(const survey::Network& network, const NetworkAdjustment& ours,
                     const formats::AdjustedNetworkFile& published) {
  ASSERT_TRUE(ours.usable) << ours.message;
  EXPECT_EQ(ours.num_observations, published.num_observations);
  EXPECT_EQ(ours.num_unknowns, published.num_unknowns);
  EXPECT_EQ(ours.defect, published.defect);
  EXPECT_EQ(ours.degrees_of_freedom, published.degrees_of_freedom);
  // Relative to the a priori value: one of the networks was adjusted with another one than its file states.
  const double factor = ours.degrees_of_freedom > 0 ? ours.chi_square / ours.degrees_of_freedom : 0.0;
  const double published_factor = std::pow(published.sigma_zero_a_posteriori / published.sigma_zero_a_priori, 2);
  EXPECT_NEAR(factor, published_factor, kVarianceFactor * published_factor + 1e-12);
  std::map<std::string, int> index;
  for (std::size_t i = 0; i < network.points.size(); ++i) index[network.points[i].name] = static_cast<int>(i);
  std::vector<int> order;
  for (const formats::AdjustedPoint& point : published.points) {
    ASSERT_TRUE(index.contains(point.name)) << point.name;
    order.push_back(index[point.name]);
    const Eigen::Vector3d& position = ours.points[static_cast<std::size_t>(order.back())].position;
    if (point.has_plane) {
      EXPECT_LT((position - point.position).head<2>().norm(), kTenthMm) << point.name;
    }
    if (point.has_height) {
      EXPECT_NEAR(position.z(), point.position.z(), kTenthMm) << point.name;
    }
  }
  // Without redundancy Gama's a posteriori scale, and with it every deviation, is zero.
  if (published.sigma_zero_a_posteriori == 0.0) return;
  const Eigen::MatrixXd covariance = ours.CovarianceOf(order);
  const double largest = published.covariance.cwiseAbs().maxCoeff();
  EXPECT_LT((covariance - published.covariance).cwiseAbs().maxCoeff(), 2e-3 * largest + 1e-16);
}

void ExpectPublishedObservations(const survey::Network& network, const NetworkAdjustment& ours,
                                 const std::vector<PublishedObservation>& published) {
  ASSERT_EQ(ours.observations.size(), published.size());
  for (std::size_t i = 0; i < published.size(); ++i) {
    const survey::Observation& o = network.observations[i];
    const survey::ObservationResult& result = ours.observations[i];
    SCOPED_TRACE("observation " + std::to_string(i) + ", " + std::string(Name(o.kind)) + ", line " +
                 std::to_string(o.line));
    // Published: gon and cc, m and mm.
    const double unit = survey::IsAngular(o.kind) ? M_PI / 200.0 : 1.0;
    const double residual = (published[i].adjusted - published[i].observed) * unit;
    const double tolerance = survey::IsAngular(o.kind) ? 1e-4 * unit : kTenthMm;
    EXPECT_NEAR(std::abs(survey::WrappedAngle(result.residual)), std::abs(survey::WrappedAngle(residual)), tolerance);
    const double small_unit = survey::IsAngular(o.kind) ? 1e-4 * unit : 1e-3;
    if (ours.degrees_of_freedom == 0) continue;
    const double stdev = published[i].stdev * small_unit;
    EXPECT_NEAR(result.sigma_adjusted * ours.scale, stdev, 1e-3 * stdev + 1e-9);
    // Gama's degree of control: how much smaller the deviation of the adjusted value is than that of the observed one.
    const double control = 100.0 * (1.0 - result.sigma_adjusted / o.sigma);
    EXPECT_NEAR(control, published[i].control, 0.02);
  }
}

TEST_P(PublishedNetworkTest, BothSolversGiveThePublishedAnswer) {
  formats::NetworkFile file = formats::ReadGkf(GetParam());
  fs::path result_file = GetParam();
  result_file.replace_extension(".xml");
  const formats::AdjustedNetworkFile published = formats::ReadGamaAdjustment(result_file);
  ASSERT_TRUE(survey::ComputeApproximations(&file.network).empty());
  MirrorCovariances(GetParam(), &file.network);
  const NetworkAdjustment sparse = AdjustNetwork(file.network, {.solver = NetworkSolver::kSparse});
  {
    SCOPED_TRACE("sparse");
    ExpectPublished(file.network, sparse, published);
    ExpectPublishedObservations(file.network, sparse, ReadObservations(result_file));
  }
  SCOPED_TRACE("dense");
  const NetworkAdjustment dense = AdjustNetwork(file.network, {.solver = NetworkSolver::kDense});
  ExpectPublished(file.network, dense, published);
  for (std::size_t i = 0; i < sparse.observations.size(); ++i) {
    EXPECT_NEAR(sparse.observations[i].w, dense.observations[i].w, 1e-5);
    EXPECT_NEAR(sparse.observations[i].redundancy, dense.observations[i].redundancy, 1e-6);
  }
}

std::string TestName(const testing::TestParamInfo<fs::path>& info) {
  std::string name = info.param.stem().string();
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PublishedNetworkTest);
INSTANTIATE_TEST_SUITE_P(Gama, PublishedNetworkTest, testing::ValuesIn(PublishedNetworks()), TestName);

// Those without a published result: written in two ways they must come out alike, by both solvers.
NetworkAdjustment Adjusted(const fs::path& folder, const std::string& name, NetworkSolver solver) {
  survey::Network network = formats::ReadGkf(folder / (name + ".gkf")).network;
  EXPECT_TRUE(survey::ComputeApproximations(&network).empty()) << name;
  NetworkAdjustment adjustment = AdjustNetwork(network, {.solver = solver});
  EXPECT_TRUE(adjustment.usable) << name << ": " << adjustment.message;
  return adjustment;
}

void ExpectAlike(const NetworkAdjustment& a, const NetworkAdjustment& b) {
  EXPECT_NEAR(a.chi_square, b.chi_square, kVarianceFactor * a.chi_square + 1e-9);
  EXPECT_EQ(a.degrees_of_freedom, b.degrees_of_freedom);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i)
    EXPECT_LT((a.points[i].position - b.points[i].position).norm(), kTenthMm) << i;
}

TEST(PublishedNetworks, WrittenInTwoWaysTheyAreAlike) {
  const auto folder = test_support::RealData("gama");
  if (!folder) GTEST_SKIP() << "no data in ../shared/data/gama";
  for (const auto& [name, other] : {std::pair<std::string, std::string>{"gama-local-nop", "gama-local-par"},
                                    {"scale-cov-dms", "scale-cov-gon"},
                                    {"railway-survey", "railway-survey-with-aproximate-xy"},
                                    {"skorepa-dusek", "skorepa-dusek"},
                                    {"fixed-constrained", "fixed-constrained"}}) {
    SCOPED_TRACE(name);
    const NetworkAdjustment first = Adjusted(*folder, name, NetworkSolver::kSparse);
    ExpectAlike(first, Adjusted(*folder, other, NetworkSolver::kSparse));
    if (first.num_unknowns > 500) continue;  // too many for the dense solver
    ExpectAlike(first, Adjusted(*folder, name, NetworkSolver::kDense));
  }
  // An azimuth turns the network and does nothing else.
  EXPECT_NEAR(Adjusted(*folder, "fixed-constrained", NetworkSolver::kSparse).chi_square,
              Adjusted(*folder, "fixed-azimuth", NetworkSolver::kSparse).chi_square, 1e-6);
}

TEST(PublishedNetworks, AreThere) {
  if (PublishedNetworks().empty()) GTEST_SKIP() << "no data in ../shared/data/gama";
  EXPECT_GE(PublishedNetworks().size(), 40U);
}

}  // namespace
