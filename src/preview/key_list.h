#pragma once
// The keys of a path (scene/key_path.h) that are set while one looks, and the file that `render --path` takes
// them from.

#include <filesystem>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace binosplat::preview {

class KeyList {
 public:
  /// Goes on with the keys that an earlier session left in cameras.json of the folder. Other cameras that lie
  /// there, and what cannot be read, are left alone: these keys then get a file of another name.
  explicit KeyList(const std::filesystem::path& folder);

  const std::vector<Camera>& keys() const { return keys_; }
  const std::filesystem::path& file() const { return file_; }

  // Each writes the file; without keys there is none. One that somebody else has changed since is left alone,
  // too. Times count from the first key. Throw Error where it cannot be written; then the keys are as they
  // were.

  /// Behind the last one, key_seconds later.
  void add(Camera camera);
  /// In the place and at the time of another.
  void replace(std::size_t k, Camera camera);
  void remove(std::size_t k);

 private:
  void set(std::vector<Camera> keys);

  std::filesystem::path file_;
  std::string written_;  // what the file holds as far as is known; empty: there is none
  std::vector<Camera> keys_;
};

/// From one key to the next, until --seconds says otherwise.
constexpr double key_seconds = 2.0;

/// A file's name in a folder that no file has: NAME_001 and so on, with that ending.
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& name,
                                const std::string& ending);

}  // namespace binosplat::preview
