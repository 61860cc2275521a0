#include "preview/viewer_choices.h"

#include <iterator>

#include "base/choices.h"
#include "render/rules.h"

namespace binosplat::preview {

void choose_threshold(render::FrameSettings& settings, Threshold threshold) {
  settings.threshold = threshold;
  settings.tolerance.reset();
  if (!render::is_exact(threshold))
    settings.tolerance = static_cast<float>(render::rule_of(threshold).starting_tolerance);
  settings.quality.reset();
}

bool is_exact(const render::FrameSettings& settings) {
  return render::is_exact(render::chosen_threshold(settings)) && render::has_every_pair(settings.tiles);
}

void next_tiles(render::FrameSettings& settings, int by) {
  const int count = static_cast<int>(std::size(tiles_choices));
  const bool stays_exact = is_exact(settings);
  do settings.tiles = (settings.tiles + by + count) % count;
  while (settings.tiles == TILES_ALL || (stays_exact && !is_exact(settings)));
}

void choose_quality(render::FrameSettings& settings, std::optional<float> db) {
  // Frames choose the rule (render/tolerance_control.h), unless the user has chosen an approximate one.
  if (!db || render::is_exact(render::chosen_threshold(settings))) {
    settings.threshold.reset();
    settings.tolerance.reset();
  }
  settings.quality = db;
}

void make_consistent(Choices& choices) {
  render::FrameSettings& s = choices.settings;
  if (!s.quality) s.threshold = render::chosen_threshold(s);
  const render::ThresholdRule& rule = render::rule_of(render::chosen_threshold(s));
  if (rule.exact) s.quality.reset();
  if (rule.exact || s.quality) s.tolerance.reset();
  if (!render::can_use(render::chosen_threshold(s), render::chosen_transmittance(s))) s.transmittance.reset();
  if (!rule.exact && !s.tolerance && !s.quality && !choices.calibrated.has_entry(s))
    s.tolerance = static_cast<float>(rule.starting_tolerance);
  if (is_exact(s)) choices.flipped = false;
  s.background = choices.background;
}

}  // namespace binosplat::preview
