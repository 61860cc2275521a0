#include "app/sequence.h"

#include <algorithm>
#include <set>

#include "app/load_scene.h"
#include "base/error.h"
#include "base/log.h"
#include "formats/model_file.h"

namespace binosplat::app {

namespace fs = std::filesystem;

std::vector<fs::path> sequence_of(const RenderOptions& o) {
  std::error_code ignored;
  if (!o.output.fps || !fs::is_directory(o.scene.name, ignored)) return {};
  std::vector<fs::path> files = models_in(o.scene.name);
  if (files.size() < 2) return {};
  for (const auto& [given, option] :
       {std::pair(o.scene.detail.has_value(), "--detail"),
        std::pair(o.scene.gpu_memory.has_value(), "--gpu-memory"), std::pair(o.resume, "--resume"),
        std::pair(!o.drawing.calibration.empty(), "--calibration")}) {
    if (given)
      fail("{} is for one model, and {} is a folder of {} that --fps draws one after the other", option,
           o.scene.name, files.size());
  }
  return files;
}

void show_in_turn(const std::vector<fs::path>& files, std::vector<Shot>& shots) {
  if (shots.size() == 1) shots.resize(files.size(), shots[0]);
  if (shots.size() != files.size()) {
    log_info("{} models and {} views: the first {} of both are drawn", files.size(), shots.size(),
             std::min(shots.size(), files.size()));
    shots.resize(std::min(shots.size(), files.size()));
  }
  std::set<std::string> taken;
  for (std::size_t k = 0; k < shots.size(); ++k) {
    shots[k].model = files[k].string();
    shots[k].name = files[k].filename().string();
    shots[k].stem = free_stem(files[k].stem().string(), taken);
  }
}

ModelsInTurn::ModelsInTurn(const SceneOptions& scene, const Model& first, const std::vector<Shot>& shots)
    : scene_(scene), format_(first.format), origin_(first.axes.origin) {
  scene_.axes = first.axes.letters;
  for (const Shot& shot : shots) files_.push_back(shot.model);
  read_next();
}

void ModelsInTurn::read_next() {
  if (next_ == files_.size()) return;
  scene_.name = files_[next_++];
  reading_ = std::async(std::launch::async, [scene = scene_] { return load_scene(scene); });
}

Model ModelsInTurn::take() {
  const std::string file = files_[next_ - 1];
  Model model = reading_.get();
  if (model.format != format_)
    fail("{} is {}, and the models before it are {}: all of a sequence must be of one kind", file,
         model.format, format_);
  move_origin(model, origin_);
  read_next();
  return model;
}

}  // namespace binosplat::app
