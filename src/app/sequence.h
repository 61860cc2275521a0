#pragma once
// A folder of models that are the frames of one moving scene.

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"

namespace binosplat::app {

/// The model files if the scene is a folder with several models and --fps is set, else empty. Throws Error
/// for options that need a single model.
std::vector<std::filesystem::path> sequence_of(const RenderOptions& options);

/// Assigns the models to the shots in order, and names each shot after its file. A single shot is repeated
/// for all models. Otherwise drops surplus models or shots, and logs the numbers.
void show_in_turn(const std::vector<std::filesystem::path>& files, std::vector<Shot>& shots);

/// The models of all shots but the first. Reads the next one while the current one is drawn.
class ModelsInTurn {
 public:
  /// All models take the axes and origin of `first`, and must have its format.
  ModelsInTurn(const SceneOptions& scene, const Model& first, const std::vector<Shot>& shots);

  /// The model of the next shot, starting with the second. Throws Error as load_scene() does, and for a file
  /// of another format.
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
