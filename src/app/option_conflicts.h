#pragma once
// Conflicts between options of `render`, `view` and `profile`.

#include "app/cli.h"

namespace binosplat::app {

/// Throws Error, with the reason, for options that conflict or need other options. Each group of
/// options checks its values in its own check().
void check_conflicts(const CLI::App& sub);

}  // namespace binosplat::app
