#pragma once
// Handling of arguments that all sub-commands share.

#include <string>
#include <vector>

#include "app/cli.h"

namespace binosplat::app {

/// Throws Error for an empty argument, usually an unset variable of a script.
void check_arguments(int argc, const char* const* argv);

/// Whether the environment names a display.
bool has_display();

/// Returns the arguments. If they begin with a model, inserts a sub-command before it and logs this: `view`
/// if there are a display and the preview, else `render`. Throws Error if the first word is neither a
/// sub-command nor a model.
std::vector<std::string> with_command(const CLI::App& program, int argc, const char* const* argv);

/// "; did you mean WORD?", or nothing if no word is similar.
std::string suggestion(const std::string& word, const std::vector<std::string>& words);

/// The error text of a failed parse: the fault, a suggestion and where to read help. `name` is the full name
/// of `command`; errors of a sub-command append its name.
std::string explain(const CLI::App& command, const std::string& name, const CLI::ParseError& error);

/// Prepares the drivers' shader caches; call it before any context is created. Removes a relative
/// XDG_CACHE_HOME, which drivers create below the working folder although its specification says to ignore
/// it. If the user's cache folder is full or cannot be written, disables the caches and warns: on a full disk
/// drivers write into mapped files, and SIGBUS ends the program.
void prepare_shader_caches();

/// Records the pictures in a folder of photos as inputs.
void note_photos(const std::string& folder);

}  // namespace binosplat::app
