#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <locale>
#include <set>
#include <sstream>
#include <utility>

#include "io/utf8.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/occupancy.hpp"

namespace pdoik {
namespace {

bool is_text(const std::string& path_or_text) {
  return path_or_text.find('\n') != std::string::npos ||
         path_or_text.find(": ") != std::string::npos ||
         path_or_text.find('{') != std::string::npos;
}

/// Whether UTF-8 text holds U+FDD0 to U+FDEF or a code point that ends in FFFE or FFFF, which stand
/// for no character: yaml-cpp writes U+FFFD in their place.
bool holds_noncharacter(const std::string& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (byte(i) == 0xBF && byte(i + 1) >= 0xBE && (byte(i - 1) & 0x0FU) == 0x0F) return true;
    if (byte(i - 1) == 0xEF && byte(i) == 0xB7 && byte(i + 1) >= 0x90 && byte(i + 1) <= 0xAF)
      return true;
  }
  return false;
}

/// Reads one entry of the file, naming it in every error message.
class Entry {
 public:
  Entry(const YAML::Node& node, std::string where) : node_(node), where_(std::move(where)) {
    if (!node_.IsMap()) fail("expected a mapping");
  }

  std::string text(const char* key) const {
    auto name = get<std::string>(key, "a name");
    // What is left empty would be read as "null".
    if (node_[key].IsNull() || holds_noncharacter(name))
      fail(std::string("'") + key + "' is not a name");
    return name;
  }
  double length(const char* key) const {
    const auto value = get<double>(key, "a length in metres");
    if (!std::isfinite(value)) fail(std::string(key) + " is not finite");
    return value;
  }
  double length_or(const char* key, double otherwise) const {
    return node_[key] ? length(key) : otherwise;
  }
  Eigen::Vector3d point(const char* key) const {
    const auto values = get<std::vector<double>>(key, "[x, y, z] in metres");
    if (values.size() != 3)
      fail(std::string(key) + " has " + std::to_string(values.size()) + " numbers, expected 3");
    Eigen::Vector3d point(values[0], values[1], values[2]);
    if (!point.allFinite()) fail(std::string(key) + " is not finite");
    return point;
  }

  /// Of a text of numbers, three by three.
  template <class Number>
  std::vector<std::array<Number, 3>> triples(const char* key) const {
    constexpr const char* kExpected = "a text of numbers with spaces between, three by three";
    std::istringstream text(get<std::string>(key, kExpected));
    text.imbue(std::locale::classic());
    std::vector<std::array<Number, 3>> triples;
    std::array<Number, 3> three;
    while (text >> three[0] >> three[1] >> three[2]) {
      triples.push_back(three);
      text >> std::ws;
      if (text.eof()) return triples;
    }
    fail(std::string("'") + key + "' is not " + kExpected);
  }
  std::vector<Eigen::Vector3d> points(const char* key) const {
    std::vector<Eigen::Vector3d> points;
    for (const auto& [x, y, z] : triples<double>(key)) points.emplace_back(x, y, z);
    return points;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw LoadError(where_ + ": " + what); }

  template <class T>
  T get(const char* key, const char* expected) const {
    if (!node_[key]) fail(std::string("has no '") + key + "', expected " + expected);
    try {
      return node_[key].as<T>();
    } catch (const YAML::Exception&) {
      fail(std::string("'") + key + "' is not " + expected);
    }
  }

  YAML::Node node_;
  std::string where_;
};

}  // namespace

