#include "base/inputs.h"

#include <sys/stat.h>

#include <map>
#include <mutex>
#include <utility>

#include "base/error.h"

namespace binosplat {

namespace {

struct Inputs {
  std::mutex mutex;
  std::map<std::pair<dev_t, ino_t>, std::filesystem::path> files;
};

Inputs& inputs() {
  static Inputs all;
  return all;
}

}  // namespace

void protect_input(const std::filesystem::path& path) {
  struct stat found = {};
  if (stat(path.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return;
  const std::lock_guard<std::mutex> lock(inputs().mutex);
  inputs().files[{found.st_dev, found.st_ino}] = std::filesystem::absolute(path);
}

std::set<std::filesystem::path> noted_inputs() {
  const std::lock_guard<std::mutex> lock(inputs().mutex);
  std::set<std::filesystem::path> paths;
  for (const auto& [id, path] : inputs().files) paths.insert(path);
  return paths;
}

void check_no_input(const std::filesystem::path& path) {
  struct stat found = {};
  if (stat(path.c_str(), &found) != 0) return;
  const std::lock_guard<std::mutex> lock(inputs().mutex);
  const auto noted = inputs().files.find({found.st_dev, found.st_ino});
  if (noted == inputs().files.end()) return;
  // A new file may reuse the inode of a deleted input.
  struct stat now = {};
  if (stat(noted->second.c_str(), &now) == 0 && now.st_dev == found.st_dev && now.st_ino == found.st_ino)
    fail("cannot write {}: it is an input of this run; name another file", path);
}

}  // namespace binosplat
