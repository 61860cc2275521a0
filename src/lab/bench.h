#pragma once
// One point of a measurement: a way to draw, first verified, then timed, then compared with exact pictures
// and with photos.

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "gl/context.h"
#include "lab/bench_case.h"
#include "lab/exact_frames.h"
#include "lab/results.h"
#include "lab/settings.h"
#include "scene/model.h"

namespace binosplat::lab {

class BenchDrawer;

/// The points that share a model and what they are measured on. What is exact is drawn once, at first use.
class Bench {
 public:
  /// `load` returns the model, at its finest levels, which outlives the bench; as the context does.
  Bench(gl::Context& context, std::function<const Model&()> load, BenchCase what, const BenchEffort& effort);
  ~Bench();

  /// About how long so many points will take that are like this one, in ms. Draws two frames.
  double work_ms(const BenchSettings& settings, std::size_t points);

  /// A point that fails verification is not timed: it has a problem instead. Where the finest levels of a
  /// scene have no room, what needs them is left out, and "no_exact" says so. TRANSMITTANCE_DEPTH goes by a
  /// table of the views for training, or of the bench's own. Throws Error where the GPU cannot draw the views
  /// at all.
  Point measure(BenchSettings settings);

  /// What single Gaussians contribute (contributions.h), as details; with bounds of the paper's table.
  Point contributions();

 private:
  using Seen = std::pair<int, int>;  // order, projection; -1: the model's
  static Seen seen_by(const BenchSettings& settings) {
    return {settings.order.value_or(-1), settings.projection.value_or(-1)};
  }

  /// A view's exact pictures by eye; and what they are worth against the photo.
  struct Exact {
    std::vector<Picture> pictures;
    std::vector<Image> eyes;  // the same over black
    double pairs = 0.0;
    std::optional<double> photo_psnr;  // dB, 8 bits
  };

  const std::shared_ptr<render::GpuModel>& gpu_model();
  /// Whether the finest levels can be drawn; why not goes into the row.
  bool has_finest(Row& row);
  /// Of the order and projection that the settings ask for.
  const std::vector<Exact>& exact(const BenchSettings& settings);
  ExactFrames& exact_frames(const BenchSettings& settings);
  const DepthTable& depth_table(const std::optional<float>& far);
  Calibrator& calibrator(bool training, bool drop, const BenchSettings& settings);
  BenchDrawer drawer(const BenchSettings& settings);
  void find_tolerance(BenchSettings& settings, Row& row);
  std::string verify(const BenchSettings& settings);

  void time_views(BenchDrawer& drawer, Row& row);
  void judge_views(const BenchSettings& settings, BenchDrawer& drawer, Point& point);
  void judge_by_sums(const BenchSettings& settings, BenchDrawer& drawer, Point& point);
  Row compare(const BenchView& view, const Exact& exact, const std::vector<Picture>& drawn) const;
  void measure_frames(const BenchSettings& settings, BenchDrawer& drawer, Point& point);
  void time_frames(BenchDrawer& drawer, Point& point);
  void measure_turns(const BenchSettings& settings, Point& point);

  gl::Context& context_;
  std::function<const Model&()> load_;
  BenchCase what_;
  BenchEffort effort_;
  std::shared_ptr<render::GpuModel> gpu_model_;
  std::string no_finest_;  // why the finest levels cannot be drawn
  std::map<Seen, std::vector<Exact>> exact_;
  std::unique_ptr<ExactFrames> exact_frames_;
  Seen exact_frames_seen_ = {-1, -1};
  std::map<std::optional<float>, DepthTable> tables_;
  std::map<std::tuple<bool, bool, Seen>, std::unique_ptr<Calibrator>>
      calibrators_;  // by calibrator()'s three
};

}  // namespace binosplat::lab
