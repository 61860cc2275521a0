#include "app/command.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "base/inputs.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/output_file.h"
#include "formats/containers/content.h"

namespace binosplat::app {

namespace fs = std::filesystem;

// Names come from files in any encoding; bytes that are not UTF-8 are replaced.
std::string json_text(const nlohmann::ordered_json& value) {
  return value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void end_cleanly_on_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    // A background job may start with ignored signals, and must keep ignoring them.
    struct sigaction action = {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&signals, signal);
  }
  // Threads created later inherit the mask, so only the waiting thread receives the signals.
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    remove_unfinished_files();
    // Ends the process by the signal itself, so that a shell sees the cause.
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    raise(signal);
  }).detach();
}

fs::path place_of(const fs::path& path) {
  std::error_code error;
  fs::path whole = fs::absolute(path, error);
  // Resolves links to missing files, too: another output may create the target.
  for (int links = 0; links < 40 && fs::is_symlink(whole, error); ++links)
    whole = whole.parent_path() / fs::read_symlink(whole, error);
  const fs::path place = fs::weakly_canonical(whole, error);
  return error ? whole.lexically_normal() : place;
}

fs::path nearest_existing_folder(fs::path folder) {
  std::error_code ignored;
  // A link counts as existing even if its target does not exist.
  while (!fs::exists(fs::symlink_status(folder, ignored)) && folder.has_relative_path())
    folder = folder.parent_path();
  return folder;
}

void check_output(const fs::path& path) {
  if (path.begin() != path.end() && *path.begin() == "-")
    fail("cannot write -: outputs are files or folders: name one (./- for one of this name)");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) fail("cannot write {}: it is a folder", path.string());
  if (error == std::errc::too_many_symbolic_link_levels)
    fail("cannot write {}: its symbolic links lead in a circle", path.string());
  check_no_input(path);
  const fs::path folder = nearest_existing_folder(fs::absolute(path).parent_path());
  if (!fs::is_directory(folder, error)) {
    const char* const what = fs::is_symlink(folder, error) ? "symbolic link that leads to no folder" : "file";
    fail("cannot write {}: {} is a {} where a folder is needed", path.string(), folder.string(), what);
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    fail("cannot write {}: {}: {}", path.string(), folder.string(), std::strerror(errno));
  }
}

nlohmann::ordered_json load_json(const fs::path& path) {
  auto json = nlohmann::ordered_json::parse(as_text(MappedFile(path).bytes()), nullptr, false);
  if (json.is_discarded()) fail("{}: not JSON, or cut short", path.string());
  return json;
}

void save_json(const fs::path& path, const nlohmann::ordered_json& value) {
  write_file(path, json_text(value));
}

void claim_run(const fs::path& file, const nlohmann::ordered_json& run, const char* results) {
  std::error_code ignored;
  if (fs::exists(file, ignored)) return check_same_run(file, run, results);
  OutputFile first(file);
  first.write(json_text(run));
  if (!first.commit_as_first()) check_same_run(file, run, results);
}

void check_same_run(const fs::path& file, const nlohmann::ordered_json& run, const char* results) {
  const nlohmann::ordered_json saved = load_json(file);
  std::vector<std::string> others;
  for (const auto& [name, value] : run.items()) {
    if (!saved.is_object() || !saved.contains(name) || saved[name] != value) others.push_back(name);
  }
  for (const auto& [name, value] : saved.items()) {
    if (!run.contains(name)) others.push_back(name);
  }
  if (others.empty()) return;
  fail(
      "{} has {} of another run: {} differs in {}. Name another folder with -o, or remove the {} and that "
      "file",
      file.parent_path().string(), results, file.string(), fmt::join(others, ", "), results);
}

std::string megabytes(std::int64_t bytes) {
  const double whole = std::round(static_cast<double>(bytes) / 1e6);
  if (whole < 10.0) return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
  std::string digits = fmt::format("{:.0f}", whole);
  for (int place = static_cast<int>(digits.size()) - 3; place > 0; place -= 3)
    digits.insert(static_cast<std::size_t>(place), ",");
  return digits + " MB";
}

void add_command(CLI::App& program, Command& command, const CommandText& text,
                 std::function<ExitCode(const Options&)> work) {
  CLI::App* sub = program.add_subcommand(text.name, text.description);
  const auto o = std::make_shared<Options>();
  o->output = text.default_output;
  add_options(*sub, text.bit, *o);
  sub->footer(text.footer);
  sub->callback([o, sub, &command, bit = text.bit, work = std::move(work)] {
    finish_options(*sub, bit, *o);
    command = [o, work] { return work(*o); };
  });
}

}  // namespace binosplat::app
