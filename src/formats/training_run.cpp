#include "formats/training_run.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string_view>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "formats/content.h"
#include "formats/flat_values.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_run_file = std::size_t{1} << 20;  // bytes; usual files have about ten thousand

/// The effect of a setting's value on the pictures. A `value` "!X" matches all values except X.
struct Clue {
  const char *key, *value, *sentence;
};

constexpr const char* no_eval3d =
    "it was trained by 3DGUT, which evaluates Gaussians along each ray and has no low-pass. They are drawn "
    "as splats with almost none (--eps2d 0.001), at about 45 dB against its own renderer: large Gaussians "
    "near the eye look different";
/// The low-pass for models of 3DGUT (tests/bench/results/judges.md).
constexpr double along_rays_kernel_px2 = 0.001;
constexpr const char* no_sigma_points =
    "it was trained with the unscented transform, and is drawn by a linear projection: large Gaussians near "
    "the eye or far from the middle of a wide picture look different. Narrower views differ less";
constexpr const char* no_such_lens =
    "it was trained on pictures of another lens than a pinhole, and only pinholes are drawn: compare it with "
    "undistorted photos";
constexpr const char* no_embedding =
    "it was trained with an appearance for each photo (app_opt), by a network that the file lacks: its "
    "colours match no photo and are the same from all sides. `refit --photos` fits them to the photos";
constexpr const char* no_grid =
    "it was trained with a colour correction for each photo (bilateral grid), which the file lacks: pictures "
    "have the colours before it, and are further from the photos. `refit --photos` fits them to the photos";
constexpr const char* no_isp =
    "it was trained with a camera's colours, exposure and vignetting for each photo (ppisp), which the file "
    "lacks: pictures have the colours before them. `refit --photos` fits them to the photos";
constexpr const char* other_poses =
    "its cameras were optimised in training, and the file lacks the result: pictures of the original cameras "
    "are shifted against the photos. Give `--cameras` those that the trainer exports, as `ns-export cameras` "
    "does";
constexpr const char* no_exposures =
    "it was trained with an exposure for each photo (train_test_exp), and their exposure.json is missing: "
    "pictures are further from the photos. `--exposure FILE` names it";
constexpr const char* moved_world =
    "its world was moved, turned and scaled before training (normalize_world_space): COLMAP's cameras of the "
    "photos do not fit it";
constexpr const char* white = "it was trained on a white background: `--background 1,1,1` draws it so";

constexpr Clue of_gsplat[] = {{"with_eval3d", "true", no_eval3d},
                              {"with_ut", "true", no_sigma_points},
                              {"camera_model", "!pinhole", no_such_lens},
                              {"app_opt", "true", no_embedding},
                              {"post_processing", "bilateral_grid", no_grid},
                              {"use_bilateral_grid", "true", no_grid},
                              {"post_processing", "ppisp", no_isp},
                              {"pose_opt", "true", other_poses},
                              {"normalize_world_space", "true", moved_world}};
constexpr Clue of_nerfstudio[] = {{"use_bilateral_grid", "true", no_grid},
                                  {"camera_optimizer.mode", "!off", other_poses},
                                  {"background_color", "white", white}};
constexpr Clue of_inria[] = {{"train_test_exp", "true", no_exposures}, {"white_background", "true", white}};
constexpr Clue of_lichtfeld[] = {{"gut", "true", no_eval3d},
                                 {"use_bilateral_grid", "true", no_grid},
                                 {"pose_optimization", "!none", other_poses}};
constexpr Clue of_3dgrut[] = {
    {"render.method", "3dgut", no_eval3d},
    {"render.method", "3dgrt",
     "it was trained by ray tracing (3DGRT), with particles that are flatter in the middle and steeper at "
     "their edges than Gaussians. They are drawn as Gaussians: edges look softer and surfaces thinner"},
    {"render.splat.global_z_order", "false",
     "it was trained with Gaussians in the order of their distance: `--order distance` draws it so"},
    {"post_processing.method", "ppisp", no_isp},
    {"post_processing.method", "linear-to-srgb",
     "it was trained in linear light and converted to sRGB at the end; its colours are drawn unconverted: "
     "pictures look too dark"},
    {"model.background.color", "white", white}};

/// A kind of file that describes a training run.
struct RunKind {
  const char *name, *trainer;
  FlatValues (*read)(const std::string& source, std::string_view text);
  const char* prefix;  // precedes the keys in the following members
  const char* mark;    // a key that every file of this kind has, and no file of another kind
  const char *antialiasing, *word_for_it;
  const char* reported_keys;  // keys to report in addition to the clues' keys
  std::vector<Clue> clues;
};

template <std::size_t N>
std::vector<Clue> all_of(const Clue (&clues)[N]) {
  return {std::begin(clues), std::end(clues)};
}

