#include "demo/room.h"

#include "demo/room_light.h"
#include "demo/room_parts.h"

namespace binosplat {

namespace {

using namespace demo;
using namespace demo::room;

/// A late afternoon: a low sun through the window, the lamp already on.
Lighting evening_light(const dvec3& to_sun) {
  Lighting light;
  light.room_low = room_low;
  light.room_high = room_high;
  light.opening_low = window_low;
  light.opening_high = window_high;
  light.to_sun = to_sun;
  light.sun = {5.0, 3.6, 2.1};
  light.sky = {1.7, 1.85, 2.0};
  light.lamp_position = lamp_bulb + dvec3(0, 0.03, 0);
  light.lamp = {0.62, 0.42, 0.22};
  light.ambient = {0.17, 0.165, 0.17};
  light.bounce_middle = {0.1, 0.0, -0.4};
  light.bounce = {0.42, 0.26, 0.16};
  return light;
}

Camera head(const char* name, const dvec3& eye, const dvec3& at, double fov_degrees) {
  Camera camera = look_at(eye, at, {0, -1, 0}, fov_degrees, 1280, 720);
  camera.name = name;
  return camera;
}

}  // namespace

std::vector<Camera> room_cameras() {
  return {head("room", {-0.95, -1.45, -1.75}, {0.30, -0.98, 1.0}, 62.0),
          head("window", {0.62, -1.08, -0.75}, {-0.70, -1.35, 2.0}, 60.0),
          head("table", {0.10, -1.25, -0.35}, {1.10, -0.80, 0.60}, 55.0)};
}

Demo demo_room() {
  const dvec3 to_sun = glm::normalize(dvec3(-0.42, -0.43, 0.84));
  Stage stage(9);
  add_floor(stage);
  add_rug(stage);
  add_walls(stage);
  add_ceiling(stage);
  add_window(stage);
  add_curtains(stage);
  add_outside(stage, to_sun);
  add_table(stage);
  add_chair(stage, turned({0.42, 0, 0.98}, 50.0));
  add_chair(stage, turned({1.62, 0, 0.05}, -130.0));
  add_armchair(stage);
  add_bookshelf(stage);
  add_lamp(stage);
  add_pictures(stage);
  add_table_setting(stage);
  add_bird_cage(stage);
  add_fairy_lights(stage);
  add_toys(stage);
  add_near_plant(stage);
  stage.remove_hidden();

  Demo demo;
  demo.model = bake(stage, evening_light(to_sun));
  demo.model.name = demo_room_name;
  demo.cameras = room_cameras();
  return demo;
}

}  // namespace binosplat
