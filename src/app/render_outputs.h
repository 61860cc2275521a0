#pragma once
// The files that `binosplat render` leaves.

#include <filesystem>
#include <string>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"
#include "base/image.h"

namespace binosplat::app {

/// Which files a shot becomes.
struct OutputPlan {
  std::filesystem::path folder;  // for one file an eye; empty: both eyes side by side in `file`
  std::filesystem::path file;    // without its ending
  bool png = true;
  bool exr = false;
};

/// From -o, --exr and --bits. Throws Error, before any long work, for what cannot be written.
OutputPlan plan_outputs(const RenderOptions& options);

/// Writes the pictures of a shot's eyes, in their order, and returns the files' names.
std::vector<std::string> write_outputs(const RenderOptions& options, const OutputPlan& plan, const Shot& shot,
                                       const std::vector<Picture>& pictures);

}  // namespace binosplat::app
