#pragma once

#include <stdexcept>
#include <string>

namespace pdoik {

/// A file or text that cannot be read as what it should be (robot description, occupancy, point
/// cloud). The message names the file, the offending element, what was expected and what was found.
class LoadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace pdoik
