#pragma once
// Runs the real program as a child process, like a shell, and returns its output and files.

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace binosplat::test {

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Returns the contents of all files below a folder, by relative path.
inline std::map<std::string, std::string> contents_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).generic_string()] = read_text(entry.path());
  }
  return files;
}

/// Waits until a condition holds, for a minute at most.
template <typename Condition>
void wait_until(const Condition& is_so) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!is_so() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

inline void wait_for_file(const std::filesystem::path& file) {
  wait_until([&] { return std::filesystem::exists(file); });
}

/// A temporary folder, removed with its contents when the object is destroyed.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "binosplat-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder " + name);
    path_ = name;
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

  /// Returns the relative paths of all files and folders in it.
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
      found.insert(std::filesystem::relative(entry.path(), path_).generic_string());
    }
    return found;
  }

  /// Returns the relative paths of all files in it.
  std::set<std::string> files() const {
    std::set<std::string> found = names();
    std::erase_if(found,
                  [&](const std::string& name) { return std::filesystem::is_directory(path_ / name); });
    return found;
  }

 private:
  std::filesystem::path path_;
};

/// The result of a run. `code` is the exit code, or minus the number of the signal that ended the run.
struct Outcome {
  int code = 0;
  std::string out;
  std::string err;
  long peak_kib = 0;  // largest memory use
};

/// Returns the path of the built program. In a bundle for a GPU server (tests/bench/bundle), it lies in the
/// folder of the tests.
inline std::filesystem::path built_program() {
  std::filesystem::path built = BINOSPLAT_PROGRAM;
  if (exists(built)) return built;
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / built.filename();
}

struct Surroundings {
  std::filesystem::path folder;                  // working folder; empty: the test's
  std::map<std::string, std::string> variables;  // additional environment variables
  std::map<int, rlim_t> limits;                  // RLIMIT_FSIZE and its like
  std::filesystem::path program = built_program();
};

/// A running program.
class Program {
 public:
  explicit Program(std::vector<std::string> arguments, const Surroundings& surroundings = {}) {
    arguments.insert(arguments.begin(), surroundings.program.string());
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("fork failed");
    if (pid_ == 0) become(arguments, surroundings);
  }

  void send(int signal) const { kill(pid_, signal); }

  Outcome wait() {
    int status = 0;
    rusage usage{};
    wait4(pid_, &status, 0, &usage);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    return {code, read_text(out()), read_text(err()), usage.ru_maxrss};
  }

  /// Returns its output so far.
  std::string said() const { return read_text(out()) + read_text(err()); }

 private:
  std::filesystem::path out() const { return said_.path() / "out"; }
  std::filesystem::path err() const { return said_.path() / "err"; }

  // Runs in the child process.
  [[noreturn]] void become(const std::vector<std::string>& arguments,
                           const Surroundings& surroundings) const {
    dup2(open(out().c_str(), O_CREAT | O_WRONLY, 0600), STDOUT_FILENO);
    dup2(open(err().c_str(), O_CREAT | O_WRONLY, 0600), STDERR_FILENO);
    signal(SIGINT, SIG_DFL);  // a shell makes its background jobs ignore it
    bool good = surroundings.folder.empty() || chdir(surroundings.folder.c_str()) == 0;
    for (const auto& [name, value] : surroundings.variables) setenv(name.c_str(), value.c_str(), 1);
    for (const auto& [what, most] : surroundings.limits) {
      const rlimit limit = {most, most};
      good = good && setrlimit(static_cast<__rlimit_resource>(what), &limit) == 0;
    }
    std::vector<char*> pointers;
    for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    if (good) execv(pointers[0], pointers.data());
    _exit(127);
  }

  TempFolder said_;
  pid_t pid_ = -1;
};

inline Outcome run_program(const std::vector<std::string>& arguments, const Surroundings& surroundings = {}) {
  return Program(arguments, surroundings).wait();
}

}  // namespace binosplat::test
