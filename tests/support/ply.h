#pragma once
// Writes ply files for tests: any format, any types, any properties.

#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "support/models.h"

namespace binosplat::test {

struct PlyFile {
  std::string format = "binary_little_endian";
  std::string type = "float";  // of every column
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
};

template <typename T>
void append_bytes(std::string& out, T value, bool big_endian) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  const bool swap = big_endian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < sizeof(T); ++i) out += bytes[swap ? sizeof(T) - 1 - i : i];
}

/// One number as `format` and `type` store it, a blank behind it in text.
inline void append_value(std::string& out, const std::string& format, const std::string& type, double value) {
  const bool big = format == "binary_big_endian";
  if (format == "ascii") {
    out += type == "double" ? fmt::format("{} ", value) : fmt::format("{} ", static_cast<float>(value));
  } else if (type == "double") {
    append_bytes(out, value, big);
  } else if (type == "float") {
    append_bytes(out, static_cast<float>(value), big);
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
  for (const std::string& column : file.columns) text += "property " + file.type + " " + column + "\n";
  text += file.header_after + "end_header\n";
  std::string out;
  for (const char c : text) out += c == '\n' ? file.newline : std::string(1, c);
  return out;
}

inline std::string to_bytes(const PlyFile& file) {
  std::string out = header_of(file) + file.data_before;
  for (const std::vector<double>& row : file.rows) {
    for (const double value : row) append_value(out, file.format, file.type, value);
    if (file.format == "ascii") out += file.newline;
  }
  return out + file.data_after;
}

/// Random Gaussians as INRIA's trainer stores them; all numbers fit a float exactly.
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
