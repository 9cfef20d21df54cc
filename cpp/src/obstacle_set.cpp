#include "detail/obstacle_set.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

constexpr int kGroup = kLanes * kLanes;  // points
constexpr float kFarAway = 1e15F;  // squares and their products stay finite in single precision

template <class Integer>
Integer round_up(Integer count) {
  constexpr auto lanes = static_cast<Integer>(kLanes);
  return (count + lanes - 1) / lanes * lanes;
}

}  // namespace

void ObstacleSet::reserve(std::size_t count) {
  const std::size_t padded = round_up(count);
  points_.reserve(padded);
  index_.reserve(padded);
  for (std::vector<float>* v : {&coarse_x_, &coarse_y_, &coarse_z_, &coarse_radius_})
    v->reserve(padded);
  if (count <= static_cast<std::size_t>(kGroup)) return;
  const std::size_t groups = padded / kGroup + 1;
  groups_.reserve(groups);
  blocks_.reserve(groups * kLanes);
  if (few_ == nullptr) few_ = std::make_unique<ObstacleSet>();
  few_->reserve(groups);
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
  if (in_order && count_ > kGroup) {
    box_points();
    box_blocks();
    pick_few();
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
  const std::size_t size = round_up(boxes);
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

void ObstacleSet::pick_few() {
  if (few_ == nullptr) few_ = std::make_unique<ObstacleSet>();
  few_->begin(groups_.count, to_vector3(origin_));
  for (int first = 0; first < count_; first += kGroup) {
    const int k = first + std::min(kGroup, count_ - first) / 2;
    const Vec4& o = (*this)[k];
    few_->add(o[0], o[1], o[2], o[3], original_index(k));
  }
  few_->finish(true);
}

namespace {

/// A side of cells for a cloud of this many points.
int side_for(std::size_t count) { return count > (1U << 17U) ? 64 : 32; }

}  // namespace

void CellOrder::reserve(std::size_t count) {
  cell_.reserve(count);
  sorted_.reserve(count);
  const auto side = static_cast<std::size_t>(side_for(count));
  first_.reserve(2 * side * side * side + 1);
}

void CellOrder::begin(int count, const Eigen::Vector3d& origin, double half_side,
                      double far_half_side) {
  const int side = side_for(static_cast<std::size_t>(count));
  origin_ = origin;
  half_ = 0.5 * side;
  last_ = side - 1.0;
  scale_[0] = half_ / half_side;
  scale_[1] = half_ / far_half_side;
  far_cells_ = static_cast<std::uint32_t>(side * side * side);
  cell_.resize(static_cast<std::size_t>(count));
  count_ = 0;
  first_.assign(2 * static_cast<std::size_t>(far_cells_) + 1, 0);
}

const std::vector<int>& CellOrder::sorted() {
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  near_count_ = first_[far_cells_];
  sorted_.resize(count_);
  for (std::size_t k = 0; k < count_; ++k)
    sorted_[static_cast<std::size_t>(first_[cell_[k]]++)] = static_cast<int>(k);
  return sorted_;
}

}  // namespace pdoik::detail
