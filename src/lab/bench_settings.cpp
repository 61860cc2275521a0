#include "lab/bench_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/choices.h"
#include "base/error.h"
#include "base/numbers.h"
#include "base/text.h"

namespace binosplat::lab {

namespace {

/// The shortest decimal number that rounds to this float.
double shortest_decimal(float number) { return std::stod(fmt::format("{}", number)); }

}  // namespace

DetailRequest parse_detail(const std::string& text, const std::string& option) {
  std::string_view rest = text;
  const std::optional<double> number = take_real(rest);
  const std::string unit = lowered(std::string(rest));
  if (number && std::isfinite(*number) && (unit.empty() || unit == "px") && *number >= 0.0)
    return {.spacing_px = *number};
  if (number && unit == "db" && *number >= 20.0 && *number <= 80.0) return {.db = *number};
  fail("{} {}: expected pixels as in 5px, or decibels from 20 to 80 as in 40dB", option, text);
}

std::string text_of(const DetailRequest& detail) {
  return detail.db ? fmt::format("{:g}dB", *detail.db) : fmt::format("{:g}px", detail.spacing_px);
}

const char* rule_of(const render::FrameSettings& s) {
  return s.quality && !s.threshold ? "either" : name_of(render::chosen_threshold(s));
}

Row row_of_settings(const BenchSettings& s) {
  const Threshold threshold = render::chosen_threshold(s);
  Row row = object("tiles", tiles_choices[s.tiles].name);
  if (s.precision != PRECISION_FULL) put(row, "precision", precision_choices[s.precision].name);
  put(row, "threshold", rule_of(s));
  if (!render::is_exact(threshold)) put(row, "transmittance", name_of(render::chosen_transmittance(s)));
  if (s.tolerance) put(row, "tolerance", shortest_decimal(*s.tolerance));
  if (s.quality) put(row, "quality", shortest_decimal(*s.quality));
  if (s.far) put(row, "far", shortest_decimal(*s.far));
  put(row, "max_drop", s.max_drop, "min_psnr", s.min_psnr);
  if (s.finds_tolerance()) put(row, "found_on", s.found_on_training ? "training" : "test");
  if (s.foveation) put(row, "inset", s.foveation->inset_degrees, "context", s.foveation->context_scale);
  if (s.order) put(row, "order", name_of(*s.order));
  if (s.projection) put(row, "projection", name_of(*s.projection));
  if (s.detail) put(row, "detail", text_of(*s.detail));
  return row;
}

std::string describe_series(const BenchSettings& s) {
  std::vector<std::string> words;
  const Threshold threshold = render::chosen_threshold(s);
  const bool exact = render::is_exact(threshold);
  if (s.tiles != TILES_ELLIPSE || exact) words.emplace_back(tiles_choices[s.tiles].name);
  if (!exact) {
    words.emplace_back(rule_of(s));
    const Transmittance source = render::chosen_transmittance(s);
    if (source != render::usual_source(threshold)) words.emplace_back(name_of(source));
  }
  if (s.far) words.push_back(fmt::format("far {:g}", *s.far));
  if (s.found_on_training) words.emplace_back("found on training views");
  if (s.precision != PRECISION_FULL) words.emplace_back(precision_choices[s.precision].name);
  if (s.foveation) {
    words.push_back(fmt::format("inset {:g}", s.foveation->inset_degrees));
    words.push_back(fmt::format("context {:g}", s.foveation->context_scale));
  }
  if (s.order) words.push_back(fmt::format("by {}", name_of(*s.order)));
  if (s.projection) words.emplace_back(name_of(*s.projection));
  if (s.detail) words.emplace_back("levels");
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string describe(const BenchSettings& s) {
  if (row_of_settings(s) == row_of_settings({})) return "exact";
  std::string text = describe_series(s);
  if (s.tolerance) text += fmt::format(", {:g}", *s.tolerance);
  if (s.quality) text += fmt::format(", asked for {:g} dB", *s.quality);
  if (s.max_drop) text += fmt::format(", {:g} dB lost", *s.max_drop);
  if (s.min_psnr) text += fmt::format(", {:g} dB left", *s.min_psnr);
  if (s.detail) text += " for " + text_of(*s.detail);
  return text;
}

void check(const std::string& place, const BenchSettings& s) {
  try {
    const Threshold threshold = render::chosen_threshold(s);
    const int asked = int{s.tolerance > 0.0f} + int{s.quality.has_value()} + int{s.max_drop.has_value()} +
                      int{s.min_psnr.has_value()};
    if (!render::is_exact(threshold) && asked != 1)
      fail("threshold needs one of: a tolerance above 0, a quality, max_drop, min_psnr");
    if (render::is_exact(threshold) && s.finds_tolerance())
      fail("max_drop and min_psnr find a tolerance, but threshold {} has none", name_of(threshold));
    if (s.far && s.transmittance != Transmittance::depth) fail("far needs transmittance depth");
    render::check(s, "", s.finds_tolerance());
    if (s.foveation) stereo::check(*s.foveation);
  } catch (const Error& error) {
    fail("{}: {}: {}", place, row_of_settings(s).dump(), error.what());
  }
}

bool is_exact(const BenchSettings& s) {
  return !s.foveation && !s.detail && s.precision == PRECISION_FULL &&
         render::is_exact(render::chosen_threshold(s)) && render::has_every_pair(s.tiles);
}

}  // namespace binosplat::lab
