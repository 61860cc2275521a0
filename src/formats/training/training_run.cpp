#include "formats/training/training_run.h"

#include <iterator>
#include <string_view>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/path_questions.h"
#include "formats/containers/content.h"
#include "formats/training/flat_values.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_run_file = std::size_t{1} << 20;  // bytes; usual files have about ten thousand

/// A kind of file that describes a training run, and the trainer in the table of keys (trainer_keys.cpp).
struct RunKind {
  const char *name, *trainer;
  FlatValues (*read)(const std::string& source, std::string_view text);
  const char* prefix;  // precedes the keys in `mark` and in the table of keys
  const char* mark;    // a key that every file of this kind has, and no file of another kind
};

FlatValues python_values(const std::string& /*source*/, std::string_view text) {
  return namespace_values(text);
}

constexpr RunKind run_kinds[] = {
    {"cfg.yml", "gsplat", yaml_values, "", "result_dir"},
    {"cfg.json", "gsplat", json_values, "", "result_dir"},
    {"config.yml", "nerfstudio", yaml_values, "pipeline.model.", "cull_alpha_thresh"},
    {"config.json", "StopThePop", json_values, "", "sort_settings.sort_mode"},
    // Of a cfg_args, the first of these with a key of its own.
    {"cfg_args", "RaDe-GS", python_values, "", "use_coord_map"},
    {"cfg_args", "GOF", python_values, "", "use_decoupled_appearance"},
    {"cfg_args", "Mip-Splatting", python_values, "", "kernel_size"},
    {"cfg_args", "Analytic-Splatting", python_values, "", "sample_more_highres"},
    {"cfg_args", "EAGLES", python_values, "", "latent_dim"},
    {"cfg_args", "Octree-GS", python_values, "", "fork"},
    {"cfg_args", "INRIA's trainer or one like it", python_values, "", "sh_degree"},
    {"training_config.json", "LichtFeld Studio", json_values, "optimization.", "sh_degree"},
    {"parsed.yaml", "3DGRUT", yaml_values, "", "render.method"}};

std::optional<TrainingRun> read_run(const fs::path& file, const RunKind& kind) {
  try {
    const MappedFile mapped(file);
    if (mapped.bytes().size() > largest_run_file) return std::nullopt;
    const FlatValues values = kind.read(file.string(), as_text(mapped.bytes()));
    const auto has_mark = [&](const std::string& prefix) {
      return find_value(values, prefix + kind.mark).has_value();
    };
    if (!has_mark(kind.prefix) && !has_mark("")) return std::nullopt;
    TrainingRun run{read_keys({kind.trainer, kind.name}, values, has_mark(kind.prefix) ? kind.prefix : ""),
                    file, kind.trainer};
    if (find_above(file, exposures_name)) std::erase(run.differences, lacks_exposures);
    return run;
  } catch (const Error& error) {
    log_warning("{}; its settings of the training are ignored", error.what());
    return std::nullopt;
  }
}

}  // namespace

std::optional<fs::path> find_above(const fs::path& model, const std::string& name, int most) {
  fs::path folder = fs::absolute(model).lexically_normal();
  for (int up = 0; up <= most; ++up) {
    folder = folder.parent_path();
    const fs::path file = folder / name;
    if (!is_file(file)) continue;
    // If the model's path is relative to the working directory, returns a relative path, too.
    return model.is_absolute() ? file : file.lexically_proximate(fs::current_path());
  }
  return std::nullopt;
}

std::optional<TrainingRun> find_training_run(const fs::path& model) {
  std::optional<TrainingRun> nearest;
  std::size_t deepest = 0;
  for (const RunKind& kind : run_kinds) {
    const auto file = find_above(model, kind.name);
    if (!file) continue;
    const fs::path whole = fs::absolute(*file).lexically_normal();
    const auto depth = static_cast<std::size_t>(std::distance(whole.begin(), whole.end()));
    if (nearest && depth <= deepest) continue;
    if (auto run = read_run(*file, kind)) {
      nearest = std::move(run);
      deepest = depth;
    }
  }
  return nearest;
}

}  // namespace binosplat
