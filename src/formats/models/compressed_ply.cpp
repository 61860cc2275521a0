#include "formats/models/compressed_ply.h"

#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "formats/containers/bytes.h"
#include "formats/models/ply_layout.h"
#include "formats/models/ply_rows.h"
#include "formats/models/smallest_three.h"

namespace binosplat {

namespace {

constexpr std::size_t plain_fields = 12;  // number of fields without the bounds of colours
constexpr const char* vertex_fields[] = {"packed_position", "packed_rotation", "packed_scale",
                                         "packed_color"};

/// An element's rows: their first byte, and the offsets of the wanted properties.
struct PackedRows {
  std::size_t at = 0;
  std::size_t bytes = 0;  // size of a row
  std::size_t count = 0;
  std::vector<std::size_t> offsets;
};

/// Unpacks 11, 10 and 11 bits as three fractions, from the highest bits on.
glm::dvec3 fractions(std::uint32_t word) {
  return {bit_field(word, 21, 11) / 2047.0, bit_field(word, 11, 10) / 1023.0,
          bit_field(word, 0, 11) / 2047.0};
}

/// Unpacks a quaternion: two bits for the largest of w, x, y, z, which is omitted, and 10 for each other one.
glm::vec4 rotation_of(std::uint32_t word) {
  SmallestThree three{static_cast<int>(bit_field(word, 30, 2))};
  for (int k = 0; k < 3; ++k)
    three.others[k] = (bit_field(word, 20 - 10 * k, 10) / 1023.0 - 0.5) * std::sqrt(2.0);
  return three.quaternion();
}

/// Decodes a byte of the harmonics: the middle of the byte's interval, except for 0 and 255.
float harmonic_of(std::byte stored) {
  const int b = std::to_integer<int>(stored);
  const double n = b == 0 ? 0.0 : b == 255 ? 1.0 : (b + 0.5) / 256.0;
  return static_cast<float>((n - 0.5) * 8.0);
}

class CompressedPlyReader {
 public:
  CompressedPlyReader(const std::filesystem::path& path, std::span<const std::byte> bytes,
                      const PlyHeader& header)
      : path_(path), bytes_(bytes), header_(header), flat_(says_flat(header)) {
    if (header.format != PlyFormat::little_endian)
      fail("{}: a compressed ply must have the format binary_little_endian", path_);
    find_elements();
  }

  Model read() const {
    Model model;
    model.name = path_.filename().string();
    model.flat = flat_;
    model.format = flat_ ? "compressed ply, flat Gaussians of 2DGS" : "compressed ply";
    model.degree = degree_;
    read_comments(path_.string(), header_, model);
    decode_all(model, vertices_.count, [&](std::size_t i) { return decode(model, i); });
    return model;
  }

 private:
  /// Finds the elements in the order of their data.
  void find_elements() {
    std::size_t at = header_.data;
    for (const PlyElement& element : header_.elements) {
      if (element.has_list())
        fail("{}: element '{}' of a compressed ply has a list; expected numbers only", path_, element.name);
      const std::size_t end = end_of_rows(path_, bytes_, element, at);
      if (element.name == "chunk") take_chunks(element, at);
      if (element.name == "vertex") take_vertices(element, at);
      if (element.name == "sh") take_harmonics(element, at);
      at = end;
    }
    if (vertices_.offsets.empty()) fail("{}: a compressed ply without element 'vertex'", path_);
    const std::size_t count = vertices_.count;
    if (count == 0) fail("{} holds no Gaussians: its header says 'element vertex 0'", path_);
    if (chunks_.count < (count + packed_chunk_size - 1) / packed_chunk_size) {
      fail("{}: element 'chunk' has {} rows, too few for {} Gaussians at {} per chunk", path_, chunks_.count,
           count, packed_chunk_size);
    }
    if (degree_ > 0 && harmonics_.count < count)
      fail("{}: element 'sh' has {} rows for {} Gaussians", path_, harmonics_.count, count);
    if (at < bytes_.size())
      log_warning("{}: {} bytes after the last element are ignored", path_, bytes_.size() - at);
  }

