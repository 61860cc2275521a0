#include "app/render/outputs.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <set>

#include "app/command.h"
#include "app/options/parse.h"
#include "app/render/tour.h"
#include "base/inputs.h"
#include "base/output_file.h"
#include "base/text.h"
#include "formats/pictures/exr.h"
#include "formats/pictures/image_file.h"
#include "formats/pictures/vr_photo.h"
#include "stereo/layout.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

bool has(const Outputs& outputs, const char* ending) {
  return std::ranges::count(outputs.endings, ending) > 0;
}

// Metadata of a picture: how it was drawn, with the units per metre, because a stereo picture is right at one
// scale only.
Notes notes_of(const PictureFile& file, const Options& render, const Outputs& outputs, const Shot& shot,
               const std::optional<double>& max_shown) {
  Notes notes = {{"Software", "binosplat " BINOSPLAT_VERSION},
                 {"binosplatScene", render.scene.name},
                 {"binosplatView", shot.name},
                 {"binosplatUnitsPerMetre", fmt::format("{}", shot.units_per_metre)}};
  const std::string side = file.eye ? shot.eyes[*file.eye].side : "left, right";
  if (!side.empty()) notes["binosplatEye"] = side;
  if (!file.eye) notes["binosplatLayout"] = layout_choices[outputs.layout].name;
  if (max_shown)
    notes["binosplatShow"] = fmt::format("{}, 0 to {}", show_choices[render.picture.show].name, *max_shown);
  if (render.picture.exr_depth == DepthKind::median) notes["binosplatDepth"] = "median";
  if (shot.ipd) notes["binosplatIpdMetres"] = fmt::format("{}", *shot.ipd);
  return notes;
}

// The requested layout, or else one that fits the output: a folder, or a file with this ending.
int layout_of(const Options& render, bool video, const std::string& ending) {
  const PictureOptions& options = render.picture;
  const bool one_picture = render.rig.one_picture(), exr_file = ending == ".exr",
             picture_file = video || ending == ".png";
  if (!options.layout) {
    const bool vr180 = render.camera.lens.vr180() && !exr_file && !options.exr_half;
    return one_picture             ? LAYOUT_SEPARATE
           : vr180 || picture_file ? LAYOUT_PARALLEL
           : exr_file              ? LAYOUT_MULTI_VIEW
                                   : LAYOUT_SEPARATE;
  }
  const int layout = *options.layout;
  const char* const name = layout_choices[layout].name;
  if (one_picture) fail("--layout {} needs both eyes: leave --mono and --only out", name);
  if (layout == LAYOUT_QUAD_BUFFER)
    fail("--layout quad-buffer is for `binosplat view`: a file has no buffers");
  if (layout == LAYOUT_SEPARATE && (picture_file || exr_file))
    fail("--layout separate writes a file for each eye: -o {} must be a folder", render.output);
  if (layout == LAYOUT_MULTI_VIEW && picture_file)
    fail("--layout multi-view is OpenEXR's: -o {} must be a folder or an .exr", render.output);
  if (stereo::mixes_colours(layout) && (exr_file || options.exr_half)) {
    fail("--layout {} mixes both eyes' display colours, which have no light and no depth: write PNG only",
         name);
  }
  if (stereo::mixes_colours(layout) && !options.background) {
    fail("--layout {} mixes both eyes' colours and leaves no alpha: --background none is not for it", name);
  }
  return layout;
}

// Frame rate from the times of a path's cameras if they are evenly spaced, else the default.
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

// Whether the path ends like a file, such as .gif or .jp2. Folders may end in .2 or .v2.
bool looks_like_file(const fs::path& path) {
  const std::string ending = lowered_ending(path);
  std::error_code ignored;
  if (ending.size() < 3 || ending.size() > 5 || fs::is_directory(path, ignored)) return false;
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  return std::all_of(ending.begin() + 1, ending.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0; }) &&
         std::count_if(ending.begin() + 1, ending.end(), is_letter) > 1;
}

// Whether the name is a generic one of trainers and exporters, possibly with a number.
bool is_generic_name(std::string name) {
  while (!name.empty() && (std::isdigit(static_cast<unsigned char>(name.back())) != 0 || name.back() == '_' ||
                           name.back() == '-'))
    name.pop_back();
  static const std::set<std::string> said = {
      "",       "point_cloud", "iteration", "ply",  "splat",    "splats", "model",     "scene",
      "output", "export",      "exports",   "meta", "lod-meta", "step",   "gaussians", "exported"};
  return said.contains(name);
}

// The file in a folder of pictures that has the full path of their model, or the name of the built-in scene.
constexpr const char* owner_name = "model.txt";

