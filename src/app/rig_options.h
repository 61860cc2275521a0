#pragma once
// The options that choose the eyes of each camera.

#include <cstddef>
#include <optional>

#include "app/cli.h"

namespace binosplat::app {

struct RigOptions {
  bool mono = false;                  // draws the camera itself
  std::optional<std::size_t> only;    // one eye of the pair: 0 left, 1 right
  std::optional<double> ipd;          // m
  std::optional<double> convergence;  // m, or infinite
  std::optional<double> cant;         // degrees
  std::optional<double> units_per_metre;

  bool one_picture() const { return mono || only; }
  /// Whether options set the positions of the eyes.
  bool places_eyes() const { return ipd || convergence || cant; }
};

inline const RigOptions no_rig{.mono = true};

/// Adds all options of RigOptions; `options` must outlive parsing.
void add_rig_options(CLI::App& sub, RigOptions& options);
CLI::Option* add_ipd_option(CLI::App& sub, RigOptions& options);

}  // namespace binosplat::app
