#pragma once
// render --resume: what an earlier run of the same kind has drawn is left as it is.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli.h"
#include "app/measured_options.h"
#include "app/photos.h"
#include "app/render_options.h"
#include "app/shots.h"
#include "lab/calibrate.h"

namespace binosplat::app {

/// The options given on the command line, as text, in an order of their own: all but those on which no
/// picture depends, so that the runs of an array may differ in them.
std::vector<std::string> options_given(const CLI::App& sub);

/// What tells a run from others whose pictures have the same names: options, and the content of what is
/// drawn. `shots` are those of all shards.
nlohmann::ordered_json identity_of(const RenderOptions& options, const CameraList& list, double near_plane,
                                   const std::vector<Shot>& shots);

/// Takes the shots off whose files are all in the folder, whole, and says how many these are. That they are
/// of this run is told by a file beside them, which the first run writes. Throws Error where it is of another
/// run, and where there are files and none that tells of them.
void leave_out_drawn(const std::filesystem::path& folder, const nlohmann::ordered_json& run,
                     std::vector<Shot>& shots);

/// Keeps what is measured for the file `result` beside it until forget_steps(), for runs of the same kind,
/// which go on from there when one is ended: of the same options, content of files and device.
lab::Keep keep_steps(const std::filesystem::path& result, const MeasuredOptions& options,
                     const PhotoSource& photos, const CameraList& list, const gl::Context& context);
void forget_steps(const std::filesystem::path& result);

/// For runs that draw all: what they leave in the folder, if it is one, is not what the file there tells of.
void forget_run(const std::filesystem::path& folder);

/// After the last shot: throws Error if a run of another kind began to draw into the folder since this one,
/// which was handed `run` to leave_out_drawn(), or nothing and called forget_run().
void check_alone(const std::filesystem::path& folder, const std::optional<nlohmann::ordered_json>& run);

}  // namespace binosplat::app
