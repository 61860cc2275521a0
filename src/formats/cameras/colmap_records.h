#pragma once
// The records of COLMAP's files, as stored.

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace binosplat {

/// A lens model (src/colmap/sensor/models.h in COLMAP).
struct ColmapModel {
  std::string_view name;
  std::size_t parameters;
  /// The number of focal lengths of a pinhole with distortion; the principal point follows, then the
  /// distortion. 0 for other lenses. Even without distortion a fisheye is none of these: its distances from
  /// the centre are proportional to angles.
  std::size_t focal_lengths = 0;
};

struct ColmapLens {
  std::uint32_t id = 0;
  const ColmapModel* model = nullptr;
  std::uint64_t width = 0;  // px
  std::uint64_t height = 0;
  std::vector<double> parameters;  // of the lens model
};

struct ColmapImage {
  std::uint32_t id = 0;
  glm::dvec4 rotation{0.0};  // world to camera, unit quaternion w x y z
  glm::dvec3 translation{0.0};
  std::uint32_t lens = 0;
  std::string name;
};

/// Each function reads a whole file. For damaged or cut files throws Error, naming the file and the record.
std::map<std::uint32_t, ColmapLens> colmap_lenses(const std::filesystem::path& path);
std::map<std::uint32_t, ColmapLens> colmap_lenses_text(const std::filesystem::path& path);
std::vector<ColmapImage> colmap_images(const std::filesystem::path& path);
std::vector<ColmapImage> colmap_images_text(const std::filesystem::path& path);

}  // namespace binosplat
