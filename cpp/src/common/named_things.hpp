#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace pdoik::detail {

/// Whether a name is a pattern: `*` stands for any characters, `?` for one.
bool is_pattern(std::string_view name);
/// Whether a pattern means a name, all of it.
bool fits(std::string_view pattern, std::string_view name);
/// Of a piece NAME/1, NAME/2 ... of an object its NAME; of any other name all of it.
std::string_view object_of(std::string_view name);
/// Those of some names that are most like one, the likeliest first.
std::vector<std::string> nearest_names(std::string_view name,
                                       const std::vector<std::string>& names);

/// Things that are found by name: by their own, by that of the object that they are a piece of, or
/// by a pattern for either.
class NamedThings {
 public:
  explicit NamedThings(std::vector<std::string> names);
  NamedThings(const NamedThings&) = delete;

  /// The places of those that a name or a pattern means, ascending.
  std::vector<int> find(const std::string& name) const;
  int count() const { return static_cast<int>(names_.size()); }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string_view, std::vector<int>> by_name_;  ///< into `names_`
};

}  // namespace pdoik::detail
