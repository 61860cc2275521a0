#include "app/command_line.h"

#include <fmt/ranges.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>

#include "app/command.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/error.h"
#include "base/inputs.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/text.h"
#include "formats/containers/size_limits.h"
#include "gl/program_cache.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t cache_room = 64 << 20;  // bytes that must be free; shaders take less

// Edit distance: insertions, deletions, replacements, and swaps of neighbours.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    now[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      now[j + 1] = std::min({last[j + 1] + 1, now[j] + 1, last[j] + (a[i] == b[j] ? 0u : 1u)});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
        now[j + 1] = std::min(now[j + 1], before[j - 1] + 1);
    }
    before = std::exchange(last, now);
  }
  return last[b.size()];
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

void check_arguments(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    if (argv[i][0] != '\0') continue;
    const std::string before = i > 1 ? argv[i - 1] : "";
    if (before.starts_with("-"))
      fail("{} '': its value is empty; give it one, or leave the option out", before);
    fail("argument {} is empty: leave it out, or fill in what it should be", i);
  }
}

// The error text of a failed parse: the fault, a suggestion and where to read help. `name` is the full name
// of `command`; errors of a sub-command append its name.
std::string explain(const CLI::App& command, const std::string& name, const CLI::ParseError& error) {
  // Extra words before a sub-command are errors of this command.
  const bool has_extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const auto chosen = command.get_subcommands();
  if (!chosen.empty() && !(has_extras && command.remaining_size() > 0))
    return explain(*chosen.front(), name + " " + chosen.front()->get_name(), error);
  std::string text = error.what();
  if (has_extras) {
    const std::vector<std::string> extras = command.remaining();
    const auto option = std::find_if(extras.begin(), extras.end(),
                                     [](const std::string& word) { return word.starts_with("-"); });
    if (option == extras.end()) {
      text =
          fmt::format("{}: one word too many (an option takes several names with commas, as in --view A,B)",
                      fmt::join(extras, " "));
    } else {
      const std::string word = option->substr(0, option->find('='));
      text = fmt::format("{}: {} has no such option{}", word, name, suggestion(word, option_names(command)));
    }
  }
  return fmt::format("{}\n  see: {} --help", text, name);
}

// Removes a relative XDG_CACHE_HOME, which drivers create below the working folder although its specification
// says to ignore it. If the user's cache folder is full or cannot be written, disables the drivers' shader
// caches and warns: on a full disk drivers write into mapped files, and SIGBUS ends the program.
void prepare_shader_caches() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && !fs::path(cache).is_absolute()) unsetenv("XDG_CACHE_HOME");
  const fs::path folder = nearest_existing_folder(gl::ProgramCache::default_folder());
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  const bool writable = fs::is_directory(folder, error) && access(folder.c_str(), W_OK | X_OK) == 0;
  if (folder.empty() || (writable && space.available >= cache_room)) return;
  // The variables of Mesa, in new and old versions, and of NVIDIA's driver.
  setenv("MESA_SHADER_CACHE_DISABLE", "1", 0);
  setenv("MESA_GLSL_CACHE_DISABLE", "1", 0);
  setenv("__GL_SHADER_DISK_CACHE", "0", 0);
  log_warning("{}: {}; drivers cache no shaders there in this run", folder.string(),
              writable ? "the disk is full" : "nothing can be written there");
}

// Logs the current exception and returns its exit code. Call it in a handler.
int exit_code_of_current_exception() {
  constexpr const char* smaller_models =
      "\nSmaller: --lod, --gpu-memory or --detail (streamed SOG, by `binosplat levels`), or `binosplat trim`";
  const auto end = [](ExitCode code, const std::string& text) {
    const bool is_model = code == ExitCode::out_of_memory && text.find("model") != std::string::npos;
    log_line(is_model ? text + smaller_models : text);
    return static_cast<int>(code);
  };
  constexpr const char* no_memory =
      "out of memory: the model and the pictures do not fit; try a smaller --size, or fewer Gaussians";
  try {
    throw;
  } catch (const Error& error) {
    return end(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return end(ExitCode::out_of_memory, no_memory);
  } catch (const fs::filesystem_error& error) {
    return end(ExitCode::bad_input, fmt::format("{}: {}", error.path1().string(), error.code().message()));
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) != 0)
      return end(ExitCode::bad_input,
                 fmt::format("cannot write to standard output: {}", error.code().message()));
    // A thread could not start for lack of memory.
    if (error.code() == std::errc::resource_unavailable_try_again ||
        error.code() == std::errc::not_enough_memory)
      return end(ExitCode::out_of_memory, no_memory);
    return end(ExitCode::bad_input, fmt::format("internal error: {}", error.what()));
  } catch (const std::exception& error) {
    // TBB reports in this form that a thread could not start.
    if (std::string_view(error.what()).find("pthread_create") != std::string_view::npos)
      return end(ExitCode::out_of_memory, no_memory);
    return end(ExitCode::bad_input, fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace

std::string suggestion(const std::string& word, const std::vector<std::string>& words) {
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  std::string nearest;
  for (const std::string& other : words) {
    const std::size_t count = other.starts_with(word) && word.size() > 3 ? 1 : edits(word, other);
    if (count < least) {
      least = count;
      nearest = other;
    }
  }
  return nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest);
}

void protect_photos(const std::string& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string ending = lowered_ending(entry.path());
    if (ending == ".jpg" || ending == ".jpeg" || ending == ".png") protect_input(entry.path());
  }
}

bool has_display() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && *value != '\0') return true;
  }
  return false;
}

std::vector<std::string> with_command(const CLI::App& program, int argc, const char* const* argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  std::vector<std::string> commands;
  for (const CLI::App* sub : program.get_subcommands({})) commands.push_back(sub->get_name());
  if (words.empty() || words[0].starts_with("-") || std::ranges::count(commands, words[0]) > 0) return words;
  if (words[0].find("://") != std::string::npos) fail_to_read(words[0], ENOENT);
  std::error_code ignored;
  if (!is_built_in(words[0]) && !fs::exists(words[0], ignored))
    fail("{}: there is no such command and no such model{}\n  see: binosplat --help", words[0],
         suggestion(words[0], commands));
  if (std::find(words.begin(), words.end(), "--quiet") != words.end()) set_quiet(true);
  words.insert(words.begin(), has_display() && has_preview() ? "view" : "render");
  log_info("no command: binosplat {} {}", words[0], words[1]);
  return words;
}

int run_program(CLI::App& program, int argc, const char* const* argv, const std::function<ExitCode()>& work) {
  // A write beyond the limit of file size then fails with an error, as on a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  as_shown = with_options;
  prepare_shader_caches();
  end_cleanly_without_memory();
  try {
    check_arguments(argc, argv);
    const ExitCode code = work();
    if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category());
    return static_cast<int>(code);
  } catch (const CLI::Success& asked) {
    return program.exit(asked);
  } catch (const CLI::ParseError& error) {
    log_line(explain(program, program.get_name(), error));
    return static_cast<int>(ExitCode::bad_input);
  } catch (...) {
    return exit_code_of_current_exception();
  }
}

}  // namespace binosplat::app
