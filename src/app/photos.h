#pragma once
// The photos that a model was trained on, by the names of its views.

#include <filesystem>
#include <optional>

#include "app/shots.h"
#include "base/image.h"

namespace binosplat::app {

/// The file of a view's photo in a folder: by the view's name as it stands, or with a picture's ending.
std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder, const Shot& shot);

/// Reads it. Throws Error unless it is RGB in the camera's size.
Image load_view_photo(const std::filesystem::path& file, const Camera& camera);

}  // namespace binosplat::app
