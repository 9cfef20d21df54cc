#include "pdoik/contact_rule.hpp"

#include <cmath>
#include <stdexcept>

namespace pdoik {

void check_contact_rule(const ContactRule& rule) {
  if (rule.one.empty() || rule.other.empty())
    throw std::invalid_argument("a contact rule names '" + rule.one + "' and '" + rule.other +
                                "', expected two names");
  if (!rule.clearance || *rule.clearance == -std::numeric_limits<double>::infinity()) return;
  if (!(std::abs(*rule.clearance) <= 1e6)) {
    throw std::invalid_argument("the clearance of '" + rule.one + "' and '" + rule.other + "' is " +
                                std::to_string(*rule.clearance) +
                                ", expected a length within 1e6 m, or minus infinity");
  }
}

}  // namespace pdoik
