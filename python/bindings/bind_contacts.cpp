#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>

#include "bind.hpp"
#include "contacts.hpp"

namespace pdoik::python {
namespace {

constexpr double kAnyDepth = -std::numeric_limits<double>::infinity();

using AllowedLike = std::variant<bool, double>;  // a whole number is a depth

ContactRule allowed_to(std::string one, std::string other, double depth) {
  if (!(depth >= 0.0)) {
    throw std::invalid_argument("'" + one + "' and '" + other + "' may touch to a depth of " +
                                std::to_string(depth) + ", expected at least 0 [m]");
  }
  return {std::move(one), std::move(other), 0.0 - depth};  // and no -0
}

ContactRule make_rule(const std::string& one, const std::string& other,
                      const std::optional<AllowedLike>& allowed,
                      const std::optional<double>& clearance, bool optional) {
  if (allowed && clearance)
    throw std::invalid_argument("allowed and clearance are both given, expected one");
  ContactRule rule{one, other};
  if (allowed && std::holds_alternative<double>(*allowed))
    rule = allowed_to(one, other, std::get<double>(*allowed));
  else if (allowed && !std::get<bool>(*allowed))
    rule.clearance = std::nullopt;
  else if (clearance)
    rule.clearance = clearance;
  rule.optional = optional;
  check_contact_rule(rule);
  return rule;
}

std::string rule_repr(const ContactRule& rule) {
  const py::object said = !rule.clearance ? py::str("allowed=False")
                          : *rule.clearance == kAnyDepth
                              ? py::str("allowed=True")
                              : py::str("clearance={:.6g}").format(*rule.clearance);
  return py::str("ContactRule({!r}, {!r}, {}{})")
      .format(rule.one, rule.other, said, rule.optional ? ", optional=True" : "");
}

using RuleState = std::tuple<std::string, std::string, std::optional<double>, bool>;

RuleState rule_state(const ContactRule& rule) {
  return {rule.one, rule.other, rule.clearance, rule.optional};
}

using AttachmentState =
    std::tuple<std::vector<std::string>, std::vector<Shape>, std::vector<ContactRule>>;

AttachmentState attachment_state(const Attachment& thing) {
  return {thing.links, thing.shapes, thing.contacts};
}

void bind_rule(py::module_& module) {
  py::class_<ContactRule>(module, "ContactRule",
                          R"(How near two things may come to each other.

Things are links of the robot, shapes of a scene, what links carry, and "points" for all points. All pairs of which
no rule speaks keep Options.clearance, or Options.self_clearance among links and what they carry. Each side is a name
or a pattern in which `*` stands for any characters and `?` for one; a name also means the pieces of an object,
NAME/1, NAME/2 and so on. Of several rules that speak of a pair those with more exact names count before those with
patterns, and of these the last. Links that are joined, or that no joint moves against each other, are no pairs
whatever rules say; nor are two shapes.)")
      .def(py::init(&make_rule), py::arg("one"), py::arg("other"), py::kw_only(),
           py::arg("allowed") = py::none(), py::arg("clearance") = py::none(),
           py::arg("optional") = false,
           R"(Say it of two things, whichever comes first.

Args:
    one: A name or a pattern.
    other: The same.
    allowed: True, which it is without anything else: contact does not count. A depth: so deep they may be in each
        other [m]. False: as the options say, whatever other rules do.
    clearance: In place of that, the least distance that is wanted of the two [m]; 0 for contact and no deeper,
        negative for a depth.
    optional: Whether there may be nothing of these names; else that is an error where a solver takes the rule.

Raises:
    ValueError: A name is empty, both are given, or a length is NaN, too large or a negative depth.)")
      .def_readonly("one", &ContactRule::one, "A name or a pattern.")
      .def_readonly("other", &ContactRule::other, "A name or a pattern.")
      .def_readonly("clearance", &ContactRule::clearance,
                    "Least distance that is wanted [m]; negative for a depth, minus infinity if "
                    "contact does not count, None for as the options say.")
      .def_readonly("optional", &ContactRule::optional,
                    "Whether there may be nothing of these names.")
      .def("__eq__",
           [](const ContactRule& self, const py::object& other) {
             return py::isinstance<ContactRule>(other) && self == other.cast<ContactRule>();
           })
      .def("__hash__", [](const ContactRule& self) { return py::hash(py::cast(rule_state(self))); })
      .def("__repr__", &rule_repr)
      .def(py::pickle(&rule_state, [](const RuleState& state) {
        return ContactRule{std::get<0>(state), std::get<1>(state), std::get<2>(state),
                           std::get<3>(state)};
      }));
}

}  // namespace

Attachment to_attachment(const Holders& link, const std::vector<Shape>& shapes,
                         const std::vector<std::string>& may_touch,
                         const std::vector<ContactRule>& contacts) {
  Attachment thing{{}, shapes, contacts};
  if (const auto* const one = std::get_if<std::string>(&link))
    thing.links = {*one};
  else
    thing.links = std::get<std::vector<std::string>>(link);
  for (const Shape& shape : shapes)
    for (const std::string& name : may_touch) thing.contacts.push_back({shape.name, name});
  return thing;
}

ContactRule to_rule(const AllowedContact& allowed) {
  if (const auto* const pair = std::get_if<ContactOfAnyDepth>(&allowed))
    return {std::get<0>(*pair), std::get<1>(*pair)};
  const auto& [one, other, depth] = std::get<ContactToDepth>(allowed);
  return allowed_to(one, other, depth);
}

std::vector<AllowedContact> allowed_by(std::span<const ContactRule> rules) {
  std::vector<AllowedContact> contacts;
  for (const ContactRule& rule : rules) {
    if (!rule.clearance || *rule.clearance > 0.0) continue;
    if (std::isinf(*rule.clearance))
      contacts.emplace_back(ContactOfAnyDepth{rule.one, rule.other});
    else
      contacts.emplace_back(ContactToDepth{rule.one, rule.other, 0.0 - *rule.clearance});
  }
  return contacts;
}

void bind_contacts(py::module_& module) {
  bind_rule(module);
  py::class_<Attachment>(module, "Attachment",
                         "Solids that links carry, see Solver.attach: an object in a hand, or one "
                         "between two hands.")
      .def(py::init(&to_attachment), py::arg("link"), py::arg("shapes"),
           py::arg("may_touch") = py::tuple(), py::arg("contacts") = py::tuple(),
           "What `Solver.attach` takes, for `Solver.attach_all`.")
      .def_readonly("links", &Attachment::links, "That hold them; they move with the first.")
      .def_readonly("shapes", &Attachment::shapes, "Their poses are in the first link's frame.")
      .def_readonly("contacts", &Attachment::contacts,
                    "Rules that count while they are carried, those of `may_touch` among them.")
      .def("__repr__",
           [](const Attachment& self) {
             py::list names;
             for (const Shape& shape : self.shapes) names.append(shape.name);
             return py::str("<Attachment of {} to {}>")
                 .format(py::str(", ").attr("join")(names), py::str(", ").attr("join")(self.links));
           })
      .def(py::pickle(&attachment_state, [](const AttachmentState& state) {
        return Attachment{std::get<0>(state), std::get<1>(state), std::get<2>(state)};
      }));
}

}  // namespace pdoik::python
