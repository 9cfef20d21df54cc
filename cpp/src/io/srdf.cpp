// The parser is the one that urdfdom is built on: TinyXML, which its header brings, or from version
// 4 on TinyXML-2, which it does not.
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <limits>
#include <optional>
#ifndef TINYXML_INCLUDED
#include <tinyxml2.h>
#endif

#include "io/xml_text.hpp"
#include "pdoik/collision_pairs.hpp"
#include "pdoik/errors.hpp"

namespace pdoik {
namespace {

#ifdef TINYXML2_INCLUDED
using Element = tinyxml2::XMLElement;
using Document = tinyxml2::XMLDocument;
void parse(Document& document, const std::string& xml) { document.Parse(xml.c_str(), xml.size()); }
std::string error_of(const Document& document) { return document.ErrorStr(); }
int line_of(const Element& element) { return element.GetLineNum(); }
#else
using Element = TiXmlElement;
using Document = TiXmlDocument;
void parse(Document& document, const std::string& xml) { document.Parse(xml.c_str()); }
std::string error_of(const Document& document) {
  return std::string(document.ErrorDesc()) + " (line " + std::to_string(document.ErrorRow()) + ")";
}
int line_of(const Element& element) { return element.Row(); }
#endif

std::string attribute(const Element& element, const char* name, const std::string& where) {
  const char* value = element.Attribute(name);
  if (value == nullptr || *value == 0)
    throw LoadError(where + " has no '" + name + "', expected the name of a link");
  return value;
}

/// What an SRDF says of links that touch.
struct Said {
  std::vector<std::string> off_by_default;  ///< links
  std::vector<LinkPair> on, off;            ///< pairs that are looked at all the same, and not
  std::string first_default;                ///< where the first of `off_by_default` stands
};

Said read(const std::string& path_or_xml) {
  const auto [xml, source] = detail::read_xml(path_or_xml, "SRDF");
  Document document;
  parse(document, xml);
  if (document.Error()) throw LoadError(source + " is not valid XML: " + error_of(document));
  const Element* root = document.RootElement();
  if (root == nullptr || std::string(root->Value()) != "robot") {
    throw LoadError(source + " is not an SRDF: expected the element <robot>, found " +
                    (root == nullptr ? "none" : "<" + std::string(root->Value()) + ">"));
  }
  Said said;
  for (const Element* each = root->FirstChildElement(); each != nullptr;
       each = each->NextSiblingElement()) {
    const std::string name = each->Value();
    std::string where = source;
    where.append(": <").append(name).append("> in line ").append(std::to_string(line_of(*each)));
    if (name.starts_with("xacro:")) throw LoadError(where + ": expand the file with xacro first");
    if (name == "disable_default_collisions") {
      said.off_by_default.push_back(attribute(*each, "link", where));
      if (said.first_default.empty()) said.first_default = where;
    } else if (name == "disable_collisions" || name == "enable_collisions") {
      const std::string link = attribute(*each, "link1", where);
      (name == "disable_collisions" ? said.off : said.on)
          .emplace_back(link, attribute(*each, "link2", where));
    }
  }
  return said;
}

bool are_same(const LinkPair& one, const LinkPair& other) {
  return one == other || one == LinkPair(other.second, other.first);
}

bool has(const std::vector<LinkPair>& pairs, const LinkPair& pair) {
  return std::ranges::any_of(pairs, [&](const LinkPair& each) { return are_same(each, pair); });
}

}  // namespace

std::vector<ContactRule> load_srdf_contacts(const std::string& path_or_xml) {
  const Said said = read(path_or_xml);
  std::vector<ContactRule> rules;
  const auto add = [&](const std::string& one, const std::string& other,
                       std::optional<double> clearance) {
    rules.push_back({one, other, clearance, true});
  };
  constexpr double kAnyDepth = -std::numeric_limits<double>::infinity();
  for (const std::string& link : said.off_by_default) add(link, "*", kAnyDepth);
  for (const LinkPair& pair : said.on) add(pair.first, pair.second, std::nullopt);
  for (const LinkPair& pair : said.off) add(pair.first, pair.second, kAnyDepth);
  return rules;
}

std::vector<LinkPair> load_srdf_pairs(const std::string& path_or_xml) {
  const Said said = read(path_or_xml);
  if (said.off_by_default.empty()) return said.off;
  throw LoadError(said.first_default +
                  " means pairs with all links: expected to be given the robot");
}

std::vector<LinkPair> load_srdf_pairs(const std::string& path_or_xml, const Robot& robot) {
  const Said said = read(path_or_xml);
  std::vector<LinkPair> pairs = said.off;
  std::erase_if(pairs, [&](const LinkPair& pair) {
    return !robot.find_link(pair.first) || !robot.find_link(pair.second);
  });
  for (const std::string& link : said.off_by_default) {
    if (!robot.find_link(link)) continue;
    for (const std::string& other : robot.link_names()) {
      const LinkPair pair(link, other);
      if (other != link && !has(said.on, pair) && !has(pairs, pair)) pairs.push_back(pair);
    }
  }
  return pairs;
}

}  // namespace pdoik
