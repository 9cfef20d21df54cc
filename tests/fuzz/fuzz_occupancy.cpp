#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "pdoik/errors.hpp"
#include "pdoik/occupancy.hpp"
#include "pdoik/robot.hpp"
#include "property.hpp"

/// Bytes as an occupancy file: hulls that are written and read back exactly, or LoadError; and a
/// robot takes them or says why not.
namespace pdoik {
namespace {

bool same(const Sphere& a, const Sphere& b) {
  return a.link == b.link && a.center == b.center && a.radius == b.radius;
}

bool same(const Spheroid& a, const Spheroid& b) {
  return a.link_a == b.link_a && a.focus_a == b.focus_a && a.link_b == b.link_b &&
         a.focus_b == b.focus_b && a.semi_major == b.semi_major;
}

template <class Hulls>
bool all_same(const Hulls& a, const Hulls& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return same(x, y); });
}

void check_occupancy(const Occupancy& occupancy) {
  for (const Sphere& s : occupancy.spheres)
    PDOIK_PROPERTY(s.center.allFinite() && std::isfinite(s.radius));
  for (const Spheroid& s : occupancy.spheroids) {
    PDOIK_PROPERTY(s.focus_a.allFinite() && s.focus_b.allFinite() && std::isfinite(s.semi_major));
  }
  const std::string text = to_yaml(occupancy);
  try {
    const Occupancy again = load_occupancy(text);
    PDOIK_PROPERTY(all_same(occupancy.spheres, again.spheres), text);
    PDOIK_PROPERTY(all_same(occupancy.spheroids, again.spheroids), text);
  } catch (const LoadError& error) {
    PDOIK_PROPERTY(false, "what was written is not read: " << error.what() << '\n' << text);
  }
}

}  // namespace
}  // namespace pdoik

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const pdoik::Robot panda = pdoik::Robot::builtin("panda");
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (text.find_first_of("\n{") == std::string::npos && text.find(": ") == std::string::npos)
    return 0;  // a path
  pdoik::Occupancy occupancy;
  try {
    occupancy = pdoik::load_occupancy(text);
  } catch (const pdoik::LoadError& error) {
    PDOIK_PROPERTY(*error.what() != 0);
    return 0;
  }
  pdoik::check_occupancy(occupancy);
  pdoik::Robot robot = panda;
  try {
    robot.set_occupancy(occupancy);
  } catch (const std::invalid_argument&) {
    PDOIK_PROPERTY(robot.occupancy().size() == panda.occupancy().size());
  }
  return 0;
}
