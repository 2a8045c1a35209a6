// SPDX-License-Identifier: Apache-2.0
//
// Values in JSON: what is not there is null, vectors are {"e", "n"}, covariances {"ee", "en", "nn"}.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>

namespace nlohmann {

// A value that is not there is null.
template <typename T>
struct adl_serializer<std::optional<T>> {
  static void to_json(json& j, const std::optional<T>& value) {
    if (value) {
      j = *value;
    } else {
      j = nullptr;
    }
  }
  static void from_json(const json& j, std::optional<T>& value) {
    value = j.is_null() ? std::nullopt : std::optional<T>(j.get<T>());
  }
};

template <>
struct adl_serializer<Eigen::Vector2d> {
  static void to_json(json& j, const Eigen::Vector2d& v) { j = {{"e", v.x()}, {"n", v.y()}}; }
  static void from_json(const json& j, Eigen::Vector2d& v) { v = {j.at("e").get<double>(), j.at("n").get<double>()}; }
};

template <>
struct adl_serializer<Eigen::Matrix2d> {
  static void to_json(json& j, const Eigen::Matrix2d& m) { j = {{"ee", m(0, 0)}, {"en", m(0, 1)}, {"nn", m(1, 1)}}; }
  static void from_json(const json& j, Eigen::Matrix2d& m) {
    m(0, 0) = j.at("ee").get<double>();
    m(0, 1) = m(1, 0) = j.at("en").get<double>();
    m(1, 1) = j.at("nn").get<double>();
  }
};

}  // namespace nlohmann
