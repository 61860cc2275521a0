#include "app/options/table.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "app/options/parse.h"
#include "app/options/values.h"
#include "base/log.h"
#include "formats/models/registry.h"
#include "lab/bench_settings.h"
#include "lab/suite.h"
#include "measure/reference_stages.h"
#include "render/frame_settings.h"

namespace binosplat::app {

namespace {

Value three_numbers(const char* option, std::optional<glm::dvec3>& into) {
  return parsed("X,Y,Z", into, [option](const std::string& text) { return parse_three(option, text); });
}

Value pixels(std::optional<glm::ivec2>& into) {
  return parsed("WxH", into, [](const std::string& text) {
    return parse_two("--size", text, "pixels as WIDTHxHEIGHT, for one 1280x720");
  });
}

CLI::Validator decibels() {
  return between(render::min_quality, render::max_quality, "decibels from 10 to 100");
}

Value stage_with_reference(std::optional<render::Stage>& into) {
  Words<render::Stage> stages;
  for (int k = 0; k < render::stages_with_reference; ++k)
    stages.emplace_back(render::name_of(static_cast<render::Stage>(k)), static_cast<render::Stage>(k));
  Value result = one_of<render::Stage>(into, stages);
  result.type = "STAGE";
  return result;
}

Value motion(std::optional<Motion>& into) {
  Value result = parsed("calm|walk|fast|M,DEG", into, parse_motion);
  for (const Motion& each : head_motions())
    result.choices += fmt::format("\n  {}: {} m and {} degrees a second", each.name, each.metres_per_second,
                                  each.degrees_per_second);
  return result;
}

Value format_to_write(std::optional<ModelFormat>& into) {
  Words<ModelFormat> formats;
  for (const ModelFormat format : written_formats()) formats.emplace_back(word_of(format), format);
  return one_of<ModelFormat>(into, formats);
}

Value backend(gl::Backend& into) {
  return one_of<gl::Backend>(into, {{"auto", gl::Backend::automatic},
                                    {"device", gl::Backend::device},
                                    {"surfaceless", gl::Backend::surfaceless},
                                    {"osmesa", gl::Backend::osmesa}});
}

std::vector<Row> scene_rows(Options& o) {
  const std::string model = "A model file or folder, demo:room or demo:city";
  const auto file = [&](const char* name, unsigned commands, const std::string& help) {
    return Row{name, commands, value("", o.scene.name), help, "", is::required | is::input};
  };
  return {
      file("SCENE", in::pictures,
           "A model's file or folder, in one of the formats " + names_of_formats() +
               "; or a built-in one: demo:room, a room, or demo:city, streets of any size"),
      file("SCENE", in::calibrate, model),
      {"SCENE", in::bench, value("", o.bench.scenes), "Models, demo:room or demo:city", "",
       is::required | is::input},
      file("MODEL", in::fits | in::convert | in::levels | in::info, model),
      {"--format", in::models,
       parsed("NAME", o.scene.format, [](const std::string& name) { return row_named(name).name; }),
       "Read the model as spz, .splat or another of the formats, whatever its content seems to be"},
      {"--lod", in::pictures | in::fits | in::convert | in::levels | in::info,
       value("N", o.scene.lod, range(0, 100)), "Level of detail of a streamed SOG, 0 the finest",
       "the finest complete one"},
      {"--detail", in::pictures,
       parsed("Npx|NdB", o.scene.detail, [](const std::string& text) { return lab::parse_detail(text); }),
       "Levels of a streamed SOG for each view, the same for both eyes. 5px: neighbouring Gaussians at most "
       "5 px apart, 0px the finest that fit; 40dB (20 to 80): that PSNR against the finest, in folders of "
       "`binosplat levels`",
       "render: the finest, always; view: 0px"},
      {"--gpu-memory", in::pictures, value("MB", o.scene.gpu_memory, positive()),
       "Choose levels of a streamed SOG that fit into MB, the finest near the eyes; for each view with "
       "--detail, else one choice for all"},
      {"--axes", in::pictures | in::fits | in::convert | in::levels, parsed("XYZ", o.scene.axes, parse_axes),
       "Directions of the model's x, y and z in the cameras' world: Right or Left, Up or Down, Forward or "
       "Back, as in rdf or rub",
       "the format's; for an spz without them: by its cameras"},
      {"--antialias", in::pictures, action([&o] { o.scene.antialias = true; }),
       "Draw as a model that was trained with anti-aliasing (gsplat's, Mip-Splatting's)",
       "as its file, or the run beside it, says"},
      {"--no-antialias", in::pictures, action([&o] { o.scene.antialias = false; }),
       "Draw as a model that was trained without it"},
      {"--eps2d", in::pictures, value("PX2", o.scene.kernel_px2, positive()),
       "Low-pass: variance in px^2 that each projected Gaussian gains, as gsplat's eps2d",
       "0.3; 0.1 for Mip-Splatting's files"},
      {"--appearance", in::pictures, value("N", o.scene.appearance, whole_number()),
       "Row of a Scaffold-GS model's appearance embedding", "0"},
      {"--seed", in::pictures | in::measures | in::convert | in::levels,
       value("N", o.scene.seed, whole_number()), "Seed of demo:city", "1"},
      {"--count", in::pictures | in::measures | in::convert | in::levels,
       value("N", o.scene.count, whole_number()), "Gaussians of demo:city, 10000 to 100000000", "1000000"},
      {"--repeat", in::pictures | in::levels,
       parsed("NXxNZ", o.scene.repeat,
              [](const std::string& text) {
                return parse_two("--repeat", text, "copies along x and z as NXxNZ, for one 4x4");
              }),
       "Copies of the scene along x and z; needs --spacing"},
      {"--spacing", in::pictures | in::levels, value("S", o.scene.spacing, positive()),
       "Distance between copies, in world units"},
      {"--place", in::pictures | in::convert | in::info, value("FILE", o.scene.place, existing_file()),
       "Other models in the scene's world: JSON, a list of {\"model\": PATH or demo:room, \"matrix\": 16 "
       "numbers as in a node of glTF, \"opacity\": 0 to 1}",
       "", is::input},
  };
}

std::vector<Row> view_rows(Options& o) {
  CameraOptions& c = o.camera;
  return {
      {"--cameras", in::pictures | in::measures, value("FILE|DIR", c.file),
       "cameras.json, transforms.json, camera_path.json, a glTF with cameras or the folder of a COLMAP "
       "reconstruction",
       "the cameras beside the model", is::input},
      {"--cameras", in::info, value("FILE|DIR", c.file),
       "Draw the views of these cameras, and count the Gaussians that they show", "", is::input},
      {"--view", in::render, names("NAME", c.views),
       "A camera by name, or all; repeat it for more, or give A,B unless a camera has that name. NAME also "
       "selects the pair NAME_left, NAME_right",
       "the first"},
      {"--view", in::view, names("NAME", c.views), "The camera to start at, by name", "the first"},
      {"--view", in::profile, names("NAME", c.views), "Stand still at this camera"},
      {"--view", in::bench, names("NAME", c.views), "Views by name, instead of as many as the suite says"},
      {"--view", in::calibrate, names("NAME", c.views), "Views by name, instead of --views"},
      {"--views", in::calibrate, value("N", o.split.count, range(1, 10000)),
       "Number of views, spread evenly over the cameras", "16"},
      {"--views", in::trim, value("N", o.split.count, range(1, 10000)),
       "Number of validation views (with a photo), spread evenly, at most half of the cameras; they "
       "validate, and the others weigh Gaussians",
       "16"},
      {"--views", in::refit, value("N", o.split.count, range(1, 10000)),
       "Number of validation views (with a photo), spread evenly, at most a quarter of the views; they "
       "validate, and the others are fitted",
       "4"},
      {"--views", in::info, flag(o.list_views), "List the views instead, by the names that --view takes"},
      {"--validation", in::fits, names("NAME", o.split.validation),
       "Validation views by name, instead of --views, as A,B: photos that the model was not trained on "
       "validate best"},
      {"--test", in::fits, names("NAME", o.split.tests), "Views by name that are only measured"},
      {"--test", in::bench, names("NAME", o.split.tests),
       "Views to measure, by name, if others are for training"},
      {"--test-every", in::bench | in::calibrate, value("N", o.split.test_every, range(2, 1000000)),
       "Take every Nth view, by name, as a test view, on which no tolerance is found",
       "8, or the views that INRIA's cameras.json lists first"},
  };
}

std::vector<Row> camera_rows(Options& o) {
  CameraOptions& c = o.camera;
  const unsigned drawn = in::render | in::profile;
  return {
      {"--path", drawn, value("FILE", c.path),
       "Camera path: cameras.json, nerfstudio's or LichtFeld Studio's JSON, or EyeNavGS's csv, of keys (as "
       "`view` saves them) or of frames; each frame uses the measurements of the one before",
       "", is::input},
      {"--path", in::bench, value("FILE", c.path),
       "Measure along the cameras of this file; a path through keys has 90 frames a second", "", is::input},
      {"--eye", in::pictures, three_numbers("--eye", c.eye),
       "Position of a camera of your own, in world units; needs --at"},
      {"--at", in::pictures, three_numbers("--at", c.at), "Point that --eye looks at, in world units"},
      {"--up", in::pictures, three_numbers("--up", c.up),
       "Up direction of --eye, --orbit and models without cameras",
       "from the cameras, or else from the model"},
      {"--fov", in::pictures, value("DEGREES", c.fov, between(1e-6, 179.999999, "degrees between 0 and 180")),
       "Vertical field of view of --eye, --orbit and models without cameras", "60"},
      {"--orbit", in::render, value("N", c.orbit, range(1, 10000)),
       "N cameras around the model, in place of its own"},
      {"--frame", in::pictures,
       one_of<Viewpoint::Kind>(c.frame, {{"all", Viewpoint::Kind::whole}, {"middle", Viewpoint::Kind::core}}),
       "A camera of the model, in place of its own: all of it, or its middle"},
      {"--size", drawn, pixels(c.lens.size), "Pixels of each eye; keeps the vertical field of view"},
      {"--size", in::view, pixels(c.lens.size), "Pixels of the window",
       "1280x720, or more where displays are dense"},
      {"--size", in::calibrate | in::fits, pixels(c.lens.size), "Pixels of a view", "the cameras' own"},
      {"--size", in::bench, value("WxH|NAME", o.bench.size), "Pixels of a view, or preview, headset or own",
       "the suite's"},
      {"--preset", drawn,
       one_of<const char*>(c.lens.preset, {{"preview", "preview"}, {"headset", "headset"}}),
       "preview: 1280 x 720 an eye; headset: 3660 x 3200 an eye, 100 degrees",
       "profile without --size: headset"},
      {"--near", in::pictures | in::measures | in::levels | in::info,
       value("DEPTH", c.near_plane, positive()), "Near plane, in world units",
       "that of the training, if a file says it; else 0.2, or 0.01 if the cameras reach to 1 unit, or less "
       "for tiny models without cameras"},
      {"--vr180", in::render, action([&c] { c.lens.preset = "vr180"; }),
       "Draw VR180: level, 180 degrees wide and high ahead of each eye (equirectangular, 2048 x 2048 px an "
       "eye, or --size); .png, or .vr.jpg, .mp4 and .mov with VR180's metadata"},
      {"--tour", drawn, motion(c.tour),
       "Move through all cameras as a head does, --fps frames a second, in metres of --units-per-metre; "
       "M,DEG: metres and degrees a second",
       "profile: walk"},
      {"--tour", in::bench, motion(c.tour),
       "Measure along a tour of all cameras, 90 frames a second; M,DEG: metres and degrees a second"},
      {"--keys", in::render, flag(c.keys), "Draw only the keys of --path"},
      {"--seconds", drawn,
       value("S", c.seconds, between(1e-6, 1e6, "seconds above zero (0.000001 to 1000000)")),
       "Seconds of the tour to draw, or in `profile` at --view; with --path: seconds through its keys, at an "
       "even pace",
       "all of the tour, in `profile` 10; keys by their times"},
  };
}

std::vector<Row> rig_rows(Options& o) {
  RigOptions& r = o.rig;
  return {
      {"--mono", in::render | in::profile | in::bench, flag(r.mono), "Draw the camera itself, one picture"},
      {"--only", in::render | in::profile, one_of<int>(r.only, {{"left", 0}, {"right", 1}}),
       "Draw one eye of the pair; --quality and --detail go by it alone"},
      {"--ipd", in::pictures | in::bench, parsed("METRES", r.ipd, parse_ipd),
       "Distance between the eyes, in metres or with a unit: 64mm, 3m", "0.063"},
      {"--units-per-metre", in::pictures | in::bench, value("N", r.units_per_metre, positive()),
       "World units that make a metre", "1"},
      {"--convergence", in::pictures, parsed("METRES|inf", r.convergence, parse_convergence),
       "Distance of the screen, where disparity is zero, in metres or with a unit: 80cm; inf: infinitely far",
       "a comfortable distance in the first view if one picture has both eyes; else inf"},
      {"--cant", in::pictures,
       value("DEGREES", r.cant, between(-44.999999, 44.999999, "degrees between -45 and 45")),
       "Turn each eye outwards by so many degrees", "0"},
  };
}

std::vector<Row> drawing_rows(Options& o) {
  DrawingOptions& d = o.drawing;
  const unsigned gpu = in::pictures | in::measures | in::levels;
  return {
      {"--tiles", in::pictures, one_of(d.tiles, tiles_choices),
       "Tile test: chooses the tiles in which a Gaussian is drawn", "ellipse"},
      {"--threshold", in::pictures, one_of(d.threshold, threshold_choices),
       "Rule for the alpha below which a Gaussian is dropped from a tile. adagscale finds its K for 40 dB, "
       "or "
       "for --quality, in 16 training views",
       "exact; with --quality: the faster in each frame; with --tolerance: adagscale; with --calibration: "
       "its "
       "first"},
      {"--tolerance", in::pictures, value("X", d.tolerance, not_negative()),
       "Accepted loss of a dropped Gaussian in a tile, in the unit of --threshold"},
      {"--quality", in::pictures, value("DB", d.quality, decibels()),
       "Choose each frame's tolerance for a PSNR of about DB against the exact picture. Frames of unknown "
       "error are exact, as are the first ones and single pictures; some frames draw a part of their tiles "
       "twice to measure it"},
      {"--quality", in::calibrate | in::trim, value("DB", o.target.quality, decibels()),
       "Allowed loss: PSNR against the exact pictures: of each view, or in trim the mean over the validation "
       "views",
       "calibrate without --max-drop: 40"},
      {"--max-drop", in::calibrate | in::trim, value("DB", o.target.max_drop, positive()),
       "Allowed loss: dB lost against the photos, mean over the views"},
      {"--calibration", in::pictures, value("FILE", d.calibration),
       "Take rule and tolerance from a file of binosplat calibrate; if there is none, --threshold adagscale "
       "writes it",
       "", is::input},
      {"--calibration", in::bench, value("FILE", d.calibration),
       "Measure the settings of a file of binosplat calibrate, too", "", is::input},
      {"--transmittance", in::pictures, one_of(d.transmittance, transmittance_choices),
       "Upper bound of a Gaussian's transmittance, for --threshold", "adagscale: depth; else: one"},
      {"--order", in::pictures | in::calibrate, one_of(d.order, order_choices), "How Gaussians are sorted",
       "as the model was trained: depth"},
      {"--order", in::refit, one_of(d.order, order_choices), "How the written model's Gaussians are sorted",
       "as before"},
      {"--projection", in::pictures | in::calibrate, one_of(d.projection, projection_choices),
       "How Gaussians are projected", "as the model was trained: affine"},
      {"--projection", in::refit, one_of(d.projection, projection_choices),
       "How the written model's Gaussians are projected", "as before"},
      {"--precision", in::pictures, one_of(d.precision, precision_choices),
       "Precision of the stored model and splats", "full"},
      {"--reference-until", in::render, stage_with_reference(d.reference_until),
       fmt::format("Compute the stages up to this one by the float64 reference: {} (decode: Scaffold-GS)",
                   fmt::join(std::span(render::stage_names).first(render::stages_with_reference), ", "))},
      {"--frames", in::render, value("N", d.frames, range(1, 100000)),
       "Draw each view N times, for the table of times", "1"},
      {"--foveate", in::pictures, parsed("inset=DEGREES,context=SHARE,...", d.foveation, parse_foveation),
       "Draw exactly an inset about the gaze, in degrees across, and the context around it with a share of "
       "the pixels along each axis: inset=20deg,context=0.4; gaze=RIGHT,UP: degrees from straight ahead "
       "(0,0), or those of both eyes; seam: a share of the inset (0.1). --tolerance is for the context"},
      {"--backend", gpu, backend(o.context.backend),
       "Source of OpenGL: a GPU by EGL's devices, Mesa without a GPU, Mesa without EGL, or the first that "
       "works",
       "auto", is::no_result},
      {"--device", gpu, value("N", o.context.device, range(0, 1000)),
       "Number of the EGL device, as `binosplat devices` lists it", "", is::no_result},
      {"--shader-dir", in::pictures | in::levels | in::bench,
       value("DIR", o.context.shader_dir, existing_folder()),
       "Read shaders from this folder, not the built-in ones"},
  };
}

std::vector<Row> headset_rows(Options& o) {
  HeadsetOptions& h = o.headset;
  return {
      {"--xr", in::view, flag(h.xr),
       "Draw in the headset of an OpenXR runtime; sticks walk and turn, grips hold the world"},
      {"--scale", in::view, value("FACTOR", h.scale, between(0.1, 4.0, "a factor from 0.1 to 4")),
       "Scale of both sides of the recommended pictures", "1"},
      {"--frame-budget", in::view, parsed("MS|auto", h.budget_ms, parse_frame_budget),
       "Reduce quality, then size, to keep frames within MS; auto: four fifths of the runtime's time for a "
       "frame"},
      {"--record", in::view,
       value("S", h.record_s, between(1e-3, 3600.0, "seconds above zero, at most 3600")),
       "Record the first S seconds as `profile` does; F8 in the mirror window records ten more"},
      {"--passthrough", in::view, flag(h.passthrough), "Show the room around the model, if the runtime can"},
      {"--no-mirror", in::view, action([&h] { h.mirror = false; }),
       "Open no window with the left eye's picture"},
  };
}

std::vector<Row> measuring_rows(Options& o) {
  BenchOptions& b = o.bench;
  return {
      {"--suite", in::bench, value("NAME|FILE", b.suite),
       fmt::format("Settings to measure: {} or a JSON file as in docs/measuring.md",
                   fmt::join(lab::suite_presets(), ", ")),
       "quick; motion or levels with the options below", is::input},
      {"--motion", in::bench, names("NAME,...", b.motions),
       "Measure along frames of a moving head, 90 a second: still, calm, walk or fast"},
      {"--detail", in::bench, names("Npx|NdB,...", b.details),
       "Measure loss and time of these levels of detail; values as for `render --detail`"},
      {"--rule", in::bench | in::calibrate, names("THRESHOLD,SOURCE", o.rules),
       "Measure only this rule: a value of `render --threshold`, and one of `--transmittance` if need be, as "
       "in squared,last; repeat it for more; rules with `last` take longest",
       "bench: the suite's; calibrate: adagscale"},
      {"--frames", in::bench, value("N", b.frames, range(1, 100000)),
       "Timed frames of each view and repeat; for a motion, the moving frames of a stretch", "the suite's"},
      {"--ppd", in::bench | in::compare, value("N", o.ppd, between(1.0, 1000.0, "a number from 1 to 1000")),
       "Pixels per degree of the viewer's field of view, for FLIP", "67"},
      {"--compare", in::bench | in::profile, value("FILE", o.older_results),
       "Print changes beyond noise since an older results.json", "", is::no_result},
      {"--fail-if-slower", in::bench | in::profile, value("PERCENT", o.fail_if_slower, not_negative()),
       "With --compare: end with exit code 1 if a time has risen beyond noise and by more than PERCENT", "",
       is::no_result},
      {"--no-clock", in::profile, action([&o] { o.asks_clock = false; }),
       "Do not read the GPU's clock, which may slow the driver"},
      {"--bins", in::calibrate, value("N", o.table_bins, range(1, 10000)),
       "Bins of the table of transmittance by depth", "20"},
      {"--far", in::calibrate, value("DEPTH", o.table_far, positive()),
       "End of the bins, in world units; AdaGScale's is 100", "fits the scene"},
      {"--against", in::refit, one_of<bool>(o.against_exact, {{"exact", true}}),
       "Instead of photos: the model's own exact pictures, in the order and projection that it was trained "
       "with"},
      {"--rounds", in::refit, value("N", o.rounds, range(1, 1000)), "Rounds of conjugate gradients, at most",
       "12"},
      {"--refit", in::trim, flag(o.refit),
       "Fit the colours of every candidate to the pictures, as refit does: leaves fewer Gaussians, but takes "
       "many times as long"},
      {"--levels", in::levels, value("N", o.levels, range(1, 16)),
       "Levels; each has half of the Gaussians of the one before", "8"},
      {"--chunk", in::levels, value("N", o.chunk, range(64, 131072)),
       "Largest chunk, in Gaussians of the finest level; each chunk has a level of its own", "2048"},
      {"A", in::compare, value("", o.compare.a), "Picture: PNG, JPEG or OpenEXR", "",
       is::required | is::input},
      {"B", in::compare, value("", o.compare.b), "Picture of the same size", "", is::required | is::input},
      {"--min-psnr", in::compare, value("DB", o.compare.min_psnr, between(-INFINITY, INFINITY, "decibels")),
       "Exit code 1 if PSNR is below this"},
      {"--foveate-at", in::compare,
       parsed("X,Y,FOV", o.compare.gaze,
              [](const std::string& text) {
                const glm::dvec3 v = parse_three("--foveate-at", text);
                return measure::Gaze{v.x, v.y, v.z};
              }),
       "Compare for an eye that looks at pixel X,Y of a picture FOV degrees across: PSNR by degrees from "
       "there, and the share of pixels that differ visibly"},
  };
}

std::vector<Row> output_rows(Options& o) {
  PictureOptions& p = o.picture;
  const unsigned look = in::render | in::view;
  const auto output = [&](unsigned commands, const char* type, const std::string& help,
                          const std::string& otherwise, unsigned flags = is::output) {
    return Row{"-o,--output", commands, value(type, o.output), help, otherwise, is::no_result | flags};
  };
  return {
      output(
          in::render, "DIR|FILE",
          "A folder for NAME_left.png, NAME_right.png (NAME.png with --mono), or FILE.png or FILE.exr with "
          "both eyes, or a video of all views: FILE.mp4, .mov, .mkv or .webm, by ffmpeg",
          "out/SCENE"),
      output(in::view, "DIR", "A folder for pictures and paths", "out/SCENE"),
      output(in::profile, "DIR",
             "Folder for report.html, trace.json, frames.csv, results.json and results.csv", "out/profile"),
      output(in::bench, "DIR", "Folder for report.html, results.csv, details.csv and results.json",
             "out/bench"),
      output(in::calibrate, "CALIB.json", "The file to write", "", is::required | is::file_output),
      output(in::fits | in::convert, "FILE", "The file to write: " + written_endings(), "",
             is::required | is::file_output),
      output(in::levels, "FOLDER", "The folder to write lod-meta.json and its SOGs to", "",
             is::required | is::output),
      {"--to", in::convert, format_to_write(o.to), "The format, if FILE's ending does not determine it"},
      {"--sh-bits", in::convert | in::refit, value("N", o.harmonic_bits, range(1, 8)),
       "Bits of each SH coefficient in spz; 4, as other writers use, saves a third of the file and costs "
       "about 15 dB",
       "8"},
      {"--layout", in::render, one_of(p.layout, layout_choices), "Layout of both eyes",
       "a folder: separate; FILE.png and videos: parallel; FILE.exr: multi-view"},
      {"--layout", in::view, one_of(p.layout, layout_choices, LAYOUT_MULTI_VIEW), "Layout of both eyes",
       "parallel"},
      {"--show", look, one_of(p.show, show_choices),
       "Map to show instead of the picture; numbers as colours from 0 (dark) to yellow", "picture"},
      {"--background", look, parsed("R,G,B|none", p.background, parse_background),
       "Colour behind the model, 0 to 1, or none: keep alpha", "0,0,0"},
      {"--background", in::compare, parsed("R,G,B|none", o.compare.background, parse_background),
       "Colour from 0 to 1 behind pictures with alpha",
       "alpha is compared if both have it, else pictures are put over black"},
      {"--fps", in::render,
       value("N", p.fps, between(min_fps, 1000.0, "frames a second above zero (0.01 to 1000)")),
       "Frames a second of a tour, of a path through keys, or of a video",
       "tours 90; keys 30; videos by the path's times, or 30"},
      {"--fps", in::profile, value("N", p.fps, between(0.0, 1000.0, "frames a second from 0 to 1000")),
       "Frames begun a second, as in a headset of 72, 90 or 120; 0: as soon as the last one is drawn", "90"},
      {"--bits", in::render, one_of<int>(p.bits, {{"8", 8}, {"16", 16}}), "Bits a channel of PNG", "8"},
      {"--png-level", in::render, value("N", p.png_level, between(0, 12, "a level from 0 to 12")),
       "Compression of PNG: 0 (fast) to 12 (small, slow)", "1", is::no_result},
      {"--exr", in::render, one_of<bool>(p.exr_half, {{"half", true}, {"float", false}}),
       "Write OpenEXR too, with depth", "-o FILE.exr alone: half"},
      {"--exr-encoding", in::render, one_of<bool>(p.exr_display, {{"linear", false}, {"display", true}}),
       "Scene-linear light, or display values as in PNG", "linear"},
      {"--exr-depth", in::render,
       one_of<DepthKind>(p.exr_depth, {{"mean", DepthKind::mean}, {"median", DepthKind::median}}),
       "Z of OpenEXR: mean depth, or where transmittance falls below a half", "mean"},
      {"--exr-compression", in::render,
       one_of<ExrCompression>(
           p.exr_compression,
           {{"none", ExrCompression::none}, {"rle", ExrCompression::rle}, {"zip", ExrCompression::zip}}),
       "Compression of OpenEXR: zip is smallest and slowest", "rle", is::no_result},
  };
}

std::vector<Row> result_rows(Options& o) {
  const std::string photos = "DIR/NAME.jpg or .png of the views";
  return {
      {"--photos", in::render, value("DIR|beside", o.photos, existing_folder() | word_is(photos_beside)),
       "Print PSNR against DIR/NAME.jpg, .png or .exr, or the photos beside the cameras; needs --mono. "
       "Photos with alpha are put over --background",
       "", is::input},
      {"--photos", in::bench, value("DIR|beside", o.photos, existing_folder() | word_is(photos_beside)),
       "Compare with " + photos + " as well", "", is::input},
      {"--photos", in::calibrate | in::trim, value("DIR", o.photos, existing_folder()), photos, "",
       is::input},
      {"--photos", in::refit, value("DIR", o.photos, existing_folder()),
       "Fit " + photos + "; a view without one is fitted to the model's own picture", "", is::input},
      {"--exposure", in::render | in::measures,
       value("FILE|none", o.exposure, existing_file() | word_is(no_exposure)),
       "Exposures that are applied to pictures before --photos compares them: INRIA's exposure.json",
       "the one of the model's training", is::input},
      {"--json", in::render | in::fits | in::convert | in::info | in::compare | in::devices,
       value("FILE", o.json), "Write everything printed as JSON", "", is::file_output},
      {"--difference", in::compare, value("FILE", o.compare.difference),
       "Write the absolute error as PNG, amplified so that about one value in a thousand is white", "",
       is::file_output},
      {"--shard", in::render, parsed("I/N", o.shard, parse_shard),
       "Draw every Nth view from the Ith on: one job of N", "", is::no_result},
      {"--resume", in::render, flag(o.resume),
       "Skip views whose pictures an earlier run with --resume and the same options wrote", "",
       is::no_result},
  };
}

std::vector<Row> run_rows(Options& o) {
  return {
      {"--max-memory", in::models, value("MB", o.max_memory, between(1.0, 1e9, "megabytes from 1 to 1e9")),
       "Memory that a model may take: a limit against damaged files", "0.4 GB, or more for larger files",
       is::no_result},
      {"--max-memory", in::compare, value("MB", o.max_memory, positive()),
       "Refuse pictures that take more memory to compare", "three quarters of the machine's", is::no_result},
      {"--quiet", in::all & ~in::devices, action([] { set_quiet(true); }),
       "Print only results, warnings and errors", "", is::no_result},
  };
}

}  // namespace

std::vector<Row> option_table(Options& into) {
  std::vector<Row> all;
  const auto add = [&](const char* group, std::vector<Row> rows) {
    for (Row& row : rows) {
      row.group = group;
      all.push_back(std::move(row));
    }
  };
  add("Scene", scene_rows(into));
  add("Cameras", view_rows(into));
  add("Cameras", camera_rows(into));
  add("Both eyes", rig_rows(into));
  add("Drawing", drawing_rows(into));
  add("Headset", headset_rows(into));
  add("Measuring", measuring_rows(into));
  add("Outputs", output_rows(into));
  add("Outputs", result_rows(into));
  add("Options", run_rows(into));
  return all;
}

std::string with_options(std::string text) {
  constexpr std::string_view commands[] = {"--compare", "--levels", "--refit", "--view"};
  static Options unused;
  static const std::vector<Row> rows = option_table(unused);
  for (std::size_t at = text.find('`'); at < text.rfind('`'); at = text.find('`', at + 1)) {
    const std::size_t count = text.find('`', at + 1) - at - 1;
    std::string option = "--" + text.substr(at + 1, count);
    std::ranges::replace(option, '_', '-');
    if (std::ranges::count(rows, option, &Row::word) > 0 && std::ranges::count(commands, option) == 0)
      text.replace(at, count + 2, option);
  }
  return text;
}

}  // namespace binosplat::app
