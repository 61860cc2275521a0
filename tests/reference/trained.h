#pragma once
// The trained models of the shared scenes and their views, for tests of the reference.

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/cameras/cameras_file.h"
#include "formats/models/ply.h"
#include "reference/render.h"
#include "support/scenes.h"

namespace binosplat::reference {

/// A trained model of the shared scenes, and what belongs to it.
struct Trained {
  const char* scene;
  const char* ply;
  const char* inria;   // folder of INRIA's 8-bit pictures
  const char* psnr;    // PSNR of those against the photos
  double inria_bound;  // dB: docs/method.md's smallest figure for these pictures, less 0.1
};
inline constexpr Trained fox{"fox", "fox.ply", "inria", "psnr.json", 81.7};
inline constexpr Trained fox_pruned{"fox", "fox_pruned.ply", "inria_pruned", "psnr_pruned.json", 87.4};
inline constexpr Trained garden{"garden", "garden.ply", "inria", "psnr.json", 81.3};

/// The camera of that name in a file.
inline Camera camera_named(const std::filesystem::path& file, const std::string& name) {
  const std::vector<Camera> cameras = load_cameras(file);
  const auto camera =
      std::find_if(cameras.begin(), cameras.end(), [&](const Camera& each) { return each.name == name; });
  if (camera == cameras.end()) throw std::runtime_error("no camera " + name);
  return *camera;
}

/// A model as one camera sees it: projected and in order.
struct Scene {
  shared::View view;
  std::vector<Splat> splats;
  std::vector<std::uint32_t> order;

  Scene(const Model& model, const Camera& camera)
      : view(make_view(camera)), splats(project_all(model, view)), order(depth_order(splats)) {}

  TileLists lists(int tiles) const { return make_lists(splats, order, view, tiles); }
  double pixels() const { return double(view.width) * view.height; }
};

}  // namespace binosplat::reference
