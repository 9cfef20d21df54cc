#include "obstacles/pairs.hpp"

#include <algorithm>

namespace pdoik::detail {
namespace {

std::vector<double> point_margins(const Robot& robot, const HullModel& hulls,
                                  const PairMargins& margins) {
  std::vector<double> by_source;
  if (!margins.speak_of_points()) return by_source;
  by_source.assign(robot.occupancy().size(), 0.0);
  for (const Hull& hull : hulls.all()) {
    const auto [one, other] = seat_of(robot, hulls, hull);
    by_source[static_cast<std::size_t>(hull.source)] = margins.to_points({one, other});
  }
  return by_source;
}

}  // namespace

Pairs::Pairs(const Robot& robot, const HullModel& hulls, std::shared_ptr<const ShapeSet> set,
             Attachments::Solids solids, PairMargins margins_in, HullCapsules& fixed)
    : margins(std::move(margins_in)),
      shapes(std::move(set), robot, margins),
      attachments(std::move(solids), robot, hulls, shapes, margins),
      points(point_margins(robot, hulls, margins)),
      fixed_to_shapes(least_clearance(fixed, shapes)) {
  for (const double margin : points) most_point_margin = std::max(most_point_margin, margin);
  fixed_to_shapes.capsule = nullptr;  // which is another's
}

}  // namespace pdoik::detail
