#include "adagscale/calibrate.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "adagscale/tolerance_search.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/statistics.h"
#include "gl/full_clock.h"
#include "measure/metrics.h"
#include "render/squared_error.h"
#include "scene/axes.h"

namespace binosplat::adagscale {

namespace {

// Precision of searches: users request drops in tenths of a dB, and qualities in integer dB.
constexpr double drop_within_db = 0.01, quality_within_db = 0.05;

using measure::equal_db;

double psnr_of(double squared_error) {
  return squared_error > 0.0 ? std::min(equal_db, -10.0 * std::log10(squared_error)) : equal_db;
}

int drawings_of(const render::FrameSettings& settings) {
  return render::measures(settings) ? render::settling_frames : 1;
}

Picture as_picture(const Image& photo) {
  Picture picture(photo.width, photo.height);
  for (std::size_t k = 0; k < picture.colour.size(); ++k)
    picture.colour[k] = {photo.data[3 * k], photo.data[3 * k + 1], photo.data[3 * k + 2], 0.0f};
  return picture;
}

}  // namespace

/// The picture to compare a view with, on the GPU, and the numbers of the view's exact frame.
struct Calibrator::Reference {
  Reference(gl::Context& context, std::span<const Picture> pictures, std::uint64_t pairs)
      : error(context, pictures), exact_pairs(pairs) {}
  Reference(gl::Context& context, const Picture& photo, const glm::mat4x3& exposure, std::uint64_t pairs)
      : error(context, std::span(&photo, 1), 255, exposure), exact_pairs(pairs) {}

