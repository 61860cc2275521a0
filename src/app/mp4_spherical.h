#pragma once
// What tells players that a video is half a sphere: the boxes st3d and sv3d of Google's Spherical Video V2,
// which no option of ffmpeg writes.

#include <filesystem>

namespace binosplat::app {

/// Puts the boxes into a finished .mp4 or .mov with one video track whose `moov` comes last, as ffmpeg leaves
/// it: equirectangular, 180 degrees across, of one eye (LAYOUT_SEPARATE) or both as `layout` has them. Throws
/// Error where the file is no such one.
void mark_half_sphere(const std::filesystem::path& path, int layout);

}  // namespace binosplat::app
