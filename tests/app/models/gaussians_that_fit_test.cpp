// --gpu-memory for models whose chunks arrive later.
#include "app/models/level_options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "render/memory.h"
#include "render/scattered_upload.h"
#include "scene/camera.h"

namespace binosplat {
namespace {

// The model reserves room for all Gaussians that fit, although most arrive later. Memory is computed as for
// frames.
TEST(GaussiansThatFit, ReserveMemoryForGrowth) {
  const std::vector<shared::View> views(2, make_view(look_at({0, 0, -1}, {0, 0, 0}, {0, -1, 0}, 60, 64, 64)));
  const auto megabytes = [&](bool in_parts, double asked) {
    Model model;
    model.capacity = app::gaussians_that_fit(asked, {}, views, 0, in_parts);
    render::FrameSettings settings;
    settings.depth_table = {1.0f, {1.0f}};
    const render::MemoryNeeds needs = render::memory_needs(render::make_plan(views, settings, model));
    // Each Gaussian of an upload takes 48 bytes, harmonics of 16 bytes and two indices.
    const std::size_t uploaded =
        std::bit_ceil(std::min<std::size_t>(model.capacity, render::ScatteredUpload::records_at_once));
    return 1e-6 *
           static_cast<double>(needs.model + needs.frame +
                               (in_parts ? static_cast<std::int64_t>(uploaded) * (48 + 16 + 2 * 4) : 0));
  };
  for (const double asked : {50.0, 400.0, 900.0, 4000.0}) {
    EXPECT_LE(megabytes(true, asked), asked);
    EXPECT_GT(megabytes(true, asked), 0.9 * asked);
  }
  EXPECT_GT(megabytes(false, 900.0), 1000.0) << "injected: as if all of it were there";
}

}  // namespace
}  // namespace binosplat
