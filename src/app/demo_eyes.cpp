#include "app/demo_eyes.h"

#include "base/log.h"
#include "demo/city.h"
#include "demo/room.h"

namespace binosplat::app {

RenderOptions with_eyes_of_demo(RenderOptions o) {
  const bool asked = o.rig.places_eyes() || o.rig.units_per_metre || o.camera.lens.headset() ||
                     o.camera.lens.vr180() || !o.camera.file.empty() || o.camera.made_up() ||
                     o.camera.along_path();
  if (asked || o.rig.mono || !is_built_in(o.scene.name)) return o;
  if (o.scene.name == demo_room_name) {
    // A plant stands half a metre from the first view, and that looks out of the window.
    o.rig.ipd = 0.020;
    o.rig.convergence = 1.2;
    log_info(
        "{}: eyes 20 mm apart and the screen at 1.2 m, which is comfortable so near to its plant (--ipd 63mm "
        "--convergence inf: as a head sees it)",
        o.scene.name);
  } else if (o.scene.name == demo_city_name) {
    o.rig.convergence = 5.0;
    log_info("{}: the screen at 5 m (--convergence METRES for another, or inf)", o.scene.name);
  }
  return o;
}

}  // namespace binosplat::app
