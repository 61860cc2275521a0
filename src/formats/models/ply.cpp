#include "formats/models/ply.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "base/numbers.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "formats/containers/bytes.h"
#include "formats/containers/content.h"
#include "formats/models/compressed_ply.h"
#include "formats/models/ply_binary_numbers.h"
#include "formats/models/ply_layout.h"
#include "formats/models/ply_rows.h"
#include "formats/training/trainer_keys.h"

namespace binosplat {

namespace {

constexpr std::size_t progress_block = 65536;  // Gaussians between two reports of progress

class PlyText : public PlyLines {
 public:
  using PlyLines::PlyLines;

  void parse_row(const PlyElement& element, std::uint64_t row, std::string_view line,
                 std::vector<double>& values) {
    values.clear();
    std::string_view rest = line;
    for (const PlyProperty& property : element.properties) {
      const double value = parse_value(element, row, property, rest);
      values.push_back(value);
      if (property.count_type) {
        if (value < 0 || value != std::floor(value)) {
          fail("{}, line {}: list '{}' of element '{}' {} has length {}", path_, number(), property.name,
               element.name, row, value);
        }
        for (double k = 0; k < value; ++k) parse_value(element, row, property, rest);
      }
    }
    if (rest.find_first_not_of(blanks) != std::string_view::npos) {
      fail("{}, line {}: element '{}' {} has more values than its {} properties", path_, number(),
           element.name, row, element.properties.size());
    }
  }

  double value_of(const PlyLayout& layout, const PlyLayout::Source& source,
                  const std::vector<double>& values) const {
    const double value = values[source.property];
    if (!source.as_bits) return value;
    if (value >= 0.0 && value <= 65535.0 && value == std::floor(value))
      return half_of(static_cast<std::uint16_t>(value));
    fail("{}, line {}: property '{}' of type ushort is {}; expected the bits of a half, 0 to 65535", path_,
         number(), layout.vertices->properties[source.property].name, value);
  }

 private:
  double parse_value(const PlyElement& element, std::uint64_t row, const PlyProperty& property,
                     std::string_view& rest) const {
    const std::size_t begin = std::min(rest.find_first_not_of(blanks), rest.size());
    const std::size_t end = std::min(rest.find_first_of(blanks, begin), rest.size());
    const std::string_view word = rest.substr(begin, end - begin);
    rest.remove_prefix(end);
    if (word.empty()) {
      fail("{}, line {}: element '{}' {} ends before property '{}'", path_, number(), element.name, row,
           property.name);
    }
    const std::optional<double> value = parse_real(word);
    if (!value) {
      fail("{}, line {}: {} is not a number (property '{}' of element '{}' {})", path_, number(),
           quoted(word), property.name, element.name, row);
    }
    return *value;
  }
};

/// Colours other than uchar were read as 0 to 1. Some programs write 0 to 255, so the largest value decides.
void scale_colours(const std::filesystem::path& path, const std::vector<std::uint8_t>& kept, Model& model) {
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(model.degree));
  constexpr double most = 2.0;  // maximum for colours from 0 to 1, because trained colours may exceed 1
  double largest = 0.0;
  for (std::size_t k = 0; k < model.sh.size(); ++k) {
    if (k % values < 3 && kept[k / values] != 0) largest = std::max(largest, 0.5 + sh_c0 * model.sh[k]);
  }
  if (largest > 255.5)
    fail("{}: properties red, green and blue reach {:.6g}; expected 0 to 1, or 0 to 255", path, largest);
  for (std::size_t k = 0; largest > most && k < model.sh.size(); ++k) {
    if (k % values < 3) model.sh[k] = sh_of_colour((0.5 + sh_c0 * model.sh[k]) / 255.0);
  }
}

/// Walks the elements of a ply file in order and decodes the Gaussians among them.
class PlyReader {
 public:
  PlyReader(const std::filesystem::path& path, std::span<const std::byte> bytes, const PlyHeader& header)
      : path_(path),
        bytes_(bytes),
        header_(header),
        layout_(find_layout(path, header_)),
        swapped_(is_swapped(header_.format)),
        at_(header_.data),
        text_(path, as_text(bytes), header),
        progress_("reading " + path.filename().string(), layout_.vertices->count) {}

