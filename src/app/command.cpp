#include "app/command.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/inputs.h"
#include "base/mapped_file.h"
#include "base/output_file.h"
#include "formats/content.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

std::mutex& writing() {
  static std::mutex mutex;
  return mutex;
}

// Of Unfinished; guarded by writing().
fs::path& unfinished() {
  static fs::path path;
  return path;
}

}  // namespace

void end_cleanly_on_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    // A job in the background may have been started with signals ignored, and is left alone then.
    struct sigaction action = {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&signals, signal);
  }
  // Threads made from here on inherit the mask: the signals reach nobody but the one that waits for them.
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::mutex& mutex = writing();
  fs::path& partial = unfinished();
  std::thread([signals, &mutex, &partial] {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    mutex.lock();
    std::error_code ignored;
    if (!partial.empty()) fs::remove(partial, ignored);
    // Ends the process the way the signal does by itself, so that a shell sees why.
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    raise(signal);
  }).detach();
}

Uninterrupted::Uninterrupted() : lock_(writing()) {}

Unfinished::Unfinished(const fs::path& path) {
  const std::lock_guard<std::mutex> lock(writing());
  unfinished() = path;
}

Unfinished::~Unfinished() {
  const std::lock_guard<std::mutex> lock(writing());
  unfinished().clear();
}

fs::path folder_there(fs::path folder) {
  std::error_code ignored;
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

void check_output(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) fail("cannot write {}: it is a folder", path.string());
  check_no_input(path);
  const fs::path folder = folder_there(fs::absolute(path).parent_path());
  if (!fs::is_directory(folder, error)) {
    fail("cannot write {}: {} is a file where a folder is needed", path.string(), folder.string());
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
  const Uninterrupted hold;
  OutputFile file(path);
  // Names come from files and may be in any encoding; what is not UTF-8 is replaced rather than refused.
  file.write(value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  file.commit();
}

}  // namespace binosplat::app
