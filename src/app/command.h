#pragma once
// Functions that the sub-commands share: registration, exit codes, outputs.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/cli11_forward.h"
#include "app/options/table.h"
#include "base/error.h"

namespace binosplat::app {

/// The work of the chosen sub-command. main runs it after all options are parsed.
using Command = std::function<ExitCode()>;

struct CommandText {
  const char* name;
  unsigned bit;  // of app/options/table.h
  const char* description;
  const char* footer;               // notes and examples, below the options
  const char* default_output = "";  // of --output
};

/// Adds a sub-command with its options. If the user names it, parsing sets `command` to its `work`.
void add_command(CLI::App& program, Command& command, const CommandText& text,
                 std::function<ExitCode(const Options&)> work);

/// Each adds its sub-command.
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

/// The keys of the window, for the help of `view`.
std::string keys_text();

/// Whether the preview was built and is installed beside this program.
bool has_preview();

/// From now on SIGHUP, SIGINT and SIGTERM end the program and remove unfinished files (base/output_file.h).
/// Call it before any thread starts.
void end_cleanly_on_signals();

/// The canonical path of the file that an output to `path` would write, for any spelling and symbolic link.
std::filesystem::path place_of(const std::filesystem::path& path);

std::filesystem::path nearest_existing_folder(std::filesystem::path folder);

/// Throws Error if `path` cannot be written: if permission is missing, or if it is a folder, lies below a
/// file or is a file that this run reads (base/inputs.h). Leaves no trace; call it before long work.
void check_output(const std::filesystem::path& path);

/// Throws Error if the file is not JSON.
nlohmann::ordered_json load_json(const std::filesystem::path& path);

/// `value` as indented JSON with a line break at the end.
std::string json_text(const nlohmann::ordered_json& value);

/// Writes `value` as indented JSON. Numbers that are not finite become null, because JSON lacks them.
void save_json(const std::filesystem::path& path, const nlohmann::ordered_json& value);

/// Stores `run` in `file`, beside its results, so that later runs can resume the run. If several runs start
/// at once, only one writes the file. Throws as check_same_run() if the file describes another run.
void claim_run(const std::filesystem::path& file, const nlohmann::ordered_json& run, const char* results);

/// Throws Error, which names the differing keys, if `file` describes another run than `run`. `results` names
/// the results in the message, such as "pictures".
void check_same_run(const std::filesystem::path& file, const nlohmann::ordered_json& run,
                    const char* results);

/// Bytes as "1,210 MB", or "3.4 MB" below 10 MB.
std::string megabytes(std::int64_t bytes);

}  // namespace binosplat::app
