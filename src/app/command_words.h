#pragma once
// The command line as texts for other programs, from the tables that its help is made of.

#include <string>

#include "app/cli.h"

namespace binosplat::app {

/// The manual page of the program and all its sub-commands, for man.
std::string manual_page(const CLI::App& program);

/// What makes a shell complete sub-commands, options, the words that they take, and files.
std::string bash_completion(const CLI::App& program);
std::string fish_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);

/// Adds --print man|bash|fish|zsh, which is for packages, to the whole program; help does not show it.
void add_print(CLI::App& program);

}  // namespace binosplat::app
