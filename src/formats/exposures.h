#pragma once
// The exposures in exposure.json of INRIA's training (train_test_exp). Photos of one scene differ in exposure
// and white balance, so the training maps each view's picture by these before it compares it with the photo.

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>

namespace binosplat {

class Exposures {
 public:
  Exposures() = default;  // none

  /// Reads a file: three rows of four numbers by view name. As in INRIA's renderer, a colour is a row vector
  /// times the first three columns, plus the last column. Throws Error naming the file, the view and the
  /// place if it is invalid.
  explicit Exposures(const std::filesystem::path& file);

  /// Returns the exposure of a view by its name, with or without a picture's ending, for exposed() of
  /// base/image.h. A missing view gets the identity.
  glm::mat4x3 of(const std::string& view) const;
  bool has(const std::string& view) const { return find(view) != nullptr; }

  const std::filesystem::path& file() const { return file_; }
  std::size_t count() const { return by_name_.size(); }
  /// Returns whether any picture changes: the trainer writes the file without train_test_exp, too.
  bool change_any() const;

 private:
  const glm::mat4x3* find(const std::string& view) const;

  std::filesystem::path file_;
  std::map<std::string, glm::mat4x3> by_name_;
  std::map<std::string, std::string> by_stem_;  // names by stem; empty if two have this stem
};

}  // namespace binosplat
