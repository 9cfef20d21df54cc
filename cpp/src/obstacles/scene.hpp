#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/input_error.hpp"
#include "hulls/hull_model.hpp"
#include "obstacles/clearance.hpp"
#include "obstacles/cloud_state.hpp"
#include "obstacles/own_rows.hpp"
#include "obstacles/pairs.hpp"
#include "pdoik/attachment.hpp"

namespace pdoik::detail {

/// The obstacles of a solver, and what follows from them for its robot.
class Scene {
 public:
  using Points =
      Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
                 Eigen::OuterStride<>>;

  /// No obstacles, and room for as many as the options say. All outlive it.
  Scene(const Robot& robot, const HullModel& hulls, const Options& options);
  /// The same obstacles as another's.
  Scene(const Scene& other);
  Scene& operator=(const Scene&) = delete;

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

  /// Take in shapes, beside the points, and rules of contact.
  /// @throws std::invalid_argument  A rule that is not optional speaks of what is not there, or
  /// lets points into hulls by a method that cannot.
  void use(std::shared_ptr<const ShapeSet> shapes);

  /// Attach these as well: all, or none if any cannot be.
  /// @throws std::invalid_argument  As AttachedSolid; one of them has the name of another; as
  /// check_contact_rule.
  void attach(std::span<const Attachment> things);
  /// The same to one link, where the solids may touch what has these names.
  void attach(const std::string& link, std::span<const Shape> shapes,
              std::span<const std::string> may_touch);
  /// What is attached, as it was given.
  std::vector<Attachment> attached() const;
  /// Detach all from a link: what is attached to others with it stays with these, if they move it.
  /// Or detach the object of this name.
  /// @throws std::invalid_argument  There is neither.
  void detach(const std::string& name);
  /// Detach all.
  void detach();

  /// Kept while a solve reads the obstacles, which stay as they are: brings up to date what follows
  /// from them. Everything that uses a scene begins with this.
  /// @throws std::invalid_argument  There is something to keep off, and the robot has no hulls.
  CloudState::Reading read();
  /// The same for who may not throw: it says so in an error, which is left alone else.
  CloudState::Reading read(InputError& error);
  /// Whether `read` has found them changed since this was last asked.
  bool has_changed() { return std::exchange(changed_, false); }

  /// What is kept off what, and how far.
  const Pairs& pairs() const { return pairs_; }
  /// The same as if all pairs whose contact counts had to keep as far off: what distances are.
  const Pairs& plain_pairs() const { return plain_ ? *plain_ : pairs_; }
  bool has_own_clearances() const { return plain_.has_value(); }

  /// Radii grow by the clearance that is wanted.
  ObstacleView obstacles() const { return obstacles(pairs_); }
  ObstacleView obstacles(const Pairs& pairs) const { return {points_, margin_, pairs.of_points()}; }
  /// The places for points, whole lanes of them, when `read` was last asked.
  int padded_points() const { return padded_points_; }
  /// Another number whenever the points are others, and in each scene.
  std::uint64_t points_stamp() const { return points_stamp_; }
  const ShapePairs& shapes() const { return pairs_.shapes; }
  const Attachments& attachments() const { return pairs_.attachments; }
  /// Another number whenever what is attached, or the shapes it is attached among, are others, and
  /// in each scene.
  std::uint64_t attachments_stamp() const { return attachments_stamp_; }
  /// Another number whenever the margins among links are others; 0 by the robot's ignored pairs
  /// alone.
  std::uint64_t links_stamp() const { return links_stamp_; }
  /// At most how many points are within the reach of moving hulls; none of the others can touch
  /// any.
  int within_reach() const { return within_reach_; }
  /// The deepest obstacle in a hull that no joint moves, if there is any.
  const Clearance& fixed() const { return fixed_; }
  /// The same among shapes, their distance without the clearance that is wanted.
  const ShapeClearance& fixed_to_shapes() const { return pairs_.fixed_to_shapes; }
  /// Whether there is one.
  bool base_collides() const {
    return fixed_.distance < -tolerance_ || fixed_to_shapes().distance - margin_ < -tolerance_;
  }

  double intake = 0.0;  ///< what taking the points in took [s]

 private:
  void refresh();
  /// Take in shapes and what is attached, or leave all as it was.
  /// @param anew  Whether the rules of the shapes have not been looked at.
  void take(std::shared_ptr<const ShapeSet> shapes, Attachments::Solids solids, bool anew);
  PairMargins margins_of(const ShapeSet& shapes, const Attachments::Solids& solids,
                         bool anew) const;

  const Robot& robot_;
  const HullModel& hulls_;
  const Options& options_;
  CollisionState fixed_hulls_;
  double margin_, tolerance_;
  std::shared_ptr<CloudState> own_;  ///< null while a cloud is used
  std::shared_ptr<const CloudState> cloud_;
  const ObstacleSet* points_ = nullptr;  ///< what is being read
  OwnRows copy_;
  CellOrder order_;
  Clearance fixed_;
  const PairMargins alone_;  ///< of the robot's links, without any rules
  Pairs pairs_;
  std::optional<Pairs> plain_;  ///< where some pair has a clearance of its own
  std::uint64_t attachments_stamp_, links_stamp_ = 0, points_stamp_ = 0;
  int within_reach_ = 0, version_ = -1, padded_points_ = 0;
  bool changed_ = true;
};

}  // namespace pdoik::detail
