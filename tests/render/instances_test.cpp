// Several instances in one frame, compared with the model into which the CPU merges them.

#include <glm/gtc/quaternion.hpp>

#include "formats/models/model_file.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "scene/reduce.h"
#include "scene/transform.h"
#include "stereo/rig.h"
#include "support/errors.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::Instance;
using render::InstancePlace;
using test::same_bits;

const Model nothing;

std::shared_ptr<render::GpuModel> upload(const Model& model) {
  return std::make_shared<render::GpuModel>(test::gl_context(), model);
}

std::vector<shared::View> eyes_of(const Camera& head) {
  const auto views = stereo::make_rig(head, {.ipd = 0.1}).views;
  return {views.begin(), views.end()};
}

InstancePlace sample_place() {
  const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(glm::dvec3(0.3, 1.0, -0.2)));
  return {.rotation = glm::mat3_cast(turn), .translation = {-2.1, 0.4, 2.9}, .scale = 0.6};
}

/// Returns the instance as a model in the frame's world.
Model moved(Model model, const InstancePlace& place) {
  glm::dmat4 map(place.scale * place.rotation);
  map[3] = glm::dvec4(place.translation, 1.0);
  std::vector<glm::dvec3> places;
  EXPECT_TRUE(transform(model, map, places));
  for (std::size_t i = 0; i < model.count(); ++i) {
    model.position[i] = glm::vec3(places[i]);
    model.opacity[i] *= place.opacity;
  }
  return model;
}

Model joined(Model a, const Model& b) {
  append(a, b, 0, b.count());
  return a;
}

Model part_of(const Model& model, std::size_t begin, std::size_t end) {
  std::vector<std::uint8_t> kept(model.count(), 0);
  std::fill(kept.begin() + static_cast<std::ptrdiff_t>(begin),
            kept.begin() + static_cast<std::ptrdiff_t>(end), 1);
  Model part = model;
  keep_only(part, kept);
  return part;
}

struct Mode {
  const char* name;
  FrameSettings settings;
};

/// Returns settings of frames without a measured transmittance.
std::vector<Mode> modes() {
  const DepthTable table{.far = 8.0f, .bounds = {1.0f, 0.9f, 0.7f, 0.5f, 0.3f, 0.2f, 0.1f, 0.05f}};
  return {{"exact", {}},
          {"distance", {{.order = Order::distance}}},
          {"tangent", {{.projection = Projection::tangent}}},
          {"both", {{.order = Order::distance, .projection = Projection::tangent}}},
          {"squared", test::squared(1e-3f)},
          {"by depth",
           {{.tolerance = 0.05f,
             .threshold = Threshold::adagscale,
             .transmittance = Transmittance::depth,
             .depth_table = table}}},
          {"half", {.precision = PRECISION_HALF}}};
}

struct Instances : testing::Test {
  const Model model = test::random_model(71, 4000, 3);
  const std::vector<shared::View> views = eyes_of(test::front_camera(96, 80, 70));

  std::vector<Picture> draw(const std::vector<Instance>& instances,
                            const FrameSettings& settings = {}) const {
    render::Frame frame(upload(nothing));
    frame.place(instances);
    frame.draw(views, settings);
    return frame.read_pictures();
  }
};

TEST_F(Instances, HalvesEqualModel) {
  const Model first = part_of(model, 0, 1500), second = part_of(model, 1500, model.count());
  for (const Mode& mode : modes()) {
    const auto halves = draw({{upload(first), {}}, {upload(second), {}}}, mode.settings);
    const auto whole = test::draw(model, views, mode.settings);
    for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_TRUE(same_bits(halves[eye], whole[eye])) << mode.name;
    EXPECT_FALSE(same_bits(draw({{upload(first), {}}}, mode.settings)[0], whole[0])) << "injected: one half";
  }
}

TEST_F(Instances, InstanceEqualsMovedModel) {
  const InstancePlace place = sample_place();
  const Model there = moved(model, place);
  const auto shown = upload(model);
  for (const Mode& mode : modes()) {
    FrameSettings own = mode.settings;
    const auto instance = draw({{shown, place}}, own), expected = test::draw(there, views, own);
    for (std::size_t eye = 0; eye < 2; ++eye)
      EXPECT_GT(test::psnr(instance[eye], expected[eye]), 60.0) << mode.name << " " << eye;
    EXPECT_LT(test::psnr(expected[0], expected[1]), 40.0) << "injected: the other eye";
  }
}

