#pragma once
// Checks of options together, whose rules options/conflicts.cpp cannot say.

#include "app/options/options.h"

namespace binosplat::app {

/// Each throws Error for values that contradict each other or do not apply to the scene.
void check(const SceneOptions& options);
void check(const ContextOptions& options);
void check(const Options& options);
void check_foveate(const Options& options);

/// Whether --quality may also apply to levels of detail, if the scene's files have errors of levels.
bool quality_may_choose_levels(const Options& options);

}  // namespace binosplat::app
