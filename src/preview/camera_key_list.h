#pragma once
// The keys of a path (scene/key_path.h) that the user sets, and their file, which `render --path` reads.

#include <filesystem>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace binosplat::preview {

class KeyList {
 public:
  /// Loads the keys that an earlier session saved as cameras.json in the folder. If the file is unreadable or
  /// has other cameras, the keys go to a file of another name.
  explicit KeyList(const std::filesystem::path& folder);

  const std::vector<Camera>& keys() const { return keys_; }
  const std::filesystem::path& file() const { return file_; }

  // Each function below writes the file, or removes it if there are no keys. If another program has changed
  // the file, each writes another one. If writing fails (Error), the keys stay. The first key's time is 0.

  /// Appends a key, key_seconds after the last one.
  void add(Camera camera);
  /// Replaces a key, but keeps its time.
  void replace(std::size_t k, Camera camera);
  void remove(std::size_t k);

 private:
  void set(std::vector<Camera> keys);

  std::filesystem::path file_;
  std::string written_;  // expected contents of the file; empty: no file
  std::vector<Camera> keys_;
};

/// Time between keys. `render --seconds` overrides it.
constexpr double key_seconds = 2.0;

/// Returns an unused path in the folder: NAME_001 and so on, with this ending.
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& name,
                                const std::string& ending);

}  // namespace binosplat::preview
