// What depths are sorted by: fewer bits than a float's where the model's box says that they suffice.

#include <algorithm>
#include <bit>

#include "render/stages.h"
#include "render/support.h"

namespace binosplat {
namespace {

TEST(OrderKeys, HoldEveryDepthOfTheBoxInAsFewBitsAsTheFarthestNeeds) {
  const Model model = test::random_model(3, 4000, 0);
  const Bounds box = all_bounds(model);
  for (const glm::dvec3& eye : {glm::dvec3(0, 0, -5), glm::dvec3(900, 30, -70), glm::dvec3(0.1, 0.2, 0.3)}) {
    Camera camera = test::front_camera(64, 48, 50);
    camera.position = eye;
    const auto plan = render::make_plan(std::vector{make_view(camera)}, {}, model, {}, {.box = box});
    const shared::View& view = plan.views.front();
    const render::OrderGroup group = plan.groups.front();
    std::uint32_t most = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                         corner & 4 ? box.high.z : box.low.z);
      const double depth =
          glm::dot(glm::dvec3(view.row_z), p - glm::dvec3(view.anchor)) + double(view.row_z.w);
      if (depth > view.anchor.w)
        most = std::max(most, std::bit_cast<std::uint32_t>(static_cast<float>(depth)) - group.nearest_key);
    }
    EXPECT_LE(static_cast<std::uint32_t>(std::bit_width(most)), group.key_bits);
    EXPECT_LE(group.key_bits, static_cast<std::uint32_t>(std::bit_width(most)) + 1);  // the slack of fp32
  }
}

TEST(OrderKeys, WithABitLessTheOrderIsWrong) {
  const Model model = test::random_model(4, 3000, 0);
  const std::vector<shared::View> views = {make_view(test::front_camera(64, 48, 50))};
  const auto depths_in_order = [&](std::uint32_t bits_less) {
    test::StageRun run(model, views);
    run.run_until(render::Stage::project);
    render::FramePlan plan = run.plan;
    plan.groups.front().key_bits -= bits_less;
    gl::Dispatcher dispatcher(test::gl_context());
    render::order(dispatcher, plan, 0, run.frame);
    const auto splats = run.frame.projected.splats.read<shared::Splat>(run.indices.front().size());
    std::vector<float> depths;
    for (const std::uint32_t slot : run.frame.ordering.order.values().read<std::uint32_t>(splats.size()))
      depths.push_back(splats[slot].depth);
    return depths;
  };
  const auto in_order = depths_in_order(0);
  EXPECT_GT(in_order.size(), 500u);
  EXPECT_TRUE(std::is_sorted(in_order.begin(), in_order.end()));
  const auto short_of_a_digit = depths_in_order(9);
  EXPECT_FALSE(std::is_sorted(short_of_a_digit.begin(), short_of_a_digit.end()));
}

}  // namespace
}  // namespace binosplat