fs::path path_of(const std::string& scene) {
  if (is_built_in(scene)) return scene;
  const fs::path path = fs::absolute(scene).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

// Empty if no run has claimed the folder.
fs::path owner_of(const fs::path& folder) {
  std::ifstream file(folder / owner_name);
  std::string owner;
  std::getline(file, owner);
  return owner;
}

// Whether the folder holds pictures of another model.
bool belongs_to_other_model(const fs::path& folder, const fs::path& model) {
  const fs::path owner = owner_of(folder);
  return !owner.empty() && owner != model;
}

// The name, with prefixes or a number if another model has taken it.
std::string free_name(std::string name, const fs::path& model) {
  const auto is_taken = [&](const std::string& asked) {
    return belongs_to_other_model(fs::path("out") / asked, model);
  };
  for (fs::path path = model.parent_path(); is_taken(name) && path.has_relative_path();
       path = path.parent_path())
    name = path.filename().string() + "_" + name;
  const std::string all = name;
  for (int n = 2; is_taken(name); ++n) name = fmt::format("{}_{}", all, n);
  return name;
}

// The shot's stem. In VR180 it has a suffix, by which players recognise the layout.
std::string stem_in_folder(const Outputs& outputs, const Shot& shot) {
  if (!outputs.vr180) return shot.stem;
  return shot.stem + (outputs.layout == LAYOUT_PARALLEL     ? "_180_LR"
                      : outputs.layout == LAYOUT_OVER_UNDER ? "_180_TB"
                                                            : "_180");
}

std::vector<PictureFile> files_of(const Outputs& outputs, const Shot& shot) {
  const bool apart = outputs.layout == LAYOUT_SEPARATE;
  std::vector<PictureFile> files;
  for (std::size_t k = 0; k < (apart ? shot.eyes.size() : 1); ++k) {
    const std::optional<std::size_t> eye = apart ? std::optional(k) : std::nullopt;
    if (outputs.video) return {{outputs.file, eye}};
    std::string base = outputs.folder.empty() ? outputs.file.parent_path() / outputs.file.stem()
                                              : outputs.folder / stem_in_folder(outputs, shot);
    if (apart && !outputs.folder.empty() && !shot.eyes[k].side.empty()) base += "_" + shot.eyes[k].side;
    for (const std::string& ending : outputs.endings) files.push_back({base + ending, eye});
  }
  return files;
}

void check_formats(const Options& render, const Outputs& outputs) {
  const PictureOptions& o = render.picture;
  const bool exr = has(outputs, ".exr"), vr_photo = has(outputs, ".jpg");
  const bool of_png = o.bits || o.png_level;
  const bool of_exr = o.exr_display || o.exr_depth || o.exr_compression;
  if (outputs.video && (of_png || o.exr_half || of_exr))
    fail("--bits, --png-level, --exr and --exr-... are for pictures: -o {} is a video", render.output);
  if (outputs.video && !o.background) fail("--background none: a video has no alpha");
  if (vr_photo && (render.rig.one_picture() || o.layout || !o.background || o.exr_half || of_png)) {
    fail(
        "-o {}: a VR photo holds both eyes, each by itself, opaque and of 8 bits: leave --mono, "
        "--layout, --exr, --bits, --png-level and --background none out",
        render.output);
  }
  if (of_png && !has(outputs, ".png"))
    fail("--bits and --png-level are for PNG: this writes OpenEXR to {}, whose precision --exr sets",
         (outputs.folder.empty() ? outputs.file : outputs.folder).string());
  if (exr && o.show != SHOW_PICTURE) {
    fail("--show {} is for PNG and videos: it has no light and no depth for OpenEXR",
         show_choices[o.show].name);
  }
  if (of_exr && !exr)
    fail("--exr-encoding, --exr-depth and --exr-compression are for OpenEXR: add --exr half or --exr float");
}

}  // namespace

