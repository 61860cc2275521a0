#pragma once
// Recorded heads: the csv files of EyeNavGS (arXiv 2506.02380), of people in headsets who walk through
// scenes.
//
// The first line names the columns; those of the gaze are ignored. Each frame has a line for the left eye
// (ViewIndex 0), then one for the right eye (1): FOV1 to FOV4 as in XrFovf, position of the eye, quaternion x
// y z w from eye to world, and ms as Timestamp, timestep or elapsed_ms (the recorder's `timestamp` is another
// clock). The recorder has applied the scene's scale, tilt and start. So the file's world is the scene's, in
// the scene's units, except that its axes are OpenXR's: y up, z backwards.

#include <filesystem>
#include <string_view>
#include <vector>

#include "scene/camera.h"

namespace binosplat {

/// Returns whether the first line of a text names columns of recorded heads.
bool is_head_trace(std::string_view text);

/// Reads the heads, between the eyes: cameras named 00000 and so on, with seconds since the first. Pictures
/// are as wide and high as an eye's, but centred on the axis, and pose_height px high
/// (formats/cameras/nerfstudio.h). A left eye at the file's end may lack its right eye. Throws Error naming
/// the line for missing columns, wrong numbers, other frames of one eye, times that do not rise, and
/// quaternions by which the right eye is not to the right of the left one.
std::vector<Camera> load_head_trace(const std::filesystem::path& path, std::string_view text);

}  // namespace binosplat
