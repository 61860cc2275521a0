#include <array>

#include "render/stages.h"
#include "render/variants.h"

namespace binosplat::render {

namespace {

constexpr std::int64_t shared_bytes = 32768;  // which every driver offers

// The anchor cull uses the tile test of 3D Gaussian Splatting.
std::array<gl::Number, 11> decode_variant(const FramePlan& plan, const NetworkBuffers& networks) {
  const FrameSettings& s = plan.settings;
  const std::int64_t weights = networks.bytes <= shared_bytes ? networks.bytes / 16 : 0;
  return {
      gl::Number{"TILES", TILES_AABB, std::size(tiles_choices), tiles_choices[TILES_AABB].name},
      {"THRESHOLD", THRESHOLD_EXACT, std::size(threshold_choices), threshold_choices[THRESHOLD_EXACT].name},
      {"TRANSMITTANCE", TRANSMITTANCE_ONE, std::size(transmittance_choices)},
      {"ANTIALIASED", 0, 2},
      {"HIDDEN", networks.hidden, 4096},
      {"BANK", networks.bank, 2},
      {"OFFSETS", plan.offset_count, 32},
      {"WEIGHTS", static_cast<std::uint64_t>(weights), shared_bytes},
      {"HALF", s.precision == PRECISION_HALF, 2},
      {"ORDER", ORDER_DEPTH, std::size(order_choices)},
      projection_number(Projection::affine)};
}

}  // namespace

void decode(gl::Dispatcher& dispatcher, const FramePlan& plan, const ModelBuffers& model,
            const FrameBuffers& buffers) {
  if (plan.offset_count == 0) return;
  const gl::Program& program =
      dispatcher.context().program("decode_anchors.comp", decode_variant(plan, model.networks));
  for (std::size_t p = 0; p < model.pages.size(); ++p) {
    const ModelBuffers::Page& page = model.pages[p];
    const AnchorBuffers& anchors = *page.anchors;
    dispatcher.run(program,
                   gl::DispatchSize::threads(std::uint64_t{plan.requested_views} * anchors.count, THREADS),
                   {{"Frame", buffers.parameters},
                    {"Views", buffers.views},
                    {"Anchors", anchors.anchors},
                    {"Offsets", anchors.offsets},
                    {"Networks", model.networks.weights},
                    {"ViewFree", anchors.view_free},
                    {"Gaussians", *page.gaussians},
                    {"Harmonics", *page.harmonics},
                    {"Kept", *buffers.kept[p]}},
                   {{"anchor_count", anchors.count}});
  }
}

}  // namespace binosplat::render
