#include "app/output_options.h"

#include "app/option_checks.h"
#include "base/error.h"

namespace binosplat::app {

namespace {

void add_photos(CLI::App& sub, std::string& photos, std::string& exposure, const char* help,
                bool found_beside) {
  const auto is = [](const char* word) { return CLI::IsMember({word}).description(""); };
  sub.add_option("--photos", photos, help)
      ->type_name(found_beside ? fmt::format("DIR|{}", photos_beside) : "DIR")
      ->check(found_beside ? folder() | is(photos_beside) : folder());
  sub.add_option("--exposure", exposure,
                 "Exposures that are applied to pictures before --photos compares them:\nINRIA's "
                 "exposure.json (the one of the model's training)")
      ->type_name(fmt::format("FILE|{}", no_exposure))
      ->check(CLI::ExistingFile.description("") | is(no_exposure));
}

}  // namespace

Background parse_background(const std::string& text) {
  if (text == "none") return std::nullopt;
  const glm::dvec3 rgb = parse_three("--background", text);
  for (int i = 0; i < 3; ++i) {
    if (!(rgb[i] >= 0.0 && rgb[i] <= 1.0))
      fail("--background {}: expected numbers from 0 to 1, or none", text);
  }
  return glm::vec3(rgb);
}

void add_look_options(CLI::App& sub, OutputOptions& o, bool in_window) {
  sub.option_defaults()->group("Outputs");
  choose_explained(
      sub, "--layout", o.layout,
      in_window
          ? "Layout of both eyes (parallel)"
          : "Layout of both eyes (a folder: separate; FILE.png and videos: parallel;\nFILE.exr: multi-view)",
      layout_choices, in_window ? LAYOUT_MULTI_VIEW : -1);
  choose_explained(
      sub, "--show", o.show,
      "Map to show instead of the picture; numbers as colours from 0 (dark) to\nyellow (picture)",
      show_choices);
  add_parsed(sub, "--background", "R,G,B|none", o.background, parse_background,
             "Colour behind the model, 0 to 1, or none: keep alpha (0,0,0)");
}

void add_output_options(CLI::App& sub, OutputOptions& o) {
  sub.option_defaults()->group("Outputs");
  sub.add_option(
         "-o,--output", o.output,
         "A folder for NAME_left.png, NAME_right.png (NAME.png with --mono),\nor FILE.png or "
         "FILE.exr with both eyes, or a video of all views:\nFILE.mp4, .mov, .mkv or .webm, by ffmpeg "
         "(out/SCENE)")
      ->type_name("DIR|FILE");
  add_look_options(sub, o, false);
  add_value(sub, "--fps", "N", o.fps, fps_range,
            "Frames a second of a tour, of a path through keys (30), or of a video\n(by the path's times, or "
            "30)");
  choose<int>(sub, "--bits", o.bits, "Bits a channel of PNG (8)", {{"8", 8}, {"16", 16}});
  add_value(sub, "--png-level", "N", o.png_level, between(0, 12, "a level from 0 to 12"),
            "Compression of PNG: 0 (fast) to 12 (small, slow) (1)");
  choose<bool>(sub, "--exr", o.exr_half, "Write OpenEXR too, with depth (-o FILE.exr alone: half)",
               {{"half", true}, {"float", false}});
  choose<bool>(sub, "--exr-encoding", o.exr_display,
               "Scene-linear light, or display values as in PNG (linear)",
               {{"linear", false}, {"display", true}});
  choose<Depth>(sub, "--exr-depth", o.exr_depth,
                "Z of OpenEXR: mean depth, or where transmittance falls below a half (mean)",
                {{"mean", Depth::mean}, {"median", Depth::median}});
  choose<ExrCompression>(
      sub, "--exr-compression", o.exr_compression,
      "Compression of OpenEXR: zip is smallest and slowest (rle)",
      {{"none", ExrCompression::none}, {"rle", ExrCompression::rle}, {"zip", ExrCompression::zip}});
  add_photos(sub, o.photos, o.exposure,
             "Print PSNR against DIR/NAME.jpg, .png or .exr, or the photos beside the\ncameras; needs "
             "--mono. Photos with alpha are put over --background",
             true);
  sub.add_option("--json", o.json, "Write everything printed as JSON")->type_name("FILE");
}

void add_photos_options(CLI::App& sub, MeasuredOptions& o, const char* help, bool found_beside) {
  add_photos(sub, o.photos, o.exposure, help, found_beside);
}

}  // namespace binosplat::app
