#pragma once
// What holds for the arguments of every sub-command.

#include <atomic>
#include <string>
#include <vector>

#include "app/cli.h"

namespace binosplat::app {

/// Throws Error for an argument that is empty, as an unset variable of a script leaves it.
void check_arguments(int argc, const char* const* argv);

/// Whether a window could be opened, as far as the environment tells.
bool has_display();

/// What the program is given, with the sub-command that is meant where it begins with a model: `view` where
/// there are a display and the preview, else `render`; says so. Throws Error for a word that is neither.
std::vector<std::string> with_command(const CLI::App& program, int argc, const char* const* argv);

/// "; did you mean WORD?", if one of the words is near enough.
std::string suggestion(const std::string& word, const std::vector<std::string>& words);

/// What a command line that cannot be parsed is told: what is wrong, what may be meant, and where to look;
/// `name` is the command's whole name, to which that of the sub-command comes where the mistake is its own.
std::string explain(const CLI::App& command, const std::string& name, const CLI::ParseError& error);

/// A relative XDG_CACHE_HOME is taken out of the environment: its specification has it ignored, and drivers
/// make a folder below the working one instead. Where the disk of the user's caches is full, drivers are told
/// to keep no shaders there: they write into mapped files, and SIGBUS would end the program; warns of that.
/// Likewise where nothing can be written there, which each driver reports in its own words. Call it
/// before any context is made.
void settle_shader_caches();

/// What pictures may take that are drawn and not written yet, in bytes (--max-memory).
inline std::atomic<double> picture_memory_allowed{1e30};

/// --max-memory for a sub-command that reads a model: how much of it is believed of a file that is small
/// (formats/plausible.h).
void add_max_memory(CLI::App& sub);

/// --quiet.
void add_quiet(CLI::App& sub);

/// Notes the files that a parsed command line names to be read (base/inputs.h): all but its outputs. Throws
/// Error where two of its outputs are one file.
void note_inputs(const CLI::App& program);

/// Notes the pictures in a folder of photos.
void note_photos(const std::string& folder);

}  // namespace binosplat::app
