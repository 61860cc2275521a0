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

/// Sets each camera's short name: the shortest end of its name, from a folder in it on, that no other
/// camera's name has, whatever the endings of their photos; else its whole name.
void set_short_names(std::span<Camera> cameras);

/// The file of a view's photo in a folder: by the view's name as it stands, or with a picture's ending. Then
/// by ends of the name, from a folder in it on, the longest first: one that begins with the last folders of
/// `folder` itself, or, down to the short name, any. Both "/" and "\" separate folders in a name. A whole
/// path counts where there is nothing of that.
std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                     const std::string& view,
                                                     const std::string& short_name = "");
inline std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                            const Camera& view) {
  return find_view_photo(folder, view.name, view.short_name);
}

/// Throws Error where two of the views have one photo, as "a.jpg" and "a.png" have where only one of these is
/// there: a view would be compared with another's photo. Of all views of a file, whichever are drawn.
void check_photos_apart(const std::filesystem::path& folder, std::span<const Camera> views);

}  // namespace binosplat
