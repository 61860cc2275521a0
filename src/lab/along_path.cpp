#include "lab/along_path.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "measure/search.h"
#include "render/frame.h"
#include "render/squared_error.h"

namespace binosplat::lab {

namespace {

// `one` with as many pairs as were drawn, from the tolerance that the last frame needed. Pairs fall slowly
// with the tolerance: a secant over logarithms gets there in a few frames.
class SamePairs {
 public:
  SamePairs(render::Frame& frame, Variant variant) : frame_(frame), variant_(variant) {
    variant_.transmittance = TRANSMITTANCE_ONE;
  }

  double draw(const std::vector<shared::View>& views, double wanted) {
    constexpr int attempts_max = 20;
    double slope = -0.35;  // of log pairs over log tolerance, about
    double pairs = draw_at(views, tolerance_);
    for (int n = 0; n < attempts_max && std::abs(pairs / wanted - 1.0) > 0.01; ++n) {
      const double before = tolerance_, pairs_before = pairs;
      tolerance_ *= std::exp(std::clamp(std::log(wanted / pairs) / slope, -2.0, 2.0));
      pairs = draw_at(views, tolerance_);
      const double seen = std::log(pairs / pairs_before) / std::log(tolerance_ / before);
      if (std::isfinite(seen) && seen < -0.01) slope = seen;
    }
    if (std::abs(pairs / wanted - 1.0) > 0.01)
      fail("no tolerance makes {} pairs with --transmittance one: the nearest made {}", wanted, pairs);
    return pairs;
  }

  double draw_at(const std::vector<shared::View>& views, double tolerance) {
    variant_.tolerance = static_cast<float>(tolerance);
    return static_cast<double>(frame_.draw(views, variant_.settings()).pairs);
  }

  void start_at(double tolerance) { tolerance_ = tolerance; }

 private:
  render::Frame& frame_;
  Variant variant_;
  double tolerance_ = 0.0;
};

}  // namespace

std::vector<PathFrame> draw_along_path(gl::Context& context, const Model& model,
                                       const std::vector<std::vector<shared::View>>& frames,
                                       const Variant& variant, float quality,
                                       const std::function<void()>& progress) {
  render::FrameSettings settings = variant.settings();
  settings.quality = quality;
  // `one` measures nothing and goes by nothing: it takes turns with the exact frames.
  render::Frame beside(context, model), moving(beside.model());
  SamePairs one(beside, variant);
  std::vector<PathFrame> results;
  for (const std::vector<shared::View>& views : frames) {
    PathFrame& result = results.emplace_back();
    const double exact_pairs = static_cast<double>(beside.draw(views).pairs);
    const std::vector<Picture> truth = beside.read_pictures();
    const render::FrameReport report = moving.draw(views, settings);
    const std::vector<Picture> pictures = moving.read_pictures();
    const FrameErrors errors = judge(views, truth, pictures, settings.tile_size);
    result.db = errors.psnr;
    result.signed_mean = errors.signed_mean;
    result.pairs = static_cast<double>(report.pairs);
    result.removed = 1.0 - result.pairs / exact_pairs;
    result.fell_back = render::measures(variant.transmittance) && !report.remembered;
    if (quality == 0.0f) {
      if (results.size() == 1) one.start_at(variant.tolerance);
      if (result.fell_back) {
        one.draw_at(views, variant.tolerance);
        result.equals_one = same_bits(pictures, beside.read_pictures());
      }
      result.one_pairs = one.draw(views, result.pairs);
      result.one_db = render::SquaredError(context, truth).psnr(beside.colours());
    }
    progress();
  }
  return results;
}

float tolerance_along_path(gl::Context& context, const Model& model,
                           const std::vector<std::vector<shared::View>>& frames, Variant variant,
                           double target) {
  if (render::is_exact(variant.th)) return 0.0f;
  render::Frame frame(context, model);
  frame.draw(frames.at(1));
  render::SquaredError error(context, frame.read_pictures());
  const auto at = [&](double tolerance) {
    frame.forget();
    variant.tolerance = 0.0f;
    frame.draw(frames[0], variant.settings());
    variant.tolerance = static_cast<float>(tolerance);
    frame.draw(frames[1], variant.settings());
    return error.psnr(frame.colours());
  };
  const double start = render::threshold_rules[variant.th].careful_tolerance;
  return static_cast<float>(measure::find_tolerance(at, target, {.start = start, .within = 0.1}).tolerance);
}

}  // namespace binosplat::lab
