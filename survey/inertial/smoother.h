// SPDX-License-Identifier: Apache-2.0
//
// The future is known too: fixed-interval smoothing of the filter's steps, backwards ([Rauch65]). In a plane pipeline
// it serves three things: the biases and the tilt of the whole drive, and the poses of stretches that no scan match
// held, which the matches behind them tie down as well as those before.
#pragma once

#include <array>
#include <deque>
#include <functional>

#include "survey/inertial/error_state_filter.h"
#include "survey/sensors/session.h"

namespace survey {

// Upper triangle of a symmetric matrix.
class PackedCovariance {
 public:
  explicit PackedCovariance(const ErrorMatrix& full);
  ErrorMatrix Full() const;

 private:
  std::array<double, 120> upper_;
};

// The filter at one stamp, before and after its observations.
struct FilterStep {
  StampNs stamp_ns = 0;
  bool continues = false;  // `transition` leads here from the step before; false: the filter started anew
  ErrorTransition transition;
  InertialState predicted;
  PackedCovariance predicted_covariance;
  InertialState updated;
  PackedCovariance updated_covariance;
};

// Two to three kilobytes each, of which a long drive has many: not in one piece, which would be copied to grow.
using FilterSteps = std::deque<FilterStep>;

// Calls `visit` for every step with its smoothed state and covariance, from the last step to the first.
void Smooth(const FilterSteps& steps,
            const std::function<void(std::size_t step, const InertialState&, const ErrorMatrix&)>& visit);

}  // namespace survey
