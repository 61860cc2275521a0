#pragma once
// Writes Scaffold-GS models as their trainer does.

#include <cmath>
#include <filesystem>
#include <fstream>

#include "support/ply.h"
#include "support/scaffold.h"
#include "support/zip.h"

namespace binosplat::test {

/// Returns the anchors in the trainer's file format.
inline PlyFile anchor_file(const Scaffold& s) {
  PlyFile file;
  file.columns = {"x", "y", "z", "nx", "ny", "nz"};
  const auto numbered = [&](const std::string& name, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) file.columns.push_back(name + std::to_string(i));
  };
  numbered("f_offset_", 3 * s.offset_count);
  numbered("f_anchor_feat_", s.feature_count);
  file.columns.emplace_back("opacity");
  numbered("scale_", 6);
  numbered("rot_", 4);
  for (std::size_t n = 0; n < s.anchor_count(); ++n) {
    std::vector<double>& row = file.rows.emplace_back();
    const auto add = [&](double value) { row.push_back(value); };
    for (int c = 0; c < 3; ++c) add(s.position[n][c]);
    for (int c = 0; c < 3; ++c) add(0);
    for (int c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < s.offset_count; ++k) add(s.offset[n * s.offset_count + k][c]);
    }
    for (std::size_t i = 0; i < s.feature_count; ++i) add(s.feature[n * s.feature_count + i]);
    add(0);
    for (int c = 0; c < 3; ++c) add(std::log(s.offset_scale[n][c]));
    for (int c = 0; c < 3; ++c) add(std::log(s.scale[n][c]));
    for (int c = 0; c < 4; ++c) add(s.rotation[n][c]);
  }
  return file;
}

inline ZipEntries entries_of(const Network& n) {
  return torch_entries({n.first, n.first_bias, n.second, n.second_bias});
}

/// Writes the model's files into a folder.
inline void write_scaffold(const std::filesystem::path& folder, const Scaffold& s) {
  std::ofstream(folder / "point_cloud.ply", std::ios::binary) << to_bytes(anchor_file(s));
  write_zip(folder / "opacity_mlp.pt", entries_of(s.opacity));
  write_zip(folder / "cov_mlp.pt", entries_of(s.covariance));
  write_zip(folder / "color_mlp.pt", entries_of(s.colour));
  if (s.appearance_size > 0) write_zip(folder / "embedding_appearance.pt", torch_entries({s.appearances}));
  if (s.bank) write_zip(folder / "feature_bank_mlp.pt", entries_of(*s.bank));
}

}  // namespace binosplat::test
