#include "app/camera_options.h"

#include "app/option_checks.h"
#include "stereo/rig.h"

namespace binosplat::app {

void add_camera_options(CLI::App& sub, CameraOptions& o) {
  const auto three = [&sub](const char* name, std::optional<glm::dvec3>& into, const char* help) {
    return sub
        .add_option_function<std::string>(
            name, [name, &into](const std::string& text) { into = parse_three(name, text); }, help)
        ->type_name("X,Y,Z");
  };
  sub.option_defaults()->group("Cameras");
  sub.add_option("--cameras", o.file,
                 "cameras.json, transforms.json, camera_path.json or the folder of a\nCOLMAP reconstruction; "
                 "default: what lies beside the model")
      ->type_name("FILE|DIR");
  add_names_option(sub, "--view", o.views,
                   "A camera to draw by name, or all (the first); may be given again, or as\nA,B where no "
                   "camera is called so. NAME also means the pair NAME_left,\nNAME_right");
  sub.add_option(
         "--path", o.path,
         "cameras.json, or nerfstudio's or LichtFeld Studio's JSON of one path: of\nkeys, as `view` saves "
         "them, or of its frames; each frame goes by what the last\none measured")
      ->type_name("FILE");
  three("--eye", o.eye, "Camera position instead, in world units");
  three("--at", o.at, "What it looks at");
  three("--up", o.up,
        "What is up in the picture (as the cameras stand, or else found in\nthe model); for --eye, --orbit "
        "and models without cameras");
  sub.add_option("--fov", o.fov, "Vertical field of view of such cameras (60)")
      ->type_name("DEGREES")
      ->check(between(1e-6, 179.999999, "degrees between 0 and 180"));
  sub.add_option("--orbit", o.orbit, "N cameras around the model instead")
      ->type_name("N")
      ->check(range(1, 10000));
  add_size_option(sub, o.lens, "Pixels of each eye; keeps the vertical field of view");
  add_preset_option(sub, o.lens, "preview: 1280 x 720 an eye; headset: 3660 x 3200 an eye,\n100 degrees");
  add_near_option(sub, o,
                  "Nothing nearer is drawn, in world units (0.2; less for tiny\nmodels without cameras)");
}

CLI::Option* add_size_option(CLI::App& sub, Lens& lens, const char* help) {
  return sub
      .add_option_function<std::string>(
          "--size",
          [&lens](const std::string& text) {
            lens.size = parse_two("--size", text, "pixels as WIDTHxHEIGHT, for one 1280x720");
          },
          help)
      ->type_name("WxH");
}

CLI::Option* add_preset_option(CLI::App& sub, Lens& lens, const char* help) {
  return choose<const char*>(sub, "--preset", lens.preset, help,
                             {{"preview", "preview"}, {"headset", "headset"}});
}

CLI::Option* add_near_option(CLI::App& sub, CameraOptions& o, const char* help) {
  return sub.add_option("--near", o.near_plane, help)->type_name("DEPTH")->check(positive);
}

Camera sized(const Lens& lens, const Camera& camera) {
  const Camera out = lens.preset.empty() ? camera : stereo::apply_preset(camera, lens.preset);
  return lens.size ? resized(out, lens.size->x, lens.size->y) : out;
}

}  // namespace binosplat::app
