#pragma once
// The files that `binosplat render` leaves.

#include <filesystem>
#include <string>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"
#include "base/image.h"
#include "shared/axes.h"

namespace binosplat::app {

/// Which files a shot becomes.
struct OutputPlan {
  std::filesystem::path folder;  // for files with the shots' names; empty: one shot, in `file`
  std::filesystem::path file;    // without its ending
  int layout = LAYOUT_SEPARATE;  // LAYOUT_ of shared/axes.h; separate in `file`: a single eye's
  bool png = true;
  bool exr = false;
};

/// From -o, --layout, --exr and --bits. Throws Error, before any long work, for what cannot be written.
OutputPlan plan_outputs(const RenderOptions& options);

/// Throws Error for shots whose eyes cannot be laid out as planned, and for many in one file.
void check_shots(const OutputPlan& plan, const std::vector<Shot>& shots);

/// Writes the pictures of a shot's eyes, in their order, and returns the files' names.
std::vector<std::string> write_outputs(const RenderOptions& options, const OutputPlan& plan, const Shot& shot,
                                       const std::vector<Picture>& pictures);

}  // namespace binosplat::app
