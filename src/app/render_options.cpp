#include "app/render_options.h"

#include <cctype>
#include <sstream>

#include "app/option_checks.h"
#include "app/tour.h"
#include "base/error.h"
#include "render/stage.h"
#include "scene/axes.h"
#include "shared/axes.h"

namespace binosplat::app {

namespace {

// "1,-2.5,3" as numbers; the whole text must be used up.
glm::dvec3 parse_three(const std::string& option, const std::string& text) {
  glm::dvec3 v{0.0};
  char comma_1 = 0, comma_2 = 0;
  std::istringstream in(text);
  in >> v.x >> comma_1 >> v.y >> comma_2 >> v.z;
  if (!in || comma_1 != ',' || comma_2 != ',' || in.peek() != std::istringstream::traits_type::eof()) {
    fail("{} {}: expected three numbers with commas, as in 1,-2.5,3", option, text);
  }
  return v;
}

// "1280x720" as two numbers above zero; `expected` says what they mean.
glm::ivec2 parse_two(const std::string& option, const std::string& text, const char* expected) {
  glm::ivec2 two{0};
  char cross = 0;
  std::istringstream in(text);
  in >> two.x >> cross >> two.y;
  if (!in || cross != 'x' || in.peek() != std::istringstream::traits_type::eof() || two.x < 1 || two.y < 1) {
    fail("{} {}: expected {}", option, text, expected);
  }
  return two;
}

Background parse_background(const std::string& text) {
  if (text == "none") return std::nullopt;
  const glm::dvec3 rgb = parse_three("--background", text);
  for (int i = 0; i < 3; ++i) {
    if (!(rgb[i] >= 0.0 && rgb[i] <= 1.0))
      fail("--background {}: expected numbers from 0 to 1, or none", text);
  }
  return glm::vec3(rgb);
}

void add_scene_name(CLI::App& sub, RenderOptions& o) {
  sub.add_option("SCENE", o.scene,
                 "A model (ply; SOG as folder, .sog or streamed), or one that is\nbuilt in: demo:room, a "
                 "room, or\ndemo:city, streets of any "
                 "size")
      ->required();
}

void add_scene(CLI::App& sub, RenderOptions& o) {
  const char* const group = "Scene";
  sub.add_option("--lod", o.lod,
                 "Level of detail of a streamed SOG, 0 the finest (the finest that\nis there)")
      ->type_name("N")
      ->check(range(0, 100))
      ->group(group);
  sub.add_option(
         "--detail", o.detail,
         "Of a streamed SOG instead: for each view levels whose Gaussians are\nseen no farther than PX "
         "apart, the same for both eyes (render: the\nfinest, always; view: 0); 0: the finest that fit")
      ->type_name("PX")
      ->check(CLI::NonNegativeNumber.description(""))
      ->group(group);
  sub.add_option(
         "--gpu-memory", o.gpu_memory,
         "Of a streamed SOG: levels, near the eyes the finest, that fit in so\nmany MB; for each view "
         "with --detail, else one choice for all")
      ->type_name("MB")
      ->check(positive)
      ->group(group);
  add_axes_option(sub, o)->group(group);
  auto* antialias =
      sub.add_flag_callback(
             "--antialias", [&o] { o.antialias = true; },
             "Draw as a model that was trained with anti-aliasing (gsplat's,\nMip-Splatting's); by default "
             "what its file says")
          ->group(group);
  sub.add_flag_callback(
         "--no-antialias", [&o] { o.antialias = false; }, "Draw as one that was not")
      ->excludes(antialias)
      ->group(group);
  sub.add_option(
         "--kernel-px2", o.kernel_px2,
         "Variance of the low-pass of projected Gaussians in px^2 (0.3; 0.1\nfor Mip-Splatting's files)")
      ->type_name("S")
      ->check(positive)
      ->group(group);
  sub.add_option("--appearance", o.appearance,
                 "Which of the appearances that a Scaffold-GS model was trained with\n(0)")
      ->type_name("ID")
      ->check(whole)
      ->group(group);
  sub.add_option("--seed", o.seed, "Which demo:city (1)")->type_name("N")->check(whole)->group(group);
  sub.add_option("--count", o.count, "Gaussians of demo:city, 10000 to 100000000 (1000000)")
      ->type_name("N")
      ->check(whole)
      ->group(group);
  sub.add_option_function<std::string>(
         "--repeat",
         [&o](const std::string& text) {
           o.repeat = parse_two("--repeat", text, "copies along x and z as NXxNZ, for one 4x4");
         },
         "Copies of the scene along x and z; needs --spacing")
      ->type_name("NXxNZ")
      ->group(group);
  sub.add_option("--spacing", o.spacing, "From one copy to the next, in world units")
      ->type_name("S")
      ->check(positive)
      ->group(group);
}

void add_cameras(CLI::App& sub, RenderOptions& o) {
  const auto three = [&sub](const char* name, std::optional<glm::dvec3>& into, const char* help) {
    return sub
        .add_option_function<std::string>(
            name, [name, &into](const std::string& text) { into = parse_three(name, text); }, help)
        ->type_name("X,Y,Z");
  };
  const char* const group = "Cameras";
  sub.add_option("--cameras", o.cameras,
                 "cameras.json, transforms.json or the folder of a COLMAP reconstruction;\ndefault: what "
                 "lies beside the model")
      ->type_name("FILE|DIR")
      ->group(group);
  sub.add_option("--view", o.views,
                 "Cameras to draw by name, or all; default: the first. NAME also\nmeans the pair NAME_left, "
                 "NAME_right")
      ->type_name("NAME")
      ->group(group);
  sub.add_option(
         "--path", o.path,
         "cameras.json whose cameras are frames of one path: each goes by\nwhat the last one measured")
      ->type_name("FILE")
      ->group(group);
  three("--eye", o.eye, "Camera position instead, in world units")->group(group);
  three("--at", o.at, "What it looks at")->group(group);
  three("--up", o.up, "What is up in the picture (0,-1,0); for --eye, --orbit and\nmodels without cameras")
      ->group(group);
  sub.add_option("--fov", o.fov, "Vertical field of view of such cameras (60)")
      ->type_name("DEGREES")
      ->check(positive)
      ->group(group);
  sub.add_option("--orbit", o.orbit, "N cameras around the model instead")
      ->type_name("N")
      ->check(range(1, 10000))
      ->group(group);
  sub.add_option_function<std::string>(
         "--size", [&o](const std::string& text) { o.size = parse_size("--size", text); },
         "Pixels of each eye; keeps the vertical field of view")
      ->type_name("WxH")
      ->group(group);
  sub.add_option("--preset", o.preset,
                 "preview: 1280 x 720 an eye; headset: 3660 x 3200 an eye,\n100 degrees")
      ->check(one_of<std::string>({"preview", "headset"}))
      ->type_name("preview|headset")
      ->group(group);
  sub.add_option("--near", o.near_plane,
                 "Nothing nearer is drawn, in world units (0.2; less for tiny\nmodels without cameras)")
      ->type_name("DEPTH")
      ->check(positive)
      ->group(group);
}

void add_rig(CLI::App& sub, RenderOptions& o) {
  const char* const group = "Both eyes";
  sub.add_flag("--mono", o.mono, "Draw the camera itself, one picture")->group(group);
  sub.add_option("--only", o.only, "Draw one eye of the pair")
      ->check(one_of<std::string>({"left", "right"}))
      ->type_name("left|right")
      ->group(group);
  sub.add_option("--ipd", o.ipd, "Distance between the eyes (0.063)")->type_name("METRES")->group(group);
  sub.add_option("--units-per-metre", o.units_per_metre, "World units that make a metre (1)")
      ->type_name("N")
      ->check(positive)
      ->group(group);
  sub.add_option("--convergence", o.convergence, "Distance without disparity (infinite)")
      ->type_name("METRES")
      ->group(group);
  sub.add_option("--cant", o.cant, "Turn each eye outwards (0)")->type_name("DEGREES")->group(group);
}

void add_frame(CLI::App& sub, RenderOptions& o) {
  const char* const group = "Drawing";
  choose(sub, "--tiles", o.tiles, "Which tiles a Gaussian is drawn in (ellipse)", tiles_choices)
      ->group(group);
  choose(sub, "--th", o.th,
         "The alpha below which a Gaussian is left out of a tile (tau;\nwith --loss: squared)", th_choices)
      ->group(group);
  sub.add_option("--loss", o.loss, "How much that may cost, in the unit of --th")
      ->type_name("X")
      ->check(CLI::NonNegativeNumber.description(""))
      ->group(group);
  sub.add_option(
         "--quality", o.quality,
         "Choose the loss so that pictures come to about DB against the exact\nones, from the first frame "
         "on: one in four draws some tiles exactly, too")
      ->type_name("DB")
      ->check(positive)
      ->group(group);
  sub.add_option("--calibration", o.calibration, "Take the loss from a file of binosplat calibrate")
      ->type_name("FILE")
      ->group(group);
  choose(sub, "--transmittance", o.transmittance, "The light that reaches a Gaussian, for --th (one)",
         transmittance_choices)
      ->group(group);
  choose(sub, "--decode", o.decode, "For which eye a Scaffold-GS model makes its Gaussians (eyes)",
         decode_choices)
      ->group(group);
  sub.add_option("--tile", o.tile, "Side of a tile in px (auto: 16)")
      ->check(one_of<std::string>({"auto", "8", "16", "32"}))
      ->type_name("auto|8|16|32")
      ->group(group);
  choose(sub, "--precision", o.precision, "What is kept of the model and of a frame (full)",
         precision_choices)
      ->group(group);
  sub.add_option(
         "--reference-until", o.reference_until,
         "Take the stages up to this one from the float64 reference: decode\n(Scaffold-GS), project, order, "
         "pairs, tile_sort, ranges or blend")
      ->check(CLI::IsMember(std::vector<std::string>(render::stage_names.begin(),
                                                     render::stage_names.begin() + render::stages_with_twins))
                  .description(""))
      ->type_name("STAGE")
      ->group(group);
  sub.add_option("--frames", o.frames, "Draw each view N times, for the table of times (1)")
      ->type_name("N")
      ->check(range(1, 100000))
      ->group(group);
  sub.add_option(
         "--backend", o.backend,
         "Where OpenGL comes from: a GPU through EGL's devices, Mesa without\na GPU, Mesa without EGL, "
         "or the first that works (auto)")
      ->check(one_of<std::string>({"auto", "device", "surfaceless", "osmesa"}))
      ->type_name("auto|device|surfaceless|osmesa")
      ->group(group);
  sub.add_option("--device", o.device, "Number of the EGL device")
      ->type_name("N")
      ->check(range(0, 1000))
      ->group(group);
  sub.add_option("--shader-dir", o.shader_dir, "Read shaders from this folder, not the built-in ones")
      ->type_name("DIR")
      ->check(folder())
      ->group(group);
}

// What files and the preview share.
void add_look(CLI::App& sub, RenderOptions& o) {
  const char* const group = "Outputs";
  choose(sub, "--layout", o.layout,
         "How both eyes are shown (a folder: separate; FILE.png and videos:\nparallel; FILE.exr: multi-view)",
         layout_choices)
      ->group(group);
  choose(sub, "--show", o.show,
         "What is shown in place of the picture; numbers as colours from 0\n(dark) to yellow (picture)",
         show_choices)
      ->group(group);
  sub.add_option_function<std::string>(
         "--background", [&o](const std::string& text) { o.background = parse_background(text); },
         "Colour behind the model, 0 to 1, or none: keep alpha (0,0,0)")
      ->type_name("R,G,B|none")
      ->group(group);
}

void add_outputs(CLI::App& sub, RenderOptions& o) {
  const char* const group = "Outputs";
  sub.add_option(
         "-o,--output", o.output,
         "A folder for NAME_left.png, NAME_right.png (NAME.png with --mono),\nor FILE.png or "
         "FILE.exr with both eyes, or a video of all views:\nFILE.mp4, .mov, .mkv or .webm, by ffmpeg "
         "(out/SCENE)")
      ->type_name("DIR|FILE")
      ->group(group);
  add_look(sub, o);
  sub.add_option("--fps", o.fps, "Frames a second of a video (by the path's times, or 30) or of a tour")
      ->type_name("N")
      ->check(positive)
      ->group(group);
  sub.add_option("--bits", o.bits, "Bits a channel of PNG (8)")
      ->check(one_of({8, 16}))
      ->type_name("8|16")
      ->group(group);
  sub.add_option("--exr", o.exr, "Write OpenEXR too, with depth; half where only -o FILE.exr asks")
      ->check(one_of<std::string>({"half", "float"}))
      ->type_name("half|float")
      ->group(group);
  sub.add_option("--exr-encoding", o.exr_encoding, "Scene-linear light, or display values as in PNG (linear)")
      ->check(one_of<std::string>({"linear", "display"}))
      ->type_name("linear|display")
      ->group(group);
  sub.add_option(
         "--photos", o.photos,
         "Print PSNR against DIR/NAME.jpg or .png, or the photos found beside\nthe cameras; with --mono")
      ->type_name(fmt::format("DIR|{}", photos_beside))
      ->check(folder() | CLI::IsMember({photos_beside}).description(""))
      ->group(group);
  sub.add_option("--json", o.json, "Write everything printed as JSON")->type_name("FILE")->group(group);
}

}  // namespace

CLI::Option* add_axes_option(CLI::App& sub, RenderOptions& o) {
  return sub
      .add_option_function<std::string>(
          "--axes",
          [&o](const std::string& text) {
            for (const char c : text)
              o.axes += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
            world_from_axes(o.axes);
          },
          "Where the model's x, y and z point in the cameras' world, by Right\nor Left, Up or Down, Forward "
          "or Back, "
          "as in rdf, rub (the format's)")
      ->type_name("XYZ");
}

void add_measured_options(CLI::App& sub, RenderOptions& o) {
  sub.add_option("--near", o.near_plane, "Nothing nearer is drawn, in world units (0.2)")
      ->type_name("DEPTH")
      ->check(positive);
  sub.add_option("--count", o.count, "Gaussians of demo:city (1000000)")->type_name("N")->check(whole);
  sub.add_option("--seed", o.seed, "Which demo:city (1)")->type_name("N")->check(whole);
  sub.add_option("--backend", o.backend, "A GPU, else Mesa; or Mesa without a GPU (auto)")
      ->check(one_of<std::string>({"auto", "surfaceless"}))
      ->type_name("auto|surfaceless");
  sub.add_option("--device", o.device, "Number of the EGL device")->type_name("N")->check(range(0, 1000));
}

void add_view_options(CLI::App& sub, RenderOptions& options) {
  add_scene_name(sub, options);
  add_scene(sub, options);
  add_cameras(sub, options);
  add_rig(sub, options);
  add_frame(sub, options);
  add_look(sub, options);
  sub.add_option("-o,--output", options.output, "A folder for pictures and paths (out/SCENE)")
      ->type_name("DIR")
      ->group("Outputs");
}

void add_options(CLI::App& sub, RenderOptions& options) {
  add_scene_name(sub, options);
  add_scene(sub, options);
  sub.add_flag("--detail-report", options.detail_report,
               "Print PSNR against the finest levels, and between those before and\nafter each switch")
      ->group("Scene");
  add_cameras(sub, options);
  add_tour_options(sub, options);
  add_rig(sub, options);
  add_frame(sub, options);
  add_outputs(sub, options);
}

glm::ivec2 parse_size(const std::string& option, const std::string& text) {
  return parse_two(option, text, "pixels as WIDTHxHEIGHT, for one 1280x720");
}

}  // namespace binosplat::app
