#pragma once
// Writes ply files for tests, with any format, types and properties.

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "support/models.h"

namespace binosplat::test {

struct PlyFile {
  std::string format = "binary_little_endian";
  std::string type = "float";                // of every column
  std::map<std::string, std::string> types;  // types of columns that differ
  std::string newline = "\n";
  std::string comments;                    // whole header lines, before the elements
  std::string header_before, data_before;  // of other elements
  std::string header_after, data_after;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;

  std::size_t column(const std::string& name) const {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] == name) return i;
    }
    throw std::out_of_range(name);
  }
  double& at(std::size_t row, const std::string& name) { return rows[row][column(name)]; }
  double at(std::size_t row, const std::string& name) const { return rows[row][column(name)]; }
  const std::string& type_of(const std::string& name) const {
    const auto other = types.find(name);
    return other == types.end() ? type : other->second;
  }
};

template <typename T>
void append_bytes(std::string& out, T value, bool big_endian) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  const bool swap = big_endian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < sizeof(T); ++i) out += bytes[swap ? sizeof(T) - 1 - i : i];
}

/// Returns the bits of the half that is nearest to a number.
inline std::uint16_t half_bits(double value) {
  const int sign = std::signbit(value) ? 0x8000 : 0;
  if (std::isnan(value)) return static_cast<std::uint16_t>(sign | 0x7e00);
  const double size = std::abs(value);
  if (size >= 65520.0) return static_cast<std::uint16_t>(sign | 0x7c00);
  if (size < 0x1p-14) return static_cast<std::uint16_t>(sign + std::lround(size * 0x1p24));
  int exponent = 0;
  const double fraction = 2.0 * std::frexp(size, &exponent) - 1.0;
  return static_cast<std::uint16_t>(sign + (exponent + 14) * 1024 + std::lround(fraction * 1024));
}

/// Appends a number as `format` and `type` store it, in text with a space after it. A ushort stores the bits
/// of a half.
inline void append_value(std::string& out, const std::string& format, const std::string& type, double value) {
  const bool big = format == "binary_big_endian";
  if (type == "ushort" || type == "uint16") {
    if (format == "ascii") {
      out += fmt::format("{} ", half_bits(value));
    } else {
      append_bytes(out, half_bits(value), big);
    }
  } else if (format == "ascii") {
    out += type == "double" ? fmt::format("{} ", value) : fmt::format("{} ", static_cast<float>(value));
  } else if (type == "double") {
    append_bytes(out, value, big);
  } else if (type == "float") {
    append_bytes(out, static_cast<float>(value), big);
  } else if (type == "half" || type == "float16") {
    append_bytes(out, half_bits(value), big);
  } else if (type == "short") {
    append_bytes(out, static_cast<std::int16_t>(value), big);
  } else if (type == "uchar") {
    append_bytes(out, static_cast<std::uint8_t>(value), big);
  } else {
    throw std::invalid_argument(type);
  }
}

inline std::string header_of(const PlyFile& file) {
  std::string text = "ply\nformat " + file.format + " 1.0\n" + file.comments + file.header_before +
                     fmt::format("element vertex {}\n", file.rows.size());
  for (const std::string& column : file.columns)
    text += "property " + file.type_of(column) + " " + column + "\n";
  text += file.header_after + "end_header\n";
  std::string out;
  for (const char c : text) out += c == '\n' ? file.newline : std::string(1, c);
  return out;
}

inline std::string to_bytes(const PlyFile& file) {
  std::string out = header_of(file) + file.data_before;
  for (const std::vector<double>& row : file.rows) {
    for (std::size_t k = 0; k < row.size(); ++k)
      append_value(out, file.format, file.type_of(file.columns[k]), row[k]);
    if (file.format == "ascii") out += file.newline;
  }
  return out + file.data_after;
}

/// Returns random Gaussians as INRIA's trainer stores them; floats hold all their numbers exactly.
inline PlyFile inria_file(int degree, std::size_t count, std::uint32_t seed = 1) {
  PlyFile file;
  file.columns = {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (int i = 0; i < 3 * (sh_count(degree) - 1); ++i) file.columns.push_back(fmt::format("f_rest_{}", i));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    file.columns.emplace_back(name);
  }
  Uniform uniform(seed);
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double>& row = file.rows.emplace_back();
    for (std::size_t k = 0; k < file.columns.size(); ++k) row.push_back(static_cast<float>(uniform(-3, 3)));
  }
  return file;
}

}  // namespace binosplat::test
