// SPDX-License-Identifier: Apache-2.0
//
// Observations of a file, by the names of their points, gathered cluster by cluster until all points are known.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "survey/network/network.h"

namespace formats {

struct NamedObservation {
  survey::Observation observation;  // without indices
  std::string from, to, fore;
  double covariance_unit = 1.0;  // of the file's covariances, with sign: m or rad
};

class NetworkClusters {
 public:
  // DataError when the point is already there.
  void AddPoint(const survey::NetworkPoint& point, const std::string& where);
  bool HasPoint(const std::string& name) const { return index_.contains(name); }
  survey::NetworkPoint* Point(const std::string& name);  // null when there is none

  // Directions between Begin and End are one set.
  void Begin();
  void Add(NamedObservation observation, const std::string& where);
  // Upper part of the covariance matrix of the cluster's observations, row by row within the band.
  void SetCovariance(const std::vector<double>& numbers, int size, int band, const std::string& where);
  void End();

  // Observations with points that the network does not have, or does not use in this way, are left out and warned of.
  void MoveInto(survey::Network* network, std::vector<std::string>* warnings);

 private:
  struct Cluster {
    std::vector<NamedObservation> observations;
    std::vector<std::string> where;
    Eigen::MatrixXd covariance;  // empty: by sigmas
  };

  bool Resolve(NamedObservation* named) const;
  void AddCluster(Cluster& cluster, survey::Network* network, std::vector<std::string>* left_out) const;

  std::vector<survey::NetworkPoint> points_;
  std::vector<std::string> point_where_;
  std::map<std::string, int> index_;
  std::vector<Cluster> clusters_;
  std::size_t num_observations_ = 0;
};

}  // namespace formats
