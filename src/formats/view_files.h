#pragma once
// Names of files for views, and photos of views.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "scene/camera.h"

namespace binosplat {

/// Converts a view's name to a file's name: trainers' names may have folders and the photos' endings.
std::string stem_of(std::string name);

/// Sets each camera's short name: the shortest end of its name, starting at a folder or the file, that is
/// unique without the photos' endings; otherwise its whole name.
void set_short_names(std::span<Camera> cameras);

/// Finds a view's photo in a folder: by the view's name, with or without a picture's ending. Then it tries
/// ends of the name, each starting at a folder, from the longest to the short name. Such an end may overlap
/// the last folders of `folder`. Both "/" and "\" separate folders in a name. An absolute path is tried last.
std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                     const std::string& view,
                                                     const std::string& short_name = "");
inline std::optional<std::filesystem::path> find_view_photo(const std::filesystem::path& folder,
                                                            const Camera& view) {
  return find_view_photo(folder, view.name, view.short_name);
}

/// Throws Error if two of a file's views share one photo, as "a.jpg" and "a.png" do if only one exists. One
/// view would be compared with the other's photo. Pass all views of the file, drawn or not.
void check_photos_unique(const std::filesystem::path& folder, std::span<const Camera> views);

}  // namespace binosplat
