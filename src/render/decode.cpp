#include "render/stages.h"

namespace binosplat::render {

void decode(gl::Dispatcher& dispatcher, const FrameShape& shape, const ModelBuffers& model,
            const FrameBuffers& buffers) {
  if (shape.offset_count == 0) return;
  // The anchor cull goes by 3D-GS's own tiles and knows no Th.
  const gl::Defines defines = {{"TILES_NAME", "aabb"},
                               {"TILES", std::to_string(TILES_AABB)},
                               {"TILE_SIZE", std::to_string(ANCHOR_TILE)},
                               {"TH", std::to_string(TH_TAU)},
                               {"TH_NAME", "tau"},
                               {"TRANSMITTANCE", std::to_string(TRANSMITTANCE_ONE)},
                               {"HIDDEN", std::to_string(model.networks.hidden)},
                               {"BANK", model.networks.bank ? "1" : "0"},
                               {"OFFSETS", std::to_string(shape.offset_count)}};
  const gl::Program& program = dispatcher.context().program("decode.comp", defines);
  for (const ModelBuffers::Page& page : model.pages) {
    const AnchorBuffers& anchors = *page.anchors;
    dispatcher.run(program, gl::Work::threads(std::uint64_t{shape.decoding_count()} * anchors.count, THREADS),
                   {{"Views", buffers.views},
                    {"Anchors", anchors.anchors},
                    {"Offsets", anchors.offsets},
                    {"Networks", model.networks.weights},
                    {"ViewFree", anchors.view_free},
                    {"Gaussians", *page.gaussians},
                    {"Harmonics", *page.harmonics},
                    {"Kept", anchors.kept}},
                   {{"anchor_count", anchors.count},
                    {"view_count", shape.asked},
                    {"views_per_decoding", shape.views_per_decoding},
                    {"offset_count", shape.offset_count},
                    {"anchor_cull", shape.settings.anchor_cull ? 1u : 0u}});
  }
}

}  // namespace binosplat::render
