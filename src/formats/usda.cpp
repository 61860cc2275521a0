#include "formats/usda.h"

#include <algorithm>
#include <charconv>

#include "formats/content.h"

namespace binosplat {

namespace {

constexpr int prims_deep_most = 500;  // recursion must not overflow the stack

bool is_blank_or_separator(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ';'; }

bool is_of_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_:.|[]").find(c) != std::string_view::npos ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

bool edits_list(std::string_view word) {
  return is_one_of(word, {"prepend", "append", "add", "delete", "reorder"});
}

/// Reads metadata: the parentheses after a prim's name, or at the top of a file.
void read_metadata(UsdaText& text, UsdaValues& values) {
  if (!text.take('(')) return;
  while (!text.take(')')) {
    if (text.next() == '"' || text.next() == '\'') {
      text.quoted();  // a comment for people
      continue;
    }
    std::string_view key = text.word();
    if (edits_list(key)) key = text.word();
    text.expect('=');
    values.insert_or_assign(std::string(key), text.value());
  }
}

/// Reads an attribute, as in `uniform token visibility = "invisible" (...)`. `word` is its first word.
void read_attribute(UsdaText& text, std::string_view word, UsdaPrim& prim) {
  while (edits_list(word) || is_one_of(word, {"custom", "uniform", "varying", "config"})) word = text.word();
  const bool orders = word == "nameChildren" || word == "properties";  // reorder nameChildren = [...]
  const std::string name(orders ? word : text.word());
  if (word.empty() || name.empty()) text.fail_to_find("the type and the name of an attribute");
  if (text.take('=')) {
    const UsdaText value = text.value();
    if (value.rest() != "None") prim.attributes.insert_or_assign(name, value);
  }
  if (text.next() == '(') text.value();
}

/// Replaces equal time samples by a constant: OpenUSD holds samples, the first one also for earlier times.
void hold_still(UsdaValues& attributes) {
  constexpr std::string_view ending = ".timeSamples";
  for (auto at = attributes.begin(); at != attributes.end();) {
    const auto moving = at++;
    if (!moving->first.ends_with(ending)) continue;
    const std::vector<UsdaText> samples = moving->second.samples();
    const auto differs = [&](const UsdaText& sample) { return sample.rest() != samples[0].rest(); };
    if (samples.empty() || std::ranges::any_of(samples, differs)) continue;
    const std::string name = moving->first.substr(0, moving->first.size() - ending.size());
    attributes.erase(moving);
    attributes.erase(name);
    if (samples[0].rest() != "None") attributes.emplace(name, samples[0]);
  }
}

UsdaPrim read_prim(UsdaText& text, std::string_view specifier, int depth) {
  if (depth > prims_deep_most) text.fail_here("prims are nested more than {} deep", prims_deep_most);
  text.next();
  UsdaPrim prim{.specifier = std::string(specifier),
                .type = {},
                .name = {},
                .where = text,
                .metadata = {},
                .attributes = {}};
  prim.type = text.word();
  prim.name = text.quoted();
  read_metadata(text, prim.metadata);
  text.expect('{');
  while (!text.take('}')) {
    const UsdaText before = text;
    const std::string_view word = text.word();
    if (is_one_of(word, {"def", "over", "class"})) {
      prim.prims.push_back(read_prim(text, word, depth + 1));
    } else if (word == "variantSet") {
      text.quoted();
      text.expect('=');
      prim.metadata.insert_or_assign("variantSet", text.value());
    } else if (word.empty()) {
      before.fail_to_find("a prim or an attribute");
    } else {
      read_attribute(text, word, prim);
    }
  }
  hold_still(prim.attributes);
  return prim;
}

}  // namespace

std::size_t UsdaText::line() const {
  return 1 + static_cast<std::size_t>(
                 std::count(all_.begin(), all_.begin() + static_cast<std::ptrdiff_t>(at_), '\n'));
}

char UsdaText::next() {
  while (at_ < end_) {
    if (all_[at_] == '#') {
      at_ = std::min(all_.find('\n', at_), end_);
    } else if (is_blank_or_separator(all_[at_])) {
      ++at_;
    } else {
      return all_[at_];
    }
  }
  return 0;
}

bool UsdaText::take(char mark) {
  if (next() != mark || at_ == end_) return false;
  ++at_;
  return true;
}

void UsdaText::fail_to_find(const std::string& wanted) const {
  if (at_ == end_ && end_ == all_.size())
    fail_here("expected {}, found the end of the file: it is cut short", wanted);
  if (at_ == end_) fail_here("expected {} before this value ends", wanted);
  const std::string_view left = rest();
  fail_here("expected {}, found {}", wanted,
            binosplat::quoted(left.substr(0, std::min<std::size_t>(left.find_first_of("\r\n"), 20))));
}

void UsdaText::expect(char mark) {
  if (!take(mark)) fail_to_find(fmt::format("'{}'", mark));
}

std::string_view UsdaText::word() {
  next();
  const std::size_t begin = at_;
  while (at_ < end_ && is_of_word(all_[at_])) ++at_;
  return all_.substr(begin, at_ - begin);
}

// Skips "..", '..', """..""" or '''..'''; only three marks allow line breaks.
void UsdaText::skip_string() {
  const UsdaText before = *this;
  const std::string mark(1, all_[at_]);
  const std::string three = mark + mark + mark;
  const std::string& close = all_.substr(at_, 3) == three ? three : mark;
  at_ += close.size();
  while (at_ < end_ && all_.substr(at_, close.size()) != close) {
    if (all_[at_] == '\n' && close.size() == 1) break;
    at_ += all_[at_] == '\\' ? 2 : 1;
  }
  if (at_ >= end_ || all_[at_] == '\n') before.fail_here("text in quotes does not end");
  at_ += close.size();
}

std::string_view UsdaText::quoted() {
  if (next() != '"' && all_.substr(at_, 1) != "'") fail_to_find("text in quotes");
  const std::size_t begin = at_;
  skip_string();
  const std::string_view all = all_.substr(begin, at_ - begin);
  const std::size_t marks = all.size() >= 6 && all[1] == all[0] && all[2] == all[0] ? 3 : 1;
  return all.substr(marks, all.size() - 2 * marks);
}

void UsdaText::skip_item() {
  const UsdaText before = *this;
  const auto skip_to = [&](std::string_view close) {
    const std::size_t found = all_.find(close, at_ + close.size());
    if (found >= end_) before.fail_here("expected '{}' after this", close);
    at_ = found + close.size();
  };
  const char c = next();
  if (c == '"' || c == '\'') return skip_string();
  if (c == '@') return skip_to(all_.substr(at_, 3) == "@@@" ? "@@@" : "@");
  if (c == '<') return skip_to(">");
  at_ += at_ < end_ ? 1 : 0;
  while (at_ < end_ && std::string_view(" \t\r\n;,#\"'@<()[]{}=").find(all_[at_]) == std::string_view::npos)
    ++at_;
}

UsdaText UsdaText::value() {
  next();
  UsdaText value = *this;
  std::string closing;  // expected closing marks, the next one last
  do {
    const char c = next();
    if (c == 0) value.fail_here("this value does not end: the file is cut short");
    const std::size_t open = std::string_view("([{").find(c), close = std::string_view(")]}").find(c);
    if (close != std::string_view::npos && (closing.empty() || closing.back() != c))
      fail_to_find(closing.empty() ? "a value" : fmt::format("'{}'", closing.back()));
    if (open != std::string_view::npos) {
      closing += ")]}"[open];
      ++at_;
    } else if (close != std::string_view::npos) {
      closing.pop_back();
      ++at_;
    } else {
      skip_item();
    }
  } while (!closing.empty());
  // A reference to another file is a file name, optionally a prim's path, and optionally a time offset.
  if (all_[value.at_] == '@' || all_[value.at_] == '<') {
    if (next() == '<') skip_item();
    if (next() == '(') this->value();
  }
  value.end_ = at_;
  return value;
}

double UsdaText::number() {
  next();
  double value = 0.0;
  const auto [stop, error] = std::from_chars(all_.data() + at_, all_.data() + end_, value);
  if (error != std::errc()) fail_to_find("a number");
  at_ = static_cast<std::size_t>(stop - all_.data());
  return value;
}

void UsdaText::finish() {
  if (next() != 0) fail_to_find("the end of this value");
}

std::vector<double> UsdaText::numbers(std::size_t count) const {
  UsdaText left = *this;
  std::vector<double> values;
  left.tuple(count, [&](double value) { values.push_back(value); });
  left.finish();
  return values;
}

std::vector<float> UsdaText::tuples(std::size_t count) const {
  UsdaText left = *this;
  std::vector<float> values;
  left.list('[', ']',
            [&] { left.tuple(count, [&](double value) { values.push_back(static_cast<float>(value)); }); });
  left.finish();
  return values;
}

std::vector<std::string> UsdaText::texts() const {
  UsdaText left = *this;
  std::vector<std::string> values;
  left.list('[', ']', [&] { values.emplace_back(left.quoted()); });
  left.finish();
  return values;
}

std::string UsdaText::text() const {
  UsdaText left = *this;
  std::string value(left.quoted());
  left.finish();
  return value;
}

std::vector<UsdaText> UsdaText::samples() const {
  UsdaText left = *this;
  std::vector<UsdaText> values;
  left.list('{', '}', [&] {
    left.number();
    left.expect(':');
    values.push_back(left.value());
  });
  left.finish();
  return values;
}

const UsdaText* UsdaPrim::attribute(std::string_view named) const {
  const auto found = attributes.find(named);
  return found == attributes.end() ? nullptr : &found->second;
}

UsdaPrim read_usda(const std::string& source, std::string_view text, bool only_metadata) {
  UsdaText left(source, text);  // the first line is a comment
  UsdaPrim file{.specifier = {}, .type = {}, .name = {}, .where = left, .metadata = {}, .attributes = {}};
  read_metadata(left, file.metadata);
  while (!only_metadata && left.next() != 0) {
    const UsdaText before = left;
    const std::string_view word = left.word();
    if (is_one_of(word, {"def", "over", "class"})) {
      file.prims.push_back(read_prim(left, word, 1));
    } else if (word == "reorder") {  // rootPrims = [...]
      left.word();
      left.expect('=');
      left.value();
    } else {
      before.fail_to_find("def, over or class, the beginning of a prim");
    }
  }
  return file;
}

}  // namespace binosplat
