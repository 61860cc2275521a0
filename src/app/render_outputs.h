#pragma once
// The files that `binosplat render` leaves.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/render_options.h"
#include "app/shots.h"
#include "app/video.h"
#include "base/image.h"
#include "shared/axes.h"
#include "stereo/debug_view.h"

namespace binosplat::app {

/// Which files a shot becomes.
struct OutputPlan {
  std::filesystem::path folder;  // for files with the shots' names; empty: one shot, in `file`
  std::filesystem::path file;    // without its ending
  int layout = LAYOUT_SEPARATE;  // LAYOUT_ of shared/axes.h; separate in `file`: a single eye's
  std::filesystem::path video;   // of all shots, instead of files
  std::optional<double> fps;     // of the video or the path; none: by the path's times
  bool png = true;
  bool exr = false;
  std::string suffix;  // of files in the folder
  bool vr180 = false;
  bool vr_photo = false;  // both eyes in a .jpg (formats/vr_photo.h)
};

/// Frames a second of videos, where nothing says otherwise.
constexpr double video_fps = 30.0;

/// Where a scene's files go without -o: out/ and its name, with the folders' above it where pictures of
/// another model lie there (claim_folder).
std::filesystem::path default_folder(const std::string& scene);

/// Writes down in a folder of pictures which model they are of. Throws Error if a run of another model has
/// done so since default_folder() found it free.
void claim_folder(const std::filesystem::path& folder, const std::string& scene);

/// From -o, --layout, --exr, --bits and --fps. Throws Error, before any long work, for what cannot be
/// written.
OutputPlan plan_outputs(const RenderOptions& render);

/// Throws Error for shots whose eyes cannot be laid out as planned, for many in one picture, for videos whose
/// frames differ in size, and for pictures that would replace what the run reads, or the file of --json.
void check_shots(const OutputPlan& plan, const std::vector<Shot>& shots, const std::string& json);

/// The video that is planned, to be given each shot's pictures as frame_of() has them; nothing if none is.
std::unique_ptr<Video> open_video(const OutputPlan& plan, const std::vector<Shot>& shots);

/// A shot's pictures as a frame of the video.
Image frame_of(const OutputPlan& plan, const Background& background, const std::vector<Picture>& pictures);

/// The files that a shot becomes in the plan's folder, or in its file.
std::vector<std::string> files_of(const OutputPlan& plan, const Shot& shot);

struct EncodedFile {
  std::string name, bytes;
};

/// The files of what is shown of a shot of the scene, of its eyes in their order.
std::vector<EncodedFile> encode_outputs(const std::string& scene, const OutputOptions& options,
                                        const OutputPlan& plan, const Shot& shot,
                                        const stereo::DebugPictures& shown);

}  // namespace binosplat::app
