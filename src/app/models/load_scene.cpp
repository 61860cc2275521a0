#include "app/models/load_scene.h"

#include <utility>

#include "app/models/placed.h"
#include "app/options/parse.h"
#include "app/render/shots.h"
#include "base/error.h"
#include "base/log.h"
#include "base/text.h"
#include "formats/models/model_file.h"
#include "formats/models/spz.h"
#include "formats/models/streamed_sog.h"
#include "scene/detected_axes.h"
#include "scene/repeat.h"
#include "stream/load_within.h"

namespace binosplat::app {

namespace {

[[noreturn]] void fail_unknown(const std::string& name) {
  fail("{} is not a built-in scene: expected {} or {}", name, demo_room_name, demo_city_name);
}

Model load_own_model(const SceneOptions& o, const std::optional<DetailBudget>& budget) {
  if (o.name == demo_city_name) return demo_city(city_settings(o)).model;
  if (o.name == demo_room_name) return demo_room().model;
  if (is_built_in(o.name)) fail_unknown(o.name);
  const auto own_lod = o.lod && (o.place.empty() || is_streamed_sog(o.name)) ? o.lod : std::nullopt;
  Model model = budget ? load_within(o.name, *budget) : load_model(o.name, {own_lod, o.appearance, o.format});
  if (model.antialiased && !o.antialias)
    log_info("{} was trained with anti-aliasing, says {}, and is drawn so (--no-antialias: as if not)",
             o.name, model.antialiased_by);
  return model;
}

}  // namespace

std::vector<Camera> cameras_beside(const SceneOptions& o) {
  try {
    SceneOptions scene;
    scene.name = o.name;
    return listed_cameras(scene, {}).cameras;
  } catch (const Error&) {
    return {};
  }
}

CitySettings city_settings(const SceneOptions& o) {
  CitySettings settings;
  settings.seed = o.seed.value_or(settings.seed);
  settings.count = o.count.value_or(settings.count);
  return settings;
}

void apply_options(const SceneOptions& o, Model& model) {
  if (!o.axes.empty()) model.axes.letters = o.axes;
  if (o.antialias) {
    model.antialiased = *o.antialias;
    model.antialiased_by = *o.antialias ? "--antialias" : "--no-antialias";
  }
  model.kernel_px2 = o.kernel_px2.value_or(model.kernel_px2);
}

std::vector<Camera> built_in_cameras(const SceneOptions& o) {
  if (o.name == demo_city_name) {
    check(city_settings(o));
    return city_cameras();
  }
  if (o.name == demo_room_name) return room_cameras();
  if (is_built_in(o.name)) fail_unknown(o.name);
  return {};
}

void choose_axes(const SceneOptions& o, std::span<const Camera> cameras, Model& model) {
  if (!o.axes.empty() || !model.format.starts_with("spz")) return;
  if (model.axes.letters != "RUB" && model.axes.letters != "RDF") return;
  const bool said = !model.format.ends_with(axes_assumed);
  const std::string usual = model.axes.letters, other = usual == "RUB" ? "RDF" : "RUB";
  auto detected = detect_axes(model, other, cameras);
  if (!detected) detected = detect_axes(model, other, cameras_beside(o));
  // Overrule the file only if almost nothing of the model is in view with the file's axes.
  constexpr double max_seen_to_overrule = 0.05;
  if (said && (!detected || detected->by_ground || detected->axes == usual ||
               detected->seen_otherwise > max_seen_to_overrule))
    return;
  if (!detected) {
    log_info(
        "{}: it does not name its axes: taken as {}, as files like it have (--axes {} if it lies upside down "
        "or out of view)",
        o.name, usual, lowered(other));
    return;
  }
  model.axes.letters = detected->axes;
  const std::string& left = detected->axes == usual ? other : usual;
  const std::string why =
      detected->by_ground
          ? "in which its ground is below its cameras"
          : fmt::format("in which its cameras have {:.0f} % of it in view, and {:.0f} % in {}",
                        100.0 * detected->seen, 100.0 * detected->seen_otherwise, left);
  if (said) {
    log_warning("{}: its axes are taken as {}, {}, though its file says that (--axes {} to take them so)",
                o.name, detected->axes, why, lowered(left));
  } else {
    log_info("{}: its axes are taken as {}, {} (--axes for others)", o.name, detected->axes, why);
  }
}

Model load_scene(const SceneOptions& o, const std::optional<DetailBudget>& budget,
                 std::span<const Camera> cameras) {
  Model model = load_own_model(o, budget);
  apply_options(o, model);
  choose_axes(o, cameras, model);
  if (o.repeat) model = repeat(std::move(model), o.repeat->x, o.repeat->y, *o.spacing, cameras);
  if (!o.place.empty()) append_placed(o, model, cameras);
  return model;
}

}  // namespace binosplat::app
