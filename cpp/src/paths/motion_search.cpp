#include "paths/motion_search.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

/// A tree goes this far towards a sample, at most: the two meet in between [rad] or [m].
constexpr double kRange = 1.0;
/// What is not worth a node [rad] or [m].
constexpr double kTiny = 1e-3;
/// Shortening ends when so many attempts in a row gain nothing.
constexpr int kIdle = 30;
/// What a shortcut has to gain of the length.
constexpr double kWorth = 5e-3;
/// Joints without limits are sampled within half a turn of zero, slides within a metre.
constexpr double kFreely = M_PI;

}  // namespace

double length_of(const MotionSearch::Way& way) {
  double sum = 0.0;
  for (std::size_t k = 1; k < way.size(); ++k) sum += (way[k] - way[k - 1]).norm();
  return sum;
}

MotionSearch::MotionSearch(Workspace& workspace, Sweep& sweep, std::span<const Goal> goals,
                           const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                           const Deadline& deadline)
    : workspace_(workspace),
      sweep_(sweep),
      goals_(goals),
      lower_(lower),
      upper_(upper),
      deadline_(deadline) {}

void MotionSearch::Tree::add(const Eigen::VectorXd& q, int parent) {
  configurations.insert(configurations.end(), q.data(), q.data() + q.size());
  parents.push_back(parent);
}

int MotionSearch::Tree::nearest(const Eigen::VectorXd& q) const {
  const Eigen::Map<const Eigen::MatrixXd> all(configurations.data(), dof_, size());
  Eigen::Index best = 0;
  (all.colwise() - q).colwise().squaredNorm().minCoeff(&best);
  return static_cast<int>(best);
}

double MotionSearch::random() {  // xorshift64*
  state_ ^= state_ >> 12;
  state_ ^= state_ << 25;
  state_ ^= state_ >> 27;
  return static_cast<double>((state_ * 0x2545F4914F6CDD1DULL) >> 11) * 0x1.0p-53;
}

void MotionSearch::sample(Eigen::VectorXd& q) {
  const Model& model = workspace_.model();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!model.matters[static_cast<std::size_t>(i)] || lower_[i] == upper_[i]) continue;
    const bool bounded = std::isfinite(lower_[i]) && std::isfinite(upper_[i]);
    const double low = bounded ? lower_[i] : -kFreely, high = bounded ? upper_[i] : kFreely;
    q[i] = low + random() * (high - low);
  }
}

bool MotionSearch::is_clear(const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
  return sweep_.is_clear_between(goals_, one, other);
}

double MotionSearch::grow(Tree& tree, int from, const Eigen::VectorXd& to, bool all_or_nothing) {
  const Eigen::VectorXd start = tree.q(from);
  for (double share = 1.0; share > 0.1; share *= 0.5) {
    const Eigen::VectorXd end = share == 1.0 ? to : start + share * (to - start);
    if ((end - start).norm() < kTiny) return 0.0;
    if (is_clear(start, end)) {
      tree.add(end, from);
      return share;
    }
    if (all_or_nothing) return 0.0;
  }
  return 0.0;
}

MotionSearch::Way MotionSearch::way_to(const Tree& tree, int node) const {
  Way way;
  for (int k = node; k >= 0; k = tree.parents[static_cast<std::size_t>(k)])
    way.emplace_back(tree.q(k));
  std::reverse(way.begin(), way.end());
  return way;
}

