#pragma once

#include <cstddef>

namespace pdoik::detail {

/// A robot's files in cpp/robots, compiled in by cpp/cmake/embed_robots.cmake.
struct EmbeddedRobot {
  const char* name;       ///< the files' stem, "panda" of panda.urdf
  const char* urdf;       ///< text of <name>.urdf
  const char* occupancy;  ///< text of <name>.occupancy.yaml, empty when there is no such file
  const char* srdf;       ///< text of <name>.srdf, empty when there is no such file
};

/// Ordered by name. The definition is generated at build time.
extern const EmbeddedRobot embedded_robots[];
extern const std::size_t embedded_robot_count;

}  // namespace pdoik::detail
