#include "app/mp4_spherical.h"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "shared/axes.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

std::string number(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

std::string box(std::string_view type, const std::string& content) {
  return number(static_cast<std::uint32_t>(content.size() + 8)) + std::string(type) + content;
}

std::string full_box(std::string_view type, const std::string& content) {
  return box(type, number(0) + content);  // version and flags
}

std::string boxes_of(int layout) {
  const char mode = layout == LAYOUT_SEPARATE ? 0 : layout == LAYOUT_OVER_UNDER ? 1 : 2;
  // Shares of the sphere that the picture leaves out at the top, the bottom, the left and the right: /2^32.
  const std::string bounds = number(0) + number(0) + number(0x40000000) + number(0x40000000);
  const std::string pose = number(0) + number(0) + number(0);
  return full_box("st3d", std::string(1, mode)) +
         box("sv3d", full_box("svhd", std::string("binosplat") + '\0') +
                         box("proj", full_box("prhd", pose) + full_box("equi", bounds)));
}

// The first box of a type in [begin, end), or npos.
std::size_t find_box(std::string_view bytes, std::size_t begin, std::size_t end, std::string_view type) {
  for (std::size_t at = begin; at + 8 <= end;) {
    const std::size_t size = number_at(bytes, at);
    if (size < 8 || at + size > end) return std::string_view::npos;
    if (bytes.substr(at + 4, 4) == type) return at;
    at += size;
  }
  return std::string_view::npos;
}

// Where the boxes are from the movie to the first track's description of its pictures, each in the one
// before; empty if one is missing.
std::vector<std::size_t> way_to_entry(std::string_view movie) {
  std::vector<std::size_t> way = {0};
  std::size_t begin = 8, end = movie.size();
  for (const std::string_view type : {"trak", "mdia", "minf", "stbl", "stsd"}) {
    const std::size_t at = find_box(movie, begin, end, type);
    if (at == std::string_view::npos) return {};
    way.push_back(at);
    begin = at + 8;
    end = at + number_at(movie, at);
  }
  begin += 8;  // the version of stsd, and how many entries it has
  if (begin + 8 > end || begin + number_at(movie, begin) > end) return {};
  way.push_back(begin);
  return way;
}

}  // namespace

void mark_half_sphere(const fs::path& path, int layout) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto length = static_cast<std::uint64_t>(fs::file_size(path));
  std::uint64_t at = 0, size = 0;
  std::string head(16, '\0'), type;
  for (; at + 16 <= length; at += size) {
    file.seekg(static_cast<std::streamoff>(at));
    file.read(head.data(), 16);
    type = head.substr(4, 4);
    size = number_at(head, 0);
    if (size == 1) size = std::uint64_t{number_at(head, 8)} << 32 | number_at(head, 12);
    if (!file || size < 8 || type == "moov") break;
  }
  std::vector<std::size_t> way;
  std::string movie;
  if (type == "moov" && at + size == length) {
    movie.resize(size);
    file.seekg(static_cast<std::streamoff>(at));
    file.read(movie.data(), static_cast<std::streamsize>(size));
    if (file) way = way_to_entry(movie);
  }
  if (way.empty()) fail("{}: ffmpeg left no film of one track that could be marked as VR180", path.string());
  const std::string added = boxes_of(layout);
  const std::size_t entry_end = way.back() + number_at(movie, way.back());
  for (const std::size_t of : way)
    movie.replace(of, 4, number(number_at(movie, of) + static_cast<std::uint32_t>(added.size())));
  movie.insert(entry_end, added);
  file.seekp(static_cast<std::streamoff>(at));
  file.write(movie.data(), static_cast<std::streamsize>(movie.size()));
  file.close();
  if (!file) fail("cannot write {}", path.string());
}

}  // namespace binosplat::app
