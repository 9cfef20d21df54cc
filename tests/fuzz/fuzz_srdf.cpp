#include <cstdint>
#include <stdexcept>
#include <string>

#include "pdoik/collision_pairs.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/robot.hpp"
#include "property.hpp"

/// Bytes as an SRDF: pairs of links with names, or LoadError.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const pdoik::Robot panda = pdoik::Robot::builtin("panda");
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (text.find_first_of("<\n") == std::string::npos) return 0;  // a path
  std::vector<pdoik::LinkPair> pairs;
  try {
    pairs = pdoik::load_srdf_pairs(text);
    PDOIK_PROPERTY(pdoik::load_srdf_contacts(text).size() >= pairs.size());
  } catch (const pdoik::LoadError& error) {
    PDOIK_PROPERTY(*error.what() != 0);
    return 0;
  }
  bool known = true;
  for (const auto& [one, other] : pairs) {
    PDOIK_PROPERTY(!one.empty() && !other.empty());
    known = known && panda.find_link(one) && panda.find_link(other);
  }
  pdoik::Robot robot = panda;
  try {
    robot.set_ignored_pairs(pairs);
    PDOIK_PROPERTY(known && robot.ignored_pairs() == pairs);
  } catch (const std::invalid_argument&) {
    PDOIK_PROPERTY(!known && robot.ignored_pairs() == panda.ignored_pairs());
  }
  return 0;
}
