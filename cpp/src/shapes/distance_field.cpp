#include "pdoik/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/check_input.hpp"
#include "shapes/field_data.hpp"
#include "shapes/spread_distances.hpp"

namespace pdoik {

namespace detail {
namespace {

constexpr int kAlong = FieldData::kBrick + 1;  ///< values of a brick

}  // namespace

FieldData::FieldData(LargeVector<float> values, const std::array<int, 3>& counts, double cell)
    : values_(std::move(values)), counts_(counts), cell_(cell) {
  std::size_t bricks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    brick_counts_[a] = (counts[a] - 1 + kBrick - 1) / kBrick;
    bricks *= static_cast<std::size_t>(brick_counts_[a]);
  }
  bricks_.reserve(bricks);
  for (int i = 0; i < brick_counts_[0]; ++i) {
    for (int j = 0; j < brick_counts_[1]; ++j) {
      for (int k = 0; k < brick_counts_[2]; ++k)
        bricks_.push_back(measured({i * kBrick, j * kBrick, k * kBrick}));
    }
  }
  deepest_ = -std::min(0.0, static_cast<double>(*std::ranges::min_element(values_)));
  // A cell's slope along an axis is a mean of those of its four edges.
  float square = 0.0F;
  for (int i = 0; i + 1 < counts_[0]; ++i) {
    for (int j = 0; j + 1 < counts_[1]; ++j) {
      const float* rows[] = {at(i, j, 0), at(i, j + 1, 0), at(i + 1, j, 0), at(i + 1, j + 1, 0)};
      float x = 0.0F, y = 0.0F;  // of the cell's lower side along z
      for (int k = 0; k < counts_[2]; ++k) {
        const float a = rows[0][k], b = rows[1][k], c = rows[2][k], d = rows[3][k];
        const float upper_x = std::max(std::abs(c - a), std::abs(d - b)),
                    upper_y = std::max(std::abs(b - a), std::abs(d - c));
        if (k > 0) {
          float z = 0.0F;
          for (const float* row : rows) z = std::max(z, std::abs(row[k] - row[k - 1]));
          const float most_x = std::max(x, upper_x), most_y = std::max(y, upper_y);
          square = std::max(square, most_x * most_x + most_y * most_y + z * z);
        }
        x = upper_x;
        y = upper_y;
      }
    }
  }
  steepest_ = std::max(1.0, (1.0 + 1e-6) * std::sqrt(static_cast<double>(square)) / cell_);
}

Brick FieldData::measured(const std::array<int, 3>& first) const {
  int count[3];
  double half[3], squares[3];
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    count[a] = std::min(kAlong, counts_[axis] - first[axis]);
    half[a] = 0.5 * (count[a] - 1);
    squares[a] = 0.0;
    for (int n = 0; n < count[a]; ++n) squares[a] += (n - half[a]) * (n - half[a]);
  }
  float least = *at(first[0], first[1], first[2]);
  double sum = 0.0, along[3] = {0.0, 0.0, 0.0};
  const auto for_rows = [&](auto&& visit) {
    for (int i = 0; i < count[0]; ++i) {
      for (int j = 0; j < count[1]; ++j) visit(i, j, at(first[0] + i, first[1] + j, first[2]));
    }
  };
  for_rows([&](int i, int j, const float* row) {
    double here = 0.0;
    for (int k = 0; k < count[2]; ++k) {
      least = std::min(least, row[k]);
      const auto value = static_cast<double>(row[k]);
      here += value;
      along[2] += (k - half[2]) * value;
    }
    sum += here;
    along[0] += (i - half[0]) * here;
    along[1] += (j - half[1]) * here;
  });
  // Of values on a grid each slope of the best fit is found by itself.
  const double all = static_cast<double>(count[0]) * count[1] * count[2];
  Brick brick{};
  double middle = sum / all;
  for (int a = 0; a < 3; ++a) {
    const double slope = along[a] / (all / count[a] * squares[a]);
    brick.slope[a] = static_cast<float>(slope);
    middle += slope * (0.5 * kBrick - half[a]);
  }
  brick.least = least;
  brick.middle = static_cast<float>(middle);
  double off = 0.0;
  for_rows([&](int i, int j, const float* row) {
    for (int k = 0; k < count[2]; ++k) {
      const Vec4 place{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k), 0.0};
      off = std::max(off, std::abs(static_cast<double>(row[k]) - evenly(brick, {0, 0, 0}, place)));
    }
  });
  brick.off = std::nextafter(static_cast<float>(off), std::numeric_limits<float>::infinity());
  return brick;
}

}  // namespace detail