  render::SquaredError error;  // against the exact picture, or the photo
  std::uint64_t exact_pairs;
  double exact_db = equal_db;  // of the exact picture against the photo
};

Calibrator::Calibrator(std::shared_ptr<render::GpuModel> model, const std::vector<CalibrationView>& views,
                       double near_plane, CalibrationTarget::Kind kind, const render::FrameSettings& like)
    : frame_(std::move(model)), kind_(kind) {
  render::FrameSettings exact = render::exact_of(like);
  exact.precision = like.precision;
  if (views.empty()) fail("calibration needs at least one view");
  for (const CalibrationView& view : views) {
    const bool drop = kind == CalibrationTarget::Kind::drop;
    if (drop && (!view.photo || view.photo->width != view.camera.width ||
                 view.photo->height != view.camera.height || view.photo->channels != 3))
      fail("view {}: a drop in dB needs a photo in the view's size", view.camera.name);
    names_.push_back(view.camera.name);
    views_.push_back(make_view(into_axes(view.camera, frame_.model()->model().axes), near_plane));
    const std::uint64_t pairs = frame_.draw(std::span(&views_.back(), 1), exact).pairs;
    references_.push_back(
        drop ? std::make_unique<Reference>(frame_.model()->context(), as_picture(*view.photo), view.exposure,
                                           pairs)
             : std::make_unique<Reference>(frame_.model()->context(), frame_.read_pictures(), pairs));
    references_.back()->exact_db = psnr_of(references_.back()->error.mean(frame_.colours()));
  }
}

Calibrator::~Calibrator() = default;

Calibrator::Cost Calibrator::cost(const render::FrameSettings& settings) {
  return cost(frame_, settings, drawings_of(settings));
}

Calibrator::Cost Calibrator::cost(const Model& other, int drawings,
                                  const std::function<void(std::size_t)>& after_view) {
  gl::Context& context = frame_.model()->context();
  render::Frame frame(context, other);
  // The GPU's clock drops while the CPU makes and uploads a model.
  if (drawings > 1) gl::raise_clock(context, 500.0, [&] { frame.draw(std::span(&views_.front(), 1)); });
  return cost(frame, {}, drawings, after_view);
}

Calibrator::Cost Calibrator::cost(render::Frame& frame, const render::FrameSettings& settings, int drawings,
                                  const std::function<void(std::size_t)>& after_view) {
  Cost cost;
  const bool drop = kind_ == CalibrationTarget::Kind::drop;
  const auto count = static_cast<double>(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    // Each view starts without measurements of other views.
    if (render::measures(settings)) frame.forget();
    Report report;
    std::vector<double> ms;
    for (int n = 0; n < drawings; ++n) {
      report = frame.draw(std::span(&views_[v], 1), settings);
      ms.push_back(report.gpu_ms);
    }
    cost.ms += quantile(std::move(ms), 0.5) / count;
    cost.pairs += static_cast<double>(report.pairs) / count;
    // Of a dim or tiny object an empty picture may have a high PSNR, but it shows nothing.
    const bool is_lost = report.pairs == 0 && references_[v]->exact_pairs > 0;
    const double db = is_lost ? 0.0 : psnr_of(references_[v]->error.mean(frame.colours())),
                 value = drop ? references_[v]->exact_db - db : db;
    const bool worse = drop ? value > cost.worst_db : value < cost.worst_db;
    if (v == 0 || worse) {
      cost.worst_db = value;
      cost.worst_view = v;
    }
    cost.view_db.push_back(value);
    cost.mean_db += value / count;
    const double pairs = static_cast<double>(references_[v]->exact_pairs);
    if (pairs > 0) cost.pairs_removed += (1.0 - static_cast<double>(report.pairs) / pairs) / count;
    if (after_view) after_view(v + 1);
  }
  return cost;
}

double Calibrator::exact_photo_db() const {
  double sum = 0.0;
  for (const auto& reference : references_) sum += reference->exact_db;
  return sum / static_cast<double>(references_.size());
}

CalibrationEntry Calibrator::find(render::FrameSettings settings, double target_db,
                                  const std::function<void()>& after_picture) {
  const Clock::time_point start = Clock::now();
  const bool drop = kind_ == CalibrationTarget::Kind::drop;
  std::map<double, Cost> tried;  // by tolerance
  const auto value = [&](double tolerance) {
    settings.tolerance = static_cast<float>(tolerance);
    const auto after_view = [&](std::size_t) {
      if (after_picture) after_picture();
    };
    const Cost& reached = tried[tolerance] = cost(frame_, settings, drawings_of(settings), after_view);
    return drop ? -reached.mean_db : reached.worst_db;
  };
  ToleranceSearch search;
  search.start = settings.tolerance.value_or(
      static_cast<float>(render::rule_of(*settings.threshold).starting_tolerance));
  search.narrowest = 1e-3;  // a tolerance that is 0.1 % larger saves nothing
  search.within = drop ? drop_within_db : quality_within_db;
  const FoundTolerance found = find_tolerance(value, drop ? -target_db : target_db, search);
  const Cost& reached = tried.at(found.tolerance);
  return {*settings.threshold,   render::chosen_transmittance(settings),
          found.tolerance,       reached.mean_db,
          reached.worst_db,      names_[reached.worst_view],
          reached.pairs_removed, found.evaluations,
          1e-3 * ms_since(start)};
}

ThresholdCalibration calibrate(std::shared_ptr<render::GpuModel> drawn,
                               const std::vector<CalibrationView>& views, double near_plane,
                               const CalibrationSettings& wanted,
                               const std::function<void(std::size_t)>& done) {
  const Model& model = drawn->model();
  const render::FrameSettings& like = wanted.table.frame;
  Calibrator calibrator(std::move(drawn), views, near_plane, wanted.target.kind, like);
  ThresholdCalibration c;
  c.model_name = model.name;
  c.gaussians = model.count();
  c.hash = model_hash(model);
  c.perspective = render::perspective_of(like, model);
  c.kernel_px2 = model.kernel_px2;
  c.antialiased = model.antialiased;
  c.width = views.front().camera.width;
  c.height = views.front().camera.height;
  c.near_plane = near_plane;
  c.target = wanted.target;
  for (const CalibrationView& view : views) {
    c.views.push_back({view.camera.name, view.camera.position});
    c.focal += view.camera.fx / static_cast<double>(views.size());
  }
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const Camera& camera : wanted.reached) {
    low = glm::min(low, camera.position);
    high = glm::max(high, camera.position);
  }
  if (!wanted.reached.empty() && low != high) c.reach = glm::distance(low, high);
  const Clock::time_point start = Clock::now();
  c.depth_table = measure_depth_table(calibrator.frame(), calibrator.views(), wanted.table);
  c.depth_table_seconds = 1e-3 * ms_since(start);
  std::size_t pictures = 0;
  for (render::FrameSettings settings : wanted.rules) {
    settings.depth_table = c.depth_table;
    settings.order = like.order;
    settings.projection = like.projection;
    settings.precision = like.precision;
    // Starts at the tolerance of the same rule with another source of transmittance, which is similar. Each
    // step saved is one frame per view, or settling_frames with measured transmittance.
    if (!c.entries.empty() && c.entries.back().threshold == settings.threshold &&
        c.entries.back().tolerance > 0.0)
      settings.tolerance = static_cast<float>(c.entries.back().tolerance);
    c.entries.push_back(calibrator.find(settings, wanted.target.db, [&] {
      if (done) done(++pictures);
    }));
  }
  return c;
}

ThresholdCalibration find_k(std::shared_ptr<render::GpuModel> model,
                            const std::vector<CalibrationView>& views, double near_plane,
                            const render::FrameSettings& requested, std::vector<Camera> reached,
                            const std::function<void(std::size_t)>& done) {
  CalibrationSettings wanted{
      .target = {.db = requested.quality.value_or(static_cast<float>(default_quality))},
      .table = {.frame = requested},
      .reached = std::move(reached)};
  if (requested.transmittance) wanted.rules.front().transmittance = requested.transmittance;
  return calibrate(std::move(model), views, near_plane, wanted, done);
}

}  // namespace binosplat::adagscale
