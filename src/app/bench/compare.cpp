// binosplat compare: measures how two pictures differ, and locates the largest error.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "app/bench/report.h"
#include "app/command.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/log.h"
#include "base/memory.h"
#include "formats/pictures/image_file.h"
#include "lab/fields.h"
#include "measure/comparison.h"
#include "measure/foveated.h"

namespace binosplat::app {

namespace {

/// Upper bound of the bytes per pixel that a comparison takes, mostly for FLIP. Measured: 119 for grey, 169
/// for colour and alpha.
constexpr std::uint64_t bytes_per_pixel = 170;

using measure::Comparison;

/// --max-memory, or three quarters of the machine's memory.
PictureLimit limit_of(const Options& options) {
  const double most = options.max_memory ? 1e6 * *options.max_memory : 0.75 * memory_bytes();
  return {static_cast<std::uint64_t>(std::min(most, 1e18)), bytes_per_pixel, "; --max-memory allows more"};
}

void check_comparable(const Options& options, const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) {
    fail("{} is {} x {} px and {} is {} x {}: only pictures of one size can be compared", options.compare.a,
         a.width, a.height, options.compare.b, b.width, b.height);
  }
}

const char* channel_name(const Image& image, int channel) {
  static const char* const names[] = {"red", "green", "blue", "alpha"};
  return image.channels == 1 ? "grey" : names[channel];
}

/// "a.exr holds a NaN or an infinity at x 3, y 4, red".
std::string why_undefined(const Options& options, const Comparison& found, const Image& a) {
  const auto& [none, x, y, channel] = found.largest;
  return fmt::format("{} holds a NaN or an infinity at x {}, y {}, {}",
                     std::isnan(a.at(x, y, channel)) ? options.compare.a : options.compare.b, x, y,
                     channel_name(a, channel));
}

void print_difference(const Options& options, const Comparison& found, const Image& image) {
  const auto line = [](const char* name, const std::string& value) { fmt::print("{:<15}{}\n", name, value); };
  const bool equal = std::isinf(found.psnr) && found.psnr > 0;
  if (std::isnan(found.psnr)) {
    for (const char* name : {"PSNR", "SSIM", "FLIP"})
      line(name, "undefined: " + why_undefined(options, found, image));
    return;
  }
  line("PSNR", equal ? "infinite: the pictures are equal" : fmt::format("{:.4f} dB", found.psnr));
  line("SSIM", std::isnan(found.ssim) ? "undefined: the pictures are smaller than its window of 11 x 11 px"
                                      : fmt::format("{:.6f}", found.ssim));
  line("FLIP", fmt::format("{:.6f} at {} pixels per degree", found.flip, options.ppd));
  const auto& largest = found.largest;
  if (largest.max > 0.0)
    line("largest error",
         fmt::format("{:.6f} ({:.2f} of 255) at x {}, y {}, {}", largest.max, 255.0 * largest.max, largest.x,
                     largest.y, channel_name(image, largest.channel)));
}

void print_rings(const measure::FoveatedComparison& found) {
  std::vector<lab::Row> rows;
  for (const measure::Ring& ring : found.rings)
    rows.push_back(lab::object("range", fmt::format("{} to {} degrees", ring.from, ring.to), "area",
                               100 * ring.share, "psnr_db", ring.psnr, "seen", 100 * ring.visible,
                               "times_threshold_99", ring.p99));
  fmt::print("\n");
  print_table(rows, {"range", "area", "psnr_db", "seen", "times_threshold_99"});
  fmt::print(
      "visible        {:.2f} % of all pixels: the difference reaches the threshold of an eye that looks "
      "there\n",
      100 * found.visible);
}

nlohmann::ordered_json comparison_json(const measure::FoveatedComparison& found, const measure::Gaze& gaze) {
  nlohmann::ordered_json json =
      lab::object("x", gaze.x, "y", gaze.y, "fov_degrees", gaze.fov_degrees, "visible", found.visible,
                  "rings", nlohmann::ordered_json::array());
  for (const measure::Ring& ring : found.rings) {
    json["rings"].push_back(lab::object("from_degrees", ring.from, "to_degrees", ring.to, "area", ring.share,
                                        "psnr_db", ring.psnr, "visible", ring.visible, "times_threshold_99",
                                        ring.p99));
  }
  return json;
}

nlohmann::ordered_json comparison_json(const Options& options, const Comparison& found, const Image& image) {
  const auto& largest = found.largest;
  return lab::object("version", BINOSPLAT_VERSION, "a", options.compare.a, "b", options.compare.b, "width",
                     image.width, "height", image.height, "equal", largest.max == 0.0, "psnr_db",
                     lab::Cell(found.psnr),  // null if infinite (equal pictures) or undefined
                     "ssim", lab::Cell(found.ssim), "flip", lab::Cell(found.flip), "pixels_per_degree",
                     options.ppd, "largest_error",
                     lab::object("value", lab::Cell(largest.max), "x", largest.x, "y", largest.y, "channel",
                                 channel_name(image, largest.channel)),
                     "min_psnr_db", options.compare.min_psnr);
}

ExitCode compare_files(const Options& options) {
  const PictureLimit limit = limit_of(options);
  Image a = load_image(options.compare.a, limit);
  Image b = load_image(options.compare.b, limit);
  check_comparable(options, a, b);
  const bool before_background = measure::prepare_comparison(a, b, options.compare.background);
  const glm::dvec3 background(options.compare.background.value_or(glm::vec3(0.0f)));
  if (before_background) {
    log_info("alpha: transparent pixels are compared over the background {:g},{:g},{:g}{}", background.r,
             background.g, background.b, options.compare.background ? "" : " (--background for another)");
  }
  const Comparison found = measure::compare(a, b, options.ppd);
  print_difference(options, found, a);
  std::optional<measure::FoveatedComparison> foveated;
  if (options.compare.gaze && !std::isnan(found.psnr))
    foveated = measure::compare_foveated(a, b, *options.compare.gaze);
  if (foveated) print_rings(*foveated);
  if (!options.compare.difference.empty()) {
    const double gain = measure::difference_gain(measure::common_error(a, b));
    save_png(options.compare.difference, measure::difference_picture(a, b, gain));
    fmt::print("difference     {} (times {}: white is an error of {:.4g} of 255 or more)\n",
               options.compare.difference, gain, 255.0 / gain);
  }
  if (!options.json.empty()) {
    auto json = comparison_json(options, found, a);
    if (before_background) json["background"] = {background.r, background.g, background.b};
    if (foveated) json["foveated"] = comparison_json(*foveated, *options.compare.gaze);
    save_json(options.json, json);
  }
  if (options.compare.min_psnr && !(found.psnr >= *options.compare.min_psnr)) {
    throw Error(
        ExitCode::fell_short,
        std::isnan(found.psnr)
            ? fmt::format("--min-psnr {}: PSNR is undefined, since {}", *options.compare.min_psnr,
                          why_undefined(options, found, a))
            : fmt::format("{:.4f} dB fall short of --min-psnr {}", found.psnr, *options.compare.min_psnr));
  }
  return ExitCode::done;
}

}  // namespace

void add_compare(CLI::App& program, Command& command) {
  add_command(program, command,
              {"compare", in::compare, "Report by how much two pictures differ, and where",
               "OpenEXR is brought back to display values by its header; values are clamped to 0 to 1.\n"
               "Examples:\n"
               "  binosplat compare drawn.png photo.jpg\n"
               "  binosplat compare a.exr b.png --min-psnr 50 --difference error.png\n"
               "  binosplat compare foveated.png exact.png --foveate-at 1830,1600,100"},
              compare_files);
}

}  // namespace binosplat::app
