#include "formats/models/ply_rows.h"

#include <algorithm>

#include "base/error.h"

namespace binosplat {

std::size_t end_of_rows(const std::filesystem::path& path, std::span<const std::byte> bytes,
                        const PlyElement& element, std::size_t at) {
  const std::size_t row = element.row_bytes(), left = bytes.size() - at;
  std::uint64_t needed = 0;
  if (__builtin_mul_overflow(element.count, row, &needed)) {
    fail("{}: its header promises {} of element '{}', more than any file can hold; the header is damaged",
         path, element.count, element.name);
  }
  if (needed > left) {
    fail(
        "{} is cut short: element '{}' needs {} x {} = {} bytes from byte {} on, but the file has only {} "
        "there; it ends in row {} of {}, counted from 0. Fetch or export it again",
        path, element.name, element.count, row, needed, at, left, left / row, element.count);
  }
  return at + needed;
}

std::size_t offset_in_row(const std::filesystem::path& path, const PlyElement& element,
                          const std::string& name, PlyType type) {
  constexpr const char* names[] = {"char", "uchar", "short", "ushort", "int",
                                   "uint", "half",  "float", "double"};
  std::size_t offset = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.name == name && property.type == type) return offset;
    if (property.name == name)
      fail("{}: property '{}' of element '{}' is not of type {}", path, name, element.name,
           names[static_cast<int>(type)]);
    offset += size_of(property.type);
  }
  fail("{}: element '{}' has no property '{}'", path, element.name, name);
}

std::string_view PlyLines::next(const PlyElement& element, std::uint64_t row) {
  while (at_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++number_;
    if (line.find_first_not_of(blanks) != std::string_view::npos) return line;
  }
  fail("{} is cut short: it ends at line {} with {} of {} lines of element '{}'; fetch or export it again",
       path_, number_, row, element.count, element.name);
}

}  // namespace binosplat
