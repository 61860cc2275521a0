#pragma once
// What the sub-commands share: how main learns of them, and how they end and write.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/cli.h"
#include "base/error.h"

namespace binosplat::app {

/// What the command line asked for; main runs it once all options are known to be well formed.
using Command = std::function<ExitCode()>;

/// Each adds its sub-command and the options of it to `program`, and sets `command` if it is the one that was
/// named.
void add_render(CLI::App& program, Command& command);
void add_compare(CLI::App& program, Command& command);
void add_devices(CLI::App& program, Command& command);
void add_bench(CLI::App& program, Command& command);
void add_profile(CLI::App& program, Command& command);
void add_calibrate(CLI::App& program, Command& command);
void add_view(CLI::App& program, Command& command);
void add_convert(CLI::App& program, Command& command);
void add_levels(CLI::App& program, Command& command);
void add_trim(CLI::App& program, Command& command);
void add_refit(CLI::App& program, Command& command);
void add_info(CLI::App& program, Command& command);

/// Whether the preview was built and lies beside this program.
bool has_preview();

/// In a handler of `main`: says what is wrong, and returns the exit code for it.
int end_by_what_was_thrown();

/// From now on SIGHUP, SIGINT and SIGTERM end the program at once, and no half file is left
/// (base/output_file.h). Call it before any thread is made.
void end_cleanly_on_signals();

/// Where a file is written that `path` names: the same for all its spellings and symbolic links.
std::filesystem::path place_of(const std::filesystem::path& path);

/// The folder itself, or the nearest above it that there is.
std::filesystem::path folder_there(std::filesystem::path folder);

/// Throws Error if `path` cannot become an output: a file stands where a folder is needed, no permission, or
/// it is a folder itself, or a file that this run reads (base/inputs.h). Leaves no trace; call it before long
/// work.
void check_output(const std::filesystem::path& path);

/// Throws Error for a file that is no JSON.
nlohmann::ordered_json load_json(const std::filesystem::path& path);

/// `value` as JSON for people and programs to read.
std::string json_text(const nlohmann::ordered_json& value);

/// Writes `value` for people and programs to read. Numbers that are not finite become null, as JSON has none.
void save_json(const std::filesystem::path& path, const nlohmann::ordered_json& value);

/// In a folder of results, `file` says which run they are of, so that another goes on from them. Writes it if
/// there is none: of runs that begin at the same time, whether alike or not, one does. Throws Error as
/// check_same_run() does where it tells of another run.
void claim_run(const std::filesystem::path& file, const nlohmann::ordered_json& run, const char* results);

/// Throws Error, naming what differs, if `file` tells of another run than `run`. `results` is what they are,
/// in the form "pictures".
void check_same_run(const std::filesystem::path& file, const nlohmann::ordered_json& run,
                    const char* results);

/// Bytes as "1,210 MB", or "3.4 MB" where whole ones would say little.
std::string megabytes(std::int64_t bytes);

}  // namespace binosplat::app
