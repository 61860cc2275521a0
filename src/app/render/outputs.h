#pragma once
// The files of `binosplat render`: names, layouts and bytes.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "app/render/shots.h"
#include "app/render/video.h"
#include "shared/choices.h"
#include "stereo/debug_view.h"

namespace binosplat::app {

struct Outputs {
  std::filesystem::path folder;  // gets the files of each shot; empty: `file` is the only output
  std::filesystem::path file;    // the picture of a single shot, or the video of all shots
  bool video = false;            // `file` is a video
  int layout = LAYOUT_SEPARATE;  // LAYOUT_ of shared/choices.h; LAYOUT_SEPARATE with `file`: one eye
  std::vector<std::string>
      endings;                // of each picture's files: .png, .exr, .jpg (formats/pictures/vr_photo.h)
  std::optional<double> fps;  // frame rate of the video or path; none: from the path's times
  bool vr180 = false;
};

constexpr double video_fps = 30.0;

/// Returns the default folder of a scene's files: out/NAME. If that folder has pictures of another model
/// (claim_folder), prefixes the name with names of the model's parent folders.
std::filesystem::path default_folder(const std::string& scene);

/// Records in a folder which model its pictures show. Throws Error if a run of another model has claimed the
/// folder since the call of default_folder().
void claim_folder(const std::filesystem::path& folder, const std::string& scene);

/// The outputs that the options request. Throws Error early for outputs that cannot be written.
Outputs outputs_of(const Options& render);

/// Names the files of each shot. Throws Error if the layout does not fit the eyes, if several shots share one
/// picture, if frames of a video differ in size, or if a file would replace an input or the file of --json.
void place_files(const Outputs& outputs, const std::string& json, std::vector<Shot>& shots);

/// Opens the requested video of the shots, which takes frames from encoded(); null if none is requested.
std::unique_ptr<Video> open_video(const Outputs& outputs, const std::vector<Shot>& shots);

/// The bytes of a shot's file, or its frame of the video. `shown` has a picture for each eye.
std::string encoded(const PictureFile& file, const Options& render, const Outputs& outputs, const Shot& shot,
                    const stereo::DebugPictures& shown);

}  // namespace binosplat::app
