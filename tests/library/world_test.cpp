// Several models in one world, placed by an application.

#include <glm/gtc/quaternion.hpp>

#include "library/renderer_fixture.h"
#include "scene/axes.h"
#include "shared/layout.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

Model seeded_model(std::uint32_t seed) { return test::random_model(seed, 2000, 1); }

Instance turned(ModelId model, double degrees) {
  Instance instance{.model = model, .translation = {0.4, -0.2, 3.0}, .scale = 0.5};
  instance.rotation = glm::mat3_cast(glm::angleAxis(glm::radians(degrees), glm::dvec3(0, 1, 0)));
  return instance;
}

TEST_F(Library, WorldOfOneModelEqualsModel) {
  const SplatModel model = in_memory(seeded_model(31));
  Renderer alone(caller.get_proc_address(), model), renderer(caller.get_proc_address());
  const std::vector<Instance> one = {{.model = renderer.add(model)}};
  alone.draw(views(), placement, over_black);
  const auto expected = read(0);
  EXPECT_GT(renderer.draw(views(), World{placement, one}, over_black).visible, 0u);
  EXPECT_EQ(read(0), expected);
  renderer.draw(views(), World{placement, std::vector{turned(one[0].model, 20.0)}}, over_black);
  EXPECT_NE(read(0), expected) << "injected: moved";
}

// Linear light is converted after it is blended, also where the blend writes the application's textures.
TEST_F(Library, ConvertsLinearColoursToSrgb) {
  Model model = seeded_model(35);
  Renderer plain(caller.get_proc_address(), in_memory(model));
  model.linear = true;
  Renderer linear(caller.get_proc_address(), in_memory(std::move(model)));
  plain.draw(views(), placement, over_black);
  const auto light = read(0);
  linear.draw(views(), placement, over_black);
  const auto shown = read(0);
  double error = 0.0, injected = 0.0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    if (k % 4 == 3) continue;
    error += std::abs(shown[k] - std::min(1.0f, shared::layout_to_display(light[k])));
    injected += std::abs(shown[k] - light[k]);
  }
  EXPECT_LT(error, 5e-3 * static_cast<double>(shown.size()));
  EXPECT_GT(injected, 2e-2 * static_cast<double>(shown.size())) << "unconverted";
}

// A moved instance looks as the model does from the eyes' positions in the model's own world.
TEST_F(Library, MovedInstanceEqualsMovedEyes) {
  Model model = seeded_model(32);
  for (const char* letters : {"RDF", "RUB", "LUF"}) {
    Model other = model;
    bring_into_axes(other, letters);
    const SplatModel in_its_axes = in_memory(std::move(other));
    Renderer alone(caller.get_proc_address(), in_its_axes), renderer(caller.get_proc_address());
    const Instance instance = turned(renderer.add(in_its_axes), 25.0);
    for (const bool foveated : {false, true}) {
      Settings settings = over_black;
      if (foveated) settings.foveation = Foveation{};
      renderer.draw(views(), World{placement, std::span(&instance, 1)}, settings);
      const auto seen = read(0);
      settings.near_plane = near_default / instance.scale;  // near plane in the model's units
      alone.draw(views(), renderer.in_model(placement, instance), settings);
      const auto expected = read(0);
      double error = 0.0, injected = 0.0;
      for (std::size_t k = 0; k < seen.size(); ++k) {
        error += std::abs(seen[k] - expected[k]);
        injected += std::abs(seen[k] - seen[seen.size() - 1 - k]);
      }
      EXPECT_LT(error, 1e-4 * static_cast<double>(seen.size())) << letters << foveated;
      EXPECT_GT(injected, 1e-2 * static_cast<double>(seen.size()));
    }
  }
}

TEST_F(Library, ModelsAreAddedAndRemoved) {
  Renderer renderer(caller.get_proc_address());
  const ModelId first = renderer.add(in_memory(seeded_model(33)));
  const std::vector<Instance> some = {{.model = first}};
  renderer.submit(views(), World{placement, some}, over_black);
  const ModelId second = renderer.add(in_memory(seeded_model(34)));  // while a frame is in flight
  EXPECT_TRUE(test::fails_saying([&] { renderer.remove(first); }, {"finish()"}));
  const auto with_one = renderer.finish().visible;
  const std::vector<Instance> both = {{.model = first}, {.model = second, .opacity = 0.5f}};
  EXPECT_GT(renderer.draw(views(), World{placement, both}, over_black).visible, with_one);
  std::vector<Instance> hidden = both;
  hidden[1].is_shown = false;
  EXPECT_EQ(renderer.draw(views(), World{placement, hidden}, over_black).visible, with_one);
  renderer.remove(second);
  EXPECT_TRUE(test::fails_saying(
      [&] {
        renderer.draw(views(), World{placement, both}, over_black);
      },
      {"instances[1].model", "add()"}));
  EXPECT_EQ(renderer.draw(views(), World{placement, some}, over_black).visible, with_one);
  EXPECT_EQ(renderer.draw(views(), World{placement, {}}, over_black).visible, 0u);
  EXPECT_TRUE(test::fails_saying([&] { renderer.draw(views(), placement, over_black); },
                                 {"without a model", "World"}));
}

TEST_F(Library, RejectsInvalidInstances) {
  Renderer renderer(caller.get_proc_address());
  const Instance good = turned(renderer.add(in_memory(seeded_model(35))), 10.0);
  const auto refused = [&](const char* said, const auto& spoil) {
    std::vector<Instance> instances = {good, good};
    spoil(instances[1]);
    EXPECT_TRUE(test::fails_saying(
        [&] {
          renderer.draw(views(), World{placement, instances}, over_black);
        },
        {"instances[1]", said}));
  };
  refused("scale", [](Instance& one) { one.scale = 0.0; });
  refused("rotation", [](Instance& one) { one.rotation *= 2.0; });
  refused("translation", [](Instance& one) { one.translation.x = 1e300; });
  refused("opacity", [](Instance& one) { one.opacity = 1.5f; });
  EXPECT_GT(renderer.draw(views(), World{placement, std::span(&good, 1)}, over_black).visible, 0u);
}

// Other kinds of frames: foveated, prepared, in half precision, with depth tables.
TEST_F(Library, WorldsAcceptSettings) {
  const SplatModel model = in_memory(seeded_model(36));
  for (const Precision precision : {Precision::full, Precision::half}) {
    Renderer renderer(caller.get_proc_address(), precision);
    std::vector<Instance> instances = {{.model = renderer.add(model)}};
    instances.push_back(turned(instances[0].model, 40.0));
    for (Instance& one : instances) one.depth_table = {.far = 6.0f, .bounds = {1.0f, 0.5f, 0.2f}};
    for (Settings settings : {over_black, Settings{.foveation = Foveation{}}, Settings{.quality = 38.0f},
                              Settings{.threshold = Threshold::adagscale}}) {
      if (settings.threshold == Threshold::adagscale) settings.tolerance = 0.05f;
      const World world{placement, instances};
      renderer.prepare(views(), world, settings);
      const Report report = renderer.draw(views(), world, settings);
      EXPECT_EQ(report.new_programs, 0);
      EXPECT_GT(report.visible, 0u);
    }
  }
}

}  // namespace
}  // namespace binosplat
