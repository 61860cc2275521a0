#pragma once
// The manual page that packages install.

#include "app/cli.h"

namespace binosplat::app {

/// Adds --print-manual to the whole program, which help does not show: it prints the help of all
/// sub-commands as a page for `man`.
void add_manual(CLI::App& program);

}  // namespace binosplat::app
