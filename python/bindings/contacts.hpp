#pragma once

#include <pybind11/stl.h>

#include <span>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "pdoik/attachment.hpp"

namespace pdoik::python {

/// One link, or several of which what they hold moves with the first.
using Holders = std::variant<std::string, std::vector<std::string>>;

/// What `attach` is given.
Attachment to_attachment(const Holders& link, const std::vector<Shape>& shapes,
                         const std::vector<std::string>& may_touch,
                         const std::vector<ContactRule>& contacts);

/// Contact that is allowed to any depth, or to one [m], as pairs of names say it.
using ContactOfAnyDepth = std::tuple<std::string, std::string>;
using ContactToDepth = std::tuple<std::string, std::string, double>;
using AllowedContact = std::variant<ContactOfAnyDepth, ContactToDepth>;

ContactRule to_rule(const AllowedContact& allowed);
/// Those of some rules that such pairs can say.
std::vector<AllowedContact> allowed_by(std::span<const ContactRule> rules);

}  // namespace pdoik::python
