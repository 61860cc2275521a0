#pragma once
// The options that choose a scene and how its file is read.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "app/cli.h"
#include "stream/choice.h"

namespace binosplat::app {

/// Whether the name has the form of a built-in scene's name. The scene need not exist.
inline bool is_built_in(const std::string& scene) { return scene.starts_with("demo:"); }

struct SceneOptions {
  std::string name;  // a model file or a built-in scene

  std::optional<int> lod;                 // level to read, of files with levels of detail
  std::optional<double> gpu_memory;       // MB that chosen levels must fit into; replaces lod
  std::optional<DetailRequest> detail;    // chooses levels for each view; its `most` is unset
  std::string format;                     // reads a file as this format; empty: as its content says
  std::string axes;                       // directions of a file's x, y and z; empty: the format's
  std::optional<std::size_t> appearance;  // index of an appearance, for a Scaffold-GS model

  // For built-in scenes and for repeated scenes.
  std::optional<std::uint64_t> seed;
  std::optional<std::size_t> count;  // Gaussians
  std::optional<glm::ivec2> repeat;  // numbers of copies along x and z
  std::optional<double> spacing;     // distance between copies, world units
  std::string place;                 // a list of other models and their places (placed.h); empty: none

  std::optional<bool> antialias;     // none: as the file says
  std::optional<double> kernel_px2;  // px^2; none: as the file says
};

/// Adds all options of SceneOptions; `options` must outlive parsing.
void add_scene_options(CLI::App& sub, SceneOptions& options);

// Single options, for commands that take only a few.
CLI::Option* add_lod_option(CLI::App& sub, SceneOptions& options,
                            const char* help = "Level of detail of a streamed SOG, 0 the finest");
CLI::Option* add_axes_option(CLI::App& sub, SceneOptions& options);
void add_format_option(CLI::App& sub, SceneOptions& options);
void add_repeat_options(CLI::App& sub, SceneOptions& options);
void add_place_option(CLI::App& sub, SceneOptions& options);
CLI::Option* add_seed_option(CLI::App& sub, SceneOptions& options);
CLI::Option* add_count_option(CLI::App& sub, SceneOptions& options,
                              const char* help = "Gaussians of demo:city (1000000)");

/// Throws Error for options that contradict each other or do not apply to the scene.
void check(const SceneOptions& options);

}  // namespace binosplat::app