namespace {

std::string content_of(const std::string& path, const std::string& source) {
  try {
    std::ifstream file;
    file.exceptions(std::ios::failbit | std::ios::badbit);
    file.open(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  } catch (const std::ios_base::failure& error) {  // not there, a folder, not readable
    throw LoadError("cannot read the occupancy " + source + ": " + error.what());
  }
}

YAML::Node parse(const std::string& path_or_text, bool text, const std::string& source) {
  if (path_or_text.find('\0') != std::string::npos)
    throw LoadError(source + " holds a NUL character");
  const std::string yaml = text ? path_or_text : content_of(path_or_text, source);
  // yaml-cpp would put U+FFFD in place of what it cannot read, and two links would share a name.
  if (!detail::is_utf8(yaml)) throw LoadError(source + " is not UTF-8 text");
  try {
    return YAML::Load(yaml);
  } catch (const std::exception& error) {
    throw LoadError(source + " is not valid YAML: " + error.what());
  }
}

void check_keys(const YAML::Node& root, const std::string& source) {
  if (!root.IsMap())
    throw LoadError(source + ": expected a mapping with 'spheres' and 'spheroids'");
  std::set<std::string> seen;
  for (const auto& item : root) {
    const std::string key =
        item.first.IsScalar() ? item.first.Scalar() : "a key that is not a word";
    if (key != "spheres" && key != "spheroids" && key != "capsules" && key != "pieces") {
      throw LoadError(source + ": '" + key +
                      "' is unknown, expected 'spheres', 'spheroids', 'capsules' and 'pieces'");
    }
    if (!seen.insert(key).second) throw LoadError(source + ": '" + key + "' is there twice");
    if (!item.second.IsSequence() && !item.second.IsNull())
      throw LoadError(source + ": '" + key + "' is not a list");
  }
}

}  // namespace

Occupancy load_occupancy(const std::string& path_or_text) {
  const bool text = is_text(path_or_text);
  const std::string source = text ? "the occupancy text" : "'" + path_or_text + "'";
  const YAML::Node root = parse(path_or_text, text, source);
  check_keys(root, source);
  Occupancy occupancy;
  for (std::size_t i = 0; root["spheres"] && i < root["spheres"].size(); ++i) {
    const Entry entry(root["spheres"][i], source + ": spheres[" + std::to_string(i) + "]");
    occupancy.spheres.push_back(
        {entry.text("link"), entry.point("center"), entry.length("radius")});
  }
  for (std::size_t i = 0; root["spheroids"] && i < root["spheroids"].size(); ++i) {
    const Entry entry(root["spheroids"][i], source + ": spheroids[" + std::to_string(i) + "]");
    occupancy.spheroids.push_back({entry.text("link_a"), entry.point("focus_a"),
                                   entry.text("link_b"), entry.point("focus_b"),
                                   entry.length("semi_major")});
  }
  for (std::size_t i = 0; root["capsules"] && i < root["capsules"].size(); ++i) {
    const Entry entry(root["capsules"][i], source + ": capsules[" + std::to_string(i) + "]");
    occupancy.capsules.push_back({entry.text("link"), entry.point("a"), entry.point("b"),
                                  entry.length("radius"), entry.length_or("overhang", 0.0)});
  }
  for (std::size_t i = 0; root["pieces"] && i < root["pieces"].size(); ++i) {
    const Entry entry(root["pieces"][i], source + ": pieces[" + std::to_string(i) + "]");
    occupancy.pieces.push_back({entry.text("link"), entry.points("vertices"),
                                entry.triples<int>("triangles"),
                                entry.length_or("tolerance", 0.0)});
  }
  return occupancy;
}

namespace {

/// Numbers with spaces between, each of which reads back exactly.
template <class Triples>
std::string numbers(const Triples& triples) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  const char* between = "";
  for (const auto& triple : triples) {
    for (const auto number : triple) text << std::exchange(between, " ") << number;
  }
  return text.str();
}

}  // namespace

std::string to_yaml(const Occupancy& occupancy) {
  YAML::Emitter out;
  out.SetDoublePrecision(17);
  const auto point = [&](const char* key, const Eigen::Vector3d& p) {
    out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq << p.x() << p.y()
        << p.z() << YAML::EndSeq;
  };
  out << YAML::BeginMap << YAML::Key << "spheres" << YAML::Value << YAML::BeginSeq;
  for (const Sphere& sphere : occupancy.spheres) {
    out << YAML::Flow << YAML::BeginMap << YAML::Key << "link" << YAML::Value << sphere.link;
    point("center", sphere.center);
    out << YAML::Key << "radius" << YAML::Value << sphere.radius << YAML::EndMap;
  }
  out << YAML::EndSeq << YAML::Key << "spheroids" << YAML::Value << YAML::BeginSeq;
  for (const Spheroid& s : occupancy.spheroids) {
    out << YAML::Flow << YAML::BeginMap << YAML::Key << "link_a" << YAML::Value << s.link_a;
    point("focus_a", s.focus_a);
    out << YAML::Key << "link_b" << YAML::Value << s.link_b;
    point("focus_b", s.focus_b);
    out << YAML::Key << "semi_major" << YAML::Value << s.semi_major << YAML::EndMap;
  }
  out << YAML::EndSeq;
  if (!occupancy.capsules.empty()) {
    out << YAML::Key << "capsules" << YAML::Value << YAML::BeginSeq;
    for (const Capsule& capsule : occupancy.capsules) {
      out << YAML::Flow << YAML::BeginMap << YAML::Key << "link" << YAML::Value << capsule.link;
      point("a", capsule.a);
      point("b", capsule.b);
      out << YAML::Key << "radius" << YAML::Value << capsule.radius;
      if (capsule.overhang != 0.0)
        out << YAML::Key << "overhang" << YAML::Value << capsule.overhang;
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  if (!occupancy.pieces.empty()) {
    out << YAML::Key << "pieces" << YAML::Value << YAML::BeginSeq;
    for (const ConvexPiece& piece : occupancy.pieces) {
      out << YAML::Flow << YAML::BeginMap << YAML::Key << "link" << YAML::Value << piece.link
          << YAML::Key << "tolerance" << YAML::Value << piece.tolerance;
      out << YAML::Key << "vertices" << YAML::Value << YAML::DoubleQuoted
          << numbers(piece.vertices);
      out << YAML::Key << "triangles" << YAML::Value << YAML::DoubleQuoted
          << numbers(piece.triangles) << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace pdoik
