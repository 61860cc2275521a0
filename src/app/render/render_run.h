#pragma once
// A run of `binosplat render`: its input, its shots and its results.

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "adagscale/calibrated_threshold.h"
#include "app/bench/photos.h"
#include "app/options/options.h"
#include "app/render/outputs.h"
#include "app/render/shots.h"
#include "gl/context.h"
#include "render/frame.h"
#include "render/memory.h"
#include "scene/model.h"
#include "stereo/comfort.h"
#include "stream/opened_model.h"
#include "stream/picture_stream.h"

namespace binosplat::app {

/// The levels that a shot was drawn with, and the times to load them.
struct ShotLevels {
  std::size_t gaussians = 0;             // of the model at these levels
  bool switched = false;                 // levels differ from those of the previous shot
  double read_ms = 0.0;                  // time to read files
  double upload_ms = 0.0;                // time to upload to the GPU
  std::optional<double> predicted_psnr;  // predicted from the levels' errors; the worse eye
};

/// The range of disparities of an eye pair, and a better rig if they are uncomfortable.
struct Comfort {
  stereo::DisparityRange range;
  std::optional<double> focus;                   // m, distance of disparity 0 in `range`; none: infinite
  std::optional<stereo::ComfortableRig> better;  // in metres; only if the program chose the rig
};

struct Drawn {
  Shot shot;
  Report report;
  std::optional<double> max_shown;   // with --show: the value of the brightest colour
  std::optional<double> photo_psnr;  // dB
  std::optional<Comfort> comfort;
  std::optional<ShotLevels> levels;           // with --detail
  std::vector<stereo::FoveatedEye> foveated;  // with --foveate, by eye
};

/// Times from the first frame to the last file. For the drawing thread, in ms: `all` is its whole time,
/// `reading` its waits for pictures from the GPU, `waiting` its waits for the threads that write.
struct RunTimes {
  double all = 0.0, reading = 0.0, waiting = 0.0;
  double gpu = 0.0;                      // ms of the GPU, all frames
  double encoding = 0.0, writing = 0.0;  // s, summed over the threads that write
  int threads = 0;
};

struct RenderRun {
  // Input.
  Options options;
  Outputs outputs;
  adagscale::CalibratedThreshold calibrated;
  render::FrameSettings settings = {};  // of all shots, before the calibration completes them
  PhotoSource photos = {};
  std::unique_ptr<gl::Context> context = {};  // before its users: destroyed last
  OpenedModel<PictureStream> opened = {};
  bool heads_turn = false;  // paths, VR180: the stream also refines chunks out of view
  CameraList list = {};
  double near_plane = 0.0;  // world units
  std::vector<Shot> shots = {};
  std::optional<Shot> screen = {};  // the shot that decides the screen's distance if no option does

  // Results.
  render::MemoryNeeds needs = {};          // of the model and of the largest view
  std::optional<double> convergence = {};  // m, from an option or chosen; none: infinitely far
  std::vector<Drawn> drawn = {};           // for each shot
  std::vector<Report> frames = {};         // of all frames: --frames for each shot
  RunTimes times = {};

  const Model& model() const { return opened.model(); }
};

/// Draws every shot --frames times and writes the files of its last frame. While the GPU draws a shot, the
/// calling thread, the only one that uses OpenGL, passes the copy of the previous one (render/read_back.h) to
/// threads that encode and write. Pictures composed by OpenGL (--show, --foveate, --vr180) are read at once
/// (draw_shots.cpp).
void draw_all(RenderRun& run);

// The tables in the terminal, and --json (render_results.cpp).
void print(const RenderRun& run);
void save(const std::filesystem::path& path, const RenderRun& run);

}  // namespace binosplat::app
