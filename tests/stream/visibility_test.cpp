// What views show of the parts of a model.

#include "stream/visibility.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>

#include "reference/render.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "scene/reduce.h"

namespace binosplat {
namespace {

using render::FrameSettings;

constexpr int side = 64;
constexpr double focal = 90.0;  // px

using Indices = std::vector<std::vector<std::uint32_t>>;

/// A model on the GPU with the Gaussians at these indices as parts.
struct Parted {
  Model model;
  ModelChunks parts;
  std::shared_ptr<render::GpuModel> gpu_model;

  Parted(const Model& all, const Indices& indices, std::uint32_t page = 0, int precision = PRECISION_FULL)
      : model(without_gaussians(all)), parts(indices.size()) {
    for (std::size_t p = 0; p < indices.size(); ++p) parts.replace(model, p, with_order(all, indices[p]));
    gpu_model = std::make_shared<render::GpuModel>(test::gl_context(), model, precision, page);
  }

  std::vector<std::vector<ChunkVisibility>> look(const std::vector<shared::View>& views,
                                          const FrameSettings& settings = {}, int shrink_most = 4) const {
    return Sight(gpu_model).look(views, settings, parts, shrink_most);
  }
};

Indices each(std::size_t count) {
  Indices indices;
  for (std::uint32_t i = 0; i < count; ++i) indices.push_back({i});
  return indices;
}

/// So many Gaussians, dealt out to parts in turn.
Indices dealt(std::size_t count, std::size_t parts) {
  Indices indices(parts);
  for (std::uint32_t i = 0; i < count; ++i) indices[i % parts].push_back(i);
  return indices;
}

shared::View sight_view() { return make_view(test::front_camera(side, side, focal)); }

/// A wall 2 units ahead, balls in front of it and behind it, and one behind the eye.
Model wall_with_balls() {
  Model model;
  test::add(model, {0, 0, 3}, glm::vec3(0.1f), 0.9f);
  test::add(model, {0, 0, 2}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.75f);
  test::add(model, {0, 0, 1}, glm::vec3(0.05f), 0.5f);
  test::add(model, {0, 0, -1}, glm::vec3(0.05f), 0.5f);
  return model;
}

double of_ball(double opacity, double deviation_px) {
  return opacity * 2.0 * glm::pi<double>() * (deviation_px * deviation_px + KERNEL_PX2);
}

TEST(Sight, IsLessOfWhatIsBehindOthers) {
  const auto parts = Parted(wall_with_balls(), {{0}, {1}, {2}, {3}, {}}).look({sight_view()}).at(0);
  ASSERT_EQ(parts.size(), 5u);
  const double ball = of_ball(0.5, 0.05 * focal), behind = of_ball(0.9, 0.1 * focal / 3.0) / 16.0;
  EXPECT_NEAR(parts[2].area, ball, 0.05 * ball);
  EXPECT_NEAR(parts[2].distance, 1.0, 1e-5);
  // A quarter of the light passes the wall, and a quarter of that counts; the ball before it takes some more.
  EXPECT_LT(parts[0].area, behind);
  EXPECT_GT(parts[0].area, 0.2 * behind);
  EXPECT_NEAR(parts[0].distance, 3.0, 1e-5);
  EXPECT_GT(parts[1].area, 0.75 * side * side - 2.0 * ball);
  EXPECT_LT(parts[1].area, 0.75 * side * side);
  for (const std::size_t none : {3u, 4u}) EXPECT_EQ(parts[none].area, 0.0);
}

TEST(Sight, TellsWhatIsHiddenFromWhatIsBeside) {
  Model model;
  test::add(model, {0, 0, 3}, glm::vec3(0.1f), 0.9f);
  for (const float z : {1.9f, 2.0f, 2.1f}) test::add(model, {0, 0, z}, glm::vec3(3.0f, 3.0f, 0.01f), 1.0f);
  test::add(model, {9, 0, 3}, glm::vec3(0.1f), 0.9f);
  const Parted parted(model, each(model.count()));
  const auto parts = parted.look({sight_view()}).at(0);
  EXPECT_GT(parts[0].area, 0.0);
  EXPECT_LT(parts[0].area, 1e-3);
  EXPECT_NEAR(parts[0].distance, 3.0, 0.2);
  EXPECT_EQ(parts[4].area, 0.0);
  const test::FaultyShaders faulty("parts_seen.comp", "max(area.x, hidden)", "area.x");
  EXPECT_EQ(parted.look({sight_view()}).at(0)[0].area, 0.0);
}

TEST(Sight, IsSumsAndMeans) {
  const auto alone = Parted(wall_with_balls(), each(4)).look({sight_view()}).at(0);
  const auto both = Parted(wall_with_balls(), {{0}, {2, 3}, {1}}).look({sight_view()}).at(0);
  EXPECT_EQ(both[0].area, alone[0].area);
  EXPECT_EQ(both[1].area, alone[2].area + alone[3].area);
  EXPECT_EQ(both[2].area, alone[1].area) << "in whatever order they lie";
  const auto all = Parted(wall_with_balls(), {{0, 1, 2, 3}}).look({sight_view()}).at(0);
  double area = 0.0, logarithm = 0.0;
  for (const ChunkVisibility& part : alone) {
    area += part.area;
    if (part.area > 0.0) logarithm += part.area * std::log(part.distance);
  }
  EXPECT_NEAR(all[0].area, area, 1e-9);
  EXPECT_NEAR(all[0].distance, std::exp(logarithm / area), 1e-5);
}

// Each Gaussian as a part of its own, against the reference.
TEST(Sight, IsWhatTheReferenceSees) {
  const Model model = test::random_model(95, 1000, 0);
  const shared::View view = sight_view();
  const auto splats = reference::project_all(model, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  const std::vector<double> expected = reference::measure_seen(splats, lists, view);
  const auto differing = [&](std::uint32_t page) {
    const Parted parted(model, each(model.count()), page);
    const auto found = parted.look({view}).at(0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < model.count(); ++i) {
      count += std::abs(found[i].area - expected[i]) > 5e-4 + 1e-3 * expected[i] ? 1 : 0;
      if (found[i].area > 0.1)
        count += std::abs(found[i].distance - double{glm::length(model.position[i])}) > 1e-3 ? 1 : 0;
    }
    return count;
  };
  for (const std::uint32_t page : {0u, 10000u}) EXPECT_LE(differing(page), model.count() / 500);
  {
    const test::FaultyShaders faulty("blending.glsl", "weight * transmittance[p] : 0.0", "weight : 0.0");
    EXPECT_GT(differing(0), model.count() / 10);
  }
  {
    const test::FaultyShaders faulty("blending.glsl", "transmittance[p] >= float(SEEN_LEAST)",
                                     "transmittance[p] >= 0.2");
    EXPECT_GT(differing(0), model.count() / 10);
  }
  const test::FaultyShaders faulty("parts_seen.comp", "views[v].anchor.xyz +", "0.5 +");
  EXPECT_GT(differing(0), model.count() / 10);
}

// Tiles of the usual size are drawn block by block, others as a whole; some lists are long, and most of each
// is needed. A few Gaussians at the brink of what can be seen are in some tiles' lists only, and count as
// hidden.
TEST(Sight, IsTheSameWhateverSummedItUp) {
  Model model = test::random_model(94, 60000, 0);
  for (float& opacity : model.opacity) opacity = 0.004f + 0.01f * opacity;
  const Parted parted(model, dealt(model.count(), 100));
  const std::vector<shared::View> views = {make_view(test::front_camera(96, 64, 96))};
  const auto usual = parted.look(views).at(0);
  const auto is_usual = [&](int tile_size) {
    const auto other = parted.look(views, {.tile_size = tile_size}).at(0);
    const double unnoticed = tile_size == TILE_SIZE_DEFAULT ? 0.0 : 1e-4;
    const auto same = [&](const ChunkVisibility& a, const ChunkVisibility& b) {
      return std::abs(a.area - b.area) <= unnoticed && std::abs(a.distance - b.distance) <= unnoticed;
    };
    return std::ranges::equal(usual, other, same);
  };
  EXPECT_TRUE(is_usual(32));
  gl::Context& context = test::gl_context();
  context.use_subgroups(false);
  EXPECT_TRUE(is_usual(TILE_SIZE_DEFAULT));
  context.use_subgroups(true);
  const auto misses = [&](const std::string& shader, const std::string& what, const std::string& instead) {
    const test::FaultyShaders faulty(shader, what, instead);
    return !is_usual(TILE_SIZE_DEFAULT);
  };
  if (context.software()) {
    EXPECT_TRUE(misses("blend_blocks.comp", "batch_measured[i] = 0;", ""));
    EXPECT_TRUE(misses("blend_blocks.comp", "pass_on(values[batch + i], batch_measured[i])",
                       "pass_on(values[begin + i], batch_measured[i])"));
  } else if (context.limits().subgroups_of_32) {
    EXPECT_TRUE(misses("blend_subgroups.comp", "batch_measured[self] = 0;", ""));
    EXPECT_TRUE(misses("blend_subgroups.comp", "at_hand = value_at(batch + self)",
                       "at_hand = value_at(begin + self)"));
  }
  const test::FaultyShaders faulty("blending.glsl", "atomicAdd(measured[2u * splat + 1u], high)", "high");
  EXPECT_FALSE(is_usual(32));
}

// Eyes of one order and of two, at once and by themselves; a smaller picture tells nearly the same.
TEST(Sight, OfSeveralViewsAndOfSmallerPictures) {
  const Model model = test::random_model(96, 3000, 0);
  Indices indices(20);
  for (std::uint32_t i = 0; i < model.count(); ++i) indices[i % 7 * (i % 3)].push_back(i);
  const Parted parted(model, indices);
  const Camera camera = test::front_camera(1100, 1030, 900.0);
  Camera beside = camera, turned = camera;
  beside.position.x += 0.1;
  turned.rotation = glm::dmat3(glm::dvec3(0.8, 0, 0.6), glm::dvec3(0, 1, 0), glm::dvec3(-0.6, 0, 0.8));
  std::vector<shared::View> views;
  for (const Camera& eye : {camera, beside, turned}) views.push_back(make_view(eye));
  const auto small = parted.look(views), large = parted.look(views, {}, 1);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto alone = parted.look({views[v]}).at(0);
    double apart = 0.0, sum = 0.0;
    for (std::size_t p = 0; p < indices.size(); ++p) {
      EXPECT_EQ(small[v][p].area, alone[p].area) << v << " " << p;
      EXPECT_EQ(small[v][p].distance, alone[p].distance) << v << " " << p;
      EXPECT_NEAR(small[v][p].area, large[v][p].area, 0.1 * large[v][p].area + 100.0) << v << " " << p;
      apart += std::abs(small[v][p].area - large[v][p].area);
      sum += large[v][p].area;
    }
    EXPECT_LT(apart, 0.03 * sum);
    EXPECT_GT(apart, 0.0) << "planted: as large";
    EXPECT_GT(sum, 0.05 * 1100 * 1030);
  }
}

// Nothing of a look is left for the next, of other views and another number of them.
// Whatever the width: bands end between cells.
TEST(Sight, OfBandsAddsUp) {
  const Model model = test::random_model(64, 3000, 0);
  const Parted parted(model, dealt(model.count(), 7));
  Sight sight(parted.gpu_model);
  for (const int width : {200, static_cast<int>(2 * BLEND_CELL + 1)}) {
    const std::vector<shared::View> views = {make_view(test::front_camera(width, 90, focal))};
    const auto all = sight.look(views, {}, parted.parts).at(0);
    for (const int count : {2, 3, 30}) {  // more than there are cells, too
      std::vector<double> areas(7, 0.0);
      std::size_t bands_with_any = 0;
      for (int k = 0; k < count; ++k) {
        const auto band = sight.look(views[0], {double(k) / count, double(k + 1) / count}, {}, parted.parts);
        for (std::size_t p = 0; p < 7; ++p) areas[p] += band[p].area;
        bands_with_any += band[3].area > 0.0 ? 1 : 0;
        EXPECT_LT(band[3].area, 0.99 * all[3].area) << "planted: the whole picture for a band";
      }
      EXPECT_GT(bands_with_any, 1u);
      for (std::size_t p = 0; p < 7; ++p) EXPECT_NEAR(areas[p], all[p].area, 0.01 + 1e-6 * all[p].area);
    }
  }
}

// Narrow ones show what a picture that is not drawn smaller does.
TEST(Sight, OfNarrowBandsIsThatOfWholeSize) {
  const Model model = test::random_model(64, 3000, 0);
  const Parted parted(model, dealt(model.count(), 7));
  Sight sight(parted.gpu_model);
  const std::vector<shared::View> views = {make_view(test::front_camera(1024, 1024, 4.0 * focal))};
  const auto small = sight.look(views, {}, parted.parts).at(0),
             whole = sight.look(views, {}, parted.parts, 1).at(0);
  constexpr int bands = 32;
  std::vector<double> areas(7, 0.0);
  for (int k = 0; k < bands; ++k) {
    const auto band = sight.look(views[0], {double(k) / bands, double(k + 1) / bands}, {}, parted.parts);
    for (std::size_t p = 0; p < 7; ++p) areas[p] += band[p].area;
  }
  for (std::size_t p = 0; p < 7; ++p) {
    EXPECT_NEAR(areas[p], whole[p].area, 0.01 + 1e-6 * whole[p].area);
    EXPECT_GT(std::abs(small[p].area - whole[p].area), 1e-5 * whole[p].area) << "planted: a smaller picture";
    EXPECT_NEAR(small[p].area, whole[p].area, 0.05 * whole[p].area);
  }
}

TEST(Sight, ForgetsWhatItSaw) {
  const Model model = test::random_model(98, 2000, 0);
  const Indices indices = dealt(model.count(), 9);
  const Parted parted(model, indices);
  Camera beside = test::front_camera(side, side, focal);
  beside.position.x += 0.2;
  const std::vector<shared::View> one = {sight_view()}, two = {make_view(beside), sight_view()};
  const auto same = [&] {
    Sight sight(parted.gpu_model);
    bool all_same = true;
    for (const auto& views : {two, one, two, one}) {
      const auto again = sight.look(views, {}, parted.parts), alone = parted.look(views);
      for (std::size_t v = 0; v < views.size(); ++v) {
        for (std::size_t p = 0; p < indices.size(); ++p)
          all_same = all_same && again[v][p].area == alone[v][p].area &&
                     again[v][p].distance == alone[v][p].distance;
      }
    }
    return all_same;
  };
  EXPECT_TRUE(same());
  const test::FaultyShaders faulty("parts_seen.comp", "if (sum != uvec2(0)) sums[from] = uvec2(0);", "");
  EXPECT_FALSE(same());
}

TEST(Sight, InHalfPrecision) {
  const Model model = test::random_model(97, 2000, 1);
  const Indices indices = dealt(model.count(), 3);
  const auto full = Parted(model, indices).look({sight_view()}).at(0);
  const auto half =
      Parted(model, indices, 0, PRECISION_HALF).look({sight_view()}, {.precision = PRECISION_HALF}).at(0);
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(half[p].area, full[p].area, 0.02 * full[p].area);
    EXPECT_NEAR(half[p].distance, full[p].distance, 0.02 * full[p].distance);
    EXPECT_NE(half[p].area, full[p].area);
  }
}

// What a pixel tells of it in the place of its depth is the same.
TEST(Sight, IsInPixelsToo) {
  const Model model = test::random_model(95, 4000, 0);
  const shared::View view = sight_view();
  const auto all = Parted(model, {[&] {
                            std::vector<std::uint32_t> indices(model.count());
                            std::iota(indices.begin(), indices.end(), 0u);
                            return indices;
                          }()})
                       .look({view})
                       .at(0)
                       .at(0)
                       .area;
  const auto in_pixels = [&](const FrameSettings& settings) {
    render::Frame frame(test::gl_context(), model);
    frame.draw({&view, 1}, settings);
    const Picture picture = frame.read_pictures().front();
    return std::accumulate(picture.z_sum.begin(), picture.z_sum.end(), 0.0);
  };
  for (const int projection : {PROJECTION_AFFINE, PROJECTION_TANGENT}) {
    FrameSettings settings{.projection = projection, .depth = Depth::seen};
    const double bound = projection == PROJECTION_AFFINE ? 1e-4 : 0.2;  // another one shows a little else
    EXPECT_NEAR(in_pixels(settings), all, bound * all);
    settings.tile_size = 8;
    EXPECT_NEAR(in_pixels(settings), all, bound * all);
  }
  const test::FaultyShaders faulty("blending.glsl", "z_sum[p] += weight * transmittance[p]",
                                   "z_sum[p] += weight");
  EXPECT_GT(std::abs(in_pixels({.depth = Depth::seen}) - all), 0.1 * all);
}

TEST(Sight, TriesPartsOut) {
  const Model all = test::random_model(3, 60, 1), other = test::random_model(4, 20, 1);
  Parted parted(all, {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20}});
  Sight sight(parted.gpu_model);
  const PartsTrial trial = sight.trial({});
  const auto picture = [&] {
    render::Frame frame(test::gl_context(), parted.model);
    const shared::View view = sight_view();
    frame.draw({&view, 1}, {});
    return frame.read_pictures();
  };
  const auto before = picture();
  trial.keep(sight_view());
  EXPECT_EQ(trial.differs(sight_view()), 0.0);
  parted.parts.replace(parted.model, 1, other);
  const auto after = picture();
  double sum = 0.0;
  for (std::size_t i = 0; i < after[0].colour.size(); ++i) {
    const auto shown = [&](const Picture& p) { return glm::clamp(glm::dvec3(p.colour[i]), 0.0, 1.0); };
    const glm::dvec3 apart = shown(before[0]) - shown(after[0]);
    sum += glm::dot(apart, apart) / 3.0;
  }
  EXPECT_EQ(trial.differs(sight_view()), 0.0) << "planted: not uploaded";
  trial.upload(parted.parts.take_changes());
  const double expected = sum / static_cast<double>(after[0].colour.size());
  EXPECT_GT(expected, 1e-4);
  EXPECT_NEAR(trial.differs(sight_view()), expected, 1e-3 * expected);
}

}  // namespace
}  // namespace binosplat
