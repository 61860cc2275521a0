#pragma once
// Reads models from ply files of a test.

#include <string>

#include "formats/models/ply.h"
#include "support/ply.h"
#include "support/program.h"

namespace binosplat::test {

/// Returns the model in a ply file with these bytes.
inline Model load(const std::string& bytes) {
  const TempFolder folder;
  write_text(folder / "model.ply", bytes);
  return load_ply(OpenedFile(folder / "model.ply"));
}

inline Model load(const PlyFile& file) { return load(to_bytes(file)); }

/// Compares two models except for their metadata.
inline bool equal(const Model& a, const Model& b) {
  return a.degree == b.degree && a.position == b.position && a.scale == b.scale && a.rotation == b.rotation &&
         a.opacity == b.opacity && a.sh == b.sh && a.left_out == b.left_out;
}

}  // namespace binosplat::test
