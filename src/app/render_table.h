#pragma once
// What `binosplat render` says of what it drew: a table for people, and JSON.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/followed.h"
#include "app/outputs.h"
#include "app/render_options.h"
#include "app/shots.h"
#include "gl/context.h"
#include "render/frame.h"
#include "render/memory.h"
#include "scene/model.h"
#include "stereo/comfort.h"

namespace binosplat::app {

/// How the disparities of a shot with both eyes lie, and what to change where they are beyond comfort.
struct Comfort {
  stereo::DisparityRange range;
  std::optional<double> focus;                   // m, that the range is against; none: infinitely far
  std::optional<stereo::ComfortableRig> better;  // m; where the range is not comfortable and the rig ours
};

/// A shot once it is drawn.
struct Drawn {
  Shot shot;
  render::FrameReport report;
  std::optional<double> most_shown;  // with --show: the number of the brightest colour
  std::optional<double> photo_psnr;  // dB
  std::optional<Comfort> comfort;
  std::optional<ShotLevels> levels;           // with --detail
  std::vector<stereo::FoveatedEye> foveated;  // with --foveate, by eye
};

/// What a run spent its time with, from its first frame to its last file. In ms of the thread that draws,
/// which reads back and waits for files while it does not draw:
struct RunTimes {
  double all = 0.0, reading = 0.0, waiting = 0.0;
  double gpu = 0.0;                      // ms of the GPU, of all frames
  double encoding = 0.0, writing = 0.0;  // s of all threads of files together
  int threads = 0;
};

struct RenderReport {
  const RenderOptions& options;
  const Outputs& outputs;
  const Model& model;
  const gl::Context& context;
  double near_plane = 0.0;                       // world units
  render::MemoryNeeds needs;                     // of the model, and of the view that needs most
  std::optional<double> convergence;             // m, by an option or because it suits; none: infinitely far
  std::vector<Drawn> drawn = {};                 // by shot
  std::vector<render::FrameReport> frames = {};  // all of them, --frames of each shot
  RunTimes run = {};
  std::optional<double> exact_ms = {};  // GPU time of an exact frame, where --quality draws many
};

void print(const RenderReport& report);
/// As JSON.
void save(const std::filesystem::path& path, const RenderReport& report);

}  // namespace binosplat::app
