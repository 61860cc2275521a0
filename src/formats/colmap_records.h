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

struct ColmapLens {
  std::uint32_t id = 0;
  int model = 0;            // COLMAP's number of the lens model
  std::uint64_t width = 0;  // px
  std::uint64_t height = 0;
  std::vector<double> parameters;  // parameters of the lens model; none if the model is unknown
};

struct ColmapImage {
  std::uint32_t id = 0;
  glm::dvec4 rotation{0.0};  // world to camera, unit quaternion w x y z
  glm::dvec3 translation{0.0};
  std::uint32_t lens = 0;
  std::string name;
};

/// Returns the name of a lens model, or "" for an unknown number.
std::string_view colmap_model_name(int model);

/// Each function reads a whole file. For damaged or cut files throws Error, naming the file and the record.
std::map<std::uint32_t, ColmapLens> colmap_lenses(const std::filesystem::path& path);
std::map<std::uint32_t, ColmapLens> colmap_lenses_text(const std::filesystem::path& path);
std::vector<ColmapImage> colmap_images(const std::filesystem::path& path);
std::vector<ColmapImage> colmap_images_text(const std::filesystem::path& path);

}  // namespace binosplat
