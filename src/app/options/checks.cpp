#include "app/options/checks.h"

#include "app/options/parse.h"
#include "base/choices.h"
#include "base/error.h"
#include "base/text.h"
#include "demo/demo.h"
#include "formats/models/streamed_sog.h"
#include "stereo/panorama.h"

namespace binosplat::app {

using gl::Backend;

namespace {

// Refuses --shard and --resume if pictures use earlier frames: the pictures would depend on the shard.
void check_shards(const Options& o) {
  if (o.shard.all() && !o.resume) return;
  const char* const part = o.resume ? "--resume" : "--shard";
  if (o.scene.detail && (o.camera.along_path() || o.camera.lens.vr180())) {
    fail("{} with --detail: a view's levels depend on the view before it; give --lod or --gpu-memory", part);
  }
  if (o.camera.along_path() && o.drawing.quality && !finds_k(o.drawing)) {
    fail(
        "{} with --quality along a path: a frame's tolerance depends on the frames before it; draw the path "
        "in one run, or give --tolerance or --calibration instead",
        part);
  }
  if (o.camera.along_path() && o.drawing.transmittance == Transmittance::last) {
    fail(
        "{} with --transmittance {} along a path: a frame uses measurements of those before it; draw the "
        "path in one run, or give another --transmittance",
        part, name_of(*o.drawing.transmittance));
  }
}

void check_vr180(const Options& o) {
  if (!o.camera.lens.vr180()) return;
  if (const auto& size = o.camera.lens.size; size && (size->x != size->y || size->x % 2 != 0)) {
    fail("--size {0}x{1} with --vr180: expected an even number of pixels twice, for one 2880x2880", size->x,
         size->y);
  }
  if (const auto& size = o.camera.lens.size; size && size->x > stereo::max_panorama_side)
    fail("--size {0}x{0} with --vr180: at most {1}x{1}", size->x, stereo::max_panorama_side);
  const int layout = o.picture.layout.value_or(LAYOUT_PARALLEL);
  if (layout != LAYOUT_PARALLEL && layout != LAYOUT_OVER_UNDER && layout != LAYOUT_SEPARATE)
    fail("--vr180 with --layout {}: expected parallel, over-under or separate", layout_choices[layout].name);
  const std::string ending = lowered_ending(o.output);
  if (ending == ".mkv" || ending == ".webm")
    fail("-o {}: expected .mp4 or .mov, which can be marked as VR180", o.output);
}

}  // namespace

void check(const SceneOptions& o) {
  if (o.name != demo_city_name && (o.seed || o.count))
    fail("{} is for {}, not for {}", o.seed ? "--seed" : "--count", demo_city_name, o.name);
  const char* const of_files = o.lod && o.place.empty() ? "--lod"
                               : o.gpu_memory           ? "--gpu-memory"
                               : o.detail               ? "--detail"
                               : o.appearance           ? "--appearance"
                               : !o.format.empty()      ? "--format"
                               : !o.axes.empty()        ? "--axes"
                                                        : nullptr;
  if (of_files != nullptr && is_built_in(o.name)) fail("{} is for model files, not for {}", of_files, o.name);
}

void check(const ContextOptions& o) {
  if (o.device >= 0 && (o.backend == Backend::surfaceless || o.backend == Backend::osmesa))
    fail("--device is for GPUs: {} has none", o.backend == Backend::osmesa ? "osmesa" : "surfaceless");
}

bool quality_may_choose_levels(const Options& o) {
  return o.drawing.quality && !finds_k(o.drawing) && !o.scene.lod && !o.scene.repeat &&
         o.scene.place.empty() && o.scene.format.empty() && !is_built_in(o.scene.name) &&
         is_streamed_sog(o.scene.name);
}

void check_foveate(const Options& o) {
  if (!o.drawing.foveation) return;
  if (o.picture.show >= SHOW_ALPHAS) {
    fail("--foveate with --show {}: this debug view needs one picture, and a foveated one has two",
         show_choices[o.picture.show].name);
  }
  if (o.picture.exr_depth == DepthKind::median)
    fail("--foveate with --exr-depth median: medians of inset and context cannot be mixed in the seam");
  if (o.rig.one_picture() && o.drawing.foveation->gaze.size() > 1)
    fail("--foveate gaze: two gazes are for both eyes: leave --mono and --only out, or give one");
}

void check(const Options& o) {
  check(o.scene);
  if (o.scene.detail && o.scene.detail->db && o.drawing.quality &&
      *o.scene.detail->db <= *o.drawing.quality) {
    fail(
        "--detail {}dB uses up the error that --quality {} allows: leave --detail out, and levels take half "
        "of it",
        *o.scene.detail->db, *o.drawing.quality);
  }
  if (o.camera.seconds && !o.camera.along_path())
    fail("--seconds needs --tour, of which it is a part, or --path, whose duration it is");
  if (o.camera.fov && o.camera.lens.headset())
    fail("--fov with --preset headset: the preset's lens has 100 degrees across");
  check(o.drawing);
  if (!o.photos.empty() && !o.rig.mono)
    fail("--photos needs --mono: a photo shows what the camera sees, not an eye beside it");
  if (o.rig.one_picture() && (o.picture.show == SHOW_DISAGREEMENT || o.picture.show == SHOW_DISPARITY))
    fail("--show {} is between both eyes: leave --mono and --only out", show_choices[o.picture.show].name);
  if (o.drawing.reference_until == render::Stage::blend && o.picture.show >= SHOW_ALPHAS) {
    fail("--show {} needs the GPU's blend, which --reference-until blend replaces",
         show_choices[o.picture.show].name);
  }
  if (o.drawing.reference_until == render::Stage::blend && o.picture.exr_depth == DepthKind::median)
    fail("--exr-depth median needs the GPU's blend, which --reference-until blend replaces");
  if (o.drawing.reference_until == render::Stage::blend && o.drawing.precision != PRECISION_FULL)
    fail("--precision half has no effect with --reference-until blend, which replaces all stages");
  check_shards(o);
  check_vr180(o);
  check_foveate(o);
  check(o.context);
}

}  // namespace binosplat::app
