#include "preview/choices.h"

#include <iterator>

#include "base/choices.h"
#include "render/rules.h"

namespace binosplat::preview {

void choose_threshold(render::FrameSettings& settings, int th) {
  settings.th = th;
  settings.tolerance = static_cast<float>(render::threshold_rules[th].careful_tolerance);
  settings.quality = 0.0f;
}

bool is_exact(const render::FrameSettings& settings) {
  return render::is_exact(settings.th) && render::has_every_pair(settings.tiles);
}

void next_tiles(render::FrameSettings& settings, int by) {
  const int count = static_cast<int>(std::size(tiles_choices));
  const bool stays_exact = is_exact(settings);
  do settings.tiles = (settings.tiles + by + count) % count;
  while (settings.tiles == TILES_ALL || (stays_exact && !is_exact(settings)));
}

void choose_quality(render::FrameSettings& settings, std::optional<float> db) {
  // If no approximate rule is chosen, choose the fastest at equal error (docs/method.md 8).
  if (!db || render::is_exact(settings.th)) choose_threshold(settings, db ? TH_SQUARED : TH_TAU);
  settings.quality = db.value_or(0.0f);
}

void make_consistent(Choices& choices) {
  render::FrameSettings& s = choices.settings;
  const render::ThresholdRule& rule = render::threshold_rules[s.th];
  if (rule.exact) s.quality = 0.0f;
  if (rule.exact || s.quality > 0.0f) s.tolerance = 0.0f;
  if (!render::can_use(s.th, s.transmittance)) s.transmittance = TRANSMITTANCE_ONE;
  const bool given = s.tolerance > 0.0f || s.quality > 0.0f;
  if (!rule.exact && !given && !choices.policy.has_entry(s))
    s.tolerance = static_cast<float>(rule.careful_tolerance);
  if (is_exact(s)) choices.flipped = false;
  s.background = choices.background;
}

}  // namespace binosplat::preview
