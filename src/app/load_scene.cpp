#include "app/load_scene.h"

#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "formats/model_file.h"
#include "scene/repeat.h"

namespace binosplat::app {

namespace {

[[noreturn]] void fail_unknown(const std::string& name) {
  fail("{}: the scenes that are built in are called {} and {}", name, demo_room_name, demo_city_name);
}

Model load_once(const SceneOptions& o, const std::optional<DetailBudget>& budget) {
  if (o.name == demo_city_name) return demo_city(city_settings(o)).model;
  if (o.name == demo_room_name) return demo_room().model;
  if (is_built_in(o.name)) fail_unknown(o.name);
  Model model = load_model(o.name, {o.lod, o.appearance, budget});
  if (model.antialiased && !o.antialias)
    log_info("{} was trained with anti-aliasing and is drawn so (--no-antialias: as if not)", o.name);
  return model;
}

}  // namespace

CitySettings city_settings(const SceneOptions& o) {
  CitySettings settings;
  settings.seed = o.seed.value_or(settings.seed);
  settings.count = o.count.value_or(settings.count);
  return settings;
}

void set_as_asked(const SceneOptions& o, Model& model) {
  if (!o.axes.empty()) model.axes = o.axes;
  model.antialiased = o.antialias.value_or(model.antialiased);
  model.kernel_px2 = o.kernel_px2.value_or(model.kernel_px2);
}

std::vector<Camera> built_in_cameras(const SceneOptions& o) {
  if (o.name == demo_city_name) {
    const CitySettings settings = city_settings(o);
    check(settings);
    return city_cameras(settings.seed);
  }
  if (o.name == demo_room_name) return room_cameras();
  if (is_built_in(o.name)) fail_unknown(o.name);
  return {};
}

Model load_scene(const SceneOptions& o, const std::optional<DetailBudget>& budget) {
  Model model = load_once(o, budget);
  set_as_asked(o, model);
  if (!o.repeat) return model;
  return repeat(std::move(model), o.repeat->x, o.repeat->y, *o.spacing);
}

}  // namespace binosplat::app
