#include "app/render_outputs.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <set>

#include "app/command.h"
#include "app/sequence.h"
#include "app/tour.h"
#include "app/vr180.h"
#include "base/inputs.h"
#include "base/output_file.h"
#include "base/text.h"
#include "formats/exr.h"
#include "formats/image_file.h"
#include "formats/vr_photo.h"
#include "stereo/layout.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

// What a picture's file says of how it was drawn: a stereo picture is right only at its scale.
Notes notes_of(const std::string& scene, const OutputOptions& options, const Shot& shot,
               const std::string& side, const std::optional<double>& most_shown) {
  Notes notes = {{"Software", "binosplat " BINOSPLAT_VERSION},
                 {"binosplatScene", scene},
                 {"binosplatView", shot.name},
                 {"binosplatUnitsPerMetre", fmt::format("{}", shot.units_per_metre)}};
  if (!side.empty()) notes["binosplatEye"] = side;
  if (most_shown)
    notes["binosplatShow"] = fmt::format("{}, 0 to {}", show_choices[options.show].name, *most_shown);
  if (options.exr_depth == Depth::median) notes["binosplatDepth"] = "median";
  if (shot.ipd) notes["binosplatIpdMetres"] = fmt::format("{}", *shot.ipd);
  return notes;
}

// `picture_file`: one PNG or a video. The layout that is asked for or that fits the output, and what it does
// not go with.
int plan_layout(const OutputOptions& options, bool one_picture, bool picture_file, bool exr_file) {
  if (!options.layout) {
    if (one_picture) return LAYOUT_SEPARATE;
    return picture_file ? LAYOUT_PARALLEL : exr_file ? LAYOUT_MULTI_VIEW : LAYOUT_SEPARATE;
  }
  const int layout = *options.layout;
  const char* const name = layout_choices[layout].name;
  if (one_picture) fail("--layout {} needs both eyes: leave --mono and --only out", name);
  if (layout == LAYOUT_QUAD_BUFFER)
    fail("--layout quad-buffer is for `binosplat view`: a file has no buffers");
  if (layout == LAYOUT_SEPARATE && (picture_file || exr_file))
    fail("--layout separate writes a file for each eye: -o {} must be a folder", options.output);
  if (layout == LAYOUT_MULTI_VIEW && picture_file)
    fail("--layout multi-view is OpenEXR's: -o {} must be a folder or an .exr", options.output);
  if (stereo::mixes_colours(layout) && (exr_file || options.exr_half)) {
    fail("--layout {} mixes both eyes' display colours, which have no light and no depth: write PNG only",
         name);
  }
  if (stereo::mixes_colours(layout) && !options.background) {
    fail("--layout {} mixes both eyes' colours and leaves no alpha: --background none is not for it", name);
  }
  return layout;
}

ExrOptions exr_options(const OutputOptions& options, const Notes& notes) {
  return {options.exr_half.value_or(true), options.exr_display.value_or(false), options.background, notes,
          options.exr_compression};
}

void encode_picture(const OutputOptions& options, const OutputPlan& plan, const std::string& base,
                    const Picture& picture, const Notes& notes, std::vector<EncodedFile>& files) {
  if (plan.png)
    files.push_back({base + ".png", png_bytes(composite(picture, options.background),
                                              {options.bits.value_or(8), options.png_level, notes})});
  if (plan.exr)
    files.push_back({base + ".exr", exr_bytes(base + ".exr", picture, exr_options(options, notes))});
}

// The files of a shot without their endings: one for each eye, or one for both.
std::vector<std::string> bases_of(const OutputPlan& plan, const Shot& shot) {
  const std::string base = plan.folder.empty() ? plan.file : plan.folder / (shot.stem + plan.suffix);
  if (plan.layout != LAYOUT_SEPARATE) return {base};
  std::vector<std::string> bases;
  for (const Eye& eye : shot.eyes)
    bases.push_back(plan.folder.empty() || eye.side.empty() ? base : base + "_" + eye.side);
  return bases;
}

