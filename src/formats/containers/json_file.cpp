#include "formats/containers/json_file.h"

#include <cmath>
#include <span>

#include "formats/containers/content.h"

namespace binosplat {

namespace {

/// Names a place, and what a text looks like that is not JSON: it may be a binary file.
std::string place_in(std::string_view text, std::size_t byte) {
  const Content content = content_of(std::as_bytes(std::span(text)));
  return fmt::format("line {}, byte {}{}", 1 + std::ranges::count(text.substr(0, byte), '\n'), byte,
                     content == Content::json ? "" : fmt::format("; it looks like {}", describe(content)));
}

/// Throws Error for deep nesting: recursion over the parsed values must not overflow the stack. Returns the
/// text with NaN and Infinity in quotes: JSON lacks them, but Python, C++ and Rust print them, often in keys
/// that nobody reads. The quotes replace letters, so that the bytes in errors stay right.
std::string prepared(const std::string& source, std::string_view text) {
  std::string result(text);
  constexpr int most = 500;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') ++i;
    if (quoted) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > most)
      fail("{}: its lists and objects are nested more than {} deep, at {}", source, most,
           place_in(text, i + 1));
    for (const std::string_view word : {"NaN", "Infinity", "nan", "inf"}) {
      if (c != word[0] || !text.substr(i).starts_with(word)) continue;
      const std::size_t first = i > 0 && text[i - 1] == '-' ? i - 1 : i;
      i += word.size() - 1;
      result[first] = result[i] = '"';
    }
  }
  return result;
}

}  // namespace

nlohmann::json parse_json(const std::string& source, std::string_view text) {
  try {
    return nlohmann::json::parse(prepared(source, text));
  } catch (const nlohmann::json::parse_error& error) {
    fail("{} is not valid JSON at {}", source,
         place_in(text, std::min<std::size_t>(error.byte, text.size())));
  } catch (const nlohmann::json::exception& error) {
    fail("{} is not valid JSON: {}", source, error.what());
  }
}

JsonValue JsonValue::inner(const nlohmann::json& value, std::string name) const {
  JsonValue result(*this);
  result.value_ = &value;
  result.step_ = std::make_shared<Step>(Step{step_, std::move(name)});
  return result;
}

std::string JsonValue::where() const {
  std::vector<const std::string*> names;
  for (const Step* step = step_.get(); step != nullptr; step = step->before.get())
    names.push_back(&step->name);
  std::string text;
  for (std::size_t i = names.size(); i-- > 0;)
    text += (text.empty() || names[i]->front() == '[' ? "" : ".") + *names[i];
  return text;
}

bool JsonValue::has(const std::string& key) const {
  if (!value_->is_object()) return false;
  const auto found = value_->find(key);
  return found != value_->end() && !found->is_null();
}

JsonValue JsonValue::at(const std::string& key) const {
  if (!value_->is_object()) fail_here("expected an object with the key '{}'", key);
  const auto found = value_->find(key);
  if (found == value_->end())
    fail("{}: the key '{}{}{}' is missing", source(), where(), step_ ? "." : "", key);
  // Errors print keys unescaped; log_line() replaces control characters.
  return inner(*found, key);
}

std::optional<JsonValue> JsonValue::find(const std::string& key) const {
  return has(key) ? std::optional(at(key)) : std::nullopt;
}

JsonValue JsonValue::at(std::size_t index) const {
  if (index >= size()) fail_here("expected a list of more than {} values", index);
  return inner((*value_)[index], fmt::format("[{}]", index));
}

std::size_t JsonValue::size() const {
  if (!value_->is_array()) fail_here("expected a list");
  return value_->size();
}

JsonValue JsonValue::list_of(std::size_t n) const {
  if (size() != n) fail_here("expected {} values, found {}", n, size());
  return *this;
}

std::vector<JsonValue> JsonValue::items() const {
  std::vector<JsonValue> all;
  for (std::size_t i = 0; i < size(); ++i) all.push_back(at(i));
  return all;
}

std::vector<double> JsonValue::numbers(std::size_t n) const {
  std::vector<double> all;
  for (const JsonValue& one : list_of(n).items()) all.push_back(one.number());
  return all;
}

double JsonValue::number() const {
  if (!value_->is_number() || !std::isfinite(value_->get<double>())) fail_here("expected a finite number");
  return value_->get<double>();
}

double JsonValue::above_zero() const {
  if (!(number() > 0.0)) fail_here("expected a number above 0");
  return number();
}

std::uint64_t JsonValue::whole(std::uint64_t most) const {
  const double value = number();
  if (!(value >= 0.0 && value <= static_cast<double>(most)) || value != std::floor(value))
    fail_here("expected a whole number from 0 to {}, found {}", most, value);
  return value_->is_number_integer() ? value_->get<std::uint64_t>() : static_cast<std::uint64_t>(value);
}

std::string JsonValue::text() const {
  if (!value_->is_string()) fail_here("expected text in quotes");
  return value_->get<std::string>();
}

}  // namespace binosplat
