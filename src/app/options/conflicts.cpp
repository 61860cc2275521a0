// Options that exclude or need each other, whatever their values. app/options/checks.cpp checks values, and
// render::check() those of a frame's settings, such as a rule with a tolerance.

#include "app/options/table.h"

namespace binosplat::app {

const std::vector<Conflict>& conflicts() {
  static const std::vector<Conflict> rows = {
      {"--eye", {"--orbit", "--cameras", "--view"}, "it makes a camera of its own"},
      {"--orbit", {"--cameras", "--view"}, "it makes cameras of its own"},
      {"--frame", {"--cameras", "--view", "--eye", "--path", "--tour"}, "it makes a camera of its own"},
      {"--tour",
       {"--view", "--eye", "--orbit", "--frames"},
       "it goes through all cameras of the scene or of --cameras, each frame drawn once"},
      {"--tour", {"--photos"}, "there are no photos between the cameras"},
      {"--path",
       {"--cameras", "--view", "--eye", "--orbit", "--frames"},
       "it names its own cameras, each frame drawn once"},
      {"--path", {"--tour", "--motion"}, "each is measured by itself"},
      {"--tour", {"--motion"}, "each is measured by itself"},
      {"--view", {"--views", "--test", "--test-every"}, "it names the views"},
      {"--validation", {"--views"}, "it names the views"},
      {"--keys", {"--seconds"}, "it draws the keys alone"},
      {"--cant", {"--convergence"}, "canted eyes have no common picture plane to shift"},
      {"--mono", {"--only"}, "it draws the camera itself, and --only an eye beside it"},
      {"--mono", {"--ipd", "--convergence", "--cant"}, "it has no rig"},
      {"--antialias", {"--no-antialias"}, "a model was trained either way"},
      {"--lod", {"--gpu-memory", "--detail"}, "both choose the levels of detail"},
      {"--detail", {"--repeat", "--place"}, "copies and placed models have one level of detail for all"},
      {"--calibration", {"--reference-until"}, "the reference uses no calibration"},
      {"--foveate",
       {"--quality", "--calibration"},
       "its tolerance is for whole pictures; give --tolerance for the context"},
      {"--foveate", {"--reference-until"}, "the reference draws whole pictures"},
      {"--foveate",
       {"--detail"},
       "levels of detail are chosen for whole pictures; --lod and --gpu-memory choose them once"},
      {"--resume", {"--json", "--photos"}, "it skips existing pictures, and these report all"},
      {"--vr180",
       {"--fov",         "--convergence", "--cant",      "--order",           "--projection", "--tiles",
        "--threshold",   "--tolerance",   "--quality",   "--transmittance",   "--show",       "--detail",
        "--calibration", "--photos",      "--precision", "--reference-until", "--exr-depth",  "--only",
        "--foveate",     "--preset"},
       "it draws both eyes, or --mono, exactly and along rays of its own"},
      {"--xr",
       {"--size", "--layout", "--ipd", "--convergence", "--cant", "--show", "--fov", "--output"},
       "the headset determines it"},
      {"--xr", {"--tiles", "--shader-dir"}, "headsets use the tile test ellipse"},
      {"--passthrough", {"--background"}, "the room is behind the model"},
      {"--frame-budget", {"--foveate"}, "a quality needs whole pictures"},
      {"--frame-budget", {"--quality", "--tolerance"}, "the budget chooses it"},
  };
  return rows;
}

const std::vector<Conflict>& needs() {
  static const std::vector<Conflict> rows = {
      {"--eye", {"--at"}, "what the camera looks at"},
      {"--at", {"--eye"}, "where the camera is"},
      {"--keys", {"--path"}, "the file of the keys"},
      {"--repeat", {"--spacing"}, "how far apart the copies are"},
      {"--spacing", {"--repeat"}, "how many copies there are"},
      {"--fail-if-slower", {"--compare"}, "the results.json of the run that it is to keep up with"},
      {"--scale", {"--xr"}, "it is for a headset", in::view},
      {"--frame-budget", {"--xr"}, "it is for a headset", in::view},
      {"--passthrough", {"--xr"}, "it is for a headset", in::view},
      {"--no-mirror", {"--xr"}, "it is for a headset", in::view},
      {"--record", {"--xr"}, "it is for a headset", in::view},
      {"--foveate", {"--xr"}, "it is for a headset", in::view},
      {"--backend", {"--xr"}, "a window draws with its display's GPU", in::view},
      {"--device", {"--xr"}, "a window draws with its display's GPU", in::view},
  };
  return rows;
}

}  // namespace binosplat::app
