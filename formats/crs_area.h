// SPDX-License-Identifier: Apache-2.0
//
// Where on Earth a projected coordinate system is meant to be used.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "survey/control/control_point.h"

namespace formats {

class CrsArea {
 public:
  // UsageError when the CRS is not known or not projected.
  explicit CrsArea(const std::string& crs);
  ~CrsArea();
  CrsArea(const CrsArea&) = delete;
  CrsArea& operator=(const CrsArea&) = delete;

  // False also for coordinates that the projection cannot invert. True everywhere when the area is not on record.
  bool Contains(const Eigen::Vector2d& east_north) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Refuses coordinates that lie outside the CRS's area of use but inside it when exchanged, with both readings; warns of
// others outside. `where` by point; empty crs: nothing is checked.
void CheckControlArea(const std::vector<survey::ControlPoint>& points, const std::string& crs,
                      const std::vector<std::string>& where, std::vector<std::string>* warnings);

}  // namespace formats
