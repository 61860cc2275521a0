#include "study/eyes.h"

#include <array>

#include "measure/metrics.h"
#include "measure/search.h"
#include "stereo/disagreement.h"
#include "study/still.h"

namespace binosplat::study {

std::vector<EyesResult> run_eyes(gl::Context& context, const Model& model,
                                 const std::vector<shared::View>& eyes, Variant variant, double target,
                                 const std::function<void()>& progress) {
  Still still(context, model, eyes);
  const auto of_eye = [&](const std::vector<Picture>& drawn, std::size_t k) {
    const glm::vec3 black(0.0f);
    return measure::psnr(composite(drawn[k], black), composite(still.exact()[k], black));
  };
  std::vector<EyesResult> results;
  for (variant.th_eyes = TH_EYES_PER_EYE; variant.th_eyes <= TH_EYES_CYCLOPEAN; ++variant.th_eyes) {
    variant.loss = still.loss_at(variant, target);
    const auto pairs = static_cast<double>(still.settle(variant).pairs);
    const double db = still.psnr();
    const std::vector<Picture> drawn = still.pictures();
    EyesResult result{variant,
                      pairs,
                      1.0 - pairs / still.exact_pairs(),
                      of_eye(drawn, 0),
                      of_eye(drawn, 1),
                      stereo::disagreement(std::array{eyes[0], eyes[1]}, still.exact(), drawn).db,
                      db,
                      db};
    if (variant.th_eyes != TH_EYES_PER_EYE) {
      Variant own = variant;
      own.th_eyes = TH_EYES_PER_EYE;
      const auto pairs_at = [&](double loss) {
        own.loss = static_cast<float>(loss);
        return static_cast<double>(still.settle(own).pairs);
      };
      // As many pairs or a few more, never fewer: to the disadvantage of the rule that shares.
      own.loss = static_cast<float>(
          measure::find_loss(pairs_at, pairs, {.start = variant.loss, .tolerance = 0.002 * pairs}).loss);
      still.settle(own);
      result.per_eye_db = still.psnr();
    }
    results.push_back(result);
    progress();
  }
  return results;
}

}  // namespace binosplat::study
