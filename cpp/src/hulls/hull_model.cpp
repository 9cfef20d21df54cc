#include "hulls/hull_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "kinematics/reach.hpp"

namespace pdoik::detail {
namespace {

/// Move a point that lies on its joint's axis to the body before it, as far as that goes.
AttachedPoint settle(const Robot& robot, int body, Eigen::Vector3d local) {
  while (body > 0) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(body)];
    if (joint.prismatic || local.head<2>().norm() > 1e-12) break;
    local = joint.T_parent_joint * local;
    body = joint.parent;
  }
  return {body, to_vec4(local)};
}

int add_point(std::vector<AttachedPoint>& points, const AttachedPoint& point) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec4 gap = points[k].local - point.local;
    if (points[k].body == point.body && dot3(gap, gap) < 1e-24) return static_cast<int>(k);
  }
  points.push_back(point);
  return static_cast<int>(points.size()) - 1;
}

/// The link that a hull is given on and is rigid to; -1 for a spheroid whose foci move apart.
int link_of(const Robot& robot, const HullModel& model, const Hull& hull) {
  const auto [a, b] = links_of(robot, hull);
  for (const int link : {a, b})
    if (moves_with(robot, model, hull, robot.body_of_link(link))) return link;
  return -1;
}

/// Whether a body is another or comes after it.
bool is_from(const Robot& robot, int body, int first) {
  while (body > first) body = robot.bodies()[static_cast<std::size_t>(body)].parent;
  return body == first;
}

/// The capsules of one link and the hulls that say where to look for them.
class LinkCapsules {
 public:
  LinkCapsules(const Robot& robot, int link)
      : body_(robot.body_of_link(link)), T_body_link_(robot.T_body_link(link)) {}

  void add(const Capsule& capsule, int source) {
    ends_.push_back({T_body_link_ * capsule.a, T_body_link_ * capsule.b});
    radii_.push_back(capsule.radius);
    sources_.push_back(source);
  }
  int body() const { return body_; }
  std::size_t count() const { return ends_.size(); }
  int first_source() const { return sources_.front(); }

  /// By how much a hull with foci at p and q, in the body's frame, must grow to hold capsule k: the
  /// half sum of distances is convex, and changes no faster than the point moves.
  double excess(std::size_t k, const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                double semi_major) const {
    double farthest = 0.0;
    for (const Eigen::Vector3d& end : ends_[k])
      farthest = std::max(farthest, 0.5 * ((end - p).norm() + (end - q).norm()));
    return farthest + radii_[k] - semi_major;
  }

