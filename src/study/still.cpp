#include "study/still.h"

#include "measure/depth_table.h"
#include "measure/search.h"

namespace binosplat::study {

Still::Still(gl::Context& context, const Model& model, std::vector<shared::View> views)
    : frame_(context, model),
      views_(std::move(views)),
      exact_pairs_(static_cast<double>(frame_.draw(views_).pairs)),
      exact_(frame_.read_pictures()),
      error_(context, exact_),
      table_(measure::measure_depth_table(frame_, views_)) {}

render::FrameReport Still::draw(const Variant& variant, int record_every) {
  render::FrameSettings settings = variant.settings();
  settings.record_every = record_every;
  settings.depth_table = table_;
  return frame_.draw(views_, settings);
}

render::FrameReport Still::settle(const Variant& variant) {
  forget();
  render::FrameReport report = draw(variant);
  for (int n = 1; n < render::settling_frames && render::measures(variant.transmittance); ++n)
    report = draw(variant);
  return report;
}

float Still::loss_at(Variant variant, double target) {
  if (render::is_exact(variant.th)) return 0.0f;
  const auto settled = [&](double loss) {
    variant.loss = static_cast<float>(loss);
    settle(variant);
    return psnr();
  };
  const measure::LossSearch search{.start = render::threshold_rules[variant.th].careful_loss,
                                   .tolerance = 0.1};
  return static_cast<float>(measure::find_loss(settled, target, search).loss);
}

}  // namespace binosplat::study
