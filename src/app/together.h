#pragma once
// Which options of `render`, `view` and `profile` do not go together.

#include "app/cli.h"

namespace binosplat::app {

/// Throws Error, which says why, for options that were given and do not go together, or need others. What
/// depends on their values is checked with each part of the options.
void check_together(const CLI::App& sub);

}  // namespace binosplat::app
