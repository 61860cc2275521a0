#include "study/eyes.h"

#include "measure/search.h"
#include "render/frame.h"

namespace binosplat::study {

namespace {

constexpr int frames_to_settle = 3;

// A still pair drawn by a rule until its measurements have settled.
struct Settled {
  double pairs = 0.0;
  std::vector<Picture> pictures;
};

Settled settled(gl::Context& context, const Model& model, const stereo::EyePair& eyes,
                const Variant& variant) {
  render::Frame frame(context, model);
  Settled result;
  for (int n = 0; n < frames_to_settle; ++n)
    result.pairs = static_cast<double>(frame.draw(eyes.views, variant.settings()).pairs);
  result.pictures = frame.read_pictures();
  return result;
}

}  // namespace

std::vector<EyesResult> run_eyes(gl::Context& context, const Model& model, const stereo::EyePair& eyes,
                                 Variant variant, double target, const std::function<void()>& progress) {
  const Settled exact = settled(context, model, eyes, {.th = TH_TAU});
  const std::span<const Picture> truth = exact.pictures;
  const auto judged = [&](const Settled& frame) {
    return judge(eyes.views, truth, frame.pictures, TILE_SIZE_DEFAULT);
  };
  const auto of_eye = [&](const Settled& frame, std::size_t k) {
    const std::span<const Picture> pictures = frame.pictures;
    return judge(std::span(eyes.views).subspan(k, 1), truth.subspan(k, 1), pictures.subspan(k, 1),
                 TILE_SIZE_DEFAULT)
        .psnr;
  };
  std::vector<EyesResult> results;
  for (variant.th_eyes = TH_EYES_PER_EYE; variant.th_eyes <= TH_EYES_CYCLOPEAN; ++variant.th_eyes) {
    variant.loss = loss_at(context, model, eyes, variant, target);
    const Settled frame = settled(context, model, eyes, variant);
    const FrameErrors errors = judged(frame);
    EyesResult result{variant,          frame.pairs,      1.0 - frame.pairs / exact.pairs,
                      of_eye(frame, 0), of_eye(frame, 1), errors.disagreement,
                      errors.psnr,      errors.psnr};
    if (variant.th_eyes != TH_EYES_PER_EYE) {
      Variant own = variant;
      own.th_eyes = TH_EYES_PER_EYE;
      const auto pairs_at = [&](double loss) {
        own.loss = static_cast<float>(loss);
        return settled(context, model, eyes, own).pairs;
      };
      // As many pairs or a few more, never fewer: to the disadvantage of the rule that shares.
      own.loss = static_cast<float>(
          measure::find_loss(pairs_at, frame.pairs, {.start = variant.loss, .tolerance = 0.002 * frame.pairs})
              .loss);
      result.per_eye_db = judged(settled(context, model, eyes, own)).psnr;
    }
    results.push_back(result);
    progress();
  }
  return results;
}

}  // namespace binosplat::study
