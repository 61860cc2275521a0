#include "formats/models/spz.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include "formats/containers/bytes.h"
#include "formats/containers/content.h"
#include "formats/models/smallest_three.h"
#include "formats/models/spz_container.h"
#include "formats/training/trainer_keys.h"

namespace binosplat {

namespace {

class SpzDecoder {
 public:
  explicit SpzDecoder(const SpzContents& contents)
      : contents_(contents), sizes_(spz_sizes(contents.version, contents.degree)) {
    const std::byte* at = contents.attributes.data();
    for (std::size_t k = 0; k < sizes_.size(); ++k)
      at_[k] = std::exchange(at, at + contents.count * sizes_[k]);
  }

  bool decode(Model& model, std::size_t i) const {
    std::array<float, 3 * sh_count(3)> sh{};
    glm::vec3 scale;
    for (std::size_t c = 0; c < 3; ++c) {
      sh[c] = static_cast<float>((byte(spz_colours, i, c) / 255.0 - 0.5) / spz_colour_scale);
      scale[static_cast<int>(c)] = static_cast<float>(std::exp(byte(spz_scales, i, c) / 16.0 - 10.0));
    }
    const std::size_t kept = std::min<std::size_t>(sizes_[spz_harmonics], sh.size() - 3);
    for (std::size_t k = 0; k < kept; ++k)
      sh[3 + k] = static_cast<float>(byte(spz_harmonics, i, k) - 128) / 128.0f;
    const float opacity = static_cast<float>(byte(spz_opacities, i, 0) / 255.0);
    return place(model, i, {position(i), scale, rotation(i), opacity, sh.data()});
  }

 private:
  const std::byte* bytes(SpzAttribute attribute, std::size_t i) const {
    return at_[attribute] + sizes_[attribute] * i;
  }
  int byte(SpzAttribute attribute, std::size_t i, std::size_t k) const {
    return std::to_integer<int>(bytes(attribute, i)[k]);
  }

  glm::vec3 position(std::size_t i) const {
    const std::byte* at = bytes(spz_positions, i);
    if (contents_.version == 1) return {load_half(at), load_half(at + 2), load_half(at + 4)};
    glm::vec3 p;
    for (int c = 0; c < 3; ++c, at += 3) {
      const std::uint32_t bits = load_number<std::uint16_t>(at) | std::to_integer<std::uint32_t>(at[2]) << 16;
      const int fixed = static_cast<int>(bits << 8) >> 8;  // sign-extends 24 bits
      p[c] = static_cast<float>(std::ldexp(fixed, -contents_.fraction_bits));
    }
    return p;
  }

  /// Returns w, x, y, z. Versions 1 and 2 store x, y, z; later versions the three smallest of x, y, z, w.
  glm::vec4 rotation(std::size_t i) const {
    SmallestThree three{3};
    for (int c = 0; c < 3 && contents_.version < 3; ++c)
      three.others[c] = byte(spz_rotations, i, static_cast<std::size_t>(c)) / 127.5 - 1.0;
    if (contents_.version >= 3) {
      const auto word = load_number<std::uint32_t>(bytes(spz_rotations, i));
      three.largest = static_cast<int>(bit_field(word, 30, 2));
      for (int k = 0; k < 3; ++k) {
        const int low = 20 - 10 * k;
        const double magnitude = bit_field(word, low, 9) / 511.0 * std::sqrt(0.5);
        three.others[k] = bit_field(word, low + 9, 1) != 0 ? -magnitude : magnitude;
      }
    }
    const glm::dvec4 xyzw = three.quaternion();
    return {glm::dvec4(xyzw.w, xyzw.x, xyzw.y, xyzw.z)};
  }

  const SpzContents& contents_;
  SpzSizes sizes_;
  std::array<const std::byte*, 6> at_{};  // where each attribute begins
};

/// Returns the axes of a file that does not name them, by what is known of its writer. The format's own (RUB)
/// are those of Scaniverse, whose files have version 2, the anti-aliased flag, degree 3 and gzip's number of
/// Apple's systems (19 at byte 9), and of LichtFeld Studio, which writes version 3 without the flag. Spark,
/// SuperSplat, splat-transform, Marble, gsbox and Niantic's own converter store the numbers of a ply.
const char* axes_of_writer(const SpzContents& contents, std::span<const std::byte> bytes) {
  constexpr std::size_t gzip_system = 9;
  const bool scaniverse = contents.version == 2 && contents.antialiased && contents.degree == 3 &&
                          content_of(bytes) == Content::gzip && bytes[gzip_system] == std::byte{19};
  return scaniverse || (contents.version == 3 && !contents.antialiased) ? "RUB" : "RDF";
}

}  // namespace

Model load_spz(const std::string& source, std::span<const std::byte> bytes) {
  const SpzContents contents = unpack_spz(source, bytes);
  Model model;
  model.format = fmt::format("spz {}{}", contents.version, contents.axes ? "" : axes_assumed);
  model.degree = std::min(contents.degree, 3);
  model.axes.letters = contents.axes.value_or(axes_of_writer(contents, bytes));
  if (contents.antialiased) follow(read_keys({"spz"}, {{"antialiased", "true"}}), "its flag", source, model);
  model.lacks_degree_4 = contents.degree == 4;
  const SpzDecoder decoder(contents);
  decode_all(model, contents.count, [&](std::size_t i) { return decoder.decode(model, i); });
  return model;
}

}  // namespace binosplat
