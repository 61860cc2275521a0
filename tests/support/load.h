#pragma once
// Models and cameras of files that a test makes, good and damaged ones.

#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "support/broken.h"

namespace binosplat::test {

/// What is read of a file of that name with these bytes.
inline Model load_model_of(const std::string& bytes, const std::string& name) {
  const TempFolder folder;
  write_text(folder / name, bytes);
  return load_model(folder / name);
}

inline std::vector<Camera> load_cameras_of(const std::string& text, const std::string& name) {
  const TempFolder folder;
  write_text(folder / name, text);
  return load_cameras(folder / name);
}

/// Expects that no model is read of these, and each time an error names the file and says what is wrong.
inline void expect_no_models(const std::string& name, const std::vector<BrokenFile>& files) {
  expect_refusals(name, files, [&](const std::string& bytes) { load_model_of(bytes, name); });
}

inline void expect_no_cameras(const std::string& name, const std::vector<BrokenFile>& files) {
  expect_refusals(name, files, [&](const std::string& text) { load_cameras_of(text, name); });
}

}  // namespace binosplat::test
