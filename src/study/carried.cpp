#include "study/carried.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "measure/search.h"
#include "render/frame.h"
#include "study/squared_error.h"

namespace binosplat::study {

namespace {

// `one` with as many pairs as were drawn, from the loss that the last frame needed. Pairs fall slowly with
// the loss: a secant over logarithms gets there in a few frames.
class SamePairs {
 public:
  SamePairs(render::Frame& frame, Variant variant) : frame_(frame), variant_(variant) {
    variant_.transmittance = TRANSMITTANCE_ONE;
  }

  double draw(const std::vector<shared::View>& views, double wanted) {
    constexpr int attempts_max = 20;
    double slope = -0.35;  // of log pairs over log loss, about
    double pairs = draw_at(views, loss_);
    for (int n = 0; n < attempts_max && std::abs(pairs / wanted - 1.0) > 0.01; ++n) {
      const double before = loss_, pairs_before = pairs;
      loss_ *= std::exp(std::clamp(std::log(wanted / pairs) / slope, -2.0, 2.0));
      pairs = draw_at(views, loss_);
      const double seen = std::log(pairs / pairs_before) / std::log(loss_ / before);
      if (std::isfinite(seen) && seen < -0.01) slope = seen;
    }
    if (std::abs(pairs / wanted - 1.0) > 0.01)
      fail("no loss makes {} pairs with --transmittance one: the nearest made {}", wanted, pairs);
    return pairs;
  }

  double draw_at(const std::vector<shared::View>& views, double loss) {
    variant_.loss = static_cast<float>(loss);
    return static_cast<double>(frame_.draw(views, variant_.settings()).pairs);
  }

  void start_at(double loss) { loss_ = loss; }

 private:
  render::Frame& frame_;
  Variant variant_;
  double loss_ = 0.0;
};

}  // namespace

std::vector<CarriedFrame> run_carried(gl::Context& context, const Model& model,
                                      const std::vector<std::vector<shared::View>>& frames,
                                      const Variant& variant, float quality,
                                      const std::function<void()>& progress) {
  render::FrameSettings settings = variant.settings();
  settings.quality = quality;
  // `one` measures nothing and goes by nothing: it takes turns with the exact frames.
  render::Frame still(context, model), carried(still.model());
  SamePairs one(still, variant);
  std::vector<CarriedFrame> results;
  for (const std::vector<shared::View>& views : frames) {
    CarriedFrame& result = results.emplace_back();
    const double exact_pairs = static_cast<double>(still.draw(views).pairs);
    const std::vector<Picture> truth = still.read_pictures();
    const render::FrameReport report = carried.draw(views, settings);
    const std::vector<Picture> pictures = carried.read_pictures();
    const FrameErrors errors = judge(views, truth, pictures, settings.tile_size);
    result.db = errors.psnr;
    result.signed_mean = errors.signed_mean;
    result.pairs = static_cast<double>(report.pairs);
    result.removed = 1.0 - result.pairs / exact_pairs;
    result.fell_back = render::measures(variant.transmittance) && !report.remembered;
    if (quality == 0.0f) {
      if (results.size() == 1) one.start_at(variant.loss);
      if (result.fell_back) {
        one.draw_at(views, variant.loss);
        result.equals_one = same_bits(pictures, still.read_pictures());
      }
      result.one_pairs = one.draw(views, result.pairs);
      result.one_db = SquaredError(context, truth).psnr(still.colours());
    }
    progress();
  }
  return results;
}

float carried_loss(gl::Context& context, const Model& model,
                   const std::vector<std::vector<shared::View>>& frames, Variant variant, double target) {
  if (render::is_exact(variant.th)) return 0.0f;
  render::Frame frame(context, model);
  frame.draw(frames.at(1));
  SquaredError error(context, frame.read_pictures());
  const auto at = [&](double loss) {
    frame.forget();
    variant.loss = 0.0f;
    frame.draw(frames[0], variant.settings());
    variant.loss = static_cast<float>(loss);
    frame.draw(frames[1], variant.settings());
    return error.psnr(frame.colours());
  };
  const double start = render::threshold_rules[variant.th].careful_loss;
  return static_cast<float>(measure::find_loss(at, target, {.start = start, .tolerance = 0.1}).loss);
}

}  // namespace binosplat::study
