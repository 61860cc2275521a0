#include "formats/models/model_file.h"

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/numbers.h"
#include "base/path_questions.h"
#include "base/text.h"
#include "formats/models/compressed_ply.h"
#include "formats/models/registry.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

/// Returns the file in `folder` that is named BEFORE, N, AFTER and has the largest N. With `inside`, these
/// names are folders, and the file `inside` in the folder with the largest N is returned.
std::optional<fs::path> latest(const fs::path& folder, std::string_view before, std::string_view after,
                               const fs::path& inside = {}) {
  std::error_code ignored;
  std::optional<fs::path> found;
  unsigned largest = 0;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    std::string_view left = name;
    if (!left.starts_with(before)) continue;
    left.remove_prefix(before.size());
    const auto n = take_number(left);
    const fs::path file = inside.empty() ? entry.path() : entry.path() / inside;
    if (!n || left != after || (found && *n < largest) || !is_file(file)) continue;
    largest = *n;
    found = file;
  }
  return found;
}

bool is_named_as_model(const fs::path& path) {
  const std::string ending = lowered_ending(path), name = lowered(path.filename().string());
  for (const char* points : {"input.ply", "points3d.ply", "sparse_pc.ply", "sparse.ply"}) {
    if (name == points) return false;
  }
  return std::ranges::any_of(format_rows(), [&](const FormatRow& row) {
    return std::ranges::count(words_of(row.endings), ending) > 0;
  });
}

/// Returns whether a file exists and contains a text. The file may be damaged or cut.
bool has_text(const fs::path& path, std::string_view text) {
  if (!is_file(path)) return false;
  const MappedFile file(path);
  return as_text(file.bytes()).find(text) != std::string_view::npos;
}

/// Returns whether a file named as a model is something else: a ply with a mesh or points, or a glTF without
/// Gaussians. Unreadable files count as models, so that their error is shown.
bool is_other_content(const fs::path& path) {
  try {
    if (lowered_ending(path).starts_with(".gl")) return !has_text(path, "gaussian_splat");
    if (lowered_ending(path) != ".ply") return false;
    const OpenedFile file(path);
    const PlyElement* const vertices = file.ply().find("vertex");
    return vertices == nullptr || (vertices->find("opacity") == nullptr && !is_compressed_ply(file.ply()));
  } catch (const Error&) {
    return false;
  }
}

void refuse_level(const fs::path& path, const ModelOptions& options) {
  if (options.lod) {
    fail("level of detail {}: {} has no levels of detail; name the lod-meta.json of a streamed SOG",
         *options.lod, path);
  }
}

/// Warns of what the model's trainer draws from more than the Gaussians of the file.
void warn_of_undrawn(const OpenedFile& file) {
  const fs::path folder = fs::absolute(file.path).parent_path();
  if (is_file(folder / "deformation.pth") || latest(folder / "../../deform", "iteration_", "", "deform.pth"))
    log_warning("{}: a network moves its Gaussians with time; they are drawn unmoved", file.path);
  if (file.content != Content::ply || file.ply().find("vertex") == nullptr) return;
  if (file.ply().find("vertex")->find("extra_level") != nullptr)
    log_warning("{}: its trainer leaves out fine levels far away; all are drawn (Octree-GS)", file.path);
  if (file.ply().find("vertex")->find("refl_strength") != nullptr)
    log_warning("{}: its trainer adds reflections and lighting, which are not drawn", file.path);
}

Model load_content(const fs::path& path, const ModelOptions& options) {
  const OpenedFile file(path);
  warn_of_undrawn(file);
  const FormatRow* const format = options.format.empty() ? format_of(file) : &row_named(options.format);
  if (format != &row_of(ModelFormat::streamed_sog)) refuse_level(path, options);
  if (format != nullptr) return format->read(file, options);
  if (file.content == Content::json) {
    fail("{} is a JSON file, but neither a glTF nor the meta.json or lod-meta.json of a SOG model{}", path,
         lowered_ending(path).starts_with(".lcc") ? "; splat-transform converts .lcc scenes of XGRIDS to ply"
                                                  : ". If it has cameras, `cameras` takes it");
  }
  fail("{} is not a model that can be read: expected {}, but it looks like {}", path, names_of_formats(),
       describe(file.content));
}

}  // namespace

