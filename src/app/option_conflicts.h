#pragma once
// Conflicts between options of `render`, `view` and `profile`.

#include "app/cli.h"

namespace binosplat::app {

/// Throws Error, with the reason, for options that conflict or need others. Checks of values are with each
/// part of the options.
void check_conflicts(const CLI::App& sub);

}  // namespace binosplat::app
