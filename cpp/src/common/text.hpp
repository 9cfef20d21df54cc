#pragma once

#include <string>
#include <vector>

namespace pdoik::detail {

/// "a, b, c", for messages.
inline std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace pdoik::detail
