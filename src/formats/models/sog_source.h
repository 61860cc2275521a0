#pragma once
// One SOG in any storage: a folder, an archive, a test's memory.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/containers/opened_file.h"
#include "scene/model.h"

namespace binosplat {

class SogSource {
 public:
  /// Returns the bytes of meta.json's file `name`, or throws Error naming it. Must be thread-safe.
  using ReadFile = std::function<std::vector<std::byte>(const std::string& name)>;

  /// Gaussians `first` to `first + count - 1` of the SOG. In a model these Gaussians begin at index `slot`.
  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
    std::size_t slot = 0;
  };

  /// Checks meta.json and the pictures' headers. Errors name `source`, the meta.json or archive.
  SogSource(std::string source, const nlohmann::json& json, ReadFile read);

  std::size_t count() const { return count_; }
  /// Bytes of the picture that compresses least, for max_gaussians_in() (formats/containers/size_limits.h).
  std::uint64_t bytes() const { return bytes_; }
  int degree() const { return degree_; }
  bool flat() const { return training_.flat; }  // 2D Gaussian Splatting: the third scale is 0
  const Training& training() const { return training_; }

  /// All decoded pictures of the SOG, four bytes a texel. Decoding dominates the time even of few Gaussians.
  struct Textures {
    std::array<std::vector<std::uint8_t>, 6> data;
    std::size_t bytes() const;
  };
  std::shared_ptr<const Textures> textures() const;

  /// Decodes ranges, which must lie below count(), into a model of degree() or a higher degree. Sets kept[i]
  /// if the model's Gaussian i is valid. Several threads may call it for disjoint Gaussians of the model.
  void decode(Model& model, std::span<const Range> ranges, std::vector<std::uint8_t>& kept) const {
    decode(model, ranges, kept, *textures());
  }
  void decode(Model& model, std::span<const Range> ranges, std::vector<std::uint8_t>& kept,
              const Textures& textures) const;
  /// Returns a model of each range's valid Gaussians, with `like`'s other properties. Ignores Range::slot.
  std::vector<Model> decode_each(const Model& like, std::span<const Range> ranges,
                                 const Textures& textures) const;

 private:
  using Table = std::array<float, 256>;  // value of each byte

  void read_tables_v1(const JsonValue& meta);
  void read_harmonics(const JsonValue& sh);
  std::string named(const std::string& file) const;
  std::vector<std::uint8_t> texels(const std::string& file) const;
  bool decode_one(const Textures& textures, std::size_t i, Model& model, std::size_t slot) const;

  std::string source_;
  ReadFile read_;
  std::size_t count_ = 0;
  std::uint64_t bytes_ = 0;
  int degree_ = 0;
  Training training_;
  std::array<std::string, 5> files_;  // means_l, means_u, quats, scales, sh0
  std::string labels_file_;           // empty without higher harmonics
  glm::dvec3 mean_low_{0.0};          // least stored position, sign(p) ln(1 + |p|)
  glm::dvec3 mean_span_{0.0};
  std::array<Table, 3> scale_;  // per axis, world units
  std::array<Table, 3> dc_;     // per channel, coefficients of degree 0
  Table opacity_;
  Table sh_;                 // coefficients of the higher degrees
  std::size_t palette_ = 0;  // number of entries; a label beyond them means no harmonics
  std::vector<std::uint8_t> palette_texels_;
};

/// Opens a SOG by its meta.json or its archive, recognised by content. The file need not outlive the result.
SogSource open_sog(const OpenedFile& file);

/// Opens the SOG of a meta.json, with pictures in its folder.
SogSource sog_in_folder(const std::filesystem::path& meta, const nlohmann::json& root);

/// Opens the SOG in a .sog archive: the meta.json that is nearest to the archive's root, with pictures in its
/// folder. Throws Error if there is none, or if several are equally near.
SogSource sog_in_archive(const std::filesystem::path& archive);

}  // namespace binosplat
