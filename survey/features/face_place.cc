// SPDX-License-Identifier: Apache-2.0
#include "survey/features/face_place.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr int kRounds = 4;
// Hits farther from the face than this belong to something else; between the limits four times what they scatter.
constexpr double kLeastHalfWidthCells = 1.5;
constexpr double kLeastHalfWidth_m = 0.06;
constexpr double kMostHalfWidth_m = 0.12;
constexpr double kLeastColumn_m = 0.025;
constexpr std::size_t kMinColumns = 5;

// Hits of a short length of face: their mean place along it and mean distance before it.
struct Column {
  double along = 0.0;
  double before = 0.0;
  double hits = 0.0;
  double weight = 0.0;
};

// `scatter` becomes the rms distance of the hits from the face.
std::vector<Column> ColumnsOf(std::span<const HitCell> cells, const FaceStretch& face, double cell_size_m,
                              double* scatter) {
  const double width = std::max(cell_size_m / 2, kLeastColumn_m);
  const Vector2d along(-face.normal.y(), face.normal.x());
  const double least = std::max(kLeastHalfWidthCells * cell_size_m, kLeastHalfWidth_m);
  const double half_width = std::max(least, std::min(4.0 * *scatter, kMostHalfWidth_m));
  double squares = 0.0;
  double hits = 0.0;
  std::vector<Column> columns(static_cast<std::size_t>(std::max(1.0, std::ceil((face.to - face.from) / width))));
  for (const HitCell& cell : cells) {
    const double before = face.normal.dot(cell.p) - face.offset;
    const double place = along.dot(cell.p);
    if (std::abs(before) > half_width || place < face.from || place > face.to) continue;
    const auto i = static_cast<std::size_t>((place - face.from) / width);
    Column& column = columns[std::min(i, columns.size() - 1)];
    column.hits += cell.hits;
    column.along += cell.hits * place;
    column.before += cell.hits * before;
    squares += cell.hits * before * before;
    hits += cell.hits;
  }
  *scatter = hits > 0 ? std::sqrt(squares / hits) : 0.0;
  std::erase_if(columns, [](const Column& column) { return column.hits == 0; });
  for (Column& column : columns) {
    column.along /= column.hits;
    column.before /= column.hits;
    // Ever more hits of the same scans tell ever less.
    column.weight = column.hits / (column.hits + hits / static_cast<double>(columns.size()));
  }
  return columns;
}

template <typename Value>
double SumOver(const std::vector<Column>& columns, const Value& value_of) {
  double sum = 0.0;
  for (const Column& column : columns) sum += value_of(column);
  return sum;
}

double MomentOf(const std::vector<Column>& columns, double middle) {
  return SumOver(columns, [&](const Column& column) { return column.weight * std::pow(column.along - middle, 2); });
}

// before = offset + slope (along - middle).
struct ColumnLine {
  double middle = 0.0;
  double offset = 0.0;
  double slope = 0.0;
  double variance_offset = 0.0;
  double variance_slope = 0.0;
};

// How many times the variance of a mean grows by the correlation of neighbours: a first-order process, its correlation
// freed of the bias that a fitted line leaves in short rows [Tjostheim83].
double Inflation(const std::vector<double>& residuals) {
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    squares += residuals[i] * residuals[i];
    if (i > 0) products += residuals[i] * residuals[i - 1];
  }
  if (squares == 0.0) return 1.0;
  const auto n = static_cast<double>(residuals.size());
  const double seen = products / squares;
  const double correlation = std::clamp(seen + (2.0 + 4.0 * seen) / n, 0.0, 0.9);
  return (1.0 + correlation) / (1.0 - correlation);
}

// By weighted least squares.
ColumnLine LineThrough(const std::vector<Column>& columns) {
  const double weights = SumOver(columns, [](const Column& column) { return column.weight; });
  ColumnLine line;
  line.middle = SumOver(columns, [](const Column& column) { return column.weight * column.along; }) / weights;
  line.offset = SumOver(columns, [](const Column& column) { return column.weight * column.before; }) / weights;
  const double moment = MomentOf(columns, line.middle);
  line.slope =
      SumOver(columns,
              [&](const Column& column) { return column.weight * (column.along - line.middle) * column.before; }) /
      moment;
  return line;
}

// By the scatter of the columns about the line.
void EstimateSigmas(const std::vector<Column>& columns, ColumnLine* line) {
  std::vector<double> residuals;
  double squares = 0.0;
  for (const Column& column : columns) {
    residuals.push_back(column.before - line->offset - line->slope * (column.along - line->middle));
    squares += column.weight * residuals.back() * residuals.back();
  }
  const double weights = SumOver(columns, [](const Column& column) { return column.weight; });
  const double squared_weights = SumOver(columns, [](const Column& column) { return column.weight * column.weight; });
  const auto n = static_cast<double>(columns.size());
  // Two degrees of freedom are the line's, two more allow for how uncertain the scatter of so few columns is: the
  // variance of Student's t with n - 2 of them is (n - 2) / (n - 4).
  const double variance = squares / weights * n / std::max(1.0, n - 4.0) * Inflation(residuals);
  line->variance_offset = variance * squared_weights / (weights * weights);
  line->variance_slope = line->variance_offset * weights / MomentOf(columns, line->middle);
}

}  // namespace

std::optional<FacePlace> PlaceFace(std::span<const HitCell> cells, const FaceStretch& about, double cell_size_m) {
  FaceStretch face = about;
  ColumnLine line;
  double scatter = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Column> columns = ColumnsOf(cells, face, cell_size_m, &scatter);
    if (columns.size() < kMinColumns) return std::nullopt;
    line = LineThrough(columns);
    EstimateSigmas(columns, &line);
    const Vector2d along(-face.normal.y(), face.normal.x());
    const Vector2d middle = line.middle * along + (face.offset + line.offset) * face.normal;
    const double half_length = (face.to - face.from) / 2;
    const double centre = (face.from + face.to) / 2 - line.middle;
    face.normal = (face.normal - line.slope * along).normalized();
    const Vector2d turned_along(-face.normal.y(), face.normal.x());
    line.middle = turned_along.dot(middle);
    face.offset = face.normal.dot(middle);
    face.from = line.middle + centre - half_length;
    face.to = line.middle + centre + half_length;
  }
  return FacePlace{
      face.normal, face.offset, line.middle, std::sqrt(line.variance_offset), std::sqrt(line.variance_slope), scatter};
}

}  // namespace survey
