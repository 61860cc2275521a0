#include "formats/flat_values.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "formats/json_file.h"

namespace binosplat {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool is_quoted(std::string_view text) {
  return text.size() >= 2 && (text.front() == '\'' || text.front() == '"') && text.back() == text.front();
}

std::string unquoted(std::string_view text) {
  return std::string(is_quoted(text) ? text.substr(1, text.size() - 2) : text);
}

/// What is left of a value without its tag and anchor, and without a comment after it.
std::string_view plain_value(std::string_view value) {
  while (value.starts_with('!') || value.starts_with('&'))
    value = trimmed(value.substr(std::min(value.find(' '), value.size())));
  if (!is_quoted(value)) value = trimmed(value.substr(0, value.find(" #")));
  return value.starts_with('#') ? std::string_view() : value;
}

/// Where a value of a Namespace ends: at a comma or the end, outside quotes and brackets.
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

FlatValues yaml_values(std::string_view text) {
  FlatValues values;
  std::vector<std::pair<std::size_t, std::string>> above;  // the indent of each mapping's key, and its path
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string_view inner = trimmed(line);
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t colon = inner.ends_with(':') ? inner.size() - 1 : inner.find(": ");
    const bool is_pair =
        colon != std::string_view::npos && !inner.starts_with('-') && !inner.starts_with('#');
    if (!is_pair) continue;
    while (!above.empty() && above.back().first >= indent) above.pop_back();
    const std::string key = unquoted(trimmed(inner.substr(0, colon)));
    const std::string path = above.empty() ? key : above.back().second + "." + key;
    const std::string_view value = plain_value(trimmed(inner.substr(colon + 1)));
    if (value.empty()) {
      above.emplace_back(indent, path);
    } else if (std::string_view("[{|>*").find(value.front()) == std::string_view::npos) {
      values.emplace(path, unquoted(value));
    }
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
  FlatValues values;
  const nlohmann::json flat = parse_json(source, text).flatten();
  for (const auto& [pointer, value] : flat.items()) {
    std::string path = pointer.starts_with('/') ? pointer.substr(1) : pointer;
    std::replace(path.begin(), path.end(), '/', '.');
    values.emplace(path, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return values;
}

}  // namespace binosplat
