// binosplat view: starts the preview, a separate program. This program links no window system.

#include <dlfcn.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "app/command.h"
#include "preview/keys.h"

namespace binosplat::app {

namespace {

std::filesystem::path preview() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "binosplat-view";
}

ExitCode view(std::vector<std::string> arguments) {
  const auto program = preview();
  if (!has_preview()) {
    throw Error(
        ExitCode::no_gl,
        fmt::format(
            "{} is missing: this binosplat was built without its preview. `./demo --view` builds it (on "
            "another system than Debian, GLFW and Dear ImGui first); `binosplat render` needs no window",
            program.string()));
  }
  // Test the preview's library here: the loader's message for a missing library is terse.
  if (const char* const library = BINOSPLAT_PREVIEW_NEEDS; *library != 0 && !dlopen(library, RTLD_LAZY)) {
    throw Error(ExitCode::no_gl,
                fmt::format("{}: the window needs it (on Debian: apt install libx11-6); `binosplat render` "
                            "needs no window",
                            dlerror()));
  }
  arguments.insert(arguments.begin(), "binosplat-view");
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  // This program blocks signals for its waiting thread, which ends at exec; unblock them.
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execv(program.c_str(), pointers.data());
  throw Error(ExitCode::no_gl, fmt::format("cannot start {}: {}", program.string(), std::strerror(errno)));
}

}  // namespace

std::string keys_text() {
  std::string text = "Keys and buttons in the window:\n";
  for (const preview::KeyHelp& key : preview::key_help)
    text += fmt::format("  {:<15}{}\n", key.keys, key.what);
  return text;
}

bool has_preview() { return access(preview().c_str(), X_OK) == 0; }

void add_view(CLI::App& program, Command& command) {
  CLI::App* sub = program.add_subcommand("view", "Look at a model with both eyes, in a window");
  sub->set_help_flag();  // the preview handles all options, also --help
  sub->prefix_command();
  sub->callback([sub, &command] {
    const std::vector<std::string> arguments = sub->remaining();
    command = [arguments] { return view(arguments); };
  });
}

}  // namespace binosplat::app
