#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "search/workspace.hpp"

namespace pdoik::detail {

/// Whether straight ways between configurations are clear of everything, by intervals. In the
/// middle of an interval each hull is asked whether anything is nearer than it gets inside the
/// interval; if not it is done with, else its halves are looked at, down to what could be grazed by
/// less than a tenth of a millimetre. Two hulls are asked the same of what moves them against each
/// other. So most hulls are looked at once, and few where they are near something.
class Sweep {
 public:
  /// Distances beyond this are not measured [m].
  static constexpr double kLook = 0.6;

  /// The workspace outlives it, and its scene stays what it is.
  explicit Sweep(Workspace& workspace);

  /// Room before contact with obstacles, and with itself; negative in it [m].
  struct Room {
    double obstacles = 0.0, self = 0.0;
  };
  Room room(const Result& verdict) const;
  /// The room of a configuration. Whose goals they are counts for what may be touched.
  Room room_at(std::span<const Goal> goals, const Eigen::VectorXd& q);

  /// Whether all between two configurations is clear.
  bool is_clear_between(std::span<const Goal> goals, const Eigen::VectorXd& from,
                        const Eigen::VectorXd& to);
  /// The same where the room at both ends is known, which mostly tells.
  bool is_clear_between(std::span<const Goal> goals, const Eigen::VectorXd& from,
                        const Eigen::VectorXd& to, const Room& one, const Room& other);

  /// The verdict on where a way was last found to be in something.
  const Result& fault();
  int looks() const { return looks_; }

 private:
  /// What is asked: a hull, a pair of hulls, or what is attached.
  using Asked = std::vector<int>;
  enum class Answer { Clear, Near, Touches };

  bool is_clear_within(double middle, double half, const Asked& asked, std::size_t depth);
  void place(double at);
  /// What of something is nearer than what it gets within a share of the way either side.
  Answer answer(int asked, double share);
  Answer of_hull(int hull, double way);
  Answer of_pair(int pair, double way);
  Answer of_attached(int attached, double way);
  /// How far a hull gets within a share of the way, seen from a body that carries it.
  double way_of(int hull, int carrier, double share) const;
  /// What is nearer than what it gets, by a question whether it is nearer than a distance.
  template <class IsNear>
  Answer told_by(double way, double reach, IsNear&& is_near) const;
  /// How much nearer a shape may be said to be once a hull has moved so far.
  double by_shapes(double than) const;
  int common_body(int one, int other) const;

  struct Pair {
    int hulls[2];
    int common;  ///< the last body that both are carried by
  };

  Workspace& workspace_;
  const Model& model_;
  CollisionState state_;
  HullCapsules capsules_;
  std::optional<SelfCollision> self_;
  std::optional<AttachmentClearance> attachments_;
  std::vector<Hull> all_;
  std::vector<Pair> pairs_;
  double finest_;
  Asked everything_;
  std::vector<Asked> left_;  ///< of each depth
  int looks_ = 0;
  std::span<const Goal> goals_;
  const Eigen::VectorXd *from_ = nullptr, *to_ = nullptr;
  Eigen::VectorXd at_, step_, displacement_bounds_, attachment_bounds_, fault_q_;
  Result probe_, fault_;
};

}  // namespace pdoik::detail
