#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "detail/frame.hpp"
#include "simd/cull.hpp"

namespace pdoik::detail {

/// Obstacle points by coordinate: in double, and in single precision relative to an origin for the
/// coarse test.
///
/// A large cloud is put in order, cell by cell along a Z-curve, so that kLanes points in a row lie
/// close together; boxes around such blocks, and around kLanes blocks each, let the coarse test
/// pass by what is far from a hull. A small one is faster looked at whole.
class ObstacleSet {
 public:
  /// Clouds of more points than this are put in order.
  static constexpr int kLarge = 4096;

  void reserve(std::size_t count);

  /// Begin a set of at most `count` points; `add` fills it and `finish` pads it.
  void begin(int count, const Eigen::Vector3d& origin);
  void add(double x, double y, double z, double radius, int original_index) {
    const auto k = static_cast<std::size_t>(count_++);
    points_[k] = Vec4{x, y, z, radius};
    index_[k] = original_index;
    coarse_x_[k] = static_cast<float>(x - origin_[0]);
    coarse_y_[k] = static_cast<float>(y - origin_[1]);
    coarse_z_[k] = static_cast<float>(z - origin_[2]);
    // A negative radius lets a point into a hull by its distance from the surface, which reaches
    // deeper than a smaller spheroid's border does: the coarse test takes the hull as it is.
    coarse_radius_[k] = radius > 0.0 ? static_cast<float>(radius) : 0.0F;
  }
  /// @param in_order  Whether points that were added one after the other lie close together.
  void finish(bool in_order = false);

  int count() const { return count_; }
  /// Whether neighbours in the list lie close together, so that blocks of them have boxes.
  bool in_order() const { return in_order_; }
  /// A few of them, spread over all: one of each group that has a box. Null if there are no boxes.
  const ObstacleSet* few() const { return blocks_.count > 0 ? few_.get() : nullptr; }
  int padded() const { return padded_; }
  const Vec4& origin() const { return origin_; }
  ObstacleArrays arrays() const {
    return {coarse_x_.data(), coarse_y_.data(), coarse_z_.data(), coarse_radius_.data(),
            padded_,          blocks_.arrays(), groups_.arrays()};
  }
  /// x, y, z, radius.
  const Vec4& operator[](int j) const { return points_[static_cast<std::size_t>(j)]; }
  int original_index(int j) const { return index_[static_cast<std::size_t>(j)]; }
  /// The largest number among coarse coordinates and radii, at least 1 [m].
  double extent() const { return extent_; }

 private:
  /// Boxes around kLanes things each.
  struct Boxes {
    std::vector<float> low[3], high[3], radius;
    int count = 0, padded = 0;

    void reserve(std::size_t boxes);
    void resize(int boxes);
    BoxArrays arrays() const {
      return {{low[0].data(), low[1].data(), low[2].data()},
              {high[0].data(), high[1].data(), high[2].data()},
              radius.data(),
              padded};
    }
  };
  void box_points();
  void box_blocks();
  void pick_few();

  std::vector<Vec4> points_;
  std::vector<float> coarse_x_, coarse_y_, coarse_z_, coarse_radius_;
  std::vector<int> index_;
  Boxes blocks_, groups_;
  std::unique_ptr<ObstacleSet> few_;
  Vec4 origin_{};
  int count_ = 0, padded_ = 0;
  double extent_ = 1.0;
  bool in_order_ = false;
};

/// Puts points in the order of the cells that they lie in, in linear time: cells of a cube about
/// the origin, 32 or 64 a side, along a Z-curve; what lies outside counts to the cells at its
/// border. Points that are called far come after the others, in the cells of a cube of their own.
class CellOrder {
 public:
  void reserve(std::size_t count);
  /// @param half_side, far_half_side  How far the cubes reach to each side of the origin [m].
  void begin(int count, const Eigen::Vector3d& origin, double half_side, double far_half_side);
  void add(double x, double y, double z, bool is_far) {
    const double scale = scale_[is_far ? 1 : 0];
    const auto cell = [&](double from_origin) {
      return static_cast<std::uint32_t>(
          std::min(std::max(from_origin * scale + half_, 0.0), last_));
    };
    const std::uint32_t key = spread(cell(x - origin_[0])) | spread(cell(y - origin_[1])) << 1U |
                              spread(cell(z - origin_[2])) << 2U | (is_far ? far_cells_ : 0U);
    cell_[count_++] = key;
    ++first_[key + 1];
  }
  /// The points by the order in which they were added. Valid until the next begin.
  const std::vector<int>& sorted();
  /// How many are not far, known once they are sorted.
  int near_count() const { return near_count_; }

 private:
  /// The six lowest bits of v with two zeros between each.
  static std::uint32_t spread(std::uint32_t v) {
    v = (v | (v << 8U)) & 0x0000F00FU;
    v = (v | (v << 4U)) & 0x000C30C3U;
    return (v | (v << 2U)) & 0x00249249U;
  }

  std::vector<std::uint32_t> cell_;
  std::vector<int> sorted_, first_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double scale_[2] = {1.0, 1.0}, half_ = 16.0, last_ = 31.0;  ///< of a side's cells
  std::uint32_t far_cells_ = 0;                               ///< the first of them
  std::size_t count_ = 0;
  int near_count_ = 0;
};

}  // namespace pdoik::detail
