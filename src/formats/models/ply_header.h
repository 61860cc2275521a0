#pragma once
// The header of a ply file (Turk 1994): its elements and their storage.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace binosplat {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float16, float32, float64 };
enum class PlyFormat { ascii, little_endian, big_endian };

constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 2, 4, 8};
  return sizes[static_cast<int>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;    // type of the value, or of a list's values
  std::optional<PlyType> count_type;  // type of a list's length; none if the property is a single value
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  // as in the header; not checked against the file
  std::vector<PlyProperty> properties;

  const PlyProperty* find(std::string_view property) const;
  std::size_t count_of(std::string_view start) const;  // properties whose names begin so
  bool has_list() const;
  std::size_t row_bytes() const;  // size of a row; with lists the minimum, for empty lists
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;   // in the order of their data
  std::vector<std::string> comments;  // without the word 'comment'
  std::size_t data = 0;               // byte where the data begins
  std::size_t lines = 0;              // number of lines in the header

  const PlyElement* find(std::string_view element) const;
};

/// Reads the header of a file's bytes. Throws Error naming `path` and the line.
PlyHeader read_ply_header(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace binosplat
