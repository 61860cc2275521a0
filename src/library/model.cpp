#include <binosplat/model.h>
#include <utility>

#include "formats/model_file.h"
#include "scene/axes.h"

namespace binosplat {

SplatModel::SplatModel(const std::filesystem::path& path, const ModelOptions& options)
    : model_(std::make_shared<const Model>(load_model(path, options))) {}

SplatModel::SplatModel(std::shared_ptr<const Model> model) : model_(std::move(model)) {}

const std::string& SplatModel::name() const { return model_->name; }

std::size_t SplatModel::count() const { return model_->count(); }

Bounds SplatModel::bounds() const { return core_bounds(*model_); }

Placement SplatModel::placement(const glm::dvec3& origin, double units_per_metre) const {
  const glm::dmat3 into_model = glm::transpose(world_from_axes(model_->axes));
  return {into_model * origin, into_model * Placement{}.axes, units_per_metre};
}

}  // namespace binosplat
