#include "formats/cameras/colmap_records.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/numbers.h"
#include "base/text.h"
#include "formats/containers/bytes.h"
#include "formats/containers/content.h"

namespace binosplat {

namespace {

/// By their numbers in binary files.
constexpr ColmapModel colmap_models[] = {{"SIMPLE_PINHOLE", 3, 1},
                                         {"PINHOLE", 4, 2},
                                         {"SIMPLE_RADIAL", 4, 1},
                                         {"RADIAL", 5, 1},
                                         {"OPENCV", 8, 2},
                                         {"OPENCV_FISHEYE", 8},
                                         {"FULL_OPENCV", 12, 2},
                                         {"FOV", 5, 2},
                                         {"SIMPLE_RADIAL_FISHEYE", 4},
                                         {"RADIAL_FISHEYE", 5},
                                         {"THIN_PRISM_FISHEYE", 12},
                                         {"RAD_TAN_THIN_PRISM_FISHEYE", 16},
                                         {"SIMPLE_DIVISION", 4, 1},
                                         {"DIVISION", 5, 2},
                                         {"SIMPLE_FISHEYE", 3},
                                         {"FISHEYE", 4},
                                         {"EUCM", 6, 2},
                                         {"EQUIRECTANGULAR", 2}};

/// Normalises a quaternion; throws Error for zero and for values that are not finite.
glm::dvec4 unit(const std::string& where, const glm::dvec4& q) {
  // Divides by the largest component first, because squares may overflow or underflow.
  const glm::dvec4 size = glm::abs(q), shrunk = q / std::max({size.x, size.y, size.z, size.w});
  const double length = glm::length(shrunk);
  if (!std::isfinite(length)) fail("{}: the rotation is not a quaternion (all zero, or not finite)", where);
  return shrunk / length;
}

void check_pose(const std::string& where, const ColmapImage& image) {
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(image.translation[c])) fail("{}: the translation is not finite", where);
  }
}

/// Reads the numbers of a file one after the other.
class Cursor {
 public:
  Cursor(const std::filesystem::path& file, std::span<const std::byte> bytes) : file_(file), bytes_(bytes) {}

  /// Sets the record that errors name.
  void at_record(const char* kind, std::uint64_t index, std::uint64_t count) {
    record_ = fmt::format("{} {} of {}, counted from 0,", kind, index, count);
  }
  std::string where() const { return fmt::format("{}: {} read up to byte {}", file_, record_, at_); }

  template <typename T>
  T take() {
    need(sizeof(T));
    at_ += sizeof(T);
    return load_number<T>(&bytes_[at_ - sizeof(T)]);
  }

  std::string take_name() {
    const std::string_view rest = as_text(bytes_.subspan(at_));
    const std::size_t end = rest.find('\0');
    if (end == std::string_view::npos)
      fail("{}: {} has a name that runs to the end of the file", file_, record_);
    at_ += end + 1;
    return std::string(rest.substr(0, end));
  }

  void skip(std::uint64_t count, std::size_t size) {
    if (count > (bytes_.size() - at_) / size) need(std::numeric_limits<std::size_t>::max());
    at_ += count * size;
  }

 private:
  void need(std::size_t size) const {
    if (size > bytes_.size() - at_)
      fail("{} is cut short or damaged: {} exceeds the file's {} bytes", file_, record_, bytes_.size());
  }

  const std::filesystem::path& file_;
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::string record_ = "the number of records";
};

/// Reads the lines of a text, numbered from 1.
class Lines {
 public:
  Lines(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // a byte order mark of UTF-8, as editors write it
  }

  /// Reads the next line, of any content, without blanks around it; returns false at the end.
  bool next(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    line = trimmed(text_.substr(at_, end - at_));
    at_ = end + 1;
    ++number_;
    return true;
  }

  bool next_no_comment(std::string_view& line) {
    while (next(line)) {
      if (!line.starts_with('#')) return true;
    }
    return false;
  }

  /// Reads the next line that is neither blank nor a comment.
  bool next_record(std::string_view& line) {
    while (next_no_comment(line)) {
      if (!line.empty()) return true;
    }
    return false;
  }

  std::string where() const { return fmt::format("{}, line {}", file_, number_); }

 private:
  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
};

/// Parses a number of type T. An integer may be written as 160.0.
template <typename T>
T parse_number(const Lines& lines, std::string_view word, const char* what) {
  const std::optional<double> value = parse_real(word);
  const bool fits = !std::is_integral_v<T> || (value >= 0.0 && *value == std::floor(*value) &&
                                               *value < std::ldexp(1.0, std::numeric_limits<T>::digits));
  if (!value || !fits) fail("{}: {} is not a {}", lines.where(), quoted(word), what);
  return static_cast<T>(*value);
}

bool are_numbers(std::span<const std::string_view> words) {
  return std::ranges::all_of(words, [](std::string_view word) { return parse_real(word).has_value(); });
}

/// Returns whether a line lists an image's points, with X Y POINT3D_ID for each, or is empty.
bool are_points(std::string_view line) {
  const std::vector<std::string_view> words = words_of(line);
  return words.size() % 3 == 0 && are_numbers(words);
}

/// Splits an image's line. The name is the rest of the line, because names may have blanks: "IMG (1).jpg".
std::vector<std::string_view> fields_of_image(std::string_view line) { return words_of(line, 10); }

