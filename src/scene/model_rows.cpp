#include "scene/model_rows.h"

#include <cmath>
#include <string_view>

#include "base/error.h"
#include "scene/axes.h"

namespace binosplat {

namespace {

void fail_at(const char* name, std::size_t row, std::string_view why) { fail("{}[{}]: {}", name, row, why); }

void refuse_row(const GaussianValues& values, std::size_t row, int coefficients) {
  const auto finite = [](const auto* of, int count) {
    for (int k = 0; k < count; ++k) {
      if (!std::isfinite(static_cast<float>(of[k]))) return false;
    }
    return true;
  };
  const char* const not_finite = "expected finite numbers";
  if (!finite(&values.position.x, 3)) fail_at("means", row, not_finite);
  if (!finite(&values.rotation.x, 4)) fail_at("quats", row, not_finite);
  if (values.rotation == glm::vec4(0.0f)) fail_at("quats", row, "a quaternion of zeros is not a rotation");
  if (!finite(&values.scale.x, 3)) fail_at("scales", row, not_finite);
  if (glm::any(glm::lessThan(values.scale, glm::vec3(0.0f))))
    fail_at("scales", row,
            "below 0: expected standard deviations, exp() of the log-scales that trainers store");
  if (!(values.opacity >= 0.0f && values.opacity <= 1.0f))
    fail_at("opacities", row, "expected 0 to 1, the sigmoid of the logits that trainers store");
  if (!finite(values.sh, coefficients)) fail_at("sh", row, not_finite);
  fail_at("scales", row, "above 1e13, which cannot be drawn");
}

}  // namespace

Model model_of_rows(std::size_t count, int degree, const std::string& axes,
                    const std::function<GaussianValues(std::size_t)>& row) {
  Model model;
  model.format = "arrays";
  model.degree = degree;
  world_from_axes(axes);  // throws for invalid letters
  model.axes.letters = axes;
  if (count == 0) fail("means: no Gaussians: expected one row or more");
  model.resize(count);
  const auto fill = [&] {
    for (std::size_t i = 0; i < count; ++i) {
      const GaussianValues values = row(i);
      if (!place(model, i, values)) refuse_row(values, i, 3 * sh_count(degree));
    }
  };
  fill();
  if (choose_origin(model)) fill();
  return model;
}

}  // namespace binosplat
