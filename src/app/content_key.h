#pragma once
// Hashes of contents, which distinguish files of the same name and size.

#include <filesystem>
#include <span>
#include <string>

#include "scene/camera.h"

namespace binosplat::app {

/// Returns a hash (XXH3, 32 hexadecimal digits) of all files that a model is read from (files_of_model).
/// Throws Error for a file that cannot be read.
std::string content_key(const std::filesystem::path& path);
std::string text_key(const std::string& text);
std::string file_key(const std::filesystem::path& file);

/// The same for all files in a folder of photos.
std::string pictures_key(const std::filesystem::path& folder);

/// The same for cameras: poses, lenses, sizes and names.
std::string content_key(std::span<const Camera> cameras);

}  // namespace binosplat::app
