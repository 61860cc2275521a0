#pragma once
// The command line as texts for other programs, from the tables that its help is made of.

#include "app/cli.h"

namespace binosplat::app {

/// Adds --print man|bash|fish|zsh to the whole program, which help does not show: a manual page, and what
/// makes a shell complete sub-commands, options, the words that they take, and files. It is for packages.
void add_print(CLI::App& program);

}  // namespace binosplat::app
