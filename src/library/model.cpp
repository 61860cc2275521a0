#include <binosplat/model.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "formats/models/model_file.h"
#include "library/views.h"
#include "scene/framing.h"
#include "scene/model_rows.h"

namespace binosplat {

namespace {

const Model& model_in(const std::shared_ptr<const Model>& model) {
  if (model == nullptr) fail("this SplatModel was moved from: expected a valid one");
  return *model;
}

}  // namespace

SplatModel::SplatModel(const std::filesystem::path& path, const ModelOptions& options) {
  if (path.empty()) fail("an empty path: expected the path of a model");
  model_ = std::make_shared<const Model>(load_model(path, options));
}

SplatModel::SplatModel(const Gaussians& gaussians, const std::string& name) {
  const std::size_t count = gaussians.means.size();
  const auto check_length = [&](const char* array, std::size_t length) {
    if (length != count) fail("{}: {} elements for {} means: expected the same number", array, length, count);
  };
  check_length("quats", gaussians.quats.size());
  check_length("scales", gaussians.scales.size());
  check_length("opacities", gaussians.opacities.size());
  int degree = 0;
  while (degree < 3 && gaussians.sh.size() != count * static_cast<std::size_t>(sh_count(degree))) ++degree;
  const auto each = static_cast<std::size_t>(sh_count(degree));
  if (gaussians.sh.size() != count * each)
    fail("sh: {} elements for {} means: expected 1, 4, 9 or 16 for each", gaussians.sh.size(), count);
  Model model = model_of_rows(count, degree, gaussians.axes, [&](std::size_t i) {
    return GaussianValues{gaussians.means[i], gaussians.scales[i], gaussians.quats[i], gaussians.opacities[i],
                          &gaussians.sh[i * each].x};
  });
  model.name = name;
  model.antialiased = gaussians.antialiased;
  model_ = std::make_shared<const Model>(std::move(model));
}

SplatModel::SplatModel(std::shared_ptr<const Model> model) : model_(std::move(model)) {}

const std::string& SplatModel::name() const { return model_in(model_).name; }

std::size_t SplatModel::count() const { return model_in(model_).count(); }

Bounds SplatModel::bounds() const { return core_bounds(model_in(model_)); }

Bounds SplatModel::all_bounds() const { return binosplat::all_bounds(model_in(model_)); }

Placement SplatModel::framing(const Fov& fov, const glm::dvec3& eye, double units_per_metre) const {
  const Model& model = model_in(model_);
  // The half of the frustum that shows less.
  const PictureShape shape{std::tan(std::min(-fov.left, fov.right)), std::tan(std::min(fov.up, -fov.down))};
  const Viewpoint viewpoint = find_viewpoint(model, shape, {}, 1.6 * units_per_metre);
  const auto& [middle, distance, elevation, first] = *viewpoint.capture.around;
  const glm::dvec3 up = viewpoint.capture.up, back = glm::normalize(first - glm::dot(first, up) * up);
  const glm::dvec3 place = middle + (viewpoint.kind == Viewpoint::Kind::within ? first : distance * back);
  const glm::dmat3 into_model = glm::transpose(world_from_axes(model.axes.letters));
  const glm::dmat3 axes = into_model * glm::dmat3(glm::cross(up, back), up, back);
  return {into_model * place - units_per_metre * axes * eye, axes, units_per_metre};
}

Placement SplatModel::placement(const glm::dvec3& origin, double units_per_metre) const {
  return library::placement_in(model_in(model_), origin, units_per_metre);
}

}  // namespace binosplat