OutputPlan plan_video(const OutputOptions& options, bool one_picture, const fs::path& output) {
  check_output(output);
  find_ffmpeg();
  if (options.bits || options.exr_half || options.exr_display || options.exr_depth == Depth::median)
    fail("--bits, --exr, --exr-depth and --exr-encoding are for pictures: -o {} is a video", output.string());
  if (!options.background) fail("--background none: a video has no alpha");
  if (!options.json.empty()) check_output(options.json);
  OutputPlan plan;
  plan.video = output;
  plan.png = false;
  plan.layout = plan_layout(options, one_picture, true, false);
  return plan;
}

// From the times of a path's cameras, where they are evenly spaced; the usual where they say nothing.
double frames_a_second(const std::vector<Shot>& shots) {
  const auto& first = shots.front().eyes[0].camera.time;
  const auto& last = shots.back().eyes[0].camera.time;
  if (shots.size() < 2 || !first || !last || !(*last > *first)) return video_fps;
  const double step = (*last - *first) / static_cast<double>(shots.size() - 1);
  for (std::size_t k = 1; k < shots.size(); ++k) {
    const auto &a = shots[k - 1].eyes[0].camera.time, &b = shots[k].eyes[0].camera.time;
    if (!a || !b || std::abs(*b - *a - step) > 0.01 * step) return video_fps;
  }
  return 1.0 / step;
}

// Whether a path's ending, as in .gif or .jp2, is one of a file; not .2 and .v2, which folders have.
bool names_a_file(const fs::path& path) {
  const std::string ending = lowered_ending(path);
  std::error_code ignored;
  if (ending.size() < 3 || ending.size() > 5 || fs::is_directory(path, ignored)) return false;
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  return std::all_of(ending.begin() + 1, ending.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0; }) &&
         std::count_if(ending.begin() + 1, ending.end(), is_letter) > 1;
}

// Whether trainers and exporters call every model's file or folder so, maybe with a number behind it.
bool tells_nothing(std::string name) {
  while (!name.empty() && (std::isdigit(static_cast<unsigned char>(name.back())) != 0 || name.back() == '_' ||
                           name.back() == '-'))
    name.pop_back();
  static const std::set<std::string> said = {
      "",       "point_cloud", "iteration", "ply",  "splat",    "splats", "model",     "scene",
      "output", "export",      "exports",   "meta", "lod-meta", "step",   "gaussians", "exported"};
  return said.contains(name);
}

// In a folder of pictures, the model that they are of, by its whole path, or a built-in scene.
constexpr const char* owner_name = "model.txt";

fs::path path_of(const std::string& scene) {
  if (is_built_in(scene)) return scene;
  const fs::path path = fs::absolute(scene).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

// Empty where nobody's pictures lie.
fs::path owner_of(const fs::path& folder) {
  std::ifstream file(folder / owner_name);
  std::string owner;
  std::getline(file, owner);
  return owner;
}

// Whether pictures of another model lie there.
bool is_anothers(const fs::path& folder, const fs::path& model) {
  const fs::path owner = owner_of(folder);
  return !owner.empty() && owner != model;
}

// The name, or where that is another model's one that tells the two apart.
std::string free_name(std::string name, const fs::path& model) {
  const auto is_taken = [&](const std::string& asked) { return is_anothers(fs::path("out") / asked, model); };
  for (fs::path path = model.parent_path(); is_taken(name) && path.has_relative_path();
       path = path.parent_path())
    name = path.filename().string() + "_" + name;
  const std::string all = name;
  for (int n = 2; is_taken(name); ++n) name = fmt::format("{}_{}", all, n);
  return name;
}

}  // namespace

fs::path default_folder(const std::string& scene) {
  const fs::path model = path_of(scene);
  if (is_built_in(scene)) return fs::path("out") / free_name(scene.substr(scene.find(':') + 1), model);
  fs::path path = model;
  std::error_code ignored;
  std::string name = fs::is_directory(path, ignored) ? path.filename().string() : path.stem().string();
  // A name with a number tells apart what one training saved.
  std::string number;
  while (tells_nothing(name) && path.has_relative_path()) {
    if (number.empty() && name.find_first_of("0123456789") != std::string::npos) number = "_" + name;
    path = path.parent_path();
    name = path.filename().string();
  }
  return fs::path("out") / free_name(name.empty() ? "model" : name + number, model);
}

