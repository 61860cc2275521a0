#pragma once
// JSON values that know their file and key, so that every error can name them.

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace binosplat {

/// Parses a whole text. Throws Error naming `source` (a file, or a file in an archive), the line and the
/// byte, and for nesting deeper than 500, which no file needs (a tree over a planet takes 60 levels).
nlohmann::json parse_json(const std::string& source, std::string_view text);

/// A value in a file. If an access does not fit the value's type, the access throws an Error that names the
/// file and the keys, as in "scene/meta.json, key 'means.files[1]': expected text in quotes".
class JsonValue {
 public:
  JsonValue(std::string source, const nlohmann::json& root)
      : source_(std::make_shared<std::string>(std::move(source))), value_(&root) {}

  const nlohmann::json& value() const { return *value_; }
  const std::string& source() const { return *source_; }

  /// Returns whether an object has this key, with a value other than null.
  bool has(const std::string& key) const;
  JsonValue at(const std::string& key) const;                   // throws if the key is missing
  std::optional<JsonValue> find(const std::string& key) const;  // nothing if has() is false
  JsonValue at(std::size_t index) const;                        // throws beyond size()
  std::size_t size() const;                                     // of a list; throws for anything else
  JsonValue list_of(std::size_t n) const;            // returns itself; throws unless it is a list of n values
  std::vector<JsonValue> items() const;              // of a list; throws for anything else
  std::vector<double> numbers(std::size_t n) const;  // of a list of n finite numbers
  double number() const;                             // finite
  double above_zero() const;                         // finite and above 0
  std::uint64_t whole(std::uint64_t most) const;     // integer from 0 to `most`, at most 2^53; accepts 5.0
  int pixels() const { return static_cast<int>(whole(std::numeric_limits<int>::max())); }
  std::string text() const;
  template <int n>
  glm::vec<n, double> vector() const {
    glm::vec<n, double> vector;
    std::ranges::copy(numbers(n), &vector.x);
    return vector;
  }

  template <typename... Args>
  [[noreturn]] void fail_here(fmt::format_string<Args...> format, Args&&... args) const {
    const std::string text = fmt::format(format, std::forward<Args>(args)...);
    if (!step_) fail("{}: {}", source(), text);
    fail("{}, key '{}': {}", source(), where(), text);
  }

 private:
  /// A key, or an index as in "[3]", and the step before it. Values share steps, and only an error joins
  /// steps to a text. So many values with long paths need little memory.
  struct Step {
    std::shared_ptr<const Step> before;
    std::string name;
  };

  JsonValue inner(const nlohmann::json& value, std::string name) const;
  std::string where() const;  // as in "frames[3].w"

  std::shared_ptr<const std::string> source_;
  const nlohmann::json* value_;
  std::shared_ptr<const Step> step_;  // none for the root
};

}  // namespace binosplat
