// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/control_misfit.h"

#include "survey/graph/normal_equations.h"
#include "survey/graph/selected_inverse.h"

namespace survey {
namespace {

using Eigen::Index;

// Where the given coordinates of a point stand; group -1: it has none.
struct GivenPlace {
  int group = -1;
  Index row = 0;
};

std::vector<GivenPlace> PlacesOfGiven(const PoseGraph& graph, const std::vector<GivenCoordinates>& given) {
  std::vector<GivenPlace> places(graph.points.size());
  for (std::size_t g = 0; g < given.size(); ++g) {
    for (std::size_t k = 0; k < given[g].points.size(); ++k) {
      places[static_cast<std::size_t>(given[g].points[k])] = {static_cast<int>(g), 2 * static_cast<Index>(k)};
    }
  }
  return places;
}

const Pose2& PoseOf(const PoseGraph& graph, const MarkEdge& mark) {
  return graph.poses[static_cast<std::size_t>(mark.pose)];
}

// Without control and the marks on it; marks on other points still tie the network.
PoseGraph FreeNetwork(const PoseGraph& graph, const std::vector<GivenPlace>& places) {
  PoseGraph network = graph;
  network.given.clear();
  network.fixed_pose = 0;
  std::erase_if(network.marks,
                [&](const MarkEdge& mark) { return places[static_cast<std::size_t>(mark.point)].group >= 0; });
  return network;
}

// d place / d pose of a mark's place, in the columns of its pose.
Eigen::Matrix<double, 2, 3> PlaceByPose(const PoseGraph& graph, const MarkEdge& mark) {
  const Eigen::Vector2d lever = Rotation2(PoseOf(graph, mark).theta) * mark.p_in_pose;
  Eigen::Matrix<double, 2, 3> derivative;
  derivative << 1, 0, -lever.y(), 0, 1, lever.x();
  return derivative;
}

Eigen::Matrix<double, 2, 3> ByDatum(const Eigen::Vector2d& from_centre) {
  Eigen::Matrix<double, 2, 3> derivative;
  derivative << 1, 0, -from_centre.y(), 0, 1, from_centre.x();
  return derivative;
}

void CollectMarks(const PoseGraph& graph, const std::vector<GivenCoordinates>& given,
                  const std::vector<GivenPlace>& places, ControlMisfit* misfit) {
  for (std::size_t i = 0; i < graph.marks.size(); ++i) {
    const GivenPlace& place = places[static_cast<std::size_t>(graph.marks[i].point)];
    if (place.group < 0) continue;
    misfit->marks.push_back(static_cast<int>(i));
    misfit->points.push_back(graph.marks[i].point);
    misfit->given.push_back(given[static_cast<std::size_t>(place.group)].coordinates.segment<2>(place.row));
  }
}

void FillControl(const PoseGraph& graph, const std::vector<GivenCoordinates>& given,
                 const std::vector<GivenPlace>& places, ControlMisfit* misfit) {
  const Index rows = 2 * misfit->size();
  misfit->of_marks = Eigen::MatrixXd::Zero(rows, rows);
  misfit->of_control = Eigen::MatrixXd::Zero(rows, rows);
  for (Index i = 0; i < misfit->size(); ++i) {
    const MarkEdge& mark = graph.marks[static_cast<std::size_t>(misfit->marks[static_cast<std::size_t>(i)])];
    const Eigen::Matrix2d rotation = Rotation2(PoseOf(graph, mark).theta);
    misfit->of_marks.block<2, 2>(2 * i, 2 * i) = rotation * mark.covariance * rotation.transpose();
    const GivenPlace& a = places[static_cast<std::size_t>(mark.point)];
    for (Index j = 0; j < misfit->size(); ++j) {
      const GivenPlace& b = places[static_cast<std::size_t>(misfit->points[static_cast<std::size_t>(j)])];
      if (a.group != b.group) continue;
      misfit->of_control.block<2, 2>(2 * i, 2 * j) =
          given[static_cast<std::size_t>(a.group)].covariance.block<2, 2>(a.row, b.row);
    }
  }
}

// At the poses about which the network is linearised, `places` of the marks there.
void FillDatum(const PoseGraph& graph, const std::vector<Eigen::Vector2d>& places, ControlMisfit* misfit) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& place : places) centre += place / static_cast<double>(places.size());
  misfit->datum.resize(2 * misfit->size(), 3);
  misfit->from_centre.resize(2 * misfit->size());
  for (Index i = 0; i < misfit->size(); ++i) {
    const Eigen::Vector2d from_centre = places[static_cast<std::size_t>(i)] - centre;
    misfit->datum.middleRows<2>(2 * i) = ByDatum(from_centre);
    misfit->from_centre.segment<2>(2 * i) = from_centre;
  }
  misfit->datum_of_poses.resize(2 * static_cast<Index>(graph.poses.size()), 3);
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    misfit->datum_of_poses.middleRows<2>(2 * static_cast<Index>(i)) = ByDatum(graph.poses[i].Translation() - centre);
  }
}

}  // namespace

std::optional<ControlMisfit> MisfitOfControl(const PoseGraph& graph, const std::vector<GivenCoordinates>& given) {
  const std::vector<GivenPlace> places = PlacesOfGiven(graph, given);
  ControlMisfit misfit;
  CollectMarks(graph, given, places, &misfit);
  FillControl(graph, given, places, &misfit);

  const NormalEquations equations = FormNormalEquations(FreeNetwork(graph, places));
  const OrderedFactor factor(equations.lower);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return std::nullopt;
  Eigen::MatrixXd by_pose = Eigen::MatrixXd::Zero(equations.right.size(), 2 * misfit.size());  // J'
  for (Index i = 0; i < misfit.size(); ++i) {
    const MarkEdge& mark = graph.marks[static_cast<std::size_t>(misfit.marks[static_cast<std::size_t>(i)])];
    const int column = equations.columns.of_pose[static_cast<std::size_t>(mark.pose)];
    if (column >= 0) by_pose.block<3, 2>(column, 2 * i) = PlaceByPose(graph, mark).transpose();
  }
  const Eigen::MatrixXd spread = factor.solve(by_pose);  // N^-1 J'
  const Eigen::VectorXd step = spread.transpose() * equations.right;
  misfit.of_network = Eigen::MatrixXd::Zero(2 * misfit.size(), 2 * misfit.size());

  std::vector<Eigen::Vector2d> places_now;
  misfit.misfit.resize(2 * misfit.size());
  for (Index i = 0; i < misfit.size(); ++i) {
    const MarkEdge& mark = graph.marks[static_cast<std::size_t>(misfit.marks[static_cast<std::size_t>(i)])];
    places_now.push_back(PoseOf(graph, mark) * mark.p_in_pose);
    const int column = equations.columns.of_pose[static_cast<std::size_t>(mark.pose)];
    if (column >= 0) misfit.of_network.middleRows<2>(2 * i) = PlaceByPose(graph, mark) * spread.middleRows<3>(column);
    misfit.misfit.segment<2>(2 * i) =
        misfit.given[static_cast<std::size_t>(i)] - places_now.back() - step.segment<2>(2 * i);
  }
  FillDatum(graph, places_now, &misfit);
  misfit.poses_with_marks = Eigen::MatrixXd::Zero(2 * static_cast<Index>(graph.poses.size()), 2 * misfit.size());
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    const int column = equations.columns.of_pose[i];
    if (column >= 0) misfit.poses_with_marks.middleRows<2>(2 * static_cast<Index>(i)) = spread.middleRows<2>(column);
  }
  return misfit;
}

}  // namespace survey
