#pragma once

#include <cctype>
#include <fstream>
#include <sstream>
#include <string>

#include "io/utf8.hpp"
#include "pdoik/errors.hpp"

namespace pdoik::detail {

/// XML text and what to call it in messages.
struct XmlText {
  std::string xml;
  std::string source;
};

/// Calls visit(position) for the '<' of each tag outside of comments.
template <class Visit>
void for_each_tag(const std::string& xml, Visit&& visit) {
  for (std::size_t i = xml.find('<'); i != std::string::npos; i = xml.find('<', i + 1)) {
    if (xml.compare(i, 4, "<!--") == 0) {
      i = xml.find("-->", i);
      if (i == std::string::npos) break;
      continue;
    }
    visit(i);
  }
}

/// What TinyXML cannot cope with, kept from it: it recurses on nesting.
inline void check_xml(const std::string& xml, const std::string& source) {
  constexpr int kDeepest = 500;
  if (!is_utf8(xml)) throw LoadError(source + " is not UTF-8 text");
  if (xml.find('\0') != std::string::npos) throw LoadError(source + " holds a NUL character");
  int depth = 0;
  for_each_tag(xml, [&](std::size_t i) {
    const char next = i + 1 < xml.size() ? xml[i + 1] : ' ';
    if (next == '?' || next == '!') return;
    const std::size_t end = xml.find('>', i);
    const bool closed = end != std::string::npos && xml[end - 1] == '/';
    depth += next == '/' ? -1 : closed ? 0 : 1;
    if (depth > kDeepest)
      throw LoadError(source + " is nested more than " + std::to_string(kDeepest) + " deep");
  });
}

inline bool is_xml(const std::string& text) {
  for (const char c : text) {
    if (!std::isspace(static_cast<unsigned char>(c)) && c != '\xEF' && c != '\xBB' && c != '\xBF') {
      return c == '<';
    }
  }
  return text.find('\n') != std::string::npos;
}

/// @param path_or_xml  A file's path, or the XML text itself (recognised by its leading '<').
/// @param what  "URDF", for messages.
/// @throws LoadError  unreadable file; text that is no UTF-8, holds NUL or is nested too deep.
inline XmlText read_xml(const std::string& path_or_xml, const std::string& what) {
  XmlText text;
  if (is_xml(path_or_xml)) {
    text = {path_or_xml, "the " + what + " text"};
  } else {
    if (path_or_xml.find('\0') != std::string::npos)
      throw LoadError("the " + what + "'s path holds a NUL character");
    if (path_or_xml.empty())
      throw LoadError("the " + what + " is an empty string, expected a file's path or XML text");
    std::ifstream file(path_or_xml, std::ios::binary);
    std::stringstream content;
    if (file) content << file.rdbuf();
    if (!file || !content)
      throw LoadError("cannot read the " + what + " file '" + path_or_xml + "'");
    text = {content.str(), "'" + path_or_xml + "'"};
  }
  check_xml(text.xml, text.source);
  return text;
}

}  // namespace pdoik::detail
