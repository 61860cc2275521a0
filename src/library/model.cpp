#include <binosplat/model.h>
#include <utility>

#include "base/error.h"
#include "formats/model_file.h"
#include "library/placement.h"

namespace binosplat {

namespace {

const Model& model_in(const std::shared_ptr<const Model>& model) {
  if (model == nullptr) fail("this SplatModel was moved from: expected one that holds a model");
  return *model;
}

}  // namespace

SplatModel::SplatModel(const std::filesystem::path& path, const ModelOptions& options) {
  if (path.empty()) fail("an empty path: expected that of a model");
  model_ = std::make_shared<const Model>(load_model(path, options));
}

SplatModel::SplatModel(std::shared_ptr<const Model> model) : model_(std::move(model)) {}

const std::string& SplatModel::name() const { return model_in(model_).name; }

std::size_t SplatModel::count() const { return model_in(model_).count(); }

Bounds SplatModel::bounds() const { return core_bounds(model_in(model_)); }

Placement SplatModel::placement(const glm::dvec3& origin, double units_per_metre) const {
  return library::placement_in(model_in(model_), origin, units_per_metre);
}

}  // namespace binosplat
