#pragma once
// What tells files from others of the same name and size.

#include <filesystem>
#include <span>
#include <string>

#include "scene/camera.h"

namespace binosplat::app {

/// 32 hexadecimal digits (XXH3) that change with any byte of what is read of `path`: a file, with the
/// networks (*.pt) beside a Scaffold-GS model's, or a folder, with the names of all files in it. Throws Error
/// for one that cannot be read.
std::string content_key(const std::filesystem::path& path);

/// The same of cameras: poses, lenses, sizes and names.
std::string content_key(std::span<const Camera> cameras);

}  // namespace binosplat::app
