#pragma once
// Where the pictures of `binosplat render` go: which files each shot becomes, and their bytes.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"
#include "app/video.h"
#include "shared/axes.h"
#include "stereo/debug_view.h"

namespace binosplat::app {

/// How the pictures of all shots are written.
struct Outputs {
  std::filesystem::path folder;      // for files with the shots' names; empty: all is in `file`
  std::filesystem::path file;        // the picture of the one shot, or the video of all
  bool video = false;                // `file` is one
  int layout = LAYOUT_SEPARATE;      // LAYOUT_ of shared/axes.h; separate in `file`: a single eye's
  std::vector<std::string> endings;  // of the files of a picture: .png, .exr, .jpg (formats/vr_photo.h)
  std::optional<double> fps;         // of the video or the path; none: by the path's times
  bool vr180 = false;
};

/// Frames a second of videos, where nothing says otherwise.
constexpr double video_fps = 30.0;

/// Where a scene's files go without -o: out/ and its name, with the folders' above it where pictures of
/// another model lie there (claim_folder).
std::filesystem::path default_folder(const std::string& scene);

/// Writes down in a folder of pictures which model they are of. Throws Error if a run of another model has
/// done so since default_folder() found it free.
void claim_folder(const std::filesystem::path& folder, const std::string& scene);

/// What the options ask for. Throws Error, before any long work, for what cannot be written.
Outputs outputs_of(const RenderOptions& render);

/// Names the files of each shot. Throws Error for shots whose eyes cannot be laid out so, for many in one
/// picture, for videos whose frames differ in size, and for pictures that would replace what the run reads,
/// or the file of --json.
void place_files(const Outputs& outputs, const std::string& json, std::vector<Shot>& shots);

/// The video of the shots, which takes what encoded() makes of each; nothing where none is asked for.
std::unique_ptr<Video> open_video(const Outputs& outputs, const std::vector<Shot>& shots);

/// The bytes of a shot's file, or its frame of the video, from what is shown of each of its eyes.
std::string encoded(const PictureFile& file, const RenderOptions& render, const Outputs& outputs,
                    const Shot& shot, const stereo::DebugPictures& shown);

}  // namespace binosplat::app
