#pragma once
// Handling of arguments that all sub-commands share.

#include <functional>
#include <string>
#include <vector>

#include "app/cli11_forward.h"
#include "base/error.h"

namespace binosplat::app {

/// What a program's main does: prepares the process, calls `work`, which parses the arguments, and turns an
/// exception into a line and an exit code. An empty argument, usually an unset variable of a script, is an
/// error.
int run_program(CLI::App& program, int argc, const char* const* argv, const std::function<ExitCode()>& work);

/// Whether the environment names a display.
bool has_display();

/// Returns the arguments. If they begin with a model, inserts a sub-command before it and logs this: `view`
/// if there are a display and the preview, else `render`. Throws Error if the first word is neither a
/// sub-command nor a model.
std::vector<std::string> with_command(const CLI::App& program, int argc, const char* const* argv);

/// "; did you mean WORD?", or nothing if no word is similar.
std::string suggestion(const std::string& word, const std::vector<std::string>& words);

/// Records the pictures in a folder of photos as inputs.
void protect_photos(const std::string& folder);

}  // namespace binosplat::app
