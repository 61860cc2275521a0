#include "app/models/placed.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "app/models/load_scene.h"
#include "base/inputs.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "formats/containers/content.h"
#include "formats/containers/json_file.h"
#include "formats/models/append_model.h"
#include "formats/models/files_of_model.h"
#include "formats/models/gltf_nodes.h"
#include "formats/models/streamed_sog.h"
#include "scene/axes.h"
#include "scene/core.h"
#include "scene/repeat.h"
#include "scene/transform.h"

namespace binosplat::app {

namespace {

void check_trained_alike(const JsonValue& entry, const Model& model, const Model& scene) {
  if (model.scaffold || scene.scaffold) entry.fail_here("a Scaffold-GS model cannot be placed among others");
  if (model.antialiased != scene.antialiased || model.kernel_px2 != scene.kernel_px2) {
    entry.fail_here(
        "trained {} anti-aliasing and for a low-pass of {} px^2, but the scene {} anti-aliasing and for {} "
        "px^2: one setting draws all; name it by --antialias or --no-antialias and --eps2d",
        model.antialiased ? "with" : "without", model.kernel_px2, scene.antialiased ? "with" : "without",
        scene.kernel_px2);
  }
  if (model.linear != scene.linear)
    entry.fail_here("one of it and the scene has colours of linear light, which all or none must have");
}

std::string model_of(const JsonValue& entry, const std::string& file) {
  std::string model = entry.at("model").text();
  if (is_built_in(model)) return model;
  return (std::filesystem::path(file).parent_path() / model).lexically_normal().string();
}

void refuse_unknown_keys(const JsonValue& entry) {
  std::vector<std::string> known = {"model", "opacity", "matrix"};
  if (!entry.has("matrix")) known.insert(known.end(), {"translation", "rotation", "scale"});
  for (const auto& [key, value] : entry.value().items())
    if (std::ranges::find(known, key) == known.end())
      entry.fail_here("unknown key '{}'{}: expected {}", key, entry.has("matrix") ? " beside 'matrix'" : "",
                      fmt::join(known, ", "));
}

}  // namespace

void append_placed(const SceneOptions& o, Model& model, std::span<const Camera> cameras) {
  const nlohmann::json list = parse_json(o.place, as_text(MappedFile(o.place).bytes()));
  const JsonValue root(o.place, list);
  SceneOptions asked{.antialias = o.antialias, .kernel_px2 = o.kernel_px2};  // others are the scene's own
  const glm::dmat4 into_scene = glm::translate(glm::dmat4(1.0), -model.axes.origin) *
                                glm::dmat4(glm::transpose(world_from_axes(model.axes.letters)));
  std::map<std::string, std::vector<JsonValue>> entries;  // by model
  for (std::size_t k = 0; k < root.size(); ++k) entries[model_of(root.at(k), o.place)].push_back(root.at(k));
  for (std::size_t k = 0; k < root.size(); ++k) refuse_unknown_keys(root.at(k));
  const auto has_levels = [](const auto& of_path) { return is_streamed_sog(of_path.first); };
  if (o.lod && !is_streamed_sog(o.name) && std::ranges::none_of(entries, has_levels))
    fail("--lod {}: {} and the models of {} have no levels of detail", *o.lod, o.name, o.place);
  double radii = 0.0;  // of the farthest model from the scene's origin
  std::vector<glm::dvec3> places(model.position.begin(), model.position.end());
  const WarningsOnce once;
  for (const auto& [path, of_model] : entries) {
    asked.name = path;
    asked.lod = o.lod && is_streamed_sog(path) ? o.lod : std::nullopt;
    const Model loaded = load_scene(asked);
    const double radius = core_of(loaded).radius;
    const glm::dmat4 from_model =
        glm::translate(glm::dmat4(world_from_axes(loaded.axes.letters)), loaded.axes.origin);
    for (const JsonValue& entry : of_model) {
      Model placed = loaded;
      check_trained_alike(entry, placed, model);
      placed.axes = {model.axes.letters};
      const double factor = entry.has("opacity") ? entry.at("opacity").number() : 1.0;
      if (factor < 0.0 || factor > 1.0) entry.at("opacity").fail_here("{}: expected 0 to 1", factor);
      for (float& opacity : placed.opacity) opacity = static_cast<float>(factor * opacity);
      const glm::dmat4 map = into_scene * node_transform(entry) * from_model;
      const double size = std::max({glm::length(map[0]), glm::length(map[1]), glm::length(map[2])});
      if (size > 0.0) radii = std::max(radii, glm::length(glm::dvec3(map[3])) / (size * radius));
      if (!transform(placed, map, places))
        entry.fail_here("its matrix or scale takes {} beyond scales of 1e13, or beyond floats", path);
      append_model(model, std::move(placed));
    }
    log_info("{}: {} x {} Gaussians of {}", o.place, of_model.size(), loaded.count(), path);
  }
  const glm::dvec3 by = move_near(cameras, radii, model.axes);
  for (std::size_t i = 0; i < places.size(); ++i) model.position[i] = places[i] - by;
}

void protect_placed(const std::string& file) {
  const nlohmann::json list = parse_json(file, as_text(MappedFile(file).bytes()));
  const JsonValue root(file, list);
  protect_input(file);
  for (std::size_t k = 0; k < root.size(); ++k) {
    const std::string model = model_of(root.at(k), file);
    if (is_built_in(model)) continue;
    for (const std::filesystem::path& of_model : files_of_model(model)) protect_input(of_model);
  }
}

}  // namespace binosplat::app
