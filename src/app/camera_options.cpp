#include "app/camera_options.h"

#include "app/option_checks.h"
#include "stereo/rig.h"

namespace binosplat::app {

void add_camera_options(CLI::App& sub, CameraOptions& o) {
  const auto three = [&sub](const char* name, std::optional<glm::dvec3>& into, const char* help) {
    add_parsed(
        sub, name, "X,Y,Z", into, [name](const std::string& text) { return parse_three(name, text); }, help);
  };
  sub.option_defaults()->group("Cameras");
  sub.add_option(
         "--cameras", o.file,
         "cameras.json, transforms.json, camera_path.json, a glTF with cameras or the\nfolder of a COLMAP "
         "reconstruction; default: the cameras beside the model")
      ->type_name("FILE|DIR");
  add_names_option(sub, "--view", o.views,
                   "A camera by name, or all (the first); repeat it for more, or give A,B\nunless a camera "
                   "has that name. NAME also selects the pair NAME_left,\nNAME_right");
  sub.add_option(
         "--path", o.path,
         "Camera path: cameras.json, nerfstudio's or LichtFeld Studio's JSON, or\nEyeNavGS's csv, of "
         "keys (as `view` saves them) or of frames; each frame\nuses the measurements of the one before")
      ->type_name("FILE");
  three("--eye", o.eye, "Position of a camera of your own, in world units; needs --at");
  three("--at", o.at, "Point that --eye looks at, in world units");
  three("--up", o.up,
        "Up direction of --eye, --orbit and models without cameras (from the\ncameras, or else from the "
        "model)");
  add_value(sub, "--fov", "DEGREES", o.fov, between(1e-6, 179.999999, "degrees between 0 and 180"),
            "Vertical field of view of --eye, --orbit and models without cameras (60)");
  add_value(sub, "--orbit", "N", o.orbit, range(1, 10000), "N cameras around the model, in place of its own");
  choose<Outlook::Kind>(sub, "--frame", o.frame,
                        "A camera of the model, in place of its own: all of it, or its middle",
                        {{"all", Outlook::Kind::whole}, {"middle", Outlook::Kind::core}});
  add_size_option(sub, o.lens, "Pixels of each eye; keeps the vertical field of view");
  add_preset_option(sub, o.lens, "preview: 1280 x 720 an eye; headset: 3660 x 3200 an eye,\n100 degrees");
  add_near_option(sub, o,
                  "Near plane, in world units (that of the training, if a file says it; else\n0.2, or 0.01 "
                  "if the cameras reach to 1 unit, or less for tiny models\nwithout cameras)");
}

CLI::Option* add_size_option(CLI::App& sub, Lens& lens, const char* help) {
  const auto parse = [](const std::string& text) {
    return parse_two("--size", text, "pixels as WIDTHxHEIGHT, for one 1280x720");
  };
  return add_parsed(sub, "--size", "WxH", lens.size, parse, help);
}

CLI::Option* add_preset_option(CLI::App& sub, Lens& lens, const char* help) {
  return choose<const char*>(sub, "--preset", lens.preset, help,
                             {{"preview", "preview"}, {"headset", "headset"}});
}

CLI::Option* add_near_option(CLI::App& sub, CameraOptions& o, const char* help) {
  return add_value(sub, "--near", "DEPTH", o.near_plane, positive, help);
}

Camera sized(const Lens& lens, const Camera& camera) {
  const Camera out = lens.preset.empty() ? camera : stereo::apply_preset(camera, lens.preset);
  return lens.size ? resized(out, lens.size->x, lens.size->y) : out;
}

}  // namespace binosplat::app
