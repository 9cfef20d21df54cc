#include "track/barriers.hpp"

#include <algorithm>
#include <limits>

#include "obstacles/placed_travel.hpp"

namespace pdoik::detail {
namespace {

constexpr int kMostBarriers = 48;   ///< constraints of a step where it begins
constexpr int kCuts = 64;           ///< and where it was found to be in something
constexpr double kAbout = 1e-3;     ///< what is so near there is cut off as well [m]
constexpr double kGrazes = 5e-5;    ///< so deep, what is about to be cut off is left a little [m]
constexpr double kBeyond = 0.5;     ///< share of a depth by which it is held off,
constexpr double kAtLeast = 1e-9;   ///< and by how much at least [m]
constexpr std::size_t kRoom = 2;    ///< times as many as are kept, from which the worst are chosen
constexpr double kApproach = 0.5;   ///< share of a distance that a step may take
constexpr double kRegular = 1e-8;   ///< of the rows' squares, so that the way out is the shortest
constexpr double kNoWorse = 1e-11;  ///< by which the way out may be missed [m]

}  // namespace

Barriers::Barriers(const Model& model) : program_(model.robot.dof()) {
  const Eigen::Index n = model.robot.dof();
  rows_.setZero(n, kMostBarriers + kCuts);
  hessian_.setZero(n, n);
  for (Eigen::VectorXd* v : {&gradient_, &out_}) v->setZero(n);
  for (Eigen::VectorXd* v : {&most_, &soft_}) v->setZero(kMostBarriers + kCuts);
  found_.reserve(kRoom * kMostBarriers);
}

template <class Reach>
bool Barriers::gather(Problem& problem, double reach, std::size_t most, Reach&& reach_of) {
  Constraints& all = problem.constraints;
  all.obstacles.use(problem.scene->obstacles(), ObstacleConstraints::Form::Distance);
  all.shapes.use(problem.scene->shapes(), problem.model.options.clearance);
  all.attachments.use(true);
  all.find(problem.rollout, reach_of);
  double least = -reach;
  found_.clear();
  bool late = false;
  // By bounds, where there are any: what c is, is asked of those alone that are kept.
  all.for_each([&](auto& family, std::size_t number) {
    for (int k = 0; k < family.count() && !late; ++k) {
      late = problem.is_late(k);
      const double c = [&] {
        if constexpr (requires { family.most(k); })
          return family.most(k);
        else
          return family.at(k).c;
      }();
      if (c <= least) continue;
      found_.push_back({c, static_cast<int>(number), k});
      if (found_.size() < kRoom * most) continue;
      keep_worst(most);
      least = found_.back().c;
    }
  });
  if (late || problem.deadline->struck()) return false;
  keep_worst(most);
  return true;
}

template <class Most>
void Barriers::add_rows(Problem& problem, double reach, Most&& most) {
  problem.constraints.for_each([&](auto& family, std::size_t number) {
    for (const Found& each : found_) {
      if (each.family != static_cast<int>(number)) continue;
      const auto& at = family.at(each.k);
      if (at.c <= -reach) continue;
      rows_.col(count_).setZero();
      family.add_row(at, problem.rollout, rows_.col(count_).data());
      most_[count_] = most(at.c, rows_.col(count_));
      ++count_;
    }
  });
}

bool Barriers::find(Problem& problem, double reach, const Eigen::VectorXd& step) {
  const Constraints& all = problem.constraints;
  // What is farther than a hull may come cannot hold it up.
  const auto reach_of = [&](std::size_t family, int group) {
    if (!all.is_by_hull(family)) return reach;
    const Hull& hull = all.hulls.hulls()[static_cast<std::size_t>(group)];
    return std::min(reach, travel_from(problem.rollout, all.hulls, hull, step) / kApproach);
  };
  if (!gather(problem, reach, kMostBarriers, reach_of)) return false;
  count_ = violated_ = 0;
  add_rows(problem, reach, [&](double c, const auto&) {
    if (c > 0.0) ++violated_;
    return c > 0.0 ? -c : -kApproach * c;
  });
  return !problem.deadline->passed();
}

bool Barriers::cut(Problem& problem, const Eigen::VectorXd& moved) {
  const auto left = static_cast<std::size_t>(rows_.cols() - count_);
  if (left == 0 || !gather(problem, kAbout, std::min<std::size_t>(left, kCuts / 4),
                           [](std::size_t, int) { return kAbout; }))
    return false;
  add_rows(problem, kAbout, [&](double c, const auto& row) {
    const double leave = row.dot(moved) - c - (c > 0.0 ? std::max(kBeyond * c, kAtLeast) : 0.0);
    // Along what is round a way grazes, however straight, unless it leads off by as much.
    if (leave >= 0.0 || c >= kGrazes) return std::max(0.0, leave);
    ++violated_;
    return leave;
  });
  return !problem.deadline->passed();
}

void Barriers::keep_worst(std::size_t most) {
  if (found_.size() <= most) return;
  std::nth_element(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(most) - 1,
                   found_.end(),
                   [](const Found& one, const Found& other) { return one.c > other.c; });
  found_.resize(most);
}

void Barriers::come_to_terms(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  out_.setZero();
  if (violated_ == 0) return;
  hessian_.setZero();
  gradient_.setZero();
  for (int i = 0; i < count_; ++i) {
    soft_[i] = most_[i];
    if (most_[i] >= 0.0) continue;
    hessian_.selfadjointView<Eigen::Upper>().rankUpdate(rows_.col(i));
    gradient_ -= most_[i] * rows_.col(i);
    soft_[i] = std::numeric_limits<double>::infinity();
  }
  hessian_.diagonal().array() += kRegular * std::max(hessian_.diagonal().maxCoeff(), 1e-12);
  const Inequalities hard{rows_, soft_, count_, lower, upper};
  if (!program_.factorise(hessian_) || !program_.solve(gradient_, hard, out_)) out_.setZero();
  for (int i = 0; i < count_; ++i) {
    if (most_[i] >= 0.0) continue;
    most_[i] = std::max(most_[i], rows_.col(i).dot(out_) + kNoWorse);
  }
}

}  // namespace pdoik::detail
