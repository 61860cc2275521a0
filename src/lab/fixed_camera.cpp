#include "lab/fixed_camera.h"

#include "measure/depth_table.h"
#include "measure/search.h"

namespace binosplat::lab {

FixedCamera::FixedCamera(gl::Context& context, const Model& model, std::vector<shared::View> views)
    : frame_(context, model),
      views_(std::move(views)),
      exact_pairs_(static_cast<double>(frame_.draw(views_).pairs)),
      exact_(frame_.read_pictures()),
      error_(context, exact_),
      table_(measure::measure_depth_table(frame_, views_)) {}

render::FrameReport FixedCamera::draw(const Variant& variant, int record_every) {
  render::FrameSettings settings = variant.settings();
  settings.record_every = record_every;
  settings.depth_table = table_;
  return frame_.draw(views_, settings);
}

render::FrameReport FixedCamera::settle(const Variant& variant) {
  forget();
  render::FrameReport report = draw(variant);
  for (int n = 1; n < render::settling_frames && render::measures(variant.transmittance); ++n)
    report = draw(variant);
  return report;
}

float FixedCamera::tolerance_at(Variant variant, double target) {
  if (render::is_exact(variant.th)) return 0.0f;
  const auto settled = [&](double tolerance) {
    variant.tolerance = static_cast<float>(tolerance);
    settle(variant);
    return psnr();
  };
  const measure::ToleranceSearch search{.start = render::threshold_rules[variant.th].careful_tolerance,
                                        .within = 0.1};
  return static_cast<float>(measure::find_tolerance(settled, target, search).tolerance);
}

}  // namespace binosplat::lab
