// A frame in two calls, between which the caller uses the CPU.

#include <chrono>
#include <cstring>
#include <optional>
#include <thread>

#include "library/renderer_fixture.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

struct SubmitFinish : Library {
  Renderer renderer{caller.get_proc_address(), in_memory(test::random_model(3, 400, 2))};

  std::array<std::vector<float>, 2> pictures() const { return {read(0), read(1)}; }
};

bool same(const std::array<std::vector<float>, 2>& a, const std::array<std::vector<float>, 2>& b) {
  for (std::size_t k = 0; k < 2; ++k) {
    if (std::memcmp(a[k].data(), b[k].data(), a[k].size() * sizeof(float)) != 0) return false;
  }
  return true;
}

TEST_F(SubmitFinish, EqualsDraw) {
  // Three kinds of frames: those that write in place, those that copy, and those of a quality.
  Settings through_quality = over_black;
  through_quality.quality = 35.0f;
  std::vector<View> copied = views();
  for (View& view : copied) view.target.in_place = false;
  struct Case {
    std::vector<View> views;
    Settings settings;
    bool in_place;
  };
  for (const Case& c : {Case{views(), over_black, true}, Case{copied, over_black, false},
                        Case{views(), through_quality, true}}) {
    Renderer one(caller.get_proc_address(), in_memory(test::random_model(3, 400, 2)));
    Renderer two(caller.get_proc_address(), in_memory(test::random_model(3, 400, 2)));
    const Report once = one.draw(c.views, placement, c.settings);
    EXPECT_EQ(once.in_place, c.in_place);
    const auto drawn = pictures();
    one.draw(c.views, {.origin = {0.0, 1.5, 0.2}}, c.settings);
    ASSERT_FALSE(same(pictures(), drawn)) << "another picture goes unnoticed";
    two.submit(c.views, placement, c.settings);
    const Report report = two.finish();
    EXPECT_TRUE(same(pictures(), drawn));
    EXPECT_EQ(report.pairs, once.pairs);
    EXPECT_EQ(report.exact, once.exact);
  }
}

TEST_F(SubmitFinish, ReportsCompletion) {
  EXPECT_TRUE(renderer.is_done()) << "nothing is under way";
  renderer.submit(views(), placement, over_black);
  for (int k = 0; k < 3000 && !renderer.is_done(); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(renderer.is_done());
  renderer.finish();
}

TEST_F(SubmitFinish, RequiresAlternation) {
  EXPECT_ERROR(renderer.finish(), "submit()");
  renderer.submit(views(), placement, over_black);
  EXPECT_ERROR(renderer.submit(views(), placement, over_black), "finish()");
  EXPECT_ERROR(renderer.draw(views(), placement, over_black), "finish()");
  EXPECT_GT(renderer.finish().pairs, 0u);
  EXPECT_ERROR(renderer.finish(), "submit()");
  // A refused frame is not submitted.
  std::vector<View> bad = views();
  bad[0].size = glm::ivec2(0);
  EXPECT_THROW(renderer.submit(bad, placement, over_black), Error);
  EXPECT_ERROR(renderer.finish(), "submit()");
  EXPECT_GT(renderer.draw(views(), placement, over_black).pairs, 0u);
}

TEST_F(SubmitFinish, EndWithoutFinishSparesOtherRenderers) {
  std::optional<Renderer> gone(std::in_place, caller.get_proc_address(),
                               in_memory(test::random_model(3, 400, 2)));
  gone->submit(views(), placement, over_black);
  gone.reset();
  EXPECT_GT(renderer.draw(views(), placement, over_black).pairs, 0u);
}

}  // namespace
}  // namespace binosplat
