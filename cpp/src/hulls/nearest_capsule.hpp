#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace pdoik::detail {

/// A ball swept along a segment, as the kernels read it.
struct Rod {
  float ax, ay, az;  ///< one end [m]
  float ux, uy, uz;  ///< unit vector to the other end, or any for a ball
  float length;      ///< [m]
  float radius;      ///< [m]
};

/// Of ends a and b and a radius, (7,).
Rod to_rod(const Eigen::Matrix<double, 7, 1>& capsule);

/// Points by coordinate, so that a loop over them is made of vector instructions.
struct PointRun {
  const float* x;
  const float* y;
  const float* z;
  int count;
};

/// gap[i] = min(gap[i], distance of point i to the segment - radius) [m]; own[i] = k where that is
/// less. Good to 1e-6 m within metres of the origin.
void lower_gaps(const PointRun& points, const Rod& rod, int k, float* gap, int* own);
/// The distance of one point to the segment, less the radius [m].
float gap_of(float x, float y, float z, const Rod& rod);

/// Points in groups of neighbours, in single precision: what lies far from all of a group need not
/// be looked at for each.
class PointGroups {
 public:
  PointGroups() = default;
  /// Of points in columns, which are put into an order of neighbours.
  explicit PointGroups(const Eigen::Matrix3Xf& points);

  int size() const { return static_cast<int>(points_.rows()); }
  Eigen::Vector3f point(int i) const { return points_.row(i).transpose(); }
  /// Those at ascending places of the order, in that order.
  PointGroups at(std::span<const int> places) const;

  /// The least gap of each point to one of the rods, and to which, (size(),); infinite and -1
  /// without rods.
  void nearest(std::span<const Rod> rods, Eigen::ArrayXf& gap, Eigen::ArrayXi& own) const;

 private:
  void bound();
  int groups() const { return static_cast<int>(reach_.size()); }

  Eigen::Matrix<float, Eigen::Dynamic, 3> points_;   // (P, 3)
  Eigen::Matrix<float, Eigen::Dynamic, 3> centers_;  // of the groups, (G, 3)
  Eigen::ArrayXf reach_;                             // of their points from those at most, (G,)
};

}  // namespace pdoik::detail
