#pragma once
// Names of files for views, and photos of views.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "scene/camera.h"

namespace binosplat {

/// Converts a view's name to a file name without ending. Trainers' names may have folders and endings.
std::string stem_of(std::string name);

/// Sets each camera's short name: the shortest end of its name that begins at a folder or at the file and is
/// unique without the photo's ending. If no end is unique, the short name is the whole name.
void set_short_names(std::span<Camera> cameras);

/// Finds a view's photo in a folder: by the view's name, with or without a picture's ending; then by ends of
/// the name from the longest to the short name. An end begins at a folder ("/" or "\"), and may begin with
/// the last folders of `folder`. If the name is an absolute path, tries that path last.
std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                     const std::string& view,
                                                     const std::string& short_name = "");
inline std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                            const Camera& view) {
  return find_view_photo(folder, view.name, view.short_name);
}

/// Throws Error if two views of a cameras file share one photo, as "a.jpg" and "a.png" do if only one photo
/// exists: a view must not be compared with another's photo. Pass all views of the file, drawn or not.
void check_photos_unique(const std::filesystem::path& folder, std::span<const Camera> views);

}  // namespace binosplat