  /// The tightest spheroid about some of them that is easily found: of those about their principal
  /// axes and their own, with foci anywhere on them.
  void enclose(const std::vector<std::size_t>& chosen, Hull& hull) const {
    constexpr int kFoci = 40;
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& axis : axes_of(chosen)) {
      const Eigen::Matrix3d R =
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), axis).toRotationMatrix();
      Eigen::AlignedBox3d box;
      for (const std::size_t k : chosen) {
        const Eigen::Vector3d around = Eigen::Vector3d::Constant(radii_[k]);
        for (const Eigen::Vector3d& end : ends_[k])
          box.extend(R.transpose() * end - around).extend(R.transpose() * end + around);
      }
      const Eigen::Vector3d middle = R * box.center();
      for (int n = 0; n < kFoci; ++n) {
        const Eigen::Vector3d half = 0.5 * n / kFoci * box.sizes().x() * axis;
        double A = 0.0;
        for (const std::size_t k : chosen)
          A = std::max(A, excess(k, middle - half, middle + half, 0.0));
        const double volume = A * (A * A - half.squaredNorm());
        if (volume >= least) continue;
        least = volume;
        hull.middle = to_vec4(middle);
        hull.half = to_vec4(half);
        hull.around = A;
      }
    }
  }

  /// A ball that holds all.
  Eigen::Vector3d centre() const {
    Eigen::AlignedBox3d box;
    for (const auto& [a, b] : ends_) box.extend(a).extend(b);
    return box.center();
  }
  double radius_about(const Eigen::Vector3d& centre) const {
    double radius = 0.0;
    for (std::size_t k = 0; k < count(); ++k)
      radius = std::max(radius, excess(k, centre, centre, 0.0));
    return radius;
  }

  /// Put some of them into blocks.
  void write(const std::vector<std::size_t>& chosen, std::vector<CapsuleBlock>& blocks) const {
    for (std::size_t n = 0; n < chosen.size(); ++n) {
      if (n % 4 == 0) blocks.emplace_back();
      CapsuleBlock& block = blocks.back();
      const std::size_t k = chosen[n], i = n % 4;
      const Eigen::Vector3d &a = ends_[k][0], v = ends_[k][1] - a;
      block.ax[i] = a.x(), block.ay[i] = a.y(), block.az[i] = a.z();
      block.vx[i] = v.x(), block.vy[i] = v.y(), block.vz[i] = v.z();
      block.inverse[i] = v.squaredNorm() > 1e-24 ? 1.0 / v.squaredNorm() : 0.0;
      block.radius[i] = radii_[k];
      block.source[i] = sources_[k];
    }
  }

 private:
  /// Unit vectors.
  std::vector<Eigen::Vector3d> axes_of(const std::vector<std::size_t>& chosen) const {
    std::vector<Eigen::Vector3d> axes;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::size_t k : chosen) {
      sum += ends_[k][0] + ends_[k][1];
      const Eigen::Vector3d along = ends_[k][1] - ends_[k][0];
      if (along.norm() > 1e-9) axes.push_back(along.normalized());
    }
    const Eigen::Vector3d mean = sum / (2.0 * static_cast<double>(chosen.size()));
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const std::size_t k : chosen)
      for (const Eigen::Vector3d& end : ends_[k]) spread += (end - mean) * (end - mean).transpose();
    const Eigen::Matrix3d principal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
    for (int i = 0; i < 3; ++i) axes.emplace_back(principal.col(i));
    return axes;
  }

  int body_;
  Eigen::Isometry3d T_body_link_;
  std::vector<std::array<Eigen::Vector3d, 2>> ends_;
  std::vector<double> radii_;
  std::vector<int> sources_;
};

}  // namespace

bool ends_with(const Robot& robot, int body, int first) {
  if (body == first) return true;
  const auto& tips = robot.tips();
  return first > 0 && is_from(robot, body, first) &&
         std::none_of(tips.begin(), tips.end(), [&](int tip) {
           const int last = robot.body_of_link(tip);
           return last != first && is_from(robot, last, first);
         });
}

bool moves_with(const Robot& robot, int link, int settled, int body) {
  for (int b = robot.body_of_link(link); b >= 0;
       b = robot.bodies()[static_cast<std::size_t>(b)].parent) {
    if (b == body) return true;
    if (b == settled) break;
  }
  return false;
}

bool is_carried_by(const Robot& robot, const AttachedPoint& point, int body) {
  std::vector<int> between;  // the bodies from the point's to this one
  for (int b = body; b != point.body; b = robot.bodies()[static_cast<std::size_t>(b)].parent) {
    if (b <= 0) return false;  // the point's is not before it
    between.push_back(b);
  }
  Eigen::Vector3d local = to_vector3(point.local);
  for (auto b = between.rbegin(); b != between.rend(); ++b) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(*b)];
    local = joint.T_parent_joint.inverse() * local;
    if (joint.prismatic || local.head<2>().norm() > 1e-12) return false;
  }
  return true;
}

bool moves_with(const Robot& robot, const HullModel& model, const Hull& hull, int body) {
  if (hull.has_capsules() && hull.body == body) return true;
  const auto [a, b] = links_of(robot, hull);
  const auto settled = [&](int point) {
    return model.points[static_cast<std::size_t>(point)].body;
  };
  return moves_with(robot, a, settled(hull.a), body) && moves_with(robot, b, settled(hull.b), body);
}

