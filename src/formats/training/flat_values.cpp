#include "formats/training/flat_values.h"

#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <iterator>

#include "base/error.h"
#include "base/text.h"
#include "formats/containers/json_file.h"

namespace binosplat {

namespace {

bool is_quoted(std::string_view text) {
  return text.size() >= 2 && (text.front() == '\'' || text.front() == '"') && text.back() == text.front();
}

std::string unquoted(std::string_view text) {
  return std::string(is_quoted(text) ? text.substr(1, text.size() - 2) : text);
}

/// Puts text that reads like a truth value in quotes.
std::string quoted_truth(const std::string& text) {
  const std::string word = lowered(text);
  return word == "true" || word == "false" ? "'" + text + "'" : text;
}

/// Converts a value to a word. Quotes distinguish text from true and false (in YAML 1.1 also yes and on).
std::string word_of(const YAML::Node& node) {
  if (node.IsNull()) return "null";
  constexpr std::string_view yes[] = {"true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "ON"};
  constexpr std::string_view no[] = {"false", "False", "FALSE", "no", "No", "NO", "off", "Off", "OFF"};
  const std::string& text = node.Scalar();
  if (node.Tag() == "?" || node.Tag().ends_with(":bool")) {
    if (std::ranges::find(yes, text) != std::end(yes)) return "true";
    if (std::ranges::find(no, text) != std::end(no)) return "false";
  }
  return quoted_truth(text);
}

struct FlatYaml {
  FlatValues values;
  std::vector<YAML::Node> above;  // mappings around the current value
  std::size_t added = 0;

  /// Adds a value. If a key is duplicate, its last value replaces the others with all of their contents.
  void add(const YAML::Node& node, const std::string& path) {
    // YAML's references can repeat content many times, and may be circular.
    constexpr std::size_t most = 20000, longest = 500;
    if (++added > most) throw YAML::Exception(node.Mark(), fmt::format("more than {} values", most));
    if (path.size() > longest || std::ranges::any_of(above, [&](const YAML::Node& n) { return n.is(node); }))
      return;
    const std::string inside = path + ".";
    values.erase(values.lower_bound(inside), values.lower_bound(path + "/"));  // '/' follows '.' in ASCII
    values.erase(path);
    if (node.IsScalar() || node.IsNull()) values.emplace(path, word_of(node));
    if (!node.IsMap()) return;
    above.push_back(node);
    for (const auto& pair : node)
      if (pair.first.IsScalar())
        add(pair.second, path.empty() ? pair.first.Scalar() : inside + pair.first.Scalar());
    above.pop_back();
  }
};

/// Returns where a value in a printed argparse.Namespace ends: at the next comma or closing bracket outside
/// quotes and brackets, or at the end of the text.
std::size_t end_of_value(std::string_view text) {
  int depth = 0;
  char quote = '\0';
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != '\0') {
      if (c == '\\') ++i;
      if (c == quote) quote = '\0';
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == '(' || c == '[' || c == '{') {
      ++depth;
    } else if (c == ')' || c == ']' || c == '}') {
      if (depth == 0) return i;
      --depth;
    } else if (c == ',' && depth == 0) {
      return i;
    }
  }
  return text.size();
}

}  // namespace

FlatValues yaml_values(const std::string& source, std::string_view text) {
  // Text in UTF-16, which begins with a byte order mark, may have zero bytes in its letters.
  const auto bad = std::ranges::find_if(
      text, [](unsigned char c) { return (c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7f; });
  if (bad != text.end() && !text.starts_with("\xff\xfe") && !text.starts_with("\xfe\xff")) {
    fail("{}, line {}: the control character {}, which YAML does not allow", source,
         1 + std::count(text.begin(), bad, '\n'), static_cast<int>(*bad));
  }
  try {
    FlatYaml flat;
    flat.add(YAML::Load(std::string(text)), "");
    return flat.values;
  } catch (const YAML::Exception& error) {
    fail("{}, line {}: {}", source, error.mark.line + 1, error.msg);
  }
}

FlatValues comment_values(const std::vector<std::string>& comments) {
  FlatValues values;
  for (const std::string& comment : comments) {
    const std::string text = fmt::format("{}", fmt::join(words_of(lowered(comment)), " "));
    const std::size_t sign = text.find_first_of(":=|"),
                      end = sign == std::string::npos ? text.rfind(' ') : sign;
    if (end == std::string::npos) continue;
    const std::size_t value = std::max(end, text[end] == '|' ? text.rfind('|') : end) + 1;
    values[std::string(trimmed(std::string_view(text).substr(0, end)))] =
        trimmed(std::string_view(text).substr(value));
  }
  return values;
}

FlatValues namespace_values(std::string_view text) {
  FlatValues values;
  constexpr std::string_view start = "Namespace(";
  text = trimmed(text);
  if (!text.starts_with(start)) return values;
  text.remove_prefix(start.size());
  while (true) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) return values;
    const std::string key(trimmed(text.substr(0, equals)));
    text.remove_prefix(equals + 1);
    const std::size_t end = end_of_value(text);
    values.emplace(key, unquoted(trimmed(text.substr(0, end))));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

FlatValues json_values(const std::string& source, std::string_view text) {
  return json_values(parse_json(source, text));
}

FlatValues json_values(const nlohmann::json& root) {
  FlatValues values;
  const nlohmann::json flat = root.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    std::string path = pointer.starts_with('/') ? pointer.substr(1) : pointer;
    std::replace(path.begin(), path.end(), '/', '.');
    values.emplace(path, value.is_string() ? quoted_truth(value.get<std::string>()) : value.dump());
  }
  return values;
}

}  // namespace binosplat