std::vector<fs::path> models_in(const fs::path& folder) {
  std::error_code ignored;
  // Other programs use these file names, too, so the contents decide.
  if (has_text(folder / "lod-meta.json", "\"lodLevels\"")) return {folder / "lod-meta.json"};
  if (has_text(folder / "meta.json", "\"means\"")) return {folder / "meta.json"};
  const fs::path clouds = folder / "point_cloud", ply = "point_cloud.ply";
  for (const fs::path& file : {folder / ply, clouds / ply}) {
    if (is_file(file)) return {file};
  }
  if (const auto file = latest(clouds, "iteration_", "", ply)) return {*file};
  if (const auto file = latest(folder / "ply", "point_cloud_", ".ply")) return {*file};
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (is_named_as_model(entry.path()) && is_file(entry.path())) found.push_back(entry.path());
  }
  if (found.size() > 1 && !std::ranges::all_of(found, is_other_content))
    std::erase_if(found, is_other_content);
  std::ranges::sort(found, [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  const fs::path exported = folder / "exports/splat/splat.ply";
  for (const fs::path& file :
       {exported, folder / "lod-meta.json", folder / "meta.json", folder / "ckpt_last.pt"}) {
    if (found.empty() && is_file(file)) return {file};
  }
  if (!found.empty()) return found;
  // Some trainers write only checkpoints unless they are asked. The error of reading one says how to ask.
  if (const auto file = latest(folder / "ckpts", "ckpt_", "_rank0.pt")) return {*file};
  if (const auto file = latest(folder / "nerfstudio_models", "step-", ".ckpt")) return {*file};
  return found;
}

fs::path file_of(const fs::path& path) {
  if (!is_folder(path)) return path;
  const std::vector<fs::path> found = models_in(path);
  if (found.size() == 1) return found[0];
  if (found.empty()) {
    fail(
        "{} is a folder without a model: expected one model file, lod-meta.json or meta.json of a SOG, "
        "point_cloud.ply (also in point_cloud/ or point_cloud/iteration_N/), gsplat's ply/point_cloud_N.ply, "
        "or nerfstudio's exports/splat/splat.ply",
        path);
  }
  std::string names;
  constexpr std::size_t shown = 8;
  for (std::size_t i = 0; i < std::min(shown, found.size()); ++i) names += "\n  " + found[i].string();
  if (found.size() > shown) names += fmt::format("\n  and {} more", found.size() - shown);
  fail("{} is a folder with {} models. Name one, or show one after the other with `fps` N (render, view):{}",
       path, found.size(), names);
}

Model load_model_alone(const fs::path& path, const ModelOptions& options) {
  const WarningsOnce once;
  const fs::path file = file_of(path);
  Model model = load_content(file, options);
  if (options.appearance && !model.scaffold)
    fail("appearance {}: {} has none; only Scaffold-GS models have appearances", *options.appearance, file);
  model.name = file.filename().string();
  model.path = path.string();
  if (model.count() == 0) {
    fail(
        "{}: all of its {} Gaussians have values that are not finite or out of range, scales above 1e13, or "
        "zero quaternions",
        file, model.left_out);
  }
  if (model.lacks_degree_4) log_warning("{}: harmonics of degree 4 are drawn up to degree 3", file);
  if (model.left_out > 0) {
    log_warning(
        "{}: {} of {} Gaussians left out (values not finite or out of range, a scale above 1e13, or a zero "
        "quaternion)",
        file, model.left_out, model.left_out + model.count());
  }
  return model;
}

Model load_model(const fs::path& path, const ModelOptions& options) {
  const fs::path file = file_of(path);
  Model model = load_model_alone(file, options);
  if (const auto run = run_of(model, file)) {
    for (const std::string& sentence : run->differences) log_warning("{}: {}", run->file, sentence);
    for (const std::string& sentence : run->notes) log_info("{}: {}", run->file, sentence);
    follow(*run, file, model);
  }
  return model;
}

void follow(const TrainingRun& run, const fs::path& file, Model& model) {
  TrainingSaid said = static_cast<const TrainingSaid&>(run);
  if (model.scaffold) said.antialiased = std::nullopt;  // Scaffold-GS trains without anti-aliasing
  follow(said, run.file.string(), file.string(), model);
}

std::optional<fs::path> find_exposures(const fs::path& path) {
  return find_above(file_of(path), exposures_name);
}

std::optional<TrainingRun> run_of(const Model& model, const fs::path& file) {
  // A streamed SOG's levels come from a model and already carry its properties.
  const bool has_levels = model.format.starts_with(row_of(ModelFormat::streamed_sog).name);
  return has_levels ? std::nullopt : find_training_run(file);
}

}  // namespace binosplat
