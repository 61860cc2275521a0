#pragma once
// Files that are named after views.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "scene/camera.h"

namespace binosplat {

/// A view's name as a file's: trainers' names may have folders, and the endings of the photos.
std::string stem_of(std::string name);

/// The file of a view's photo in a folder: by the view's name as it stands, or with a picture's ending.
std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                     const std::string& view);

/// Throws Error where two of the views have one photo, as "a.jpg" and "a.png" have where only one of these is
/// there: a view would be compared with another's photo. Of all views of a file, whichever are drawn.
void check_photos_apart(const std::filesystem::path& folder, std::span<const Camera> views);

}  // namespace binosplat
