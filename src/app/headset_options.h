#pragma once
// `binosplat view --xr`: the preview's options for a headset.

#include <optional>

#include "app/cli.h"

namespace binosplat::app {

struct HeadsetOptions {
  bool xr = false;
  double scale = 1.0;               // of the sizes that the runtime recommends
  std::optional<double> budget_ms;  // 0: what the runtime has for a frame
  std::optional<double> record_s;   // so much is recorded, from the first frame on
  bool mirror = true;               // the left eye in a window, where there is a display
};

/// Adds all of them; `options` must outlive the parsing.
void add_headset_options(CLI::App& sub, HeadsetOptions& options);

/// Throws Error for options of `sub` that a headset decides, and for those of a headset without one.
void check(const HeadsetOptions& options, const CLI::App& sub);

}  // namespace binosplat::app
