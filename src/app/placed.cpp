#include "app/placed.h"

#include <algorithm>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>

#include "app/content_key.h"
#include "app/load_scene.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/gltf_nodes.h"
#include "formats/join.h"
#include "formats/json_file.h"
#include "formats/model_file.h"
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
  return (std::filesystem::path(file).parent_path() / entry.at("model").text()).lexically_normal().string();
}

}  // namespace

void append_placed(const SceneOptions& o, Model& model) {
  const nlohmann::json list = list_of(o.place);
  const JsonValue root(o.place, list);
  SceneOptions asked = o;
  asked.axes.clear();  // --axes is for the scene itself
  const glm::dmat4 into_scene(glm::transpose(world_from_axes(model.axes.letters)));
  for (std::size_t k = 0; k < root.size(); ++k) {
    const JsonValue entry = root.at(k);
    const std::string path = model_of(entry, o.place);
    const glm::dmat4 matrix = node_transform(entry);
    Model placed = load_model(path);
    apply_options(asked, placed);
    check_trained_alike(entry, placed, model);
    // From the placed model's axes into the scene's axes.
    const glm::dmat4 turned(world_from_axes(placed.axes.letters));
    const glm::dmat4 map = glm::translate(glm::dmat4(1.0), -model.axes.origin) * into_scene * matrix *
                           glm::translate(turned, placed.axes.origin);
    placed.axes = model.axes;
    std::vector<glm::dvec3> places;
    if (!transform(placed, map, places))
      entry.fail_here("its matrix moves {} beyond the range of floats", path);
    std::ranges::copy(places, placed.position.begin());
    log_info("{}: {} Gaussians of {}", o.place, placed.count(), path);
    join(model, std::move(placed));
  }
}

std::string placed_key(const std::string& file) {
  const nlohmann::json list = list_of(file);
  const JsonValue root(file, list);
  std::string keys = file_key(file);
  for (std::size_t k = 0; k < root.size(); ++k)
    keys += content_key(std::filesystem::path(model_of(root.at(k), file)));
  return text_key(keys);
}

}  // namespace binosplat::app
