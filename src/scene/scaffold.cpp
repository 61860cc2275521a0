#include "scene/scaffold.h"

#include <utility>

#include "base/error.h"

namespace binosplat {

namespace {

// Typical scale, relative to the networks' largest, and the middle of the opacities above 0.
constexpr float usual_scale = 0.5f;
constexpr float usual_opacity = 0.5f;

}  // namespace

Model placeholder_model(std::shared_ptr<Scaffold> scaffold) {
  Model model;
  model.name = scaffold->name;
  model.format = describe(*scaffold);
  model.resize(scaffold->count());
  for (std::size_t id = 0; id < model.count(); ++id) {
    model.position[id] = scaffold->mean(id);
    model.scale[id] = usual_scale * scaffold->scale[id / scaffold->offset_count];
    model.rotation[id] = {1.0f, 0.0f, 0.0f, 0.0f};
    model.opacity[id] = usual_opacity;
  }
  model.left_out = scaffold->left_out * scaffold->offset_count;
  model.scaffold = std::move(scaffold);
  return model;
}

std::string describe(const Scaffold& s) {
  std::string text = fmt::format("Scaffold-GS, {} anchors of {} Gaussians, features of {}", s.anchor_count(),
                                 s.offset_count, s.feature_count);
  if (s.bank) text += " with a feature bank";
  if (s.opacity.distance || s.covariance.distance || s.colour.distance)
    text += ", with the distance as an input";
  if (s.appearance_size > 0)
    text += fmt::format(", appearance {} of 0 to {}", s.appearance, s.appearance_count() - 1);
  return text;
}

void choose_appearance(Scaffold& scaffold, std::size_t id) {
  const std::size_t count = scaffold.appearance_count();
  if (count == 0) fail("appearance {}: {} was trained without appearances", id, scaffold.name);
  if (id >= count) fail("appearance {}: {} has appearances 0 to {}", id, scaffold.name, count - 1);
  scaffold.appearance = id;
}

}  // namespace binosplat
