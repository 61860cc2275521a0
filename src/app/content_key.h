#pragma once
// What tells files from others of the same name and size.

#include <filesystem>
#include <span>
#include <string>

#include "scene/camera.h"

namespace binosplat::app {

/// 32 hexadecimal digits (XXH3) that change with any byte of the files that a model is read from
/// (files_of_model), and with no others. Throws Error for what cannot be read.
std::string content_key(const std::filesystem::path& path);

/// The same of a text.
std::string text_key(const std::string& text);

/// The same of one file by itself.
std::string file_key(const std::filesystem::path& file);

/// The same of all files in a folder of photos.
std::string pictures_key(const std::filesystem::path& folder);

/// The same of cameras: poses, lenses, sizes and names.
std::string content_key(std::span<const Camera> cameras);

}  // namespace binosplat::app
