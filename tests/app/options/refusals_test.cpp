// Invalid options of binosplat render, and invalid combinations: each run prints this message, exits with
// code 2, and leaves no file.

#include "app/scene.h"
#include "support/scaffold_files.h"

namespace binosplat {
namespace {

struct Refusals : SceneTest {
  Refusals() { add_cameras(); }
  const std::string cameras = folder / "cameras.json", png = folder / "a.png", exr = folder / "a.exr";
};

TEST_F(Refusals, WrongCamerasAreNamed) {
  expect_refused({
      {{"--eye", "0,0,0", "--at", "0,0,0"}, "--eye (0, 0, 0), --at (0, 0, 0)"},
      {{"--up", "0,0,1"}, "--up and --fov are for cameras that are made up"},
      {{"--eye", "1,2", "--at", "0,0,0"}, "three numbers"},
      {{"--fov", "200", "--orbit", "1"}, "between 0 and 180"},
      {{"--size", "0x10"}, "WIDTHxHEIGHT"},
      {{"--size", "99999999999x2"}, "WIDTHxHEIGHT"},
      {{"--size", "2000000000x2000000000", "--mono"}, "2^30 pixels"},
      {{"--size", "40000000x1", "--mono"}, "2^30 pixels"},
      {{"--view", "frnt"}, "has no camera of this name. It has:\n  front\n  side\n"},
      {{"--view", "pair", "--mono"}, "pair_left or pair_right"},
      {{"--view", "pair", "--ipd", "0.06"}, "is a pair of eyes that the cameras give"},
      {{"--view", "pair", "--preset", "headset"}, "use --size"},
      {{"--view", "all", "-o", png}, "name a folder"},
      {{"--view", "front,side", "-o", png}, "is one file for 2 views (front, side)"},
      {{"--axes", "xyz"}, "axes 'XYZ': expected three letters"},
  });
  fs::remove(cameras);
  expect_refused({{{"--view", "front"}, "no cameras beside"}});
}

TEST_F(Refusals, WrongEyesAreNamed) {
  expect_refused({
      {{"--cant", "50"}, "--cant: 50: expected degrees between -45 and 45"},
      {{"--convergence", "0"}, "--convergence 0: expected metres above zero"},
      {{"--ipd", "-1"}, "--ipd -1"},
      {{"--ipd", "63"}, "--ipd 63 means 63 m"},
      {{"--ipd", "0.063x"}, "its unit may be m, cm or mm"},
      {{"--convergence", "3ft"}, "its unit may be m, cm or mm"},
      {{"--convergence", "near"}, "--convergence near: expected metres"},
  });
}

TEST_F(Refusals, WrongOutputsAreNamed) {
  write_text(folder / "file", "in the way");
  fs::create_directories(folder / "taken.png");
  expect_refused({
      {{"-o", folder / "a.gif"}, "pictures are written as .png or .exr"},
      {{"-o", folder / "a.vr.jpg"}, "pictures are written as .png"},
      {{"-o", "-"}, "cannot write -: outputs are files"},
      {{"--json", "-"}, "cannot write -: outputs are files"},
      {{"-o", folder / "file/deep/out"}, "is a file where a folder is needed"},
      {{"-o", folder / "taken.png"}, "it is a folder"},
      {{"--json", folder / "file/r.json"}, "is a file where a folder is needed"},
      {{"-o", "/proc/nowhere"}, "cannot write /proc/nowhere"},
      {{"--photos", folder.path()}, "--photos needs --mono"},
      {{"-o", exr, "--bits", "16"}, "--bits and --png-level are for PNG"},
      {{"-o", exr, "--png-level", "1"}, "--bits and --png-level are for PNG"},
      {{"-o", folder / "a.mp4", "--png-level", "1"}, "--png-level, --exr and --exr-... are for pictures"},
      {{"-o", folder / "a.mp4", "--exr-compression", "zip"}, "are for pictures"},
      {{"--exr-encoding", "display"}, "--exr-encoding, --exr-depth and --exr-compression are for OpenEXR"},
      {{"--exr-depth", "mean"}, "--exr-depth and --exr-compression are for OpenEXR"},
      {{"--exr-compression", "rle"}, "--exr-compression are for OpenEXR"},
      {{"--background", "2,0,0"}, "from 0 to 1, or none"},
      {{"--background", "blue"}, "three numbers"},
  });
}

TEST_F(Refusals, WrongLayoutsAreNamed) {
  expect_refused({
      {{"--layout", "rows", "--mono"}, "--layout rows needs both eyes"},
      {{"--layout", "separate", "-o", png}, "must be a folder"},
      {{"--layout", "multi-view", "-o", png}, "is OpenEXR's"},
      {{"--layout", "multi-view", "--bits", "8"}, "are for PNG"},
      {{"--layout", "anaglyph", "-o", exr}, "write PNG only"},
      {{"--layout", "grey", "--exr", "half"}, "write PNG only"},
      {{"--layout", "half-colour", "--background", "none"}, "--background none is not for it"},
      {{"--layout", "sideways"}, "sideways"},
      {{"--layout", "quad-buffer"}, "binosplat view"},
      {{"--show", "colour"}, "colour"},
      {{"--show", "disagreement", "--mono"}, "both eyes"},
      {{"--show", "disparity", "--mono"}, "--show disparity is between both eyes"},
      {{"--show", "alphas", "--reference-until", "blend"}, "--show alphas"},
      {{"--show", "depth", "-o", exr}, "PNG and videos"},
  });
  json odd = {camera_json("odd_left", -0.1), camera_json("odd_right", 0.1)};
  odd[1]["width"] = 70;
  write_text(cameras, odd.dump());
  expect_refused({{{"-o", png}, "72 x 48 and 70 x 48 px"}});
}

TEST_F(Refusals, WrongDrawingIsNamed) {
  expect_refused({
      {{"--threshold", "squared"}, "needs --tolerance, --quality or a calibration"},
      {{"--threshold", "exact", "--quality", "40"}, "--quality has no effect"},
      {{"--tolerance", "1", "--quality", "40"}, "--quality 40 with --tolerance 1"},
      {{"--quality", "40", "--reference-until", "project"}, "--reference-until"},
      {{"--tolerance", "1", "--transmittance", "last", "--reference-until", "project"}, "--reference-until"},
      {{"--precision", "half", "--reference-until", "blend"}, "--precision half has no effect with"},
      {{"--tiles", "round"}, "see: binosplat render --help"},
      {{"--frames", "0"}, "see: binosplat render --help"},
      {{"--reference-until", "lunch"}, "see: binosplat render --help"},
      {{"--shader-dir", "/no/such/folder"}, "/no/such/folder"},
      {{"--device", "0", "--backend", "surfaceless"}, "surfaceless has none"},
      {{"--eps2d", "0"}, "--eps2d"},
  });
}

TEST_F(Refusals, WrongFoveationIsNamed) {
  expect_refused({
      {{"--foveate", "inset=0"}, "--foveate inset 0: expected 1 to 120"},
      {{"--foveate", "inset=20px"}, "inset=20px: expected degrees"},
      {{"--foveate", "contxt=0.4"}, "there is no contxt; did you mean context?"},
      {{"--foveate", "20"}, "'20': expected WORD=NUMBER"},
      {{"--foveate", "inset=20,inset=30"}, "inset is given twice"},
      {{"--foveate", "gaze=3"}, "gaze=3: expected degrees to the right and up"},
      {{"--foveate", "gaze=3,up"}, "gaze=up: expected degrees"},
      {{"--foveate", "gaze=1,1,2,2", "--mono"}, "two gazes are for both eyes"},
      {{"--foveate", "inset=20", "--show", "alphas"}, "--foveate with --show alphas"},
      {{"--foveate", "inset=20", "--exr-depth", "median", "--exr", "half"}, "--exr-depth median"},
  });
}

TEST_F(Refusals, WrongPanoramasAreNamed) {
  expect_refused({{{"--size", "9000x9000"}, "at most 8192"},
                  {{"--size", "32x30"}, "an even number of pixels twice"},
                  {{"-o", folder / "a.vr.jpg", "--exr", "half"}, "--exr"},
                  {{"-o", folder / "a.vr.jpg", "--mono"}, "holds both eyes"},
                  {{"--layout", "anaglyph"}, "expected parallel, over-under or separate"},
                  {{"-o", folder / "a.webm"}, "expected .mp4 or .mov"},
                  {{"--preset", "headset"}, "--preset"}},
                 {"--vr180"});
}

TEST_F(Refusals, ToursAndPaths) {
  expect_refused({
      {{"--tour", "trot"}, "--tour trot: expected calm, walk, fast, or metres and degrees a second"},
      {{"--tour", "1.5,45,3"}, "as in 1.5,45"},
      {{"--tour", "0,45"}, "above 0"},
      {{"--seconds", "1"}, "--seconds needs --tour, of which it is a part, or --path"},
      {{"--fps", "30"}, "--fps is for videos, --tour and --path"},
      {{"--tour", "walk", "--up", "0,0,1"}, "--up and --fov are for cameras that are made up"},
      {{"--tour", "1e-9,1e-9"}, "fewer frames a second or a faster tour"},
      {{"--tour", "walk", "--units-per-metre", "1e6"}, "or other units per metre"},
      {{"--tour", "walk", "-o", png}, "name a folder"},
      {{"--path", cameras, "--fps", "30"}, "has frames, each drawn as it is"},
      {{"--path", cameras, "--keys", "--fps", "10"}, "leave one of them out"},
  });
  write_text(cameras, json({camera_json("lonely", 0.0)}).dump());
  expect_refused({{{"--tour", "walk"}, "a --tour needs at least two cameras, found 1"}});
  fs::remove(cameras);
  expect_refused(
      {{{"--tour", "walk"}, "--tour goes through cameras: no cameras beside " + model + "; name their"}});
}

TEST_F(Refusals, WrongShardsAreNamed) {
  expect_refused({
      {{"--shard", "3/2"}, "--shard 3/2: expected I/N with I from 1 to N"},
      {{"--shard", "1/2", "--path", cameras, "--quality", "40"}, "--shard with --quality along a path"},
      {{"--resume", "--tour", "walk", "--quality", "40"}, "--resume with --quality along a path"},
      {{"--shard", "1/2", "--path", cameras, "--tolerance", "1", "--transmittance", "last"},
       "--shard with --transmittance last along a path"},
      {{"--shard", "1/2", "--path", cameras, "--detail", "1"}, "--shard with --detail"},
      {{"--shard", "1/2", "-o", png}, "a.png is one file: name a folder"},
      {{"--resume", "-o", folder / "a.mp4"}, "a.mp4 is one file: name a folder"},
  });
}

TEST_F(Refusals, WrongScenesAreNamed) {
  expect_refused({
      {{"--seed", "1"}, "--seed is for demo:city, not for " + model},
      {{"--count", "20000"}, "--count is for demo:city"},
      {{"--repeat", "0x2", "--spacing", "1"}, "NXxNZ, for one 4x4"},
      {{"--repeat", "65536x65536", "--spacing", "1"}, "--repeat 65536x65536 of 300 Gaussians"},
      {{"--repeat", "2x2", "--spacing", "1e300"}, "--spacing: 1e300: expected a number above zero"},
      {{"--appearance", "0"}, "only Scaffold-GS models have appearances"},
  });
  expect_refused_after(
      {"render"},
      {{{"https://example.org/a.ply"}, "it is a URL; download the file first"},
       {{"demo:town"}, "expected demo:room or demo:city"},
       {{"demo:room", "--axes", "rub"}, "--axes is for model files"},
       {{"demo:room", "--appearance", "0"}, "--appearance is for model files"},
       {{"demo:city", "--count", "9999"}, "--count 9999: demo:city is made of 10000 to 100000000 Gaussians"},
       {{"demo:city", "--count", "-5"}, "expected a whole number"},
       {{"demo:city", "--count", "99999999999999999999999"}, "expected a whole number"},
       {{"demo:city", "--seed", "many"}, "see: binosplat render --help"}});
}

TEST_F(Refusals, OptionsWithoutEffect) {
  const std::string to = folder / "to.ply", none = "for demo:city";
  for (const Words& line : {Words{"trim", model, "-o", to, "--quality", "40"},
                            {"calibrate", model, "-o", folder / "c.json", "--quality", "40"}})
    expect_refused_after(line, {{{"--backend", "surfaceless", "--device", "0"}, "surfaceless has none"}});
  const Words city[] = {{"--seed", "1"}, {"--count", "20000"}};
  for (const Words& line : {Words{"convert", model, "-o", to},
                            {"trim", model, "-o", to, "--quality", "40"},
                            {"refit", model, "-o", to, "--against", "exact"},
                            {"calibrate", model, "-o", folder / "c.json", "--quality", "40"},
                            {"levels", model},
                            {"bench", model},
                            {"bench", model, "demo:room"}})
    for (const Words& words : city) expect_refused_after(line, {{words, none}});
  for (const Words& line : {Words{"convert", "demo:room", "-o", to, "--axes", "rub"},
                            {"trim", "demo:room", "-o", to, "--quality", "40", "--lod", "1"},
                            {"refit", "demo:room", "-o", to, "--against", "exact", "--axes", "rub"},
                            {"bench", "demo:room", "--format", "ply"}})
    expect_refused_after(line, {{{}, "is for model files, not for demo:room"}});
  for (const Words& line : {Words{"convert", model, "--to", "ply", "-o"},
                            {"convert", model, "-o", to, "--json"},
                            {"calibrate", model, "--quality", "40", "-o"},
                            {"compare", model, model, "--difference"},
                            {"levels", model, "-o"},
                            {"profile", model, "-o"},
                            {"bench", model, "-o"}})
    expect_refused_after(line, {{{"-"}, "cannot write -: outputs are files"}});
  expect_refused_after({"bench", model}, {{{"--test-every", "2"},
                                           "have no effect here: suite quick keeps no views for training"},
                                          {{"--test", "side"}, "--test and --test-every have no effect"}});
  expect_refused_after({"calibrate", model, "--quality", "40", "-o", folder / "c.json", "--view", "front"},
                       {{{"--rule", "exact"}, "--rule exact: it is exact, and has no tolerance"}});
}

TEST_F(Refusals, ScaffoldsAreRefusedWhereUnsupported) {
  const std::string trained = folder / "trained", none = "is a Scaffold-GS model";
  fs::create_directories(trained);
  test::write_scaffold(trained, test::random_scaffold(1, {.anchors = 10, .appearances = 3}));
  expect_refused_after(
      {}, {{{"convert", trained, "-o", folder / "m.ply"}, none},
           {{"trim", trained, "-o", folder / "m.ply", "--quality", "40", "--cameras", cameras}, none},
           {{"info", trained, "--cameras", cameras}, none},
           {{"render", trained, "--appearance", "3"}, "has appearances 0 to 2"}});
  fs::remove(trained + "/cov_mlp.pt");
  expect_refused_after({"render", trained}, {{{}, "cov_mlp.pt is missing"}});
}

// Tests every numeric option of every command.
TEST_F(Refusals, WrongNumbersAreNamed) {
  const std::string to = folder / "to.ply";
  const Words render = {"render", model}, trim = {"trim", model, "-o", to},
              calibrate = {"calibrate", model, "-o", to}, compare = {"compare", model, model};
  for (const char* number : {"nan", "inf", "4000", "-40", "9.9", "100.1"}) {
    for (const Words& line : {render, trim, calibrate})
      expect_refused_after(line, {{{"--quality", number}, "expected decibels from 10 to 100"}});
  }
  const std::pair<Words, Words> options_of[] = {
      {render,
       {"--tolerance", "--near", "--fov", "--fps", "--eps2d", "--gpu-memory", "--max-memory",
        "--units-per-metre", "--ipd", "--cant", "--convergence", "--spacing", "--detail", "--seconds"}},
      {trim, {"--max-drop"}},
      {calibrate, {"--max-drop", "--far"}},
      {compare, {"--min-psnr", "--ppd", "--max-memory"}},
      {{"bench", model}, {"--ppd", "--ipd", "--units-per-metre"}},
  };
  for (const auto& [line, options] : options_of) {
    for (const std::string& option : options) expect_refused_after(line, {{{option, "nan"}, "nan"}});
  }
}

}  // namespace
}  // namespace binosplat
