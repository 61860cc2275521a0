#pragma once
// What is drawn: a model's file or a scene that is built in, and how it is to be taken.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "app/cli.h"
#include "stream/choice.h"

namespace binosplat::app {

/// Whether the name is that of a scene which the program makes, or would be if there were one.
inline bool is_built_in(const std::string& scene) { return scene.starts_with("demo:"); }

struct SceneOptions {
  std::string name;  // a model file, or one that is built in

  std::optional<int> lod;                 // of a model file that has levels of detail
  std::optional<double> gpu_memory;       // MB, which levels are chosen to fit; instead of lod
  std::optional<DetailRequest> detail;    // by which levels are chosen for each view anew; not `most`
  std::string axes;                       // where a file's x, y and z point; empty: what its format says
  std::optional<std::size_t> appearance;  // of a Scaffold-GS model

  // Of scenes that are built in, and how often a scene is repeated.
  std::optional<std::uint64_t> seed;
  std::optional<std::size_t> count;  // Gaussians
  std::optional<glm::ivec2> repeat;  // along x and z
  std::optional<double> spacing;     // world units

  std::optional<bool> antialias;     // as the model was trained; by default what its file says
  std::optional<double> kernel_px2;  // px^2, likewise
};

/// Adds all of them; `options` must outlive the parsing.
void add_scene_options(CLI::App& sub, SceneOptions& options);

// One of them, for commands that take few.
CLI::Option* add_lod_option(CLI::App& sub, SceneOptions& options,
                            const char* help = "Level of detail of a streamed SOG, 0 the finest");
CLI::Option* add_axes_option(CLI::App& sub, SceneOptions& options);
void add_repeat_options(CLI::App& sub, SceneOptions& options);
CLI::Option* add_seed_option(CLI::App& sub, SceneOptions& options);
CLI::Option* add_count_option(CLI::App& sub, SceneOptions& options,
                              const char* help = "Gaussians of demo:city (1000000)");

/// Throws Error for options that contradict each other, or that the scene does not have.
void check(const SceneOptions& options);

}  // namespace binosplat::app
