// The parser is the one that urdfdom is built on: TinyXML, which its header brings, or from version
// 4 on TinyXML-2, which it does not.
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
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
std::string complaint(const Document& document) { return document.ErrorStr(); }
int line_of(const Element& element) { return element.GetLineNum(); }
#else
using Element = TiXmlElement;
using Document = TiXmlDocument;
void parse(Document& document, const std::string& xml) { document.Parse(xml.c_str()); }
std::string complaint(const Document& document) {
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

}  // namespace

std::vector<LinkPair> load_srdf_pairs(const std::string& path_or_xml) {
  const auto [xml, source] = detail::read_xml(path_or_xml, "SRDF");
  Document document;
  parse(document, xml);
  if (document.Error()) throw LoadError(source + " is not valid XML: " + complaint(document));
  const Element* root = document.RootElement();
  if (root == nullptr || std::string(root->Value()) != "robot") {
    throw LoadError(source + " is not an SRDF: expected the element <robot>, found " +
                    (root == nullptr ? "none" : "<" + std::string(root->Value()) + ">"));
  }
  std::vector<LinkPair> pairs;
  for (const Element* each = root->FirstChildElement(); each != nullptr;
       each = each->NextSiblingElement()) {
    const std::string name = each->Value();
    std::string where = source;
    where.append(": <").append(name).append("> in line ").append(std::to_string(line_of(*each)));
    if (name.starts_with("xacro:")) throw LoadError(where + ": expand the file with xacro first");
    if (name == "disable_default_collisions")
      throw LoadError(where + " is not supported, expected <disable_collisions> for each pair");
    if (name != "disable_collisions") continue;
    const std::string link = attribute(*each, "link1", where);
    pairs.emplace_back(link, attribute(*each, "link2", where));
  }
  return pairs;
}

std::vector<LinkPair> load_srdf_pairs(const std::string& path_or_xml, const Robot& robot) {
  const std::vector<std::string>& names = robot.link_names();
  const auto is_link = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<LinkPair> pairs = load_srdf_pairs(path_or_xml);
  std::erase_if(
      pairs, [&](const LinkPair& pair) { return !is_link(pair.first) || !is_link(pair.second); });
  return pairs;
}

}  // namespace pdoik
