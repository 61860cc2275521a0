#include "adagscale/training_cameras.h"

#include <algorithm>

#include "formats/cameras/cameras_file.h"
#include "formats/cameras/dataparser.h"
#include "scene/framing.h"

namespace binosplat::adagscale {

std::vector<Camera> training_cameras(const Model& model) {
  const CoredModel cored(model);
  std::vector<Camera> cameras;
  if (const auto file = model.path.empty() ? std::nullopt : find_cameras(model.path)) {
    cameras = load_cameras(*file);
    if (const auto moved = find_dataparser(model.path)) move_into_training(*moved, *file, cameras);
    const std::vector<std::string> names = test_split(file->string(), cameras, {}).training;
    if (cameras.size() >= 8)  // of fewer, one in eight would be the first alone
      std::erase_if(cameras, [&](const Camera& c) { return std::ranges::count(names, c.name) == 0; });
    std::erase_if(cameras, [&](const Camera& c) { return !any_camera_sees(std::span(&c, 1), cored); });
  }
  if (cameras.empty()) cameras.push_back(frame_model(cored, 1280, 720));
  return cameras;
}

}  // namespace binosplat::adagscale
