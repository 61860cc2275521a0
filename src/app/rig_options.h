#pragma once
// Which eyes are drawn of a camera, and where they are.

#include <cstddef>
#include <optional>

#include "app/cli.h"

namespace binosplat::app {

struct RigOptions {
  bool mono = false;                  // the camera itself
  std::optional<std::size_t> only;    // one eye of the pair: 0 the left one, 1 the right one
  std::optional<double> ipd;          // m
  std::optional<double> convergence;  // m, or infinite
  std::optional<double> cant;         // degrees
  std::optional<double> units_per_metre;

  bool one_picture() const { return mono || only; }
  /// Whether they say where the eyes are.
  bool places_eyes() const { return ipd || convergence || cant; }
};

/// For commands that know no rig.
inline const RigOptions no_rig{.mono = true};

/// Adds all of them; `options` must outlive the parsing.
void add_rig_options(CLI::App& sub, RigOptions& options);

/// One of them, for commands that take few.
CLI::Option* add_ipd_option(CLI::App& sub, RigOptions& options);

}  // namespace binosplat::app