namespace {

using detail::LargeVector;

/// Values that change more or less than this times as fast as distances do are none.
constexpr double kTooFast = 2.0, kTooSlow = 0.5;
/// So many cells at most are asked how fast values change, spread over all.
constexpr std::size_t kMostAsked = 200'000;
/// The largest value is a truncation if this share of the cells hold it.
constexpr double kTruncatedShare = 0.1;
constexpr std::size_t kMostCells = std::size_t{1} << 30U;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

void check_cells(std::size_t values, const std::array<int, 3>& counts, double cell) {
  if (!(cell > 0.0 && cell <= detail::kLargestNumber))
    throw std::invalid_argument("cell is " + number(cell) +
                                ", expected a positive length of at most 1e6 m");
  std::size_t cells = 1;
  for (const int count : counts) {
    if (count < 2)
      throw std::invalid_argument("values has shape (" + std::to_string(counts[0]) + ", " +
                                  std::to_string(counts[1]) + ", " + std::to_string(counts[2]) +
                                  "), expected at least 2 cells along each axis");
    cells *= static_cast<std::size_t>(count);
    if (cells > kMostCells)
      throw std::invalid_argument("values has more than 2^30 cells: take larger ones");
  }
  if (cells != values)
    throw std::invalid_argument(std::to_string(values) + " values, expected " +
                                std::to_string(cells));
}

/// What the values of typical and of the steepest cells change by, per cell's edge; 0 if none does.
struct Slopes {
  double typical = 0.0, steepest = 0.0;
};

Slopes slopes(const LargeVector<float>& values, const std::array<int, 3>& counts, double cell,
              double truncation) {
  const auto K = static_cast<std::size_t>(counts[2]), JK = static_cast<std::size_t>(counts[1]) * K;
  const auto most = static_cast<float>(truncation);
  std::vector<float> found;
  const auto ask = [&](std::size_t step) {
    found.clear();
    for (std::size_t c = 0; c + JK + K + 1 < values.size(); c += step) {
      if (c % K + 1 == K || c % JK >= JK - K) continue;
      const float here = values[c];
      double square = 0.0;
      bool is_known = std::abs(here) < most;
      for (const std::size_t next : {c + 1, c + K, c + JK}) {
        is_known = is_known && std::abs(values[next]) < most;
        const double change = static_cast<double>(values[next] - here) / cell;
        square += change * change;
      }
      if (is_known && square > 0.0) found.push_back(static_cast<float>(std::sqrt(square)));
    }
  };
  // Odd, so that it goes through all places of a row.
  const std::size_t step = (values.size() / kMostAsked) | 1U;
  ask(step);
  if (found.size() < kMostAsked / 100 && step > 1) ask(1);  // few are near anything
  if (found.empty()) return {};
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
  std::ranges::nth_element(found, middle);
  return {static_cast<double>(*middle), static_cast<double>(*std::ranges::max_element(found))};
}

void check_slopes(const Slopes& slopes, double cell) {
  if (slopes.typical > kTooFast) {
    throw std::invalid_argument(
        "values change by " + number(slopes.typical * cell) + " from one cell to the next, which " +
        number(cell) +
        " m lie apart (typically), and distances in metres by no more than those: "
        "are they counted in cells, in millimetres or in shares of a truncation?");
  }
  if (slopes.steepest > 0.0 && slopes.steepest < kTooSlow) {
    throw std::invalid_argument(
        "values change by " + number(slopes.steepest * cell) +
        " at most from one cell to the "
        "next, which " +
        number(cell) +
        " m lie apart, and distances by as much where they come "
        "straight from something: is cell in millimetres, or are they no distances?");
  }
}

/// Distances differ by no more than the grid is wide. One number that is beyond that above all
/// others, or below, stands for what is not known: it becomes NaN, as what is no number does.
/// @returns Whether anything is known.
bool mark_unknown(LargeVector<float>& values, double diagonal) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  for (float& value : values) {
    if (!(std::abs(value) <= static_cast<float>(detail::kLargestNumber))) value = kUnknown;
  }
  for (const float sign : {1.0F, -1.0F}) {
    float least = std::numeric_limits<float>::infinity(), most = -least;
    for (const float value : values) {  // NaN is neither less nor more
      least = std::min(least, sign * value);
      most = std::max(most, sign * value);
    }
    if (least > most) return false;
    const float beyond = least + static_cast<float>(diagonal);
    const bool is_one = most > beyond && std::ranges::none_of(values, [&](float value) {
                          return sign * value > beyond && sign * value < most;
                        });
    if (is_one) std::ranges::replace(values, sign * most, kUnknown);
  }
  return true;
}

double found_truncation(const LargeVector<float>& values) {
  float most = 0.0F;
  std::size_t known = 0, held = 0;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    most = std::max(most, std::abs(value));
    ++known;
  }
  for (const float value : values) held += std::abs(value) >= 0.999F * most ? 1 : 0;
  return static_cast<double>(held) >= kTruncatedShare * static_cast<double>(known)
             ? static_cast<double>(most)
             : std::numeric_limits<double>::infinity();
}

}  // namespace

DistanceField::DistanceField(std::span<const float> given, const std::array<int, 3>& counts,
                             double cell, const Options& options) {
  if (std::isnan(options.truncation) || options.truncation == 0.0)
    throw std::invalid_argument("truncation is " + number(options.truncation) +
                                ", expected a positive length [m]");
  check_cells(given.size(), counts, cell);
  // Another thread may write into them meanwhile: the copy is checked.
  LargeVector<float> values(given.begin(), given.end());
  if (!mark_unknown(values, cell * std::hypot(counts[0], counts[1], counts[2]))) {
    throw std::invalid_argument(
        "no value is a number of at most 1e6: nothing is known of any cell");
  }
  const double truncation =
      options.truncation < 0.0 ? found_truncation(values) : options.truncation;
  check_slopes(slopes(values, counts, cell, truncation), cell);
  detail::spread_distances(values, counts, cell, truncation, options.unknown);
  data_ = std::make_shared<const detail::FieldData>(std::move(values), counts, cell);
}

const std::array<int, 3>& DistanceField::counts() const { return data_->counts(); }
double DistanceField::cell() const { return data_->cell(); }
std::span<const float> DistanceField::values() const { return data_->values(); }
double DistanceField::steepest() const { return data_->steepest(); }

}  // namespace pdoik
