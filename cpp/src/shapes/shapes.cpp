#include "pdoik/shapes.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>

#include "shapes/shape_parts.hpp"
#include "shapes/shape_set.hpp"

namespace pdoik {

namespace detail {

ShapeSet::ShapeSet(std::vector<Shape> shapes_in, std::vector<ContactRule> contacts_in)
    : shapes(std::move(shapes_in)), contacts(std::move(contacts_in)) {
  std::set<std::string> known;
  for (const Shape& shape : shapes) {
    if (!known.insert(shape.name).second)
      throw std::invalid_argument("two shapes are called '" + shape.name + "'");
    names.push_back(shape.name);
  }
  std::ranges::for_each(contacts, check_contact_rule);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    std::ranges::move(parts_of(shapes[k]), std::back_inserter(parts));
    owners.resize(parts.size(), static_cast<int>(k));
  }
  tree = ShapeTree(parts);
  has_surfaces = std::ranges::any_of(parts, &Solid::is_surface);
  for (const Solid& part : parts) steepest = std::max(steepest, part.steepest());
}

std::shared_ptr<const ShapeSet> no_shapes() {
  static const auto none = std::make_shared<const ShapeSet>();
  return none;
}

}  // namespace detail

Shapes::Shapes() : set_(detail::no_shapes()) {}

Shapes::Shapes(std::vector<Shape> shapes, std::vector<ContactRule> contacts)
    : set_(std::make_shared<const detail::ShapeSet>(std::move(shapes), std::move(contacts))) {}

std::span<const Shape> Shapes::shapes() const { return set_->shapes; }
std::span<const ContactRule> Shapes::contacts() const { return set_->contacts; }

}  // namespace pdoik