std::pair<int, int> links_of(const Robot& robot, const Hull& hull) {
  return links_of_source(robot, hull.source);
}

std::pair<int, int> seat_of(const Robot& robot, const HullModel& model, const Hull& hull) {
  return hull.has_capsules() ? links_of_source(robot, model.capsules(hull)->source[0])
                             : links_of(robot, hull);
}

std::pair<int, int> links_of_source(const Robot& robot, int place) {
  const Occupancy& occupancy = robot.occupancy();
  const auto source = static_cast<std::size_t>(place);
  const std::size_t spheres = occupancy.spheres.size(), spheroids = occupancy.spheroids.size();
  const auto both = [&](const std::string& a, const std::string& b) {
    return std::pair(robot.link_index(a), robot.link_index(b));
  };
  if (source < spheres) return both(occupancy.spheres[source].link, occupancy.spheres[source].link);
  if (source < spheres + spheroids) {
    const Spheroid& s = occupancy.spheroids[source - spheres];
    return both(s.link_a, s.link_b);
  }
  const Capsule& capsule = occupancy.capsules[source - spheres - spheroids];
  return both(capsule.link, capsule.link);
}

void HullModel::give_capsules(const Robot& robot, std::vector<Hull>& hulls) {
  const Occupancy& occupancy = robot.occupancy();
  std::map<int, LinkCapsules> links;
  int source = static_cast<int>(occupancy.spheres.size() + occupancy.spheroids.size());
  for (const Capsule& capsule : occupancy.capsules) {
    const int link = robot.link_index(capsule.link);
    links.try_emplace(link, robot, link).first->second.add(capsule, source++);
  }
  if (links.empty()) return;
  std::vector<Eigen::Isometry3d> T_base_body(robot.bodies().size());
  robot.body_poses(robot.mid_configuration(), T_base_body);
  std::vector<Hull> kept;
  std::map<int, std::vector<Hull>> of_link;
  for (const Hull& hull : hulls) {
    const int link = link_of(robot, *this, hull);
    (links.contains(link) ? of_link[link] : kept).push_back(hull);
  }
  for (const auto& [link, capsules] : links) {
    std::vector<Hull>& around = of_link[link];
    if (around.empty()) {  // nobody said where to look
      const Eigen::Vector3d centre = capsules.centre();
      points.push_back({capsules.body(), to_vec4(centre)});
      const int at = static_cast<int>(points.size()) - 1;
      around.push_back({at, at, capsules.radius_about(centre), capsules.first_source()});
    }
    const Eigen::Isometry3d T_body_base =
        T_base_body[static_cast<std::size_t>(capsules.body())].inverse();
    const auto focus = [&](int point) {
      const AttachedPoint& p = points[static_cast<std::size_t>(point)];
      return Eigen::Vector3d(T_body_base * T_base_body[static_cast<std::size_t>(p.body)] *
                             to_vector3(p.local));
    };
    // Each goes to the hull that must grow least.
    std::vector<std::vector<std::size_t>> chosen(around.size());
    for (std::size_t k = 0; k < capsules.count(); ++k) {
      std::size_t best = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t h = 0; h < around.size(); ++h) {
        const Hull& hull = around[h];
        const double excess = capsules.excess(k, focus(hull.a), focus(hull.b), hull.semi_major);
        if (excess >= least) continue;
        least = excess;
        best = h;
      }
      chosen[best].push_back(k);
      around[best].excess = std::max(around[best].excess, least);
    }
    for (std::size_t h = 0; h < around.size(); ++h) {
      if (chosen[h].empty()) continue;  // what it holds is held by the others' capsules
      Hull& hull = around[h];
      hull.body = capsules.body();
      hull.first_block = static_cast<int>(blocks.size());
      capsules.write(chosen[h], blocks);
      capsules.enclose(chosen[h], hull);
      hull.blocks = static_cast<int>(blocks.size()) - hull.first_block;
      give_pieces(link, hull);
      kept.push_back(hull);
    }
  }
  hulls = std::move(kept);
}

