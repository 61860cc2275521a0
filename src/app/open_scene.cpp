#include "app/open_scene.h"

#include <memory>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "demo/room.h"
#include "formats/model_file.h"
#include "scene/repeat.h"

namespace binosplat::app {

namespace {

Scene open_once(const RenderOptions& options) {
  if (options.scene == demo_city_name) {
    const CitySettings settings = city_settings(options);
    check(settings);
    return {city_cameras(settings.seed), [settings] { return demo_city(settings).model; }};
  }
  if (options.scene == demo_room_name) {
    const auto room = std::make_shared<Demo>(demo_room());
    return {room->cameras, [room] { return std::move(room->model); }};
  }
  if (options.scene.rfind("demo:", 0) == 0) {
    fail("{}: the scenes that are built in are called {} and {}", options.scene, demo_room_name,
         demo_city_name);
  }
  return {{}, [&options] {
            Model model = load_model(options.scene, {options.lod, options.appearance, options.budget});
            if (model.antialiased && !options.antialias)
              log_info("{} was trained with anti-aliasing and is drawn so (--no-antialias: as if not)",
                       options.scene);
            return model;
          }};
}

}  // namespace

CitySettings city_settings(const RenderOptions& options) {
  CitySettings settings;
  settings.seed = options.seed.value_or(settings.seed);
  settings.count = options.count.value_or(settings.count);
  return settings;
}

void set_as_asked(const RenderOptions& options, Model& model) {
  if (!options.axes.empty()) model.axes = options.axes;
  model.antialiased = options.antialias.value_or(model.antialiased);
  model.kernel_px2 = options.kernel_px2.value_or(model.kernel_px2);
}

Scene open_scene(const RenderOptions& options) {
  Scene scene = open_once(options);
  scene.model = [read = scene.model, &options] {
    Model model = read();
    set_as_asked(options, model);
    return model;
  };
  if (!options.repeat) return scene;
  const auto once = scene.model;
  scene.model = [once, &options] {
    return repeat(once(), options.repeat->x, options.repeat->y, *options.spacing);
  };
  return scene;
}

}  // namespace binosplat::app
