#include "hulls/pair_margins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/named_things.hpp"
#include "common/text.hpp"

namespace pdoik::detail {
namespace {

constexpr double kAnyDepth = -std::numeric_limits<double>::infinity();

/// All that rules may speak of: links, what is attached, the points, shapes, in this order.
NamedThings all_things(const Robot& robot, const PairMargins::Things& things) {
  std::vector<std::string> names = robot.link_names();
  names.insert(names.end(), things.attached.begin(), things.attached.end());
  names.emplace_back(ContactRule::kPoints);
  names.insert(names.end(), things.shapes.begin(), things.shapes.end());
  return NamedThings(std::move(names));
}

[[noreturn]] void refuse(const Robot& robot, const NamedThings& all, const ContactRule& rule,
                         const std::string& name) {
  const std::vector<std::string> near = nearest_names(name, all.names());
  const std::string nearest =
      near.empty() ? "links: " + join(robot.link_names()) : "nearest: " + join(near);
  throw std::invalid_argument(
      "the contact rule of '" + rule.one + "' and '" + rule.other + "': '" + name +
      (is_pattern(name) ? "' means nothing that there is" : "' is not there") +
      ", neither a link of '" + robot.name() + "' nor a shape nor what a link carries (" + nearest +
      "); an optional rule may speak of what is not there");
}

/// Of a rule how many of its names are no patterns: those with more count before others.
int exact_names(const ContactRule& rule) {
  return (is_pattern(rule.one) ? 0 : 1) + (is_pattern(rule.other) ? 0 : 1);
}

}  // namespace

PairMargins::PairMargins(const Robot& robot)
    : links_(static_cast<int>(robot.link_names().size())), count_(links_) {
  ignore_pairs(robot);
}

PairMargins::PairMargins(const Robot& robot, const Options& options, const Things& things,
                         const Rules& rules)
    : links_(static_cast<int>(robot.link_names().size())),
      count_(links_ + static_cast<int>(things.attached.size())),
      shape_count_(static_cast<int>(things.shapes.size())) {
  const NamedThings all = all_things(robot, things);
  struct Meant {
    std::vector<int> one, other;
    const ContactRule* rule;
  };
  std::vector<Meant> each;
  const auto add = [&](const ContactRule& rule, bool optional) {
    Meant meant{all.find(rule.one), all.find(rule.other), &rule};
    if (!optional && meant.one.empty()) refuse(robot, all, rule, rule.one);
    if (!optional && meant.other.empty()) refuse(robot, all, rule, rule.other);
    each.push_back(std::move(meant));
  };
  for (const ContactRule& rule : rules.scene) add(rule, rule.optional);
  for (const ContactRule& rule : rules.attached) add(rule, true);

  const auto beyond = [](const ContactRule& rule, double wanted) {
    return rule.clearance ? *rule.clearance - wanted : 0.0;
  };
  const auto row = [this](Table& table, int columns) -> Table& {
    const auto size = static_cast<std::size_t>(count_) * static_cast<std::size_t>(columns);
    if (table.empty()) table.assign(size, 0.0);
    return table;
  };
  // What a later one says replaces what earlier ones said.
  const auto say = [&](int mover, int thing, const ContactRule& rule) {
    if (thing < count_) {
      set(mover, thing, beyond(rule, options.self_clearance));
    } else if (thing == count_) {
      row(points_, 1)[static_cast<std::size_t>(mover)] = beyond(rule, options.clearance);
    } else {
      const auto place = static_cast<std::size_t>(mover) * things.shapes.size() +
                         static_cast<std::size_t>(thing - count_ - 1);
      row(shapes_, shape_count_)[place] = beyond(rule, options.clearance);
    }
  };
  for (int exact = 0; exact <= 2; ++exact) {
    if (exact == 2) ignore_pairs(robot);
    for (const Meant& meant : each) {
      if (exact_names(*meant.rule) != exact) continue;
      for (const auto& [movers, others] :
           {std::pair(&meant.one, &meant.other), std::pair(&meant.other, &meant.one)}) {
        for (const int mover : *movers) {
          if (mover >= count_) break;
          for (const int thing : *others) say(mover, thing, *meant.rule);
        }
      }
    }
  }
}

void PairMargins::set(Mover one, Mover other, double margin) {
  const auto n = static_cast<std::size_t>(count_), a = static_cast<std::size_t>(one),
             b = static_cast<std::size_t>(other);
  if (movers_.empty()) movers_.assign(n * n, 0.0);
  movers_[a * n + b] = movers_[b * n + a] = margin;
}

void PairMargins::ignore_pairs(const Robot& robot) {
  for (const LinkPair& pair : robot.ignored_pairs())
    set(robot.link_index(pair.first), robot.link_index(pair.second), kAnyDepth);
}

bool PairMargins::have_own() const {
  const auto is_own = [](double margin) { return margin != 0.0 && !std::isinf(margin); };
  return std::ranges::any_of(movers_, is_own) || std::ranges::any_of(shapes_, is_own) ||
         std::ranges::any_of(points_, is_own);
}

PairMargins PairMargins::without_own() const {
  PairMargins result = *this;
  for (Table* table : {&result.movers_, &result.shapes_, &result.points_})
    for (double& margin : *table)
      if (!std::isinf(margin)) margin = 0.0;
  return result;
}

bool PairMargins::are_alike_of_links(const PairMargins& other) const {
  for (int a = 0; a < links_; ++a)
    for (int b = 0; b < a; ++b)
      if (between(a, b) != other.between(a, b)) return false;
  return true;
}

}  // namespace pdoik::detail
