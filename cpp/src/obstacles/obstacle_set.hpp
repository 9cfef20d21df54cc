#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/frame.hpp"
#include "common/large_vector.hpp"
#include "obstacles/cell_order.hpp"
#include "simd/cull.hpp"

namespace pdoik::detail {

/// Obstacle points by coordinate: in double, and in single precision relative to an origin for the
/// coarse test.
///
/// A large cloud is put in order, cell by cell along a Z-curve, so that kLanes points in a row lie
/// close together; boxes around such blocks, around kLanes blocks (a group) and around kLanes
/// groups (a district) let the coarse test pass by what is far from a hull. A small one is faster
/// looked at whole. Points have places, not all of which need hold one.
class ObstacleSet {
 public:
  /// Clouds of more points than this are put in order.
  static constexpr int kLarge = 1024;
  /// Room for points that come later, as a share of those there are when it is made.
  static constexpr double kSpareShare = 0.05;

  void reserve(std::size_t count);

  /// Become another one, with no less room. Allocates nothing if there is as much already.
  void copy(const ObstacleSet& other);

  /// Take in `count` points. Allocates nothing if there is room.
  /// @param source  Vec4 source(int row) is x, y, z, radius, all finite; source.id(row) the point's
  /// number, source.prefetch(row) a hint that it will be wanted.
  template <class Source>
  void assign(int count, CellOrder& order, const Source& source);

  /// Begin a set of at most `count` points; `add` fills it and `finish` pads it.
  void begin(int count, const Eigen::Vector3d& origin);
  void add(const Vec4& point, int id) { put(count_++, point, id); }
  /// @param in_order  Whether points that were added one after the other lie close together.
  void finish(bool in_order = false);

  /// Take out the points in a box. Of a set in order only the blocks that it meets are looked at.
  /// @returns How many there were.
  int remove(const Eigen::AlignedBox3d& region);
  /// The same for these places, which may come in any order and more than once.
  int remove(std::vector<int> places);
  /// Add points, in places that `remove` has left if it has just been called, and else at the end.
  /// They get the ids from next_id() on. @returns false, and does nothing, if there is no room
  /// left: the set has to be made anew.
  bool insert(std::span<const Vec4> points, CellOrder& order);

  /// The points it holds.
  int count() const { return count_; }
  /// The places there are, of which some may be empty: operator[] and id() take one of them.
  int places() const { return places_; }
  bool holds(int place) const { return id(place) >= 0; }
  int next_id() const { return next_id_; }
  void set_next_id(int id) { next_id_ = id; }
  /// Whether neighbours in the list lie close together, so that blocks of them have boxes.
  bool in_order() const { return in_order_; }
  /// A few of them, spread over all: one of each block. Null if there are no boxes.
  const ObstacleSet* few() const { return in_order_ && few_ != nullptr ? few_.get() : nullptr; }
  int padded() const { return padded_; }
  const Vec4& origin() const { return origin_; }
  ObstacleArrays arrays() const {
    return {coarse_x_.data(), coarse_y_.data(), coarse_z_.data(), coarse_radius_.data(),
            padded_,          blocks_.arrays(), groups_.arrays(), districts_.arrays()};
  }
  /// x, y, z, radius.
  const Vec4& operator[](int place) const { return points_[static_cast<std::size_t>(place)]; }
  int id(int place) const { return index_[static_cast<std::size_t>(place)]; }
  /// The largest number among coarse coordinates and radii, at least 1 [m].
  double extent() const { return extent_; }
  /// How many points may come within a radius, less twice their own: at least as many as do.
  int count_within(const Eigen::Vector3d& centre, double radius) const;
  /// The memory that it takes [bytes].
  std::size_t bytes() const;

 private:
  /// Boxes around kLanes things each.
  struct Boxes {
    std::vector<float> low[3], high[3], radius;
    int count = 0, padded = 0;

