#include "formats/models/ply_header.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "formats/containers/content.h"

namespace binosplat {

namespace {

constexpr std::size_t longest_header = std::size_t{1} << 20;

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName type_names[] = {
    {"char", PlyType::int8},       {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},     {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},   {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},     {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"half", PlyType::float16},    {"float16", PlyType::float16}, {"float", PlyType::float32},
    {"float32", PlyType::float32}, {"double", PlyType::float64},  {"float64", PlyType::float64}};

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& path, std::string_view text)
      : path_(path), text_(text.substr(0, longest_header)) {}

  PlyHeader read() {
    if (next_line() != "ply") fail_here("expected 'ply'");
    bool has_format = false;
    for (std::string_view line = next_line(); line != "end_header"; line = next_line()) {
      const std::vector<std::string_view> words = words_of(line);
      if (words.empty() || words[0] == "obj_info") continue;
      if (words[0] == "comment") {
        header_.comments.emplace_back(line.substr(line.find("comment") + 7));
      } else if (words[0] == "format") {
        header_.format = read_format(words);
        has_format = true;
      } else if (words[0] == "element") {
        add_element(words);
      } else if (words[0] == "property") {
        add_property(words);
      } else {
        fail_here("{} is not a keyword of a ply header; is its 'end_header' line missing?", quoted(words[0]));
      }
    }
    if (!has_format) fail_here("the header ends without a 'format' line");
    header_.data = at_;
    return std::move(header_);
  }

 private:
  /// Returns the next line without its end and surrounding blanks.
  std::string_view next_line() {
    ++header_.lines;
    const std::string_view rest = text_.substr(at_);
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos)
      fail("{}: the ply header has no 'end_header' line in its first {} bytes", path_, text_.size());
    at_ += end + 1;
    return trimmed(rest.substr(0, end));
  }

  template <typename... Args>
  [[noreturn]] void fail_here(fmt::format_string<Args...> format, Args&&... args) const {
    fail("{}, header line {}: {}", path_, header_.lines, fmt::format(format, std::forward<Args>(args)...));
  }

  PlyFormat read_format(const std::vector<std::string_view>& words) const {
    if (words.size() == 3 && words[2] == "1.0") {
      if (words[1] == "ascii") return PlyFormat::ascii;
      if (words[1] == "binary_little_endian") return PlyFormat::little_endian;
      if (words[1] == "binary_big_endian") return PlyFormat::big_endian;
    }
    fail_here("expected 'format', then ascii, binary_little_endian or binary_big_endian, then 1.0");
  }

  PlyType read_type(std::string_view word) const {
    for (const TypeName& known : type_names) {
      if (known.name == word) return known.type;
    }
    fail_here("{} is not a type of a property (char, uchar, short, ushort, int, uint, half, float, double)",
              quoted(word));
  }

  /// Returns a name. Throws Error for control characters, because errors print names unescaped.
  std::string read_name(std::string_view word) const {
    const auto control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; };
    if (word.size() > 200 || std::any_of(word.begin(), word.end(), control))
      fail_here("{} is not a name", quoted(word));
    return std::string(word);
  }

  void add_element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail_here("expected 'element NAME COUNT'");
    PlyElement element;
    element.name = read_name(words[1]);
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc() || stop != end) fail_here("{} is not a number of elements", quoted(words[2]));
    if (!element_names_.insert(element.name).second) fail_here("element '{}' occurs twice", element.name);
    property_names_.clear();
    header_.elements.push_back(std::move(element));
  }

  void add_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail_here("a property comes before any element");
    PlyProperty property;
    if (words.size() == 5 && words[1] == "list") {
      property.count_type = read_type(words[2]);
      if (*property.count_type >= PlyType::float16)
        fail_here("the length of a list must be an integer type, not '{}'", words[2]);
    } else if (words.size() != 3) {
      fail_here("expected 'property TYPE NAME' or 'property list LENGTH_TYPE TYPE NAME'");
    }
    property.type = read_type(words[words.size() - 2]);
    property.name = read_name(words.back());
    PlyElement& element = header_.elements.back();
    if (!property_names_.insert(property.name).second)
      fail_here("property '{}' occurs twice in element '{}'", property.name, element.name);
    element.properties.push_back(std::move(property));
  }

  const std::filesystem::path& path_;
  std::string_view text_;
  std::size_t at_ = 0;
  PlyHeader header_;
  std::set<std::string> element_names_;
  std::set<std::string> property_names_;  // those of the last element
};

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
  const auto found = std::ranges::find(properties, property, &PlyProperty::name);
  return found == properties.end() ? nullptr : &*found;
}

std::size_t PlyElement::count_of(std::string_view start) const {
  const auto begins = [&](const PlyProperty& property) { return property.name.starts_with(start); };
  return static_cast<std::size_t>(std::ranges::count_if(properties, begins));
}

bool PlyElement::has_list() const {
  return std::ranges::any_of(properties, [](const PlyProperty& one) { return one.count_type.has_value(); });
}

std::size_t PlyElement::row_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += size_of(property.count_type.value_or(property.type));
  return bytes;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  const auto found = std::ranges::find(elements, element, &PlyElement::name);
  return found == elements.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  if (content_of(bytes) != Content::ply)
    fail("{}: expected a ply file, but it looks like {}", path, describe(content_of(bytes)));
  return HeaderReader(path, as_text(bytes)).read();
}

}  // namespace binosplat
