#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "detail/clearance.hpp"
#include "detail/cloud_state.hpp"
#include "detail/complaint.hpp"
#include "detail/held.hpp"
#include "detail/model.hpp"
#include "detail/own_rows.hpp"
#include "detail/shape_clearance.hpp"

namespace pdoik::detail {

/// The obstacles of a solver, and what follows from them for its robot.
class Scene {
 public:
  using Points =
      Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
                 Eigen::OuterStride<>>;

  /// No obstacles, and room for as many as the options say. The model outlives it.
  explicit Scene(const Model& model);
  /// The same obstacles as another's.
  Scene(const Model& model, const Scene& other);

  /// A copy of points, to check and then to assign. Valid until the next. Allocates as `assign`.
  Points copied(const Points& points) {
    copy_.take(points);
    return copy_.rows();
  }
  /// Take in points of its own: (N, 3) or (N, 4) rows x y z [radius]. Allocates only if there are
  /// more than ever before, or another scene has the last ones.
  void assign(const Points& points);
  /// Take those of a cloud, as they are whenever `read` is asked.
  void use(std::shared_ptr<const CloudState> cloud);

  /// Take in shapes, beside the points.
  /// @throws std::invalid_argument  Contact is allowed with a link that the robot does not have.
  void use(std::shared_ptr<const ShapeSet> shapes);

  /// Let a link hold these as well.
  /// @throws std::invalid_argument  As HeldSolid; or one of them has the name of another.
  void attach(const std::string& link, std::span<const Shape> shapes,
              std::span<const std::string> may_touch);
  /// Let a link hold nothing.
  /// @throws std::invalid_argument  There is no such link.
  void detach(const std::string& link);
  /// What the robot holds from now on.
  void hold(Held::Solids solids);

  /// Held while a solve reads the obstacles, which stay as they are: brings up to date what follows
  /// from them. Everything that uses a scene begins with this.
  /// @throws std::invalid_argument  There is something to keep off, and the robot has no hulls.
  CloudState::Reading read();
  /// The same for who may not throw: it says so in a complaint, which is left alone else.
  CloudState::Reading read(Complaint& complaint);
  /// Whether `read` has found them changed since this was last asked.
  bool has_changed() { return std::exchange(changed_, false); }

  /// Radii grow by the clearance that is wanted.
  ObstacleView obstacles() const { return {points_, margin_}; }
  /// The places for points, whole lanes of them, when `read` was last asked.
  int padded_points() const { return padded_points_; }
  /// Another number whenever the points are others, and in each scene.
  std::uint64_t points_stamp() const { return points_stamp_; }
  const ShapePairs& shapes() const { return shapes_; }
  const Held& held() const { return held_; }
  /// Another number whenever what is held, or the shapes it is held among, are others, and in each
  /// scene.
  std::uint64_t held_stamp() const { return held_stamp_; }
  /// At most how many points are within the reach of moving hulls; none of the others can touch
  /// any.
  int within_reach() const { return within_reach_; }
  /// The deepest obstacle in a hull that no joint moves, if there is any.
  const Clearance& fixed() const { return fixed_; }
  /// The same among shapes, their distance without the clearance that is wanted.
  const ShapeClearance& fixed_to_shapes() const { return fixed_to_shapes_; }
  /// Whether there is one.
  bool base_collides() const {
    return fixed_.distance < -tolerance_ || fixed_to_shapes_.distance - margin_ < -tolerance_;
  }

  double intake = 0.0;  ///< what taking the points in took [s]

 private:
  void refresh();

  const Model& model_;
  const HullModel& hulls_;
  CollisionState fixed_hulls_;
  double margin_, tolerance_;
  std::shared_ptr<CloudState> own_;  ///< null while a cloud is used
  std::shared_ptr<const CloudState> cloud_;
  const ObstacleSet* points_ = nullptr;  ///< what is being read
  OwnRows copy_;
  CellOrder order_;
  Clearance fixed_;
  ShapePairs shapes_;
  ShapeClearance fixed_to_shapes_;
  Held held_;
  std::uint64_t held_stamp_, points_stamp_ = 0;
  int within_reach_ = 0, version_ = -1, padded_points_ = 0;
  bool changed_ = true;
};

}  // namespace pdoik::detail