void HullModel::give_pieces(int link, Hull& hull) {
  hull.first_piece = static_cast<int>(piece_ids.size());
  for (int k = 0; k < pieces->count(); ++k) {
    if (pieces->link(k) != link) continue;
    const auto reaches_into = [&](const CapsuleBlock& block, std::size_t i) {
      const Vec4 half = broadcast(0.5) * Vec4{block.vx[i], block.vy[i], block.vz[i], 0.0};
      const Vec4 middle = Vec4{block.ax[i], block.ay[i], block.az[i], 0.0} + half;
      const double radius = block.radius[i];
      const Solid& solid = pieces->solid(k);
      return solid.bound(middle, half, 0.0) < radius &&
             solid.distance(middle, half, radius).distance < radius;
    };
    for (int n = 0; n < 4 * hull.blocks; ++n) {
      const CapsuleBlock& block = capsules(hull)[n / 4];
      const auto i = static_cast<std::size_t>(n % 4);
      if (block.source[i] < 0 || !reaches_into(block, i)) continue;
      piece_ids.push_back(k);
      ++hull.pieces;
      break;
    }
  }
}

HullModel::HullModel(const Robot& robot)
    : HullModel(robot, true, std::make_shared<LinkPieces>(robot)) {}

HullModel::HullModel(const Robot& robot, bool with_fixed,
                     std::shared_ptr<const LinkPieces> pieces_in)
    : pieces(std::move(pieces_in)) {
  std::vector<Hull> hulls;
  const auto attach = [&](const std::string& link, const Eigen::Vector3d& xyz) {
    const int index = robot.link_index(link);
    return add_point(points,
                     settle(robot, robot.body_of_link(index), robot.T_body_link(index) * xyz));
  };
  int source = 0;
  const auto add = [&](int a, int b, double semi_major) {
    hulls.push_back({a, b, semi_major, source++});
  };
  for (const Sphere& sphere : robot.occupancy().spheres) {
    const int at = attach(sphere.link, sphere.center);
    add(at, at, sphere.radius);
  }
  for (const Spheroid& s : robot.occupancy().spheroids) {
    const int a = attach(s.link_a, s.focus_a), b = attach(s.link_b, s.focus_b);
    add(a, b, s.semi_major);
    Hull& hull = hulls.back();
    hull.rigid = false;
    for (int body = robot.body_of_link(robot.link_index(s.link_a)); body >= 0 && !hull.rigid;
         body = robot.bodies()[static_cast<std::size_t>(body)].parent)
      hull.rigid = moves_with(robot, *this, hull, body);
  }

  give_capsules(robot, hulls);
  for (const Hull& hull : hulls) {
    const bool stays = points[static_cast<std::size_t>(hull.a)].body == 0 &&
                       points[static_cast<std::size_t>(hull.b)].body == 0 && hull.body == 0;
    if (!stays)
      moving.push_back(hull);
    else if (with_fixed)
      fixed.push_back(hull);
  }

  double farthest = 0.0;
  int root = -1;
  bool common = true;
  for (const Hull& hull : moving) {
    for_each_arm(hull, [&](int body, double arm) {
      if (body == 0) return;
      const Reach r = reach_of(robot, body, arm);
      common = common && (root < 0 || r.root == root);
      root = r.root;
      farthest = std::max(farthest, r.distance);
    });
  }
  if (!common) return;  // several branches at the base
  if (root < 0) return;
  reach_centre = Reach{root}.centre(robot);
  reach = farthest * (1.0 + 1e-9);
}

}  // namespace pdoik::detail
