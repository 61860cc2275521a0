#pragma once
// The exposures in exposure.json of INRIA's training (train_test_exp). Photos differ in exposure and white
// balance, so the training applies a view's exposure to its picture before it compares picture and photo.

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>

namespace binosplat {

class Exposures {
 public:
  Exposures() = default;  // no exposures

  /// Reads a file: three rows of four numbers for each view name. As in INRIA's renderer, the exposed colour
  /// is the colour as a row vector times the first three columns, plus the last column. If the file is
  /// invalid, throws Error and names the file, the view and the element.
  explicit Exposures(const std::filesystem::path& file);

  /// Returns the exposure of a view, for exposed() of base/image.h. The view's name may lack the picture's
  /// ending. For views that the file lacks, returns the identity.
  glm::mat4x3 of(const std::string& view) const;
  bool has(const std::string& view) const { return find(view) != nullptr; }

  const std::filesystem::path& file() const { return file_; }
  std::size_t count() const { return by_name_.size(); }
  /// Returns whether any exposure changes a picture. Without train_test_exp, the trainer writes identities.
  bool changes_any() const;

 private:
  const glm::mat4x3* find(const std::string& view) const;

  std::filesystem::path file_;
  std::map<std::string, glm::mat4x3> by_name_;
  std::map<std::string, std::string> by_stem_;  // names by stem; "" if two names have the same stem
};

}  // namespace binosplat
