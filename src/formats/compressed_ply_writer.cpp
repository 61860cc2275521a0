// PlayCanvas' compressed ply.

#include <array>
#include <limits>

#include "formats/bytes.h"
#include "formats/compressed_ply.h"
#include "formats/model_writers.h"
#include "formats/morton.h"
#include "formats/perspective.h"
#include "formats/row_writer.h"

namespace binosplat {

namespace {

/// Logarithms of scales beyond this are clipped, as by PlayCanvas.
constexpr double packed_log_scale_most = 20.0;
/// The higher harmonics reach from -4 to 4.
constexpr double harmonic_most = 4.0;

struct PackedBox {
  glm::vec3 low{std::numeric_limits<float>::max()};
  glm::vec3 high{std::numeric_limits<float>::lowest()};

  void add(const glm::vec3& v) {
    low = glm::min(low, v);
    high = glm::max(high, v);
  }

  /// Where `v` lies between the ends, in 2^bits - 1 steps.
  std::uint32_t step(const glm::vec3& v, int c, int bits) const {
    const double extent = static_cast<double>(high[c]) - low[c];
    const std::uint32_t most = (1u << bits) - 1u;
    return extent > 0.0 ? nearest_step((static_cast<double>(v[c]) - low[c]) / extent * most, most) : 0u;
  }

  /// 11, 10 and 11 bits, the first highest.
  std::uint32_t packed(const glm::vec3& v) const {
    return step(v, 0, 11) << 21 | step(v, 1, 10) << 11 | step(v, 2, 11);
  }
};

class CompressedPlyWriter {
 public:
  CompressedPlyWriter(OutputFile& file, const Model& model)
      : file_(file),
        model_(model),
        order_(morton_order(model.position)),
        values_(3 * static_cast<std::size_t>(sh_count(model.degree))) {}

  void write() {
    const std::size_t n = model_.count(), chunks = (n + packed_chunk_size - 1) / packed_chunk_size;
    const std::size_t higher = values_ - 3;
    std::string header = fmt::format("ply\nformat binary_little_endian 1.0\nelement chunk {}\n", chunks);
    for (const char* field : packed_chunk_fields) header += fmt::format("property float {}\n", field);
    header += fmt::format("element vertex {}\n", n);
    for (const char* field : {"packed_position", "packed_rotation", "packed_scale", "packed_color"})
      header += fmt::format("property uint {}\n", field);
    if (higher > 0) header += fmt::format("element sh {}\n", n);
    for (std::size_t k = 0; k < higher; ++k) header += fmt::format("property uchar f_rest_{}\n", k);
    header += antialias_comment(model_);
    header += perspective_comments(model_.perspective);
    file_.write(header + "end_header\n");

    boxes_.resize(chunks);
    RowWriter rows([&](std::span<const std::byte> bytes) { file_.write(bytes); },
                   chunks + (higher > 0 ? 2 : 1) * n);
    rows.write(chunks, 4 * std::size(packed_chunk_fields),
               [&](std::size_t chunk, std::byte* row) { put_chunk(chunk, row); });
    rows.write(n, 16, [&](std::size_t slot, std::byte* row) { put_vertex(slot, row); });
    if (higher > 0)
      rows.write(n, higher, [&](std::size_t slot, std::byte* row) { put_harmonics(slot, row); });
  }

  glm::vec3 log_scale(std::size_t i) const {
    return glm::clamp(glm::log(glm::dvec3(model_.scale[i])), -packed_log_scale_most, packed_log_scale_most);
  }

 private:
  glm::vec3 colour(std::size_t i) const {
    const float* dc = &model_.sh[i * values_];
    return 0.5 + sh_c0 * glm::dvec3(dc[0], dc[1], dc[2]);
  }

  void put_chunk(std::size_t chunk, std::byte* row) {
    std::array<PackedBox, 3>& boxes = boxes_[chunk];
    for (std::size_t k = chunk * packed_chunk_size;
         k < std::min((chunk + 1) * packed_chunk_size, order_.size()); ++k) {
      const std::size_t i = order_[k];
      boxes[0].add(model_.position[i]);
      boxes[1].add(log_scale(i));
      boxes[2].add(colour(i));
    }
    for (const PackedBox& box : boxes) {
      for (const glm::vec3& end : {box.low, box.high}) {
        for (int c = 0; c < 3; ++c, row += 4) store_number(row, end[c]);
      }
    }
  }

  void put_vertex(std::size_t slot, std::byte* row) const {
    const std::size_t i = order_[slot];
    const std::array<PackedBox, 3>& boxes = boxes_[slot / packed_chunk_size];
    const SmallestThree q = smallest_three(model_.rotation[i]);
    auto rotation = static_cast<std::uint32_t>(q.largest);
    for (int c = 0; c < 3; ++c)
      rotation = rotation << 10 | nearest_step((q.others[c] / std::sqrt(2.0) + 0.5) * 1023.0, 1023);
    const glm::vec3 rgb = colour(i);
    std::uint32_t rgba = 0;
    for (int c = 0; c < 3; ++c) rgba = rgba << 8 | boxes[2].step(rgb, c, 8);
    rgba = rgba << 8 | nearest_step(255.0 * model_.opacity[i], 255);
    store_number(row, boxes[0].packed(model_.position[i]));
    store_number(row + 4, rotation);
    store_number(row + 8, boxes[1].packed(log_scale(i)));
    store_number(row + 12, rgba);
  }

  /// Channel-major. Readers take the middle of a step, but for the first and the last.
  void put_harmonics(std::size_t slot, std::byte* row) const {
    const float* sh = &model_.sh[order_[slot] * values_];
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 3; k < values_; k += 3) {
        const double step = std::floor((sh[k + c] / (2.0 * harmonic_most) + 0.5) * 256.0);
        *row++ = static_cast<std::byte>(std::clamp(step, 0.0, 255.0));
      }
    }
  }

  OutputFile& file_;
  const Model& model_;
  std::vector<std::uint32_t> order_;
  std::size_t values_;                           // coefficients of a Gaussian, all channels
  std::vector<std::array<PackedBox, 3>> boxes_;  // by chunk: positions, logarithms of scales, base colours
};

}  // namespace

Losses write_compressed_ply(OutputFile& file, const Model& model) {
  CompressedPlyWriter(file, model).write();
  Losses losses;
  count_lost(losses, model, "scales beyond e^-20 to e^20, which a compressed ply clips", [&](std::size_t i) {
    const glm::dvec3 scale(model.scale[i]);
    const double most = std::exp(packed_log_scale_most) * 1.000001;  // e^20 itself, as fp32 has it, is none
    return std::min({scale.x, scale.y, scale.z}) * most < 1.0 || std::max({scale.x, scale.y, scale.z}) > most;
  });
  const std::size_t values = model.sh.size() / model.count();
  count_lost(losses, model, "harmonics beyond -4 to 4, which a compressed ply clips", [&](std::size_t i) {
    const float* sh = &model.sh[i * values];
    return std::any_of(sh + 3, sh + values, [](float v) { return std::abs(v) > harmonic_most; });
  });
  return losses;
}

}  // namespace binosplat
