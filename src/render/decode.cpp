#include "render/stages.h"

namespace binosplat::render {

namespace {

bool reuses(const FrameShape& shape) {
  const FrameSettings& s = shape.settings;
  // What is hidden is told by the area of a splat as the affine projection, which the anchor cull goes by,
  // has it.
  return s.anchor_reuse && shape.perspective.projection == PROJECTION_AFFINE && measures(s.transmittance) &&
         !is_exact(s.th) && !shape.probe && shape.kernel_px2 == KERNEL_PX2;
}

// Of shared memory: what every driver has.
constexpr std::int64_t shared_bytes = 32768;

// The anchor cull goes by 3D-GS's own tiles.
gl::Defines decode_defines(const FrameShape& shape, const NetworkBuffers& networks) {
  const FrameSettings& s = shape.settings;
  const bool reuse = reuses(shape);
  gl::Defines defines = {
      {"TILES_NAME", "aabb"},
      {"TILES", std::to_string(TILES_AABB)},
      {"TILE_SIZE", std::to_string(ANCHOR_TILE)},
      {"TH", std::to_string(reuse ? s.th : TH_TAU)},
      {"TH_NAME", th_choices[reuse ? s.th : TH_TAU].name},
      {"TRANSMITTANCE", std::to_string(reuse ? s.transmittance : TRANSMITTANCE_ONE)},
      {"ANTIALIASED", "0"},
      {"HIDDEN", std::to_string(networks.hidden)},
      {"BANK", networks.bank ? "1" : "0"},
      {"OFFSETS", std::to_string(shape.offset_count)},
      {"WEIGHTS", std::to_string(networks.bytes <= shared_bytes ? networks.bytes / 16 : 0)},
      {"HALF", s.precision == PRECISION_HALF ? "1" : "0"},
      {"REUSE", reuse ? "1" : "0"},
      {"ORDER", std::to_string(ORDER_DEPTH)}};
  add_projection(defines, PROJECTION_AFFINE);
  return defines;
}

}  // namespace

void decode(gl::Dispatcher& dispatcher, const FrameShape& shape, const ModelBuffers& model,
            const FrameBuffers& buffers) {
  if (shape.offset_count == 0) return;
  const gl::Program& program =
      dispatcher.context().program("decode.comp", decode_defines(shape, model.networks));
  for (std::size_t p = 0; p < model.pages.size(); ++p) {
    const ModelBuffers::Page& page = model.pages[p];
    const AnchorBuffers& anchors = *page.anchors;
    dispatcher.run(program, gl::Work::threads(std::uint64_t{shape.decoding_count()} * anchors.count, THREADS),
                   {{"Frame", buffers.parameters},
                    {"Views", buffers.views},
                    {"Anchors", anchors.anchors},
                    {"Offsets", anchors.offsets},
                    {"Networks", model.networks.weights},
                    {"ViewFree", anchors.view_free},
                    {"Gaussians", *page.gaussians},
                    {"Harmonics", *page.harmonics},
                    {"Kept", *buffers.kept[p]},
                    {"KeptLast", *buffers.kept_last[p]},
                    {"Bounds", *buffers.bounds}},
                   {{"anchor_count", anchors.count}, {"page_first", page.first}});
  }
}

}  // namespace binosplat::render