  Model read() {
    model_.name = path_.filename().string();
    model_.format = layout_.flat ? "ply, flat Gaussians of 2DGS" : "ply";
    model_.flat = layout_.flat;
    model_.degree = layout_.degree;
    read_comments(path_.string(), header_, model_);
    model_.up = up_comment(header_);
    if (layout_.filter_3d)
      follow({.kernel_px2 = 0.1, .antialiased = true}, by_filter, path_.string(), model_);
    for (const PlyElement& element : header_.elements) {
      const bool gaussians = &element == layout_.vertices;
      if (header_.format == PlyFormat::ascii) {
        read_text(element, gaussians);
      } else if (element.has_list()) {
        read_ragged(element, gaussians);
      } else {
        read_fixed(element, gaussians);
      }
    }
    if (header_.format != PlyFormat::ascii && at_ < bytes_.size())
      log_warning("{}: {} bytes after the last element are ignored", path_, bytes_.size() - at_);
    if (layout_.flat) {
      log_info("{}: its Gaussians are flat (2D Gaussian Splatting) and drawn as 3D ones without thickness",
               path_);
    }
    if (layout_.rgb && !layout_.rgb_bytes) scale_colours(path_, kept_, model_);
    warn_if_activated();
    model_.lacks_degree_4 = layout_.lacks_degree_4;
    keep_only(model_, kept_);
    if (layout_.wide) {
      std::size_t i = 0;
      std::erase_if(places_, [&](const glm::dvec3&) { return kept_[i++] == 0; });
      set_far_positions(model_, places_);
    }
    return std::move(model_);
  }

 private:
  /// Some programs write scales and opacities instead of the logarithms and logits of a ply. They decode to
  /// scales of 1 or more, and opacities from 0.5 to 0.731.
  void warn_if_activated() const {
    const auto is_activated = [&](std::size_t i) {
      const glm::vec3& s = model_.scale[i];
      return std::min(s.x, s.y) >= 1.0f && model_.opacity[i] >= 0.5f && model_.opacity[i] <= 0.7311f;
    };
    std::size_t activated = 0;
    for (std::size_t i = 0; i < model_.count(); ++i) activated += is_activated(i) ? 1 : 0;
    if (activated > model_.count() - model_.count() / 20)
      log_warning(
          "{}: it seems to hold scales and opacities, not the logarithms and logits of a ply, and looks like "
          "fog: store log(scale) and log(opacity / (1 - opacity))",
          path_);
  }

  /// Allocates all Gaussians. The caller has checked that the file is long enough.
  void make_larger() {
    model_.resize(layout_.vertices->count);
    kept_.assign(layout_.vertices->count, 0);
    if (layout_.wide) places_.resize(layout_.vertices->count);
  }

  /// Decodes Gaussian i; number(source) returns each of its numbers.
  template <typename Number>
  void keep(std::size_t i, const Number& number) {
    RawGaussian raw;
    for (std::size_t k = 0; k < layout_.sources.size(); ++k) {
      const double value = number(layout_.sources[k]);
      raw[k] = static_cast<float>(value);
      if (layout_.wide && k < 3) places_[i][static_cast<glm::length_t>(k)] = value;
    }
    kept_[i] = decode(layout_, model_, i, raw) ? 1 : 0;
  }

  [[noreturn]] void fail_cut(const PlyElement& element, std::uint64_t row) const {
    fail("{} is cut short: element '{}' {} of {} exceeds the file's {} bytes; fetch or export it again",
         path_, element.name, row, element.count, bytes_.size());
  }

