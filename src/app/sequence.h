#pragma once
// A folder of models that are the frames of one moving scene.

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"

namespace binosplat::app {

/// The files of the scene where it is a folder with several models and --fps says how fast they follow each
/// other; empty where it is no such folder. Throws Error for options that are for one model.
std::vector<std::filesystem::path> sequence_of(const RenderOptions& options);

/// Each shot shows a model, in order, and is called after its file; one shot stands for as many as there are
/// models. Those beyond the shorter of the two are left out, which is said.
void show_in_turn(const std::vector<std::filesystem::path>& files, std::vector<Shot>& shots);

/// The models of the shots after the first, which is there. While one is drawn, the next one is read.
class ModelsInTurn {
 public:
  /// The others take the axes and the origin of `first`, and must have its format.
  ModelsInTurn(const SceneOptions& scene, const Model& first, const std::vector<Shot>& shots);

  /// That of the next shot, beginning with the second. Throws Error as load_scene() does, and for a file of
  /// another kind.
  Model take();

 private:
  void read_next();

  SceneOptions scene_;
  std::string format_;
  glm::dvec3 origin_;
  std::vector<std::string> files_;
  std::size_t next_ = 1;
  std::future<Model> reading_;
};

}  // namespace binosplat::app
