#pragma once
// Measures one point: a setting is verified, timed, and compared with exact pictures and photos.

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "gl/context.h"
#include "gl/full_clock.h"
#include "lab/bench_settings.h"
#include "lab/bench_views.h"
#include "lab/exact_frames.h"
#include "lab/results.h"
#include "scene/model.h"

namespace binosplat::lab {

class BenchDrawer;

/// Measures points that share a model and a case. Draws exact pictures once, at first use.
class Bench {
 public:
  /// `load` returns the model at its finest levels. Model and context must outlive the bench.
  Bench(gl::Context& context, std::function<const Model&()> load, BenchCase what, const BenchEffort& effort);
  ~Bench();

  /// Estimates the time in ms to measure `points` points with similar settings. Draws two frames.
  double work_ms(const BenchSettings& settings, std::size_t points);

  /// Measures one point. If verification fails, the point is not timed and has a problem instead. If the
  /// finest levels do not fit into memory, the row lacks the numbers that need them, and "no_exact" gives the
  /// reason. Transmittance::depth uses a table measured in the training views, or else in the bench's own
  /// views. Throws Error if the GPU cannot draw the views at all.
  Point measure(BenchSettings settings);

  /// Measures the contributions of single Gaussians (contributions.h) and returns them as details.
  Point contributions();

 private:
  using OrderAndProjection = std::pair<std::optional<Order>, std::optional<Projection>>;  // none: the model's
  static OrderAndProjection order_and_projection(const BenchSettings& settings) {
    return {settings.order, settings.projection};
  }

  struct Exact {
    std::vector<Picture> pictures;
    std::vector<Image> eyes;  // the pictures over black
    double pairs = 0.0;
    std::optional<double> photo_psnr;  // dB, 8 bits
  };

  const std::shared_ptr<render::GpuModel>& gpu_model();
  /// Whether the finest levels can be drawn. If not, writes the reason into the row.
  bool has_finest(Row& row);
  const std::vector<Exact>& exact(const BenchSettings& settings);
  ExactFrames& exact_frames(const BenchSettings& settings);
  const DepthTable& depth_table(const std::optional<float>& far, const OrderAndProjection& perspective);
  adagscale::Calibrator& calibrator(bool training, bool drop, const BenchSettings& settings);
  BenchDrawer drawer(const BenchSettings& settings);
  void find_tolerance(BenchSettings& settings, Row& row);
  /// Returns the problem of these settings, or "".
  std::string verify(const BenchSettings& settings);

  void time_views(BenchDrawer& drawer, Row& row);
  void measure_views(const BenchSettings& settings, BenchDrawer& drawer, Point& point);
  void measure_by_sums(const BenchSettings& settings, BenchDrawer& drawer, Point& point);
  Row compare(const BenchView& view, const Exact& exact, const std::vector<Picture>& drawn) const;
  void measure_frames(const BenchSettings& settings, BenchDrawer& drawer, Point& point);
  void time_frames(BenchDrawer& drawer, Point& point);

  gl::Context& context_;
  gl::FullClock clock_;
  std::function<const Model&()> load_;
  BenchCase what_;
  BenchEffort effort_;
  std::shared_ptr<render::GpuModel> gpu_model_;
  std::string no_finest_;  // why the finest levels cannot be drawn
  std::map<OrderAndProjection, std::vector<Exact>> exact_;
  std::unique_ptr<ExactFrames> exact_frames_;
  OrderAndProjection exact_frames_key_;
  std::map<std::pair<std::optional<float>, OrderAndProjection>, DepthTable> tables_;
  std::map<std::tuple<bool, bool, OrderAndProjection>, std::unique_ptr<adagscale::Calibrator>>
      calibrators_;  // by training, drop
};

}  // namespace binosplat::lab