const std::vector<RunKind>& run_kinds() {
  const auto python = [](const std::string&, std::string_view text) { return namespace_values(text); };
  static const std::vector<RunKind> kinds = {
      {"cfg.yml", "gsplat", yaml_values, "", "result_dir", "antialiased", "true",
       "antialiased sh_degree random_bkgd", all_of(of_gsplat)},
      {"config.yml", "nerfstudio", yaml_values, "pipeline.model.", "cull_alpha_thresh", "rasterize_mode",
       "antialiased", "rasterize_mode sh_degree color_corrected_metrics", all_of(of_nerfstudio)},
      {"cfg_args", "INRIA's trainer or one like it", python, "", "sh_degree", "antialiasing", "true",
       "antialiasing sh_degree resolution eval", all_of(of_inria)},
      {"training_config.json", "LichtFeld Studio", json_values, "optimization.", "sh_degree", "antialiasing",
       "true", "antialiasing sh_degree strategy", all_of(of_lichtfeld)},
      {"parsed.yaml", "3DGRUT", yaml_values, "", "render.method", "", "",
       "model.progressive_training.max_n_features render.particle_kernel_degree render.splat.k_buffer_size",
       all_of(of_3dgrut)}};
  return kinds;
}

/// Makes a value printable on a terminal.
std::string printable(std::string value) {
  constexpr std::size_t longest = 60;
  if (value.size() > longest) value = value.substr(0, longest) + "...";
  std::ranges::replace_if(
      value, [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return value;
}

/// Returns a key's value in lower case: Python writes True, YAML true.
std::optional<std::string> value_of(const FlatValues& values, const RunKind& kind, std::string_view key) {
  const auto found = values.find(kind.prefix + std::string(key));
  if (found == values.end()) return std::nullopt;
  const std::string value = lowered(found->second);
  return value == "null" || value == "none" || value.empty() ? std::nullopt : std::optional(value);
}

bool holds(const Clue& clue, const std::string& value) {
  return *clue.value == '!' ? value != clue.value + 1 : value == clue.value;
}

void tell(const FlatValues& values, const RunKind& kind, TrainingRun& run) {
  std::vector<std::string_view> keys = words_of(kind.reported_keys);
  for (const Clue& clue : kind.clues) keys.emplace_back(clue.key);
  for (const std::string_view key : keys) {
    const auto is_key = [&](const auto& said) { return said.first == key; };
    const auto value = value_of(values, kind, key);
    if (value && std::ranges::none_of(run.settings, is_key))
      run.settings.emplace_back(std::string(key), printable(*value));
  }
  for (const Clue& clue : kind.clues) {
    const auto value = value_of(values, kind, clue.key);
    if (!value || !holds(clue, *value)) continue;
    // The sentence about 3DGUT's evaluation along rays covers its transform, too.
    if (clue.sentence == no_sigma_points && !run.differences.empty()) continue;
    if (clue.sentence == no_exposures && find_above(run.file, exposures_name)) continue;
    if (clue.sentence == no_eval3d) run.kernel_px2 = along_rays_kernel_px2;
    const bool is_advice = clue.sentence == white || clue.sentence == moved_world;
    (is_advice ? run.advice : run.differences).emplace_back(clue.sentence);
  }
  const auto value = value_of(values, kind, kind.antialiasing);
  // A text other than true or false decides nothing.
  if (value && (*kind.word_for_it != 't' || *value == "true" || *value == "false"))
    run.antialiased = *value == kind.word_for_it;
}

std::optional<TrainingRun> read_run(const fs::path& file, const RunKind& kind) {
  try {
    const MappedFile mapped(file);
    if (mapped.bytes().size() > largest_run_file) return std::nullopt;
    const FlatValues values = kind.read(file.string(), as_text(mapped.bytes()));
    if (!value_of(values, kind, kind.mark)) return std::nullopt;
    TrainingRun run{file, kind.trainer, {}, {}, {}, {}, {}};
    tell(values, kind, run);
    return run;
  } catch (const Error& error) {
    log_warning("{}; its settings of the training are ignored", error.what());
    return std::nullopt;
  }
}

}  // namespace

std::optional<fs::path> find_above(const fs::path& model, const std::string& name, int most) {
  std::error_code ignored;
  fs::path folder = fs::absolute(model).lexically_normal();
  for (int up = 0; up <= most; ++up) {
    folder = folder.parent_path();
    const fs::path file = folder / name;
    if (!fs::is_regular_file(file, ignored)) continue;
    // If the model's path is relative to the working directory, returns a relative path, too.
    return model.is_absolute() ? file : file.lexically_proximate(fs::current_path());
  }
  return std::nullopt;
}

std::optional<TrainingRun> find_training_run(const fs::path& model) {
  std::optional<TrainingRun> nearest;
  std::size_t deepest = 0;
  for (const RunKind& kind : run_kinds()) {
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