// Each fault alone, in a shader or in a model.
TEST_F(Instances, DetectInjectedFaults) {
  const InstancePlace place = sample_place();
  const Model there = moved(model, place);
  const auto expected = test::draw(there, views);
  // These faults omit the instance's scale: from the covariance to which the low-pass in px is added, and
  // from the distance.
  const auto faulty = [&](const test::ShaderFault& fault, const FrameSettings& settings) {
    const auto exact = test::draw(there, views, settings);
    const test::FaultyShaders injected({fault});
    EXPECT_LT(test::psnr(draw({{upload(model), place}}, settings)[0], exact[0]), 45.0) << fault.fault;
  };
  faulty({"projection.glsl", "precise vec3 jx = gain.x * (view.row_x.xyz",
          "precise vec3 jx = gain.x / view.eye.w * (view.row_x.xyz"},
         {});
  faulty({"projection/tangent.glsl",
          "vec3 away = d - view.eye.xyz;\n  precise float distance = view.eye.w * sqrt",
          "vec3 away = d - view.eye.xyz;\n  precise float distance = sqrt"},
         {{.order = Order::distance, .projection = Projection::tangent}});
  // Injected: harmonics that are not rotated.
  Model unturned = there;
  unturned.sh = model.sh;
  EXPECT_LT(test::psnr(test::draw(unturned, views)[0], expected[0]), 45.0);
}

TEST_F(Instances, AreSortedTogether) {
  const Model few = test::random_model(71, 100, 3), other = test::random_model(72, 60, 3);
  InstancePlace place{.translation = {-0.3, 0.1, 0.6}, .scale = 0.4, .opacity = 0.5f};
  const auto on_gpu = upload(few);
  const auto several = draw({{on_gpu, {}}, {upload(other), place}, {on_gpu, sample_place()}});
  const auto expected =
      test::draw(joined(joined(few, moved(other, place)), moved(few, sample_place())), views);
  for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_GT(test::psnr(several[eye], expected[eye]), 60.0);
  place.opacity = 1.0f;
  const auto opaque = draw({{on_gpu, {}}, {upload(other), place}, {on_gpu, sample_place()}});
  EXPECT_LT(test::psnr(opaque[0], expected[0]), 40.0) << "injected: its opacity";
}

// Models with another degree, low-pass and anti-aliasing have separate programs.
TEST_F(Instances, KeepTrainingSettings) {
  Model other = test::random_model(73, 3000, 1);
  other.kernel_px2 = 0.1;
  other.antialiased = true;
  const InstancePlace behind{.translation = {0, 0, 40}};
  // Neither model hides the other, so each must look as it does alone.
  FrameSettings settings;
  const auto together = draw({{upload(model), {}}, {upload(other), behind}}, settings);
  std::vector<Picture> front = test::draw(model, views), back = test::draw(moved(other, behind), views);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    Picture& over = front[eye];
    for (std::size_t k = 0; k < over.colour.size(); ++k) {
      over.colour[k] = {glm::vec3(over.colour[k]) + over.colour[k].w * glm::vec3(back[eye].colour[k]),
                        over.colour[k].w * back[eye].colour[k].w};
    }
    EXPECT_GT(test::psnr(together[eye], over), 60.0);
  }
}

TEST_F(Instances, HaveSeparateDepthTables) {
  const InstancePlace bare = sample_place();
  InstancePlace place = bare;
  place.depth_table = {.far = 9.0f, .bounds = {1.0f, 0.6f, 0.2f, 0.05f, 0.01f}};
  DepthTable in_world = place.depth_table;
  in_world.far *= static_cast<float>(place.scale);
  FrameSettings settings{
      {.tolerance = 0.2f, .threshold = Threshold::adagscale, .transmittance = Transmittance::depth}};
  const auto own = draw({{upload(model), place}}, settings);
  settings.depth_table = in_world;
  EXPECT_GT(test::psnr(own[0], test::draw(moved(model, bare), views, settings)[0]), 60.0);
  settings.depth_table.far = place.depth_table.far;
  EXPECT_LT(test::psnr(own[0], test::draw(moved(model, bare), views, settings)[0]), 60.0)
      << "injected: its scale";
  settings.depth_table.bounds = {1.5f};
  EXPECT_TRUE(test::fails_saying([&] { draw({{upload(model), bare}}, settings); }, {"table"}));
}

