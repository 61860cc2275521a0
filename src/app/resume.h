#pragma once
// render --resume: keeps the pictures that an earlier run with the same options drew.

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

/// The options of the command line as text, in the order of definition. Omits options that no picture depends
/// on, so that the shards of one run may differ in them.
std::vector<std::string> options_given(const CLI::App& sub);

/// The values that distinguish runs with the same file names: options, and hashes of the files' contents.
/// `shots` are those of all shards.
nlohmann::ordered_json identity_of(const RenderOptions& options, const CameraList& list, double near_plane,
                                   const std::vector<Shot>& shots);

/// Removes the shots whose files are all complete in the folder, and logs their number. The first run writes
/// a file that identifies it beside the pictures. Throws Error if the file describes another run, or if there
/// are pictures but no file of a run.
void leave_out_drawn(const std::filesystem::path& folder, const nlohmann::ordered_json& run,
                     std::vector<Shot>& shots);

/// Stores each measured step in a folder beside the file `result` until forget_steps(). An interrupted run of
/// the same options, contents and device resumes from there.
lab::StepCache cache_steps(const std::filesystem::path& result, const MeasuredOptions& options,
                           const PhotoSource& photos, const CameraList& list, const gl::Context& context);
void forget_steps(const std::filesystem::path& result);

/// For runs that draw all views: removes the file that identifies earlier pictures in the folder.
void forget_run(const std::filesystem::path& folder);

/// Call it after the last shot. Throws Error if another run has started to draw into the folder meanwhile.
/// `run` is as for leave_out_drawn(), or none after forget_run().
void check_alone(const std::filesystem::path& folder, const std::optional<nlohmann::ordered_json>& run);

}  // namespace binosplat::app