    void reserve(std::size_t boxes);
    void resize(int boxes);
    /// Make box b that around boxes `first` to `end` of another level.
    void enclose(int b, const Boxes& inner, int first, int end);
    BoxArrays arrays() const {
      return {{low[0].data(), low[1].data(), low[2].data()},
              {high[0].data(), high[1].data(), high[2].data()},
              radius.data(),
              padded};
    }
  };
  /// Numbers, not a vector of them: it would be written to memory and read back in other pieces.
  void put(int place, double x, double y, double z, double radius, int id);
  void put(int place, const Vec4& point, int id) {
    put(place, point[0], point[1], point[2], point[3], id);
  }
  void clear(int place);
  /// Forget the places from the last one on up to the next full block.
  void pad();
  void resize_boxes();
  void box_block(int block);
  void box_group(int group);
  void box_district(int district);
  /// Put boxes, and what depends on them, right for blocks that have changed, ascending.
  void refit(const std::vector<int>& changed);
  void measure_extent();
  void grow_to(int places);
  /// Hold what a place of another set holds, or nothing where that is negative.
  void replace(int place, const ObstacleSet& source, int source_place);
  /// Calls visit(block) for each that a box meets.
  template <class Visit>
  void for_blocks_in(const Eigen::AlignedBox3f& box, Visit&& visit) const;

  LargeVector<Vec4> points_;
  LargeVector<float> coarse_x_, coarse_y_, coarse_z_, coarse_radius_;
  LargeVector<int> index_;
  Boxes blocks_, groups_, districts_;
  std::unique_ptr<ObstacleSet> few_;
  std::vector<int> changed_;  ///< blocks that the last `remove` made room in, ascending
  Vec4 origin_{};
  int count_ = 0, places_ = 0, padded_ = 0, next_id_ = 0;
  double extent_ = 1.0;
  bool in_order_ = false;
};

/// Points whose radii have grown by a margin, which may be negative, and for some hulls by another.
struct ObstacleView {
  /// @param own_in  By how much more for a hull, by its place in the occupancy: minus infinity if
  /// it may touch them. Null for nothing.
  ObstacleView(const ObstacleSet* points_in, double margin_in, const double* own_in = nullptr)
      : points(points_in), margin(margin_in), own(own_in) {}
  /// As they are.
  ObstacleView(const ObstacleSet& set) : ObstacleView(&set, 0.0) {}

  const ObstacleSet* operator->() const { return points; }
  const ObstacleSet& operator*() const { return *points; }
  /// x, y, z, radius, as they are for a hull with this place in the occupancy.
  Vec4 of(int source, int place) const {
    return (*points)[place] + Vec4{0.0, 0.0, 0.0, margin_of(source)};
  }
  /// The same for hulls that have no margin of their own.
  Vec4 operator[](int place) const { return (*points)[place] + Vec4{0.0, 0.0, 0.0, margin}; }
  double margin_of(int source) const {
    return own == nullptr ? margin : margin + own[static_cast<std::size_t>(source)];
  }

  const ObstacleSet* points;
  double margin;
  const double* own;
};

template <class Source>
void ObstacleSet::assign(int count, CellOrder& order, const Source& source) {
  if (count <= kLarge) {
    begin(count, Eigen::Vector3d::Zero());
    for (int i = 0; i < count; ++i) add(source(i), source.id(i));
    finish();
    return;
  }
  order.begin(count, source);
  for (int i = 0; i < count; ++i) order.add(source(i));
  const auto sorted = order.sorted();
  if (points_.capacity() < static_cast<std::size_t>(count))
    reserve(static_cast<std::size_t>((1.0 + kSpareShare) * count) + kLanes);
  begin(count, order.centre());
  for (int k = 0; k < count; ++k) {
    // Rows are fetched ahead of their turn, since their order in memory is another.
    constexpr int kAhead = 64;
    source.prefetch(sorted[static_cast<std::size_t>(std::min(k + kAhead, count - 1))].row);
    const int row = sorted[static_cast<std::size_t>(k)].row;
    add(source(row), source.id(row));
  }
  finish(true);
}

}  // namespace pdoik::detail