TEST_F(Instances, HundredShareMemoryOfModel) {
  gl::Context& context = test::gl_context();
  const auto shown = upload(model);
  const auto before = context.allocated_bytes();
  std::vector<Instance> crowd;
  Model merged;
  merged.degree = model.degree;
  for (int k = 0; k < 100; ++k) {
    InstancePlace place = sample_place();
    place.scale = 0.15;
    const int row = k / 10;
    place.translation = {0.5 * (k % 10 - 5), 0.5 * (row - 5), 4.0};
    crowd.push_back({shown, place});
    merged = joined(std::move(merged), moved(model, place));
  }
  const auto pictures = draw(crowd);
  EXPECT_EQ(context.allocated_bytes(), before);
  EXPECT_GT(test::psnr(pictures[0], test::draw(merged, views)[0]), 60.0);
}

TEST_F(Instances, MayMoveAppearAndDisappear) {
  const auto shown = upload(model);
  render::Frame frame(upload(nothing));
  const FrameSettings measured = test::squared(1e-3f, Transmittance::last);
  InstancePlace place = sample_place();
  const auto draw_next = [&](std::vector<Instance> instances) {
    frame.place(std::move(instances));
    return frame.draw(views, measured);
  };
  EXPECT_FALSE(draw_next({{shown, place}}).used_last);
  place.translation.x += 0.01;
  EXPECT_TRUE(draw_next({{shown, place}}).used_last);
  place.translation.x += 5.0;
  EXPECT_FALSE(draw_next({{shown, place}}).used_last);
  EXPECT_TRUE(draw_next({{shown, place}}).used_last);
  EXPECT_FALSE(draw_next({{shown, place}, {shown, {}}}).used_last) << "another one";
  EXPECT_EQ(draw_next({}).visible, 0u);
  const Picture empty = frame.read_pictures()[0];
  for (const glm::vec4& pixel : empty.colour) EXPECT_EQ(pixel, glm::vec4(0, 0, 0, 1));
  EXPECT_GT(draw_next({{shown, {}}}).visible, 0u);
}

TEST_F(Instances, FreeRemovedModels) {
  render::Frame frame(upload(nothing));
  const auto first = upload(model);
  auto second = upload(model);
  const std::weak_ptr<render::ModelBuffers> held = second->buffers_in(PRECISION_FULL);
  frame.place({{first, {}}, {second, sample_place()}});
  frame.draw(views);
  second.reset();
  EXPECT_FALSE(held.expired());
  frame.place({{first, {}}});
  EXPECT_TRUE(held.expired());
}

// A quality applies to all instances together, as if they were one model.
TEST_F(Instances, KeepQuality) {
  const auto shown = upload(model);
  render::Frame frame(upload(nothing));
  InstancePlace place = sample_place();
  const FrameSettings with_quality{{.quality = 40.0f, .threshold = Threshold::squared}};
  for (int k = 0; k < 4; ++k) {
    place.translation.x += 0.02;
    const std::vector<Instance> instances = {{shown, {}}, {shown, place}};
    frame.place(instances);
    EXPECT_GT(frame.draw(views, with_quality).quality, 38.0);
    EXPECT_GT(test::psnr(frame.read_pictures()[0], draw(instances)[0]), 38.0);
  }
}

TEST(InstancesOfScenes, HalvesOfFoxEqualFox) {
  REQUIRE_SCENE("fox", folder);
  const Model fox = load_model(folder / "fox.ply");
  const Camera camera = look_at({0, 0, -3}, {0, 0, 0}, {0, -1, 0}, 60, 160, 120);
  const auto views = eyes_of(camera);
  const std::size_t half = fox.count() / 2;
  const Model first = part_of(fox, 0, half), second = part_of(fox, half, fox.count());
  render::Frame frame(upload(nothing));
  frame.place({{upload(first), {}}, {upload(second), {}}});
  EXPECT_GT(frame.draw(views).visible, 1000u);
  const auto whole = test::draw(fox, views);
  for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_TRUE(same_bits(frame.read_pictures()[eye], whole[eye]));
}

}  // namespace
}  // namespace binosplat
