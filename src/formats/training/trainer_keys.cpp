#include "formats/training/trainer_keys.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include "base/log.h"
#include "base/numbers.h"
#include "base/text.h"

namespace binosplat {

namespace {

constexpr double of_key = std::numeric_limits<double>::quiet_NaN();
/// The smallest low-pass that is drawn: splats narrower than a pixel need one
/// (tests/bench/results/judges.md).
constexpr double min_low_pass = 0.001;   // px^2
constexpr double min_near_plane = 1e-6;  // world units

constexpr Meaning near_of(double units = of_key) { return {Meaning::near_plane, units}; }
constexpr Meaning low_pass(double px2 = of_key) { return {Meaning::low_pass, px2}; }
constexpr Meaning compensated{Meaning::compensated, 1.0}, uncompensated{Meaning::compensated, 0.0};
constexpr Meaning by_distance{Meaning::by_distance, 0.0};
constexpr Meaning differs(const char* sentence) { return {Meaning::differs, 0.0, sentence}; }
constexpr Meaning linear_light{Meaning::linear, 0.0};
constexpr Meaning background{Meaning::background, 0.0};
constexpr Meaning note(const char* sentence) { return {Meaning::note, 0.0, sentence}; }

constexpr Meaning along_rays = differs(
    "its trainer evaluates Gaussians along each ray, as 3DGUT, 3DGRT and GOF do, and has no low-pass. They "
    "are drawn as splats with almost none (`eps2d` 0.001), at about 45 dB against pictures along rays: large "
    "Gaussians near the eye look different");
constexpr Meaning other_particles = differs(
    "its particles are no Gaussians (particle_kernel_degree; 3DGRT's are flatter in the middle and steeper "
    "at their edges). They are drawn as Gaussians: edges look softer and surfaces thinner");
constexpr Meaning surfels = differs("its particles are discs (trisurfel), and are drawn as Gaussians");
constexpr Meaning integrated = differs(
    "it was trained by Analytic-Splatting, which integrates Gaussians over each pixel. They are drawn with a "
    "low-pass of the same width (1/12 px^2) and compensated opacity");
constexpr Meaning sigma_points = differs(
    "it was trained with the unscented transform, and is drawn by a linear projection: large Gaussians near "
    "the eye or far from the middle of a wide picture look different. Narrower views differ less");
constexpr Meaning by_pixel = differs(
    "it was trained with Gaussians sorted at each pixel, and is drawn with one order for all pixels: "
    "surfaces that cross look different");
constexpr Meaning other_lens = differs(
    "it was trained on pictures of another lens than a pinhole, and only pinholes are drawn: compare it with "
    "undistorted photos");
constexpr Meaning embedding = differs(
    "it was trained with an appearance for each photo, by a network that the file lacks: its colours match "
    "no photo and may be the same from all sides. `refit` fits them to the photos");
constexpr Meaning network_colours = differs("its colours come from a network that the file lacks (nht)");
constexpr Meaning network_background = differs("its background comes from a network that the file lacks");
constexpr Meaning grid = differs(
    "it was trained with a colour correction for each photo (bilateral grid), which the file lacks: pictures "
    "have the colours before it, and are further from the photos. `refit` fits them to the photos");
constexpr Meaning isp = differs(
    "it was trained with a camera's colours, exposure and vignetting for each photo (ppisp), which the file "
    "lacks: pictures have the colours before them. `refit` fits them to the photos");
constexpr Meaning other_poses = differs(
    "its cameras were optimised in training, and the file lacks the result: pictures of the original cameras "
    "are shifted against the photos. Give `cameras` those that the trainer exports (`ns-export cameras`)");
constexpr Meaning exposures = differs(lacks_exposures);
constexpr Meaning moved_world = note(
    "its world was moved, turned and scaled before training (normalize_world_space): COLMAP's cameras of the "
    "photos do not fit it");
constexpr Meaning image_behind = note("it was trained on a picture as background, which is not drawn");
constexpr Meaning white = note("it was trained on a white background: `background` 1,1,1 draws it so");

constexpr const char *ply = "ply", *brush = "Brush's ply", *sog = "SOG", *spz = "spz", *gsplat = "gsplat",
                     *nerfstudio = "nerfstudio", *lichtfeld = "LichtFeld Studio", *grut = "3DGRUT",
                     *stop_the_pop = "StopThePop", *cfg_args = "cfg_args";

// Of rows about the same setting the first one that holds counts. cfg_args is the file of INRIA's trainer and
// of all that came from it; its rows hold after those of the trainer.
// clang-format off
constexpr TrainerKey key_rows[] = {
    // Comments, in lower case. lowPass and nearPlane are binosplat's own (formats/training/training_words.h).
    {brush, "", "", near_of(0.01)},
    {brush, "splatrendermode", "mip", low_pass(0.1)},
    {ply, "nearplane", "*", near_of()},
    {ply, "lowpass", "*", low_pass()},
    {ply, "colorspace", "lin_rec709_display", linear_light},
    {ply, "splatrendermode", "mip", compensated},
    {ply, "splatrendermode", "default", uncompensated},
    {ply, "postshot.anti_aliasing", "1", compensated},
    {ply, "postshot.anti_aliasing", "0", uncompensated},
    {ply, "antialiased", "1", compensated},
    {ply, "antialiased", "0", uncompensated},
    {ply, "generated by nerstudio", "*", near_of(0.01)},  // so spelled
    {ply, "generated by opensplat at iteration", "*", near_of(0.01)},
    {ply, "fvdb_ply_af_8198767135near_plane", "*", near_of()},
    {ply, "fvdb_ply_af_8198767135eps2d", "*", low_pass()},
    {ply, "fvdb_ply_af_8198767135antialias", "1", compensated},
    {ply, "fvdb_ply_af_8198767135antialias", "0", uncompensated},

    // meta.json, and the flag in the header of spz
    {sog, "nearPlane", "*", near_of()},
    {sog, "lowPass", "*", low_pass()},
    {sog, "colorSpace", "lin_rec709_display", linear_light},
    {sog, "model", "antialiased", compensated},
    {sog, "antialias", "true", compensated},
    {sog, "antialias", "false", uncompensated},
    {spz, "antialiased", "true", compensated},

    {gsplat, "near_plane", "*", near_of()},
    {gsplat, "", "", near_of(0.01)},
    {gsplat, "with_eval3d", "true", low_pass(0.0)},
    {gsplat, "with_eval3d", "true", uncompensated},
    {gsplat, "with_eval3d", "true", along_rays},
    {gsplat, "with_ut", "true", sigma_points},
    {gsplat, "antialiased", "true", compensated},
    {gsplat, "antialiased", "false", uncompensated},
    {gsplat, "camera_model", "!pinhole", other_lens},
    {gsplat, "data_type", "ncore", other_lens},
    {gsplat, "app_opt", "true", embedding},
    {gsplat, "post_processing", "bilateral_grid", grid},
    {gsplat, "use_bilateral_grid", "true", grid},
    {gsplat, "post_processing", "ppisp", isp},
    {gsplat, "pose_opt", "true", other_poses},
    {gsplat, "normalize_world_space", "true", moved_world},

    {nerfstudio, "", "", near_of(0.01)},
    {nerfstudio, "rasterize_mode", "antialiased", compensated},
    {nerfstudio, "rasterize_mode", "classic", uncompensated},
    {nerfstudio, "use_bilateral_grid", "true", grid},
    {nerfstudio, "appearance_embed_dim", "!0", embedding},
    {nerfstudio, "enable_bg_model", "true", network_background},
    {nerfstudio, "camera_optimizer.mode", "!off", other_poses},
    {nerfstudio, "background_color", "white", white},

    {"EAGLES", "", "", near_of(0.1)},
    {"GOF", "", "", along_rays},
    {"Analytic-Splatting", "", "", low_pass(1.0 / 12.0)},
    {"Analytic-Splatting", "", "", compensated},
    {"Analytic-Splatting", "", "", integrated},
    {stop_the_pop, "", "", near_of(0.2)},
    {stop_the_pop, "proper_ewa_scaling", "true", compensated},
    {stop_the_pop, "proper_ewa_scaling", "false", uncompensated},
    {stop_the_pop, "sort_settings.sort_order", "!0", by_distance},
    {stop_the_pop, "sort_settings.sort_mode", "!0", by_pixel},
    {cfg_args, "", "", near_of(0.2)},
    {cfg_args, "kernel_size", "*", low_pass()},
    {cfg_args, "kernel_size", "*", compensated},
    {cfg_args, "antialiasing", "true", compensated},  // INRIA's own trainer does not write it
    {cfg_args, "antialiasing", "false", uncompensated},
    {cfg_args, "train_test_exp", "true", exposures},
    {cfg_args, "white_background", "true", white},

    {lichtfeld, "", "", near_of(0.01)},
    {lichtfeld, "gut", "true", low_pass(0.0)},
    {lichtfeld, "gut", "true", uncompensated},
    {lichtfeld, "gut", "true", along_rays},
    {lichtfeld, "mip_filter", "true", low_pass(0.1)},
    {lichtfeld, "mip_filter", "true", compensated},
    {lichtfeld, "mip_filter", "false", uncompensated},
    // Versions that write one of these two ignored antialiasing.
    {lichtfeld, "save_sog", "*", uncompensated},
    {lichtfeld, "enable_sparsity", "*", uncompensated},
    {lichtfeld, "antialiasing", "true", compensated},
    {lichtfeld, "antialiasing", "false", uncompensated},
    {lichtfeld, "use_bilateral_grid", "true", grid},
    {lichtfeld, "use_ppisp", "true", isp},
    {lichtfeld, "use_exposure_correction", "true", isp},
    {lichtfeld, "pose_optimization", "!none", other_poses},
    {lichtfeld, "bg_mode", "solid_color", background},
    {lichtfeld, "bg_mode", "image", image_behind},

    {grut, "render.method", "3dgut", near_of(0.2)},
    {grut, "", "", near_of(0.0)},
    {grut, "", "", low_pass(0.0)},
    {grut, "", "", along_rays},
    {grut, "render.particle_kernel_degree", "!2", other_particles},
    {grut, "render.primitive_type", "trisurfel", surfels},
    {grut, "render.splat.k_buffer_size", "!0", by_pixel},
    {grut, "render.splat.global_z_order", "false", by_distance},
    {grut, "model.feature_type", "nht", network_colours},
    {grut, "post_processing.method", "ppisp", isp},
    {grut, "post_processing.method", "linear-to-srgb", linear_light},
    {grut, "dataset.normalize_world_space", "true", moved_world},
    {grut, "model.background.color", "white", white},
};
// clang-format on

/// Makes a value printable on a terminal.
std::string printable(std::string value) {
  constexpr std::size_t longest = 60;
  if (value.size() > longest) value = value.substr(0, longest) + "...";
  std::ranges::replace_if(
      value, [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return value;
}

double finite_number(std::string_view text) {
  const auto number = parse_real(text);
  return number && std::isfinite(*number) ? *number : of_key;
}

bool holds(const TrainerKey& row, const std::optional<std::string>& value) {
  const std::string_view wanted = row.value;
  if (*row.key == '\0') return true;
  if (!value || wanted == "*") return value.has_value();
  return wanted.starts_with('!') ? *value != wanted.substr(1) : *value == wanted;
}

/// The note about LichtFeld's bg_color; empty for black.
std::string background_note(const FlatValues& values, const std::string& prefix) {
  std::array<double, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = finite_number(find_value(values, fmt::format("{}bg_color.{}", prefix, c)).value_or("0"));
  if (rgb == std::array<double, 3>{}) return "";
  return fmt::format("it was trained on the background {0},{1},{2}: `background` {0},{1},{2} draws it so",
                     rgb[0], rgb[1], rgb[2]);
}

}  // namespace

std::span<const TrainerKey> trainer_keys() { return key_rows; }

std::optional<std::string> find_value(const FlatValues& values, const std::string& key) {
  const auto found = values.find(key);
  if (found == values.end()) return std::nullopt;
  const std::string value = lowered(found->second);
  return value == "null" || value == "none" || value.empty() ? std::nullopt : std::optional(value);
}

TrainingSaid read_keys(std::initializer_list<std::string_view> writers, const FlatValues& values,
                       const std::string& prefix) {
  TrainingSaid said;
  for (const TrainerKey& row : key_rows) {
    if (std::ranges::find(writers, row.writer) == writers.end()) continue;
    const auto value = find_value(values, prefix + row.key);
    const auto is_key = [&](const auto& pair) { return pair.first == row.key; };
    if (value && std::ranges::none_of(said.keys, is_key)) said.keys.emplace_back(row.key, printable(*value));
    if (!holds(row, value)) continue;
    const auto& [kind, given, sentence] = row.meaning;
    const double number = std::isnan(given) ? finite_number(*value) : given;
    if ((kind == Meaning::near_plane || kind == Meaning::low_pass) && !(number >= 0.0)) {
      said.differences.push_back(
          fmt::format("its {} '{}' is ignored: expected a number from 0", row.key, printable(*value)));
    } else if (kind == Meaning::near_plane && !said.near_plane) {
      said.near_plane = std::max(number, min_near_plane);
    } else if (kind == Meaning::low_pass && !said.kernel_px2) {
      said.kernel_px2 = std::max(number, min_low_pass);
    } else if (kind == Meaning::compensated && !said.antialiased) {
      said.antialiased = number == 1.0;
    } else if (kind == Meaning::linear) {
      said.linear = true;
    } else if (kind == Meaning::by_distance) {
      said.order = Order::distance;
    } else if (kind == Meaning::background) {
      if (const std::string line = background_note(values, prefix); !line.empty()) said.notes.push_back(line);
    } else if (sentence != nullptr) {
      (kind == Meaning::note ? said.notes : said.differences).emplace_back(sentence);
    }
  }
  // The sentence about rays covers their transform, too.
  if (std::ranges::count(said.differences, along_rays.sentence) > 0)
    std::erase(said.differences, sigma_points.sentence);
  return said;
}

void follow(const TrainingSaid& said, const std::string& by, const std::string& model, Training& training) {
  const auto take = [&](const char* what, const auto& value, auto& into, std::string& into_by) {
    if (!value) return;
    // Mip-Splatting's usual low-pass, which a ply with its filter is drawn with, unless a file says another.
    if (!into_by.empty() && into_by != by_filter) {
      if (into != *value)
        log_warning("{}: {} and {} disagree about its {}; the first one counts", model, into_by, by, what);
      return;
    }
    into = *value;
    into_by = by;
  };
  take("near plane", said.near_plane, training.near_plane, training.near_by);
  take("low-pass", said.kernel_px2, training.kernel_px2, training.kernel_by);
  take("anti-aliasing", said.antialiased, training.antialiased, training.antialiased_by);
  take("colour space", said.linear, training.linear, training.linear_by);
  take("order", said.order, training.perspective.order, training.perspective_by);
}

}  // namespace binosplat