std::optional<MotionSearch::Way> MotionSearch::find(const Eigen::VectorXd& from, const Way& to,
                                                    int& reached) {
  workspace_.watch(deadline_);
  std::vector<int> order(to.size());
  for (std::size_t k = 0; k < to.size(); ++k) order[k] = static_cast<int>(k);
  const auto goal = [&](int k) -> const Eigen::VectorXd& {
    return to[static_cast<std::size_t>(k)];
  };
  std::ranges::stable_sort(order, {}, [&](int k) { return (goal(k) - from).squaredNorm(); });
  for (const int k : order) {  // what is nearest may be had at once
    if (deadline_.passed()) return std::nullopt;
    if (!is_clear(from, goal(k))) continue;
    reached = k;
    return Way{from, goal(k)};
  }
  Tree trees[] = {Tree(from.size()), Tree(from.size())};
  trees[0].add(from, -1);
  for (const int k : order) trees[1].add(goal(k), -1);
  Eigen::VectorXd q = from;
  for (int turn = 0; !deadline_.passed(); ++turn) {
    Tree &one = trees[turn % 2], &other = trees[1 - turn % 2];
    q = from;
    sample(q);
    const int near = one.nearest(q);
    const double distance = (q - one.q(near)).norm();
    if (distance > kRange) q = one.q(near) + (kRange / distance) * (q - one.q(near));
    if (grow(one, near, q, false) == 0.0) continue;
    // The other tree comes to it, in steps of the same size.
    const int tip = one.size() - 1;
    const Eigen::VectorXd meeting = one.q(tip);
    bool met = false;
    for (int last = other.nearest(meeting);;) {
      const double left = (meeting - other.q(last)).norm();
      const bool is_last = left <= kRange;
      if (is_last)
        q = meeting;
      else
        q = other.q(last) + (kRange / left) * (meeting - other.q(last));
      const double share = grow(other, last, q, is_last);
      if (share == 0.0) break;
      last = other.size() - 1;
      met = is_last;
      if (is_last || share < 1.0) break;
    }
    if (!met) continue;
    const bool forward = turn % 2 == 0;
    const int last = other.size() - 1;
    Way way = way_to(trees[0], forward ? tip : last), back = way_to(trees[1], forward ? last : tip);
    for (std::size_t k = 0; k < to.size(); ++k) {
      if (to[k] == back.front()) reached = static_cast<int>(k);
    }
    std::reverse(back.begin(), back.end());
    way.insert(way.end(), back.begin() + 1, back.end());
    return way;
  }
  return std::nullopt;
}

void MotionSearch::shorten(Way& way, double seconds) {
  // Between two places of it, anywhere on its lines.
  const double end = deadline_.elapsed() + seconds;
  const auto place_at = [&](double at, std::size_t& line) -> Eigen::VectorXd {
    line = 0;
    double along = 0.0;
    for (; line + 2 < way.size(); ++line) {
      const double next = (way[line + 1] - way[line]).norm();
      if (along + next >= at) break;
      along += next;
    }
    const double length = (way[line + 1] - way[line]).norm();
    const double share = length > 0.0 ? std::clamp((at - along) / length, 0.0, 1.0) : 0.0;
    return way[line] + share * (way[line + 1] - way[line]);
  };
  // Corners that can be skipped, which is most of it.
  const auto skip = [&] {
    for (std::size_t k = 1; k + 1 < way.size() && !deadline_.passed();) {
      if (is_clear(way[k - 1], way[k + 1]))
        way.erase(way.begin() + static_cast<std::ptrdiff_t>(k));
      else
        ++k;
    }
  };
  skip();
  for (int idle = 0; idle < kIdle && way.size() > 2 && deadline_.elapsed() < end;) {
    const double length = length_of(way);
    double a = random() * length, b = random() * length;
    if (a > b) std::swap(a, b);
    std::size_t first = 0, last = 0;
    const Eigen::VectorXd one = place_at(a, first), other = place_at(b, last);
    ++idle;
    const double gain = (b - a) - (other - one).norm();
    if (first == last || gain < kWorth * length || !is_clear(one, other)) continue;
    way.erase(way.begin() + static_cast<std::ptrdiff_t>(first) + 1,
              way.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    way.insert(way.begin() + static_cast<std::ptrdiff_t>(first) + 1, {one, other});
    idle = 0;
  }
  skip();
}

}  // namespace pdoik::detail