void claim_folder(const fs::path& folder, const std::string& scene) {
  const fs::path model = path_of(scene);
  const bool cut = fs::exists(folder / owner_name) && owner_of(folder).empty();
  OutputFile file(folder / owner_name);
  file.write(model.string() + "\n");
  if (cut) return file.commit();
  if (!file.commit_as_first() && is_anothers(folder, model))
    fail("{}: another run has begun to draw another model there: start again, or name a folder with -o",
         folder.string());
}

OutputPlan plan_outputs(const RenderOptions& render) {
  const OutputOptions& options = render.output;
  const bool one_picture = render.rig.one_picture(), tour = render.camera.tour.has_value(),
             along_path = render.camera.along_path();
  const fs::path output =
      options.output.empty() ? default_folder(render.scene.name) : fs::path(options.output);
  const bool named = !options.output.empty();  // else it is a folder, however its model is called
  const bool video = named && is_video(output);
  const std::string extension = lowered_ending(output);
  const bool vr_photo = named && render.camera.lens.vr180() && extension == ".jpg";
  const bool file = named && (extension == ".png" || extension == ".exr" || vr_photo);
  if ((video || file) && (!render.shard.all() || render.resume))
    fail("--shard and --resume are for a folder of pictures, and -o {} is one file: name a folder",
         output.string());
  OutputPlan plan;
  if (video) plan = plan_video(options, one_picture, output);
  plan.fps = tour ? tour_fps(options.fps, video) : options.fps;
  plan.vr180 = render.camera.lens.vr180();
  if (video) return plan;
  plan.exr = options.exr_half.has_value();
  if (options.fps && !along_path && sequence_of(render).empty())
    fail("--fps is for videos, --tour, --path and folders of models: -o FILE.mp4, .mov, .mkv or .webm");
  if (options.output == "-") fail("-o -: pictures are files: name one, or a folder");
  if (named && !file && names_a_file(output)) {
    fail(
        "-o {}: pictures are written as .png or .exr, videos as .mp4, .mov, .mkv or .webm; for a folder "
        "of that name, make it first",
        output.string());
  }
  if (file) {
    check_output(output);
    plan.file = output.parent_path() / output.stem();
    plan.png = extension == ".png";
    plan.vr_photo = vr_photo;
    plan.exr = plan.exr || extension == ".exr";
  } else {
    // A name in the folder stands for all of them.
    check_output(output / "picture");
    plan.folder = output;
  }
  plan.layout = plan_layout(options, one_picture, file && extension == ".png", file && extension == ".exr");
  if (plan.layout == LAYOUT_MULTI_VIEW) {
    plan.png = false;
    plan.exr = true;
  }
  if (options.bits && !plan.png && !plan.vr_photo)
    fail("--bits is for PNG: this writes OpenEXR to {}, whose depth --exr sets", output.string());
  if (plan.exr && options.show != SHOW_PICTURE) {
    fail("--show {} is for PNG and videos: it has no light and no depth for OpenEXR",
         show_choices[options.show].name);
  }
  if (options.exr_display && !plan.exr) fail("--exr-encoding is for OpenEXR: add --exr half or --exr float");
  if (options.exr_depth == Depth::median && !plan.exr)
    fail("--exr-depth is for OpenEXR: add --exr half or --exr float");
  if (!options.json.empty()) check_output(options.json);
  if (plan.vr180) plan_vr180(render, plan);
  return plan;
}

