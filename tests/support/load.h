#pragma once
// Reads models and cameras from files that a test makes, good or damaged.

#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "support/broken.h"

namespace binosplat::test {

/// Returns the model in a file with this name and these bytes.
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

/// Expects that reading each file fails with an error that names the file and contains its texts.
inline void expect_no_models(const std::string& name, const std::vector<BrokenFile>& files) {
  expect_refusals(name, files, [&](const std::string& bytes) { load_model_of(bytes, name); });
}

inline void expect_no_cameras(const std::string& name, const std::vector<BrokenFile>& files) {
  expect_refusals(name, files, [&](const std::string& text) { load_cameras_of(text, name); });
}

}  // namespace binosplat::test
