#pragma once
// The writers behind write_model (formats/models/model_output.h), and their common parts.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "formats/containers/zip_file.h"
#include "formats/models/model_output.h"
#include "formats/models/smallest_three.h"

namespace binosplat {

/// Properties that a format loses, a line each.
using Losses = std::vector<std::string>;

Losses write_ply(OutputFile& file, const Model& model);
Losses write_sog(OutputFile& file, const Model& model);
Losses write_spz(OutputFile& file, const Model& model, int harmonic_bits);

/// Returns the files of a SOG in a folder, meta.json first. Gaussians keep their order.
ZipEntries sog_files(const Model& model);
Losses sog_losses(const Model& model);

/// Returns whether a file may say that the model is flat: its reader then draws all Gaussians as discs.
inline bool stores_flat(const Model& model) {
  return model.flat && std::ranges::all_of(model.scale, [](const glm::vec3& s) { return s.z == 0.0f; });
}

/// Returns the nearest integer from 0 to `most`.
inline std::uint32_t nearest_step(double v, std::uint32_t most) {
  return static_cast<std::uint32_t>(std::clamp(std::floor(v + 0.5), 0.0, static_cast<double>(most)));
}

/// Adds a line to `losses` if lost(i) is true for some Gaussians i.
template <typename Lost>
void count_lost(Losses& losses, const Model& model, const char* what, const Lost& lost) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < model.count(); ++i) count += lost(i) ? 1 : 0;
  if (count > 0) losses.push_back(fmt::format("{} of {} Gaussians have {}", count, model.count(), what));
}

}  // namespace binosplat