void check_shots(const OutputPlan& plan, const std::vector<Shot>& shots, const std::string& json) {
  const fs::path place = json.empty() ? fs::path() : place_of(json);
  for (const Shot& shot : shots) {
    for (const std::string& file : files_of(plan, shot)) {
      check_no_input(file);
      if (!json.empty() && place_of(file) == place)
        fail("--json {}: it is the picture of {}; name another file", json, shot.name);
    }
  }
  if (!plan.file.empty() && shots.size() > 1) {
    std::vector<std::string> names;
    for (const Shot& shot : shots) names.push_back(shot.name);
    constexpr std::size_t few = 4;
    if (names.size() > few) {
      names.resize(few);
      names.emplace_back("...");
    }
    const char* ending = plan.vr_photo ? ".jpg" : plan.png ? ".png" : ".exr";
    fail(
        "-o {}{} is one file, and {} views are to be drawn ({}): name a folder, as -o {}, and each view's "
        "pictures are called after it there; or draw one of them, as --view {}",
        plan.file.string(), ending, shots.size(), fmt::join(names, ", "), plan.file.string(), names[0]);
  }
  for (const Shot& shot : shots) {
    const Camera &a = shots[0].eyes[0].camera, &b = shot.eyes[0].camera;
    if (!plan.video.empty() && (a.width != b.width || a.height != b.height)) {
      fail("-o {}: the views differ in size, {} x {} and {} x {} px: give them one with --size",
           plan.video.string(), a.width, a.height, b.width, b.height);
    }
  }
  if (plan.layout == LAYOUT_SEPARATE) return;
  for (const Shot& shot : shots) {
    const Camera &left = shot.eyes[0].camera, &right = shot.eyes[1].camera;
    if (left.width != right.width || left.height != right.height) {
      fail(
          "--layout {}: the eyes of {} differ in size, {} x {} and {} x {} px: give them one with --size, or "
          "use "
          "--layout separate and a folder",
          layout_choices[plan.layout].name, shot.name, left.width, left.height, right.width, right.height);
    }
    stereo::layout_size(plan.layout, {left.width, left.height});
  }
}

std::unique_ptr<Video> open_video(const OutputPlan& plan, const std::vector<Shot>& shots) {
  if (plan.video.empty()) return nullptr;
  const Camera& eye = shots[0].eyes[0].camera;
  const glm::ivec2 size = stereo::layout_size(plan.layout, {eye.width, eye.height});
  return std::make_unique<Video>(plan.video, size.x, size.y, plan.fps ? *plan.fps : frames_a_second(shots),
                                 plan.layout, plan.vr180);
}

Image frame_of(const OutputPlan& plan, const Background& background, const std::vector<Picture>& pictures) {
  if (plan.layout == LAYOUT_SEPARATE) return composite(pictures[0], background);
  return composite(stereo::lay_out(plan.layout, pictures[0], pictures[1], background), background);
}

std::vector<std::string> files_of(const OutputPlan& plan, const Shot& shot) {
  std::vector<std::string> files;
  for (const std::string& base : bases_of(plan, shot)) {
    if (plan.png) files.push_back(base + ".png");
    if (plan.exr) files.push_back(base + ".exr");
    if (plan.vr_photo) files.push_back(base + ".jpg");
  }
  return files;
}

std::vector<EncodedFile> encode_outputs(const std::string& scene, const OutputOptions& options,
                                        const OutputPlan& plan, const Shot& shot,
                                        const stereo::DebugPictures& shown) {
  const std::vector<Picture>& pictures = shown.pictures;
  const std::vector<std::string> bases = bases_of(plan, shot);
  std::vector<EncodedFile> files;
  if (plan.vr_photo) {
    const std::string name = bases[0] + ".jpg";
    files.push_back({name, vr_photo_bytes(name, composite(pictures[0], options.background),
                                          composite(pictures[1], options.background))});
    return files;
  }
  if (plan.layout == LAYOUT_SEPARATE) {
    for (std::size_t k = 0; k < bases.size(); ++k)
      encode_picture(options, plan, bases[k], pictures[k],
                     notes_of(scene, options, shot, shot.eyes[k].side, shown.most), files);
    return files;
  }
  Notes notes = notes_of(scene, options, shot, "left, right", shown.most);
  notes["binosplatLayout"] = layout_choices[plan.layout].name;
  if (plan.layout == LAYOUT_MULTI_VIEW) {
    const std::string name = bases[0] + ".exr";
    files.push_back({name, exr_bytes(name, pictures[0], pictures[1], exr_options(options, notes))});
  } else {
    encode_picture(options, plan, bases[0],
                   stereo::lay_out(plan.layout, pictures[0], pictures[1], options.background), notes, files);
  }
  return files;
}

}  // namespace binosplat::app
