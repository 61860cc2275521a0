#pragma once
// Files that are named after views.

#include <filesystem>
#include <optional>
#include <string>

namespace binosplat {

/// A view's name as a file's: trainers' names may have folders, and the endings of the photos.
std::string stem_of(std::string name);

/// The file of a view's photo in a folder: by the view's name as it stands, or with a picture's ending.
std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                     const std::string& view);

}  // namespace binosplat
