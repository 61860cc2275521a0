#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "formats/containers/bytes.h"
#include "formats/models/ply_rows.h"
#include "formats/models/scaffold_file.h"

namespace binosplat {

namespace {

// A shader has one bit for each Gaussian of an anchor, in one 32-bit word.
constexpr std::size_t offsets_max = 31;
constexpr std::size_t features_max = 256;

/// Offsets of an anchor's numbers in a row of the file.
struct AnchorLayout {
  std::size_t row = 0;  // size of a row, bytes
  std::vector<std::size_t> position, scale, rotation, offset, feature;
};

class AnchorReader {
 public:
  AnchorReader(const OpenedFile& ply, Scaffold& scaffold)
      : path_(ply.path),
        bytes_(ply.bytes()),
        header_(ply.ply()),
        vertices_(header_.find("vertex")),
        scaffold_(scaffold) {
    if (vertices_ == nullptr) fail("{}: the ply header has no element 'vertex'", path_);
  }

  void read() {
    check_form();
    find_columns();
    check_length();
    const std::size_t count = vertices_->count;
    const std::size_t k = scaffold_.offset_count;
    scaffold_.position.resize(count);
    scaffold_.offset_scale.resize(count);
    scaffold_.scale.resize(count);
    scaffold_.rotation.resize(count);
    scaffold_.offset.resize(count * k);
    scaffold_.feature.resize(count * scaffold_.feature_count);
    std::vector<std::uint8_t> good(count);
    parallel_for(
        count, [&](std::size_t n) { good[n] = decode(n) ? 1 : 0; }, 1024);
    keep_only(good);
  }

 private:
  void check_form() const {
    if (header_.format != PlyFormat::little_endian || header_.elements.front().name != "vertex" ||
        vertices_->has_list()) {
      fail(
          "{}: anchors of Scaffold-GS are expected first in a ply of format binary_little_endian, without "
          "lists",
          path_);
    }
  }

  void check_length() {
    layout_.row = vertices_->row_bytes();
    if (vertices_->count == 0) fail("{} holds no anchors: its header says 'element vertex 0'", path_);
    end_of_rows(path_, bytes_, *vertices_, header_.data);
  }

  std::size_t column(const std::string& name) const {
    return offset_in_row(path_, *vertices_, name, PlyType::float32);
  }

  // Returns the columns NAME0, NAME1, ... sorted by number; the file may have any order.
  std::vector<std::size_t> columns(const std::string& name, std::size_t count) const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(column(name + std::to_string(i)));
    return out;
  }

  void find_columns() {
    const std::size_t offsets = vertices_->count_of("f_offset_");
    const std::size_t features = vertices_->count_of("f_anchor_feat_");
    if (offsets == 0 || offsets % 3 != 0 || offsets > 3 * offsets_max) {
      fail("{}: {} properties f_offset_*; expected 3 per Gaussian, with 1 to {} Gaussians per anchor", path_,
           offsets, offsets_max);
    }
    if (features > features_max)
      fail("{}: {} properties f_anchor_feat_*; expected at most {}", path_, features, features_max);
    scaffold_.offset_count = offsets / 3;
    scaffold_.feature_count = features;
    layout_.position = {column("x"), column("y"), column("z")};
    layout_.scale = columns("scale_", 6);
    layout_.rotation = columns("rot_", 4);
    layout_.offset = columns("f_offset_", offsets);
    layout_.feature = columns("f_anchor_feat_", features);
  }

  // Decodes row n to anchor n; returns whether the anchor is valid.
  bool decode(std::size_t n) {
    const std::byte* row = bytes_.data() + header_.data + n * layout_.row;
    bool finite = true;
    const auto number = [&](std::size_t at) {
      const auto value = load_number<float>(row + at);
      finite = finite && std::isfinite(value);
      return value;
    };
    const auto standard_deviation = [&](std::size_t at) {
      const float value = std::exp(number(at));
      finite = finite && std::isfinite(value);
      return value;
    };
    const std::size_t k = scaffold_.offset_count;
    glm::dvec4 q(0.0);
    for (int c = 0; c < 3; ++c) {
      scaffold_.position[n][c] = number(layout_.position[c]);
      scaffold_.offset_scale[n][c] = standard_deviation(layout_.scale[c]);
      scaffold_.scale[n][c] = standard_deviation(layout_.scale[3 + c]);
      for (std::size_t i = 0; i < k; ++i)
        scaffold_.offset[n * k + i][c] = number(layout_.offset[static_cast<std::size_t>(c) * k + i]);
    }
    for (int c = 0; c < 4; ++c) q[c] = number(layout_.rotation[c]);
    const double norm = glm::length(q);
    scaffold_.rotation[n] = glm::vec4(q / norm);
    for (std::size_t i = 0; i < scaffold_.feature_count; ++i)
      scaffold_.feature[n * scaffold_.feature_count + i] = number(layout_.feature[i]);
    return finite && norm > 0.0;
  }

  void keep_only(const std::vector<std::uint8_t>& good) {
    const auto close = [&](auto& values, std::size_t each) {
      auto to = values.begin();
      for (std::size_t n = 0; n < good.size(); ++n) {
        if (good[n] == 0) continue;
        const auto from = values.begin() + static_cast<std::ptrdiff_t>(n * each);
        if (to != from) std::copy_n(from, each, to);
        to += static_cast<std::ptrdiff_t>(each);
      }
      values.erase(to, values.end());
    };
    close(scaffold_.position, 1);
    close(scaffold_.offset_scale, 1);
    close(scaffold_.scale, 1);
    close(scaffold_.rotation, 1);
    close(scaffold_.offset, scaffold_.offset_count);
    close(scaffold_.feature, scaffold_.feature_count);
    scaffold_.left_out = good.size() - scaffold_.anchor_count();
    if (scaffold_.anchor_count() == 0) {
      fail("{}: all of its {} anchors have values that are not finite or zero quaternions", path_,
           good.size());
    }
  }

  const std::filesystem::path& path_;
  std::span<const std::byte> bytes_;
  const PlyHeader& header_;
  const PlyElement* vertices_;
  AnchorLayout layout_;
  Scaffold& scaffold_;
};

}  // namespace

void load_anchors(const OpenedFile& ply, Scaffold& scaffold) {
  scaffold.name = ply.path.filename().string();
  AnchorReader(ply, scaffold).read();
}

}  // namespace binosplat
