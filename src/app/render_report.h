#pragma once
// What `binosplat render` says about what it drew, for people and as JSON.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/followed.h"
#include "app/render_options.h"
#include "app/shots.h"
#include "gl/context.h"
#include "render/frame.h"
#include "render/memory.h"
#include "scene/model.h"
#include "stereo/comfort.h"

namespace binosplat::app {

/// GPU times of frames, by stage. The first frame of all makes the driver compile shaders: it counts only
/// while it is alone.
class StageTimes {
 public:
  struct Row {
    std::string stage;  // the last one is "frame", the sum
    double median_ms = 0.0;
    double p99_ms = 0.0;
  };

  void add(const render::FrameReport& report);
  std::vector<Row> rows() const;
  std::size_t frames() const { return frames_.size() > 1 ? frames_.size() - 1 : frames_.size(); }

 private:
  std::vector<render::FrameReport> frames_;
};

/// How a pair's disparities lie, and what to change where they are beyond comfort.
struct Comfort {
  stereo::DisparityRange range;
  std::optional<double> focus;                   // m, that the range is against; none: infinitely far
  bool headset = false;                          // that is its optics', else the screen's
  std::optional<stereo::ComfortableRig> better;  // m; where the range is not comfortable and the rig ours
};

/// Of a shot with both eyes and something that has a depth, from the left eye's picture; `headset`: seen in
/// one.
std::optional<Comfort> comfort_of(const Shot& shot, bool headset, const Picture& left);

/// A shot once it is drawn.
struct Drawn {
  Shot shot;
  render::FrameReport report;
  std::vector<std::string> files;
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
  bool is_video = false;  // ffmpeg writes, one frame after the other
};

struct RenderReport {
  const RenderOptions& options;
  const Model& model;
  const gl::Context& context;
  double near_plane = 0.0;            // world units
  render::MemoryNeeds needs;          // of the model, and of the view that needs most
  std::optional<double> convergence;  // m, by an option or because it suits; none: infinitely far
  std::vector<Drawn> drawn;
  StageTimes times;
  RunTimes run;
  std::optional<double> exact_ms;  // GPU time of an exact frame, where --quality draws many
};

/// Bytes as "1,210 MB", or "3.4 MB" where whole ones would say little.
std::string megabytes(std::int64_t bytes);

/// The line about memory, before anything is uploaded.
void print_needs(const render::MemoryNeeds& needs);
void print(const RenderReport& report);
/// As JSON.
void save(const std::filesystem::path& path, const RenderReport& report);

}  // namespace binosplat::app