bool is_image(std::string_view line) {
  const std::vector<std::string_view> fields = fields_of_image(line);
  return fields.size() == 10 && are_numbers(std::span(fields).first(9));
}

void add(std::map<std::uint32_t, ColmapLens>& lenses, const std::string& where, ColmapLens lens) {
  const std::uint32_t id = lens.id;
  if (!lenses.emplace(id, std::move(lens)).second) fail("{}: there is a camera {} already", where, id);
}

}  // namespace

std::map<std::uint32_t, ColmapLens> colmap_lenses(const std::filesystem::path& path) {
  const MappedFile file(path);
  Cursor cursor(path, file.bytes());
  std::map<std::uint32_t, ColmapLens> lenses;
  const auto count = cursor.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    cursor.at_record("camera", i, count);
    ColmapLens lens;
    lens.id = cursor.take<std::uint32_t>();
    const auto model = cursor.take<std::int32_t>();
    lens.width = cursor.take<std::uint64_t>();
    lens.height = cursor.take<std::uint64_t>();
    // The number of parameters is unknown, too, so the next camera cannot be found.
    if (model < 0 || model >= std::ssize(colmap_models))
      fail("{}: camera {} has the unknown model {}: expected 0 to 17", path, lens.id, model);
    lens.model = &colmap_models[model];
    for (std::size_t k = 0; k < lens.model->parameters; ++k) lens.parameters.push_back(cursor.take<double>());
    add(lenses, cursor.where(), std::move(lens));
  }
  return lenses;
}

std::map<std::uint32_t, ColmapLens> colmap_lenses_text(const std::filesystem::path& path) {
  const MappedFile file(path);
  Lines lines(path, as_text(file.bytes()));
  std::map<std::uint32_t, ColmapLens> lenses;
  for (std::string_view line; lines.next_record(line);) {
    const std::vector<std::string_view> words = words_of(line);
    if (words.size() < 4) fail("{}: expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS...", lines.where());
    ColmapLens lens;
    lens.id = parse_number<std::uint32_t>(lines, words[0], "number of a camera");
    lens.model = std::ranges::find(colmap_models, words[1], &ColmapModel::name);
    if (lens.model == std::end(colmap_models))
      fail("{}: {} is not a COLMAP camera model", lines.where(), quoted(words[1]));
    lens.width = parse_number<std::uint64_t>(lines, words[2], "number of pixels");
    lens.height = parse_number<std::uint64_t>(lines, words[3], "number of pixels");
    for (std::size_t k = 4; k < words.size(); ++k)
      lens.parameters.push_back(parse_number<double>(lines, words[k], "number"));
    if (lens.parameters.size() != lens.model->parameters) {
      fail("{}: {} parameters; the model {} has {}", lines.where(), lens.parameters.size(), words[1],
           lens.model->parameters);
    }
    add(lenses, lines.where(), std::move(lens));
  }
  return lenses;
}

std::vector<ColmapImage> colmap_images(const std::filesystem::path& path) {
  constexpr std::size_t observation = 24;
  const MappedFile file(path);
  Cursor cursor(path, file.bytes());
  std::vector<ColmapImage> images;
  const auto count = cursor.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    cursor.at_record("image", i, count);
    ColmapImage& image = images.emplace_back();
    image.id = cursor.take<std::uint32_t>();
    for (int c = 0; c < 4; ++c) image.rotation[c] = cursor.take<double>();
    for (int c = 0; c < 3; ++c) image.translation[c] = cursor.take<double>();
    image.lens = cursor.take<std::uint32_t>();
    image.rotation = unit(cursor.where(), image.rotation);
    check_pose(cursor.where(), image);
    image.name = cursor.take_name();
    cursor.skip(cursor.take<std::uint64_t>(), observation);
  }
  return images;
}

std::vector<ColmapImage> colmap_images_text(const std::filesystem::path& path) {
  const MappedFile file(path);
  Lines lines(path, as_text(file.bytes()));
  std::vector<ColmapImage> images;
  bool may_be_points = false;  // the next line may list the last image's points; some programs omit them
  for (std::string_view line; lines.next_no_comment(line);) {
    const bool points = std::exchange(may_be_points, false);
    if (line.empty() || (points && are_points(line))) continue;
    if (points && !is_image(line))
      fail("{}: expected the points seen in image {} (X Y POINT3D_ID ...), an empty line, or the next image",
           lines.where(), images.back().id);
    const std::vector<std::string_view> words = fields_of_image(line);
    if (words.size() < 10) fail("{}: expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME", lines.where());
    ColmapImage& image = images.emplace_back();
    image.id = parse_number<std::uint32_t>(lines, words[0], "number of an image");
    for (std::size_t c = 0; c < 4; ++c)
      image.rotation[static_cast<int>(c)] = parse_number<double>(lines, words[1 + c], "number");
    for (std::size_t c = 0; c < 3; ++c)
      image.translation[static_cast<int>(c)] = parse_number<double>(lines, words[5 + c], "number");
    image.rotation = unit(lines.where(), image.rotation);
    check_pose(lines.where(), image);
    image.lens = parse_number<std::uint32_t>(lines, words[8], "number of a camera");
    image.name = std::string(words[9]);
    may_be_points = true;
  }
  return images;
}

}  // namespace binosplat