  void take_chunks(const PlyElement& element, std::size_t at) {
    chunks_ = {at, element.row_bytes(), element.count, {}};
    coloured_ = element.properties.size() > plain_fields;
    const std::size_t fields = coloured_ ? std::size(packed_chunk_fields) : plain_fields;
    for (std::size_t i = 0; i < fields; ++i)
      chunks_.offsets.push_back(offset_in_row(path_, element, packed_chunk_fields[i], PlyType::float32));
  }

  void take_vertices(const PlyElement& element, std::size_t at) {
    vertices_ = {at, element.row_bytes(), element.count, {}};
    for (const char* name : vertex_fields)
      vertices_.offsets.push_back(offset_in_row(path_, element, name, PlyType::uint32));
  }

  void take_harmonics(const PlyElement& element, std::size_t at) {
    const std::size_t values = element.properties.size();
    if (values != 0 && values != 9 && values != 24 && values != 45) {
      fail(
          "{}: element 'sh' has {} properties; expected 9, 24 or 45 (degrees 1 to 3 of the spherical "
          "harmonics)",
          path_, values);
    }
    while (3 * static_cast<std::size_t>(sh_count(degree_) - 1) < values) ++degree_;
    harmonics_ = {at, element.row_bytes(), element.count, {}};
    for (std::size_t k = 0; k < values / 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        harmonics_.offsets.push_back(
            offset_in_row(path_, element, fmt::format("f_rest_{}", c * values / 3 + k), PlyType::uint8));
      }
    }
  }

  /// Interpolates from a chunk's three lower bounds, at `field`, to the three upper bounds after them.
  glm::dvec3 between(std::size_t chunk, std::size_t field, const glm::dvec3& fraction) const {
    const std::byte* row = bytes_.data() + chunks_.at + chunk * chunks_.bytes;
    glm::dvec3 value;
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = field + static_cast<std::size_t>(c);
      const double low = load_number<float>(row + chunks_.offsets[at]);
      const double high = load_number<float>(row + chunks_.offsets[at + 3]);
      value[c] = low + (high - low) * fraction[c];
    }
    return value;
  }

  bool decode(Model& model, std::size_t i) const {
    const std::byte* row = bytes_.data() + vertices_.at + i * vertices_.bytes;
    const auto word = [&](std::size_t k) { return load_number<std::uint32_t>(row + vertices_.offsets[k]); };
    const std::size_t chunk = i / packed_chunk_size;
    const std::uint32_t rgba = word(3);
    glm::dvec3 colour =
        glm::dvec3(bit_field(rgba, 24, 8), bit_field(rgba, 16, 8), bit_field(rgba, 8, 8)) / 255.0;
    if (coloured_) colour = between(chunk, plain_fields, colour);
    std::array<float, 3 * sh_count(3)> sh{};
    for (int c = 0; c < 3; ++c) sh[static_cast<std::size_t>(c)] = sh_of_colour(colour[c]);
    const std::byte* bytes = bytes_.data() + harmonics_.at + i * harmonics_.bytes;
    for (std::size_t k = 0; k < harmonics_.offsets.size(); ++k)
      sh[3 + k] = harmonic_of(bytes[harmonics_.offsets[k]]);
    glm::dvec3 scale = glm::exp(between(chunk, 6, fractions(word(2))));
    if (flat_) scale.z = 0.0;
    return place(model, i,
                 {between(chunk, 0, fractions(word(0))), scale, rotation_of(word(1)),
                  static_cast<float>(bit_field(rgba, 0, 8) / 255.0), sh.data()});
  }

  const std::filesystem::path& path_;
  std::span<const std::byte> bytes_;
  const PlyHeader& header_;
  bool flat_;
  PackedRows chunks_, vertices_, harmonics_;
  bool coloured_ = false;  // chunks have bounds of colours
  int degree_ = 0;
};

}  // namespace

bool is_compressed_ply(const PlyHeader& header) {
  return !header.elements.empty() && header.elements[0].name == "chunk";
}

Model load_compressed_ply(const std::filesystem::path& path, std::span<const std::byte> bytes,
                          const PlyHeader& header) {
  return CompressedPlyReader(path, bytes, header).read();
}

}  // namespace binosplat
