#pragma once
// A run of `binosplat render`: what is drawn and where it goes, and what came of it.

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "app/calibrated.h"
#include "app/followed.h"
#include "app/outputs.h"
#include "app/photos.h"
#include "app/render_options.h"
#include "app/shots.h"
#include "gl/context.h"
#include "render/frame.h"
#include "render/memory.h"
#include "scene/model.h"
#include "stereo/comfort.h"
#include "stream/picture_stream.h"

namespace binosplat::app {

/// Which levels a shot was drawn with, and what that took.
struct ShotLevels {
  std::size_t gaussians = 0;  // of the model
  bool switched = false;      // other levels than the shot before
  double read_ms = 0.0;       // for the files, where they had to be read
  double upload_ms = 0.0;     // for the GPU
  std::optional<double>
      switch_psnr;  // dB, between the shot with the levels before and with these, both exact
  std::optional<double> finest_psnr;     // dB, against the exact picture of the finest levels
  std::optional<double> predicted_psnr;  // the same by the errors of the levels, of the worse eye
};

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

struct RenderRun {
  // What is drawn, by what, and where it goes.
  RenderOptions options;
  Outputs outputs;
  render::ThresholdPolicy policy;
  PhotoSource photos = {};
  std::unique_ptr<gl::Context> context = {};   // outlives what draws with it
  std::unique_ptr<PictureStream> stream = {};  // of a model whose levels follow the shots
  bool heads_turn = false;                     // along a path or in VR180, for the stream
  Model loaded = {};                           // where there is no stream
  CameraList list = {};
  double near_plane = 0.0;  // world units
  std::vector<Shot> shots = {};
  std::optional<Shot> screen = {};  // tells how far the screen is, where no option does

  // What came of it.
  render::MemoryNeeds needs = {};                // of the model, and of the view that needs most
  std::optional<double> convergence = {};        // m, by an option or because it suits; none: infinitely far
  std::vector<Drawn> drawn = {};                 // by shot
  std::vector<render::FrameReport> frames = {};  // all of them, --frames of each shot
  RunTimes times = {};
  std::optional<double> exact_ms = {};  // GPU time of an exact frame, where --quality draws many

  const Model& model() const { return stream ? stream->model() : loaded; }
};

/// Draws every shot as often as asked for, and leaves the files of its last frame. All of OpenGL is called on
/// the thread that calls this: while the GPU draws a shot, it waits for the copy of the one before
/// (render/read_back.h) and hands that to threads that encode and write it. What has to be made of a frame
/// with OpenGL, as with --show, --foveate and --vr180, is read at once.
void draw_all(RenderRun& run);

/// What it drew: a table for people,
void print(const RenderRun& run);
/// and JSON.
void save(const std::filesystem::path& path, const RenderRun& run);

}  // namespace binosplat::app