fs::path default_folder(const std::string& scene) {
  const fs::path model = path_of(scene);
  if (is_built_in(scene)) return fs::path("out") / free_name(scene.substr(scene.find(':') + 1), model);
  fs::path path = model;
  std::error_code ignored;
  std::string name = fs::is_directory(path, ignored) ? path.filename().string() : path.stem().string();
  // A number distinguishes models of one training, such as iteration_7000.
  std::string number;
  while (is_generic_name(name) && path.has_relative_path()) {
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
  if (!file.commit_as_first() && belongs_to_other_model(folder, model))
    fail("{}: another run has begun to draw another model there: start again, or name a folder with -o",
         folder.string());
}

Outputs outputs_of(const Options& render) {
  const PictureOptions& options = render.picture;
  const bool named = !render.output.empty();  // else a folder, even if the model's name has an ending
  const fs::path output = named ? fs::path(render.output) : default_folder(render.scene.name);
  const std::string ending = named ? lowered_ending(output) : "";
  Outputs outputs;
  outputs.video = named && is_video(output);
  outputs.vr180 = render.camera.lens.vr180();
  const bool vr_photo = outputs.vr180 && ending == ".jpg";
  const bool is_file = outputs.video || ending == ".png" || ending == ".exr" || vr_photo;
  if (is_file && (!render.shard.all() || render.resume))
    fail("--shard and --resume are for a folder of pictures, and -o {} is one file: name a folder",
         output.string());
  if (options.fps && !outputs.video && !render.camera.along_path())
    fail("--fps is for videos, --tour and --path: -o FILE.mp4, .mov, .mkv or .webm");
  if (named && !is_file && looks_like_file(output)) {
    fail(
        "-o {}: pictures are written as .png or .exr, videos as .mp4, .mov, .mkv or .webm; for a folder "
        "of that name, make it first",
        output.string());
  }
  check_output(is_file ? output : output / "picture");  // "picture" represents any name in the folder
  if (outputs.video) check_ffmpeg();
  (is_file ? outputs.file : outputs.folder) = output;
  outputs.fps = options.fps;
  if (render.camera.tour && !options.fps) outputs.fps = outputs.video ? video_fps : headset_fps;
  outputs.layout = layout_of(render, outputs.video, ending);
  const bool only_exr = ending == ".exr" || outputs.layout == LAYOUT_MULTI_VIEW;
  if (vr_photo) {
    outputs.endings = {".jpg"};
  } else if (!outputs.video) {
    if (!only_exr) outputs.endings.emplace_back(".png");
    if (only_exr || options.exr_half) outputs.endings.emplace_back(".exr");
  }
  check_formats(render, outputs);
  return outputs;
}

void place_files(const Outputs& outputs, const std::string& json, std::vector<Shot>& shots) {
  if (!outputs.video && !outputs.file.empty() && shots.size() > 1) {
    std::vector<std::string> names;
    for (const Shot& shot : shots) names.push_back(shot.name);
    constexpr std::size_t max_listed = 4;
    if (names.size() > max_listed) {
      names.resize(max_listed);
      names.emplace_back("...");
    }
    fail(
        "-o {} is one file for {} views ({}): name a folder, as -o {}, for a file named after each view, or "
        "draw one view, as --view {}",
        outputs.file.string(), shots.size(), fmt::join(names, ", "),
        (outputs.file.parent_path() / outputs.file.stem()).string(), names[0]);
  }
  const fs::path place = json.empty() ? fs::path() : place_of(json);
  const auto differ = [](const Camera& a, const Camera& b) {
    return a.width != b.width || a.height != b.height;
  };
  const Camera& first = shots[0].eyes[0].camera;
  for (Shot& shot : shots) {
    shot.files = files_of(outputs, shot);
    for (const PictureFile& file : shot.files) {
      check_no_input(file.name);
      if (!json.empty() && place_of(file.name) == place)
        fail("--json {}: it is the picture of {}; name another file", json, shot.name);
    }
    const Camera &left = shot.eyes.front().camera, &right = shot.eyes.back().camera;
    if (outputs.video && differ(first, left)) {
      fail("-o {}: the views differ in size, {} x {} and {} x {} px: give them one with --size",
           outputs.file.string(), first.width, first.height, left.width, left.height);
    }
    if (outputs.layout == LAYOUT_SEPARATE) continue;
    if (differ(left, right)) {
      fail(
          "--layout {}: the eyes of {} differ in size, {} x {} and {} x {} px: give them one with --size, or "
          "use --layout separate and a folder",
          layout_choices[outputs.layout].name, shot.name, left.width, left.height, right.width, right.height);
    }
    stereo::layout_size(outputs.layout, {left.width, left.height});  // throws Error for odd sizes
  }
}

std::unique_ptr<Video> open_video(const Outputs& outputs, const std::vector<Shot>& shots) {
  if (!outputs.video) return nullptr;
  const Camera& eye = shots[0].eyes[0].camera;
  const glm::ivec2 size = stereo::layout_size(outputs.layout, {eye.width, eye.height});
  return std::make_unique<Video>(outputs.file, size.x, size.y,
                                 outputs.fps ? *outputs.fps : frames_a_second(shots), outputs.layout,
                                 outputs.vr180);
}

std::string encoded(const PictureFile& file, const Options& render, const Outputs& outputs, const Shot& shot,
                    const stereo::DebugPictures& shown) {
  const PictureOptions& o = render.picture;
  const std::vector<Picture>& pictures = shown.pictures;
  if (has(outputs, ".jpg"))
    return vr_photo_bytes(file.name, composite(pictures[0], o.background),
                          composite(pictures[1], o.background));
  const Notes notes = notes_of(file, render, outputs, shot, shown.max);
  const ExrOptions exr{o.exr_half.value_or(true), o.exr_display.value_or(false), o.background, notes,
                       o.exr_compression.value_or(ExrCompression::rle)};
  if (outputs.layout == LAYOUT_MULTI_VIEW) return exr_bytes(file.name, pictures[0], pictures[1], exr);
  const Picture both =
      file.eye ? Picture() : stereo::lay_out(outputs.layout, pictures[0], pictures[1], o.background);
  const Picture& picture = file.eye ? pictures[*file.eye] : both;
  if (file.name.ends_with(".exr")) return exr_bytes(file.name, picture, exr);
  const Image image = composite(picture, o.background);
  return outputs.video ? Video::bytes_of(image)
                       : png_bytes(image, {o.bits.value_or(8), o.png_level.value_or(1), notes});
}

}  // namespace binosplat::app
