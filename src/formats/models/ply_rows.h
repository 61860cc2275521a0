#pragma once
// Rows of a ply file's elements: their bytes in a binary file, their lines in a text.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "formats/models/ply_header.h"

namespace binosplat {

/// Returns the position of the first byte after an element's rows, which have no lists and begin at byte `at`
/// of a binary file. Throws Error if the file ends earlier.
std::size_t end_of_rows(const std::filesystem::path& path, std::span<const std::byte> bytes,
                        const PlyElement& element, std::size_t at);

/// Returns a property's offset in bytes in such a row. Throws Error if it is missing or of another type.
std::size_t offset_in_row(const std::filesystem::path& path, const PlyElement& element,
                          const std::string& name, PlyType type);

/// The lines of a text file's elements, one a row.
class PlyLines {
 public:
  PlyLines(const std::filesystem::path& path, std::string_view text, const PlyHeader& header)
      : path_(path), text_(text), at_(header.data), number_(header.lines) {}

  /// Returns the next line that is not blank, for a row of an element. Throws Error at the end of the file.
  std::string_view next(const PlyElement& element, std::uint64_t row);
  /// Number of the line that next() returned last, counted from 1.
  std::size_t number() const { return number_; }
  /// Unread bytes.
  std::size_t left() const { return text_.size() - at_; }

  static constexpr std::string_view blanks = " \t\r";

 protected:
  const std::filesystem::path& path_;

 private:
  std::string_view text_;
  std::size_t at_;
  std::size_t number_;
};

}  // namespace binosplat
