#include "app/placed.h"

#include <algorithm>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "app/content_key.h"
#include "app/load_scene.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/gltf_nodes.h"
#include "formats/join.h"
#include "formats/json_file.h"
#include "scene/axes.h"
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
}

nlohmann::json list_of(const std::string& file) {
  return parse_json(file, as_text(MappedFile(file).bytes()));
}

std::string model_of(const JsonValue& entry, const std::string& file) {
  std::string model = entry.at("model").text();
  if (is_built_in(model)) return model;
  return (std::filesystem::path(file).parent_path() / model).lexically_normal().string();
}

}  // namespace

void append_placed(const SceneOptions& o, Model& model) {
  const nlohmann::json list = list_of(o.place);
  const JsonValue root(o.place, list);
  SceneOptions asked;  // the other options are for the scene itself
  asked.antialias = o.antialias;
  asked.kernel_px2 = o.kernel_px2;
  const glm::dmat4 turned(glm::transpose(world_from_axes(model.axes.letters)));
  const glm::dmat4 into_scene = glm::translate(glm::dmat4(1.0), -model.axes.origin) * turned;
  std::map<std::string, std::vector<JsonValue>> entries;  // by model
  for (std::size_t k = 0; k < root.size(); ++k) entries[model_of(root.at(k), o.place)].push_back(root.at(k));
  const WarningsOnce once;
  for (const auto& [path, of_model] : entries) {
    asked.name = path;
    const Model loaded = load_scene(asked);
    const glm::dmat4 from_model =
        glm::translate(glm::dmat4(world_from_axes(loaded.axes.letters)), loaded.axes.origin);
    for (const JsonValue& entry : of_model) {
      Model placed = loaded;
      check_trained_alike(entry, placed, model);
      placed.axes = model.axes;
      std::vector<glm::dvec3> places;
      if (!transform(placed, into_scene * node_transform(entry) * from_model, places))
        entry.fail_here("its matrix moves {} beyond the range of floats", path);
      std::ranges::copy(places, placed.position.begin());
      join(model, std::move(placed));
    }
    log_info("{}: {} x {} Gaussians of {}", o.place, of_model.size(), loaded.count(), path);
  }
}

std::string placed_key(const std::string& file) {
  const nlohmann::json list = list_of(file);
  const JsonValue root(file, list);
  std::string keys = file_key(file);
  for (std::size_t k = 0; k < root.size(); ++k) {
    const std::string model = model_of(root.at(k), file);
    keys += is_built_in(model) ? model : content_key(std::filesystem::path(model));
  }
  return text_key(keys);
}

}  // namespace binosplat::app
