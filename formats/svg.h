// SPDX-License-Identifier: Apache-2.0
//
// Pieces of inline SVG for the certificate's drawings; places in pixels, y down. `style` is a list of attributes.
#pragma once

#include <Eigen/Core>
#include <string>

#include "survey/accuracy/certificate.h"

namespace formats {

inline constexpr const char* kCheckColour = "#c0262c";

std::string Px(double value);

// The opening tag. Fonts stand in attributes: not every printer of pages hands style sheets down to drawings.
std::string BeginSvg(const Eigen::Vector2d& size);
std::string Line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const std::string& style);
std::string Circle(const Eigen::Vector2d& centre, double radius, const std::string& style);
std::string Label(const Eigen::Vector2d& at, const std::string& text, const std::string& style = "");
std::string Triangle(const Eigen::Vector2d& at, double r, const std::string& style);
std::string Square(const Eigen::Vector2d& at, double r, const std::string& style);

// A circle for points, a square for features; filled for blunders.
std::string CheckSymbol(survey::CheckKind kind, const Eigen::Vector2d& at, bool blunder);

// The largest of 1, 2, 5 times a power of ten that is not above `value`.
double RoundDown(double value);
std::string LengthText(double metres);  // "5 mm", "20 cm", "10 m"
std::string ScaleBar(const Eigen::Vector2d& at, double length, const std::string& text, const std::string& colour);

}  // namespace formats
