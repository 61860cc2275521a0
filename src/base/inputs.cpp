#include "base/inputs.h"

#include <sys/stat.h>

#include <mutex>
#include <set>
#include <utility>

#include "base/error.h"

namespace binosplat {

namespace {

struct Inputs {
  std::mutex mutex;
  std::set<std::pair<dev_t, ino_t>> files;
};

Inputs& inputs() {
  static Inputs all;
  return all;
}

}  // namespace

void note_input(const std::filesystem::path& path) {
  struct stat found = {};
  if (stat(path.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return;
  const std::lock_guard<std::mutex> lock(inputs().mutex);
  inputs().files.emplace(found.st_dev, found.st_ino);
}

void check_no_input(const std::filesystem::path& path) {
  struct stat found = {};
  if (stat(path.c_str(), &found) != 0) return;
  const std::lock_guard<std::mutex> lock(inputs().mutex);
  if (inputs().files.contains({found.st_dev, found.st_ino}))
    fail("cannot write {}: this run reads it, and it would be lost; name another file", path.string());
}

}  // namespace binosplat
