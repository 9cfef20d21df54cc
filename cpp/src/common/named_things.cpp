#include "common/named_things.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pdoik::detail {
namespace {

/// How many letters must be put in, taken out or exchanged to make one of the other.
std::size_t edits_between(std::string_view one, std::string_view other) {
  std::vector<std::size_t> row(other.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < one.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < other.size(); ++j) {
      const std::size_t exchanged = diagonal + (one[i] == other[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({exchanged, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

bool is_pattern(std::string_view name) { return name.find_first_of("*?") != name.npos; }

bool fits(std::string_view pattern, std::string_view name) {
  // Where the last star stands, and up to where in the name it was tried.
  std::size_t star = pattern.npos, tried = 0, p = 0, n = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      tried = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != pattern.npos) {
      p = star + 1;
      n = ++tried;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::string_view object_of(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  if (slash == name.npos || slash == 0 || slash + 1 == name.size()) return name;
  const std::string_view number = name.substr(slash + 1);
  const bool is_number =
      std::ranges::all_of(number, [](char letter) { return letter >= '0' && letter <= '9'; });
  return is_number ? name.substr(0, slash) : name;
}

std::vector<std::string> nearest_names(std::string_view name,
                                       const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  std::vector<std::pair<std::size_t, std::string>> likely;
  for (const std::string& each : names) {
    const std::size_t edits = edits_between(name, each);
    if (2 * edits <= std::max(name.size(), each.size())) likely.emplace_back(edits, each);
  }
  std::ranges::sort(likely);
  std::vector<std::string> nearest;
  for (const auto& [edits, each] : likely)
    if (nearest.size() < kMost && !std::ranges::count(nearest, each)) nearest.push_back(each);
  return nearest;
}

NamedThings::NamedThings(std::vector<std::string> names) : names_(std::move(names)) {
  for (int k = 0; k < count(); ++k) {
    const std::string_view name = names_[static_cast<std::size_t>(k)], object = object_of(name);
    by_name_[name].push_back(k);
    if (object != name) by_name_[object].push_back(k);
  }
}

std::vector<int> NamedThings::find(const std::string& name) const {
  if (const auto found = by_name_.find(name); found != by_name_.end()) return found->second;
  std::vector<int> places;
  if (!is_pattern(name)) return places;
  for (int k = 0; k < count(); ++k) {
    const std::string_view each = names_[static_cast<std::size_t>(k)];
    if (fits(name, each) || fits(name, object_of(each))) places.push_back(k);
  }
  return places;
}

}  // namespace pdoik::detail
