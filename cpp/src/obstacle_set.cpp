#include "detail/obstacle_set.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

constexpr float kFarAway = 1e15F;  // squares and their products stay finite in single precision

int round_up(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

}  // namespace

void ObstacleSet::reserve(std::size_t count) {
  const auto padded = static_cast<std::size_t>(round_up(static_cast<int>(count)));
  points_.reserve(padded);
  index_.reserve(padded);
  for (std::vector<float>* v : {&coarse_x_, &coarse_y_, &coarse_z_, &coarse_radius_})
    v->reserve(padded);
  if (count <= static_cast<std::size_t>(kLanes * kLanes)) return;
  groups_.reserve(padded / kLanes / kLanes + 1);
  blocks_.reserve((padded / kLanes / kLanes + 1) * kLanes);
}

void ObstacleSet::begin(int count, const Eigen::Vector3d& origin) {
  const auto size = static_cast<std::size_t>(round_up(count));
  points_.resize(size);
  index_.resize(size);
  for (std::vector<float>* v : {&coarse_x_, &coarse_y_, &coarse_z_, &coarse_radius_})
    v->resize(size);
  origin_ = to_vec4(origin);
  count_ = 0;
}

void ObstacleSet::finish(bool in_order) {
  in_order_ = in_order;
  padded_ = round_up(count_);
  for (auto k = static_cast<std::size_t>(count_); k < static_cast<std::size_t>(padded_); ++k) {
    coarse_x_[k] = coarse_y_[k] = coarse_z_[k] = kFarAway;
    coarse_radius_[k] = 0.0F;
    index_[k] = -1;
  }
  float extent = 1.0F;
  blocks_.resize(0);
  groups_.resize(0);
  if (in_order && count_ > kLanes * kLanes) {
    box_points();
    box_blocks();
    for (std::size_t g = 0; g < static_cast<std::size_t>(groups_.count); ++g) {
      for (int axis = 0; axis < 3; ++axis) {
        extent =
            std::max({extent, std::abs(groups_.low[axis][g]), std::abs(groups_.high[axis][g])});
      }
      extent = std::max(extent, groups_.radius[g]);
    }
  } else {
    for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
      extent = std::max({extent, std::abs(coarse_x_[k]), std::abs(coarse_y_[k]),
                         std::abs(coarse_z_[k]), coarse_radius_[k]});
    }
  }
  extent_ = static_cast<double>(extent);
}

void ObstacleSet::Boxes::reserve(std::size_t boxes) {
  const std::size_t size = (boxes + kLanes - 1) / kLanes * kLanes;
  for (std::vector<float>* v : {&low[0], &low[1], &low[2], &high[0], &high[1], &high[2], &radius})
    v->reserve(size);
}

void ObstacleSet::Boxes::resize(int boxes) {
  count = boxes;
  padded = round_up(boxes);
  const auto size = static_cast<std::size_t>(padded);
  for (std::vector<float>* v : {&low[0], &low[1], &low[2], &high[0], &high[1], &high[2]})
    v->resize(size);
  radius.resize(size);
  for (auto b = static_cast<std::size_t>(boxes); b < size; ++b) {
    for (int axis = 0; axis < 3; ++axis) low[axis][b] = high[axis][b] = kFarAway;
    radius[b] = 0.0F;
  }
}

void ObstacleSet::box_points() {
  blocks_.resize(padded_ / kLanes);
  const std::vector<float>* coordinate[] = {&coarse_x_, &coarse_y_, &coarse_z_};
  for (int b = 0; b < blocks_.count; ++b) {
    const int first = b * kLanes, end = std::min(first + kLanes, count_);
    const auto at = static_cast<std::size_t>(b);
    for (int axis = 0; axis < 3; ++axis) {
      const float* const v = coordinate[axis]->data();
      float low = v[first], high = v[first];
      for (int k = first + 1; k < end; ++k) {
        low = std::min(low, v[k]);
        high = std::max(high, v[k]);
      }
      blocks_.low[axis][at] = low;
      blocks_.high[axis][at] = high;
    }
    blocks_.radius[at] =
        *std::max_element(coarse_radius_.data() + first, coarse_radius_.data() + end);
  }
}

void ObstacleSet::box_blocks() {
  const int blocks = blocks_.count;
  groups_.resize((blocks + kLanes - 1) / kLanes);
  for (int g = 0; g < groups_.count; ++g) {
    const auto at = static_cast<std::size_t>(g);
    const int first = g * kLanes, end = std::min(first + kLanes, blocks);
    for (int axis = 0; axis < 3; ++axis) {
      const float *const low = blocks_.low[axis].data(), *const high = blocks_.high[axis].data();
      groups_.low[axis][at] = *std::min_element(low + first, low + end);
      groups_.high[axis][at] = *std::max_element(high + first, high + end);
    }
    groups_.radius[at] =
        *std::max_element(blocks_.radius.data() + first, blocks_.radius.data() + end);
  }
}

namespace {

/// A side of cells for a cloud of this many points.
int side_for(std::size_t count) { return count > (1U << 17U) ? 64 : 32; }

/// The six lowest bits of v with two zeros between each.
std::uint32_t spread(std::uint32_t v) {
  v = (v | (v << 8U)) & 0x0000F00FU;
  v = (v | (v << 4U)) & 0x000C30C3U;
  return (v | (v << 2U)) & 0x00249249U;
}

}  // namespace

void CellOrder::reserve(std::size_t count) {
  cell_.reserve(count);
  sorted_.reserve(count);
  const auto side = static_cast<std::size_t>(side_for(count));
  first_.reserve(2 * side * side * side + 1);
}

void CellOrder::begin(int count, const Eigen::Vector3d& origin, double half_side,
                      double far_half_side) {
  side_ = side_for(static_cast<std::size_t>(count));
  origin_ = origin;
  scale_[0] = 0.5 * side_ / half_side;
  scale_[1] = 0.5 * side_ / far_half_side;
  near_count_ = 0;
  cell_.clear();
  first_.assign(static_cast<std::size_t>(2 * side_ * side_ * side_) + 1, 0);
}

void CellOrder::add(double x, double y, double z, bool is_far) {
  const double scale = scale_[is_far ? 1 : 0], half = 0.5 * side_, last = side_ - 1.0;
  const auto cell = [&](double value, Eigen::Index axis) {
    return static_cast<std::uint32_t>(
        std::min(std::max((value - origin_[axis]) * scale + half, 0.0), last));
  };
  std::uint32_t key = spread(cell(x, 0)) | spread(cell(y, 1)) << 1U | spread(cell(z, 2)) << 2U;
  if (is_far)
    key += static_cast<std::uint32_t>(side_ * side_ * side_);
  else
    ++near_count_;
  cell_.push_back(key);
  ++first_[key + 1];
}

const std::vector<int>& CellOrder::sorted() {
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  sorted_.resize(cell_.size());
  for (std::size_t k = 0; k < cell_.size(); ++k)
    sorted_[static_cast<std::size_t>(first_[cell_[k]]++)] = static_cast<int>(k);
  return sorted_;
}

}  // namespace pdoik::detail
