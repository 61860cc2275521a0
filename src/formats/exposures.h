#pragma once
// The exposures that INRIA's training leaves in exposure.json: what it made of each view's picture before it
// compared it with the photo (train_test_exp), since photos of one scene differ in exposure and white.

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>

namespace binosplat {

class Exposures {
 public:
  Exposures() = default;  // none

  /// Reads a file: by the name of each view three rows of four numbers. As INRIA's renderer has it, a colour
  /// is a row before the first three columns, and the last column is added. Throws Error naming the file, the
  /// view and the place for what is no such thing.
  explicit Exposures(const std::filesystem::path& file);

  /// By a view's name as it stands, or else without a picture's ending; nothing is changed of a view that is
  /// not there. For base/image.h, exposed().
  glm::mat4x3 of(const std::string& view) const;
  bool has(const std::string& view) const { return find(view) != nullptr; }

  const std::filesystem::path& file() const { return file_; }
  std::size_t count() const { return by_name_.size(); }
  /// Whether they change any picture. The trainer writes the file without train_test_exp, too.
  bool change_any() const;

 private:
  const glm::mat4x3* find(const std::string& view) const;

  std::filesystem::path file_;
  std::map<std::string, glm::mat4x3> by_name_;
  std::map<std::string, std::string> by_stem_;  // names; empty where two have this stem
};

}  // namespace binosplat