  /// Reads binary rows without lists, which all have the same size.
  void read_fixed(const PlyElement& element, bool gaussians) {
    const std::size_t row = element.row_bytes(), behind = end_of_rows(path_, bytes_, element, at_);
    if (gaussians) {
      make_larger();
      std::vector<std::size_t> offsets;
      find_offsets(element, at_, offsets);
      for (std::size_t begin = 0; begin < element.count; begin += progress_block) {
        const std::size_t end = std::min<std::size_t>(begin + progress_block, element.count);
        parallel_for(
            end - begin,
            [&](std::size_t k) { keep_row(begin + k, bytes_.data() + at_ + (begin + k) * row, offsets); },
            2048);
        progress_.update(end);
      }
    }
    at_ = behind;
  }

  /// Reads binary rows with lists. Only reading all rows reveals their sizes.
  void read_ragged(const PlyElement& element, bool gaussians) {
    const std::size_t most = (bytes_.size() - at_) / element.row_bytes();
    if (element.count > most) fail_cut(element, most);
    if (gaussians) make_larger();
    std::vector<std::size_t> offsets;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const std::size_t end = find_offsets(element, at_, offsets);
      if (end > bytes_.size()) fail_cut(element, i);
      if (gaussians) keep_row(i, bytes_.data() + at_, offsets);
      if (gaussians && i % 4096 == 0) progress_.update(i);
      at_ = end;
    }
  }

  /// Finds the offset of each property in the row at byte `row`. Returns the row's end, or one byte beyond
  /// the file's end if the row does not fit.
  std::size_t find_offsets(const PlyElement& element, std::size_t row,
                           std::vector<std::size_t>& offsets) const {
    offsets.clear();
    std::size_t at = row;
    const std::size_t beyond = bytes_.size() + 1;
    for (const PlyProperty& property : element.properties) {
      offsets.push_back(at - row);
      std::size_t length = 1;
      if (property.count_type) {
        if (size_of(*property.count_type) > bytes_.size() - at) return beyond;
        const double count = load_ply_number(*property.count_type, bytes_.data() + at, swapped_);
        if (count < 0) return beyond;
        length = static_cast<std::size_t>(count);
        at += size_of(*property.count_type);
      }
      if (length * size_of(property.type) > bytes_.size() - at) return beyond;
      at += length * size_of(property.type);
    }
    return at;
  }

  void keep_row(std::size_t i, const std::byte* row, const std::vector<std::size_t>& offsets) {
    keep(i, [&](const PlyLayout::Source& source) {
      return load_ply_number(source.type, row + offsets[source.property], swapped_);
    });
  }

  /// Reads text: one line a row.
  void read_text(const PlyElement& element, bool gaussians) {
    if (element.properties.empty()) return;
    // A value takes at least a digit and a blank.
    const std::size_t shortest = 2 * element.properties.size();
    const std::size_t left = text_.left() + 1;
    if (element.count > left / shortest) fail_cut(element, left / shortest);
    if (gaussians) make_larger();
    std::vector<double> values;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const std::string_view line = text_.next(element, i);
      if (!gaussians) continue;
      text_.parse_row(element, i, line, values);
      keep(i, [&](const PlyLayout::Source& source) { return text_.value_of(layout_, source, values); });
      if (i % 4096 == 0) progress_.update(i);
    }
  }

  const std::filesystem::path& path_;
  std::span<const std::byte> bytes_;
  const PlyHeader& header_;
  PlyLayout layout_;
  bool swapped_;
  std::size_t at_;  // byte where the next element begins
  PlyText text_;
  Progress progress_;
  Model model_;
  std::vector<std::uint8_t> kept_;
  std::vector<glm::dvec3> places_;  // positions as doubles, if layout_.wide
};

}  // namespace

Model load_ply(const OpenedFile& file) {
  if (is_compressed_ply(file.ply())) return load_compressed_ply(file.path, file.bytes(), file.ply());
  return PlyReader(file.path, file.bytes(), file.ply()).read();
}

}  // namespace binosplat
