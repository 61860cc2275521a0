// The visibility of a model's chunks in views.

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

/// A model on the GPU. Its chunks consist of the Gaussians at these indices.
struct Chunked {
  Model model;
  ModelChunks chunks;
  std::shared_ptr<render::GpuModel> gpu_model;

  Chunked(const Model& all, const Indices& indices, std::uint32_t page = 0, int precision = PRECISION_FULL)
      : model(without_gaussians(all)), chunks(indices.size()) {
    for (std::size_t p = 0; p < indices.size(); ++p) chunks.replace(model, p, with_order(all, indices[p]));
    gpu_model = std::make_shared<render::GpuModel>(test::gl_context(), model, precision, page);
  }

  std::vector<std::vector<ChunkVisibility>> measure(const std::vector<shared::View>& views,
                                                    const FrameSettings& settings = {},
                                                    int max_shrink = 4) const {
    return Visibility(gpu_model).measure(views, settings, chunks, max_shrink);
  }
};

Indices each(std::size_t count) {
  Indices indices;
  for (std::uint32_t i = 0; i < count; ++i) indices.push_back({i});
  return indices;
}

/// Returns indices of `count` Gaussians, distributed to chunks in turn.
Indices dealt_indices(std::size_t count, std::size_t chunks) {
  Indices indices(chunks);
  for (std::uint32_t i = 0; i < count; ++i) indices[i % chunks].push_back(i);
  return indices;
}

shared::View small_view() { return make_view(test::front_camera(side, side, focal)); }

/// Returns a wall 2 units ahead, balls before and behind it, and one behind the eye.
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

TEST(Visibility, DecreasesBehindOccluders) {
  const auto chunks = Chunked(wall_with_balls(), {{0}, {1}, {2}, {3}, {}}).measure({small_view()}).at(0);
  ASSERT_EQ(chunks.size(), 5u);
  const double ball = of_ball(0.5, 0.05 * focal), behind = of_ball(0.9, 0.1 * focal / 3.0) / 16.0;
  EXPECT_NEAR(chunks[2].area, ball, 0.05 * ball);
  EXPECT_NEAR(chunks[2].distance, 1.0, 1e-5);
  // The wall transmits a quarter of the light, so a quarter of the ball's area counts, less the part behind
  // the nearer ball.
  EXPECT_LT(chunks[0].area, behind);
  EXPECT_GT(chunks[0].area, 0.2 * behind);
  EXPECT_NEAR(chunks[0].distance, 3.0, 1e-5);
  EXPECT_GT(chunks[1].area, 0.75 * side * side - 2.0 * ball);
  EXPECT_LT(chunks[1].area, 0.75 * side * side);
  for (const std::size_t none : {3u, 4u}) EXPECT_EQ(chunks[none].area, 0.0);
}

TEST(Visibility, DistinguishesHiddenFromOutside) {
  Model model;
  test::add(model, {0, 0, 3}, glm::vec3(0.1f), 0.9f);
  for (const float z : {1.9f, 2.0f, 2.1f}) test::add(model, {0, 0, z}, glm::vec3(3.0f, 3.0f, 0.01f), 1.0f);
  test::add(model, {9, 0, 3}, glm::vec3(0.1f), 0.9f);
  const Chunked chunked(model, each(model.count()));
  const auto chunks = chunked.measure({small_view()}).at(0);
  EXPECT_GT(chunks[0].area, 0.0);
  EXPECT_LT(chunks[0].area, 1e-3);
  EXPECT_NEAR(chunks[0].distance, 3.0, 0.2);
  EXPECT_EQ(chunks[4].area, 0.0);
  const test::FaultyShaders faulty("chunk_visibility.comp", "max(area.x, hidden)", "area.x");
  EXPECT_EQ(chunked.measure({small_view()}).at(0)[0].area, 0.0);
}

TEST(Visibility, SumsAreasAndAveragesDistances) {
  const auto alone = Chunked(wall_with_balls(), each(4)).measure({small_view()}).at(0);
  const auto both = Chunked(wall_with_balls(), {{0}, {2, 3}, {1}}).measure({small_view()}).at(0);
  EXPECT_EQ(both[0].area, alone[0].area);
  EXPECT_EQ(both[1].area, alone[2].area + alone[3].area);
  EXPECT_EQ(both[2].area, alone[1].area) << "in whatever order they lie";
  const auto all = Chunked(wall_with_balls(), {{0, 1, 2, 3}}).measure({small_view()}).at(0);
  double area = 0.0, logarithm = 0.0;
  for (const ChunkVisibility& chunk : alone) {
    area += chunk.area;
    if (chunk.area > 0.0) logarithm += chunk.area * std::log(chunk.distance);
  }
  EXPECT_NEAR(all[0].area, area, 1e-9);
  EXPECT_NEAR(all[0].distance, std::exp(logarithm / area), 1e-5);
}

// Each Gaussian is a chunk, compared with the reference.
TEST(Visibility, MatchesReference) {
  const Model model = test::random_model(95, 1000, 0);
  const shared::View view = small_view();
  const auto splats = reference::project_all(model, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  const std::vector<double> expected = reference::measure_visibility(splats, lists, view);
  const auto differing = [&](std::uint32_t page) {
    const Chunked chunked(model, each(model.count()), page);
    const auto found = chunked.measure({view}).at(0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < model.count(); ++i) {
      count += std::abs(found[i].area - expected[i]) > 5e-4 + 1e-3 * expected[i] ? 1 : 0;
      if (found[i].area > 0.1)
        count += std::abs(found[i].distance - double{glm::length(model.position[i])}) > 1e-3 ? 1 : 0;
    }
    return count;
  };
  for (const std::uint32_t page : {0u, 10000u}) EXPECT_LE(differing(page), model.count() / 500);
  const test::FaultyShaders faulty("measure/visibility.glsl", "weight * transmittance[p] : 0.0",
                                   "weight : 0.0");
  EXPECT_GT(differing(0), model.count() / 10);
}

// GPUs with subgroups blend by blocks, others whole tiles. Some lists are long, and most of each is
// needed. A few Gaussians near the limit of visibility are in some tiles' lists only, and count as hidden.
TEST(Visibility, DoesNotDependOnSummation) {
  Model model = test::random_model(94, 60000, 0);
  for (float& opacity : model.opacity) opacity = 0.004f + 0.01f * opacity;
  const Chunked chunked(model, dealt_indices(model.count(), 100));
  const std::vector<shared::View> views = {make_view(test::front_camera(96, 64, 96))};
  const auto usual = chunked.measure(views).at(0);
  const auto is_usual = [&] {
    const auto same = [&](const ChunkVisibility& a, const ChunkVisibility& b) {
      return a.area == b.area && a.distance == b.distance;
    };
    return std::ranges::equal(usual, chunked.measure(views).at(0), same);
  };
  gl::Context& context = test::gl_context();
  context.use_subgroups(false);
  EXPECT_TRUE(is_usual());
  context.use_subgroups(true);
  const test::FaultyShaders faulty("measure/visibility.glsl", "atomicAdd(measured[2u * splat + 1u], high)",
                                   "high");
  EXPECT_FALSE(is_usual());
}

// Eyes of one order group and of two, together and alone. A smaller picture gives nearly the same visibility.
TEST(Visibility, ViewsAreIndependentOfEachOther) {
  const Model model = test::random_model(96, 3000, 0);
  Indices indices(20);
  for (std::uint32_t i = 0; i < model.count(); ++i) indices[i % 7 * (i % 3)].push_back(i);
  const Chunked chunked(model, indices);
  const Camera camera = test::front_camera(1100, 1030, 900.0);
  Camera beside = camera, turned = camera;
  beside.position.x += 0.1;
  turned.rotation = glm::dmat3(glm::dvec3(0.8, 0, 0.6), glm::dvec3(0, 1, 0), glm::dvec3(-0.6, 0, 0.8));
  std::vector<shared::View> views;
  for (const Camera& eye : {camera, beside, turned}) views.push_back(make_view(eye));
  const auto small = chunked.measure(views);
  const auto large = chunked.measure({views.back()}, {}, 1).at(0);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto alone = chunked.measure({views[v]}).at(0);
    for (std::size_t p = 0; p < indices.size(); ++p) {
      EXPECT_EQ(small[v][p].area, alone[p].area) << v << " " << p;
      EXPECT_EQ(small[v][p].distance, alone[p].distance) << v << " " << p;
    }
  }
  double apart = 0.0, sum = 0.0;
  for (std::size_t p = 0; p < indices.size(); ++p) {
    EXPECT_NEAR(small.back()[p].area, large[p].area, 0.1 * large[p].area + 100.0) << p;
    apart += std::abs(small.back()[p].area - large[p].area);
    sum += large[p].area;
  }
  EXPECT_LT(apart, 0.03 * sum);
  EXPECT_GT(apart, 0.0) << "injected: as large";
  EXPECT_GT(sum, 0.05 * 1100 * 1030);
}

// A pass leaves nothing to the next one, which has other views in another number.
TEST(Visibility, PassesAreIndependent) {
  const Model model = test::random_model(98, 2000, 0);
  const Indices indices = dealt_indices(model.count(), 9);
  const Chunked chunked(model, indices);
  Camera beside = test::front_camera(side, side, focal);
  beside.position.x += 0.2;
  const std::vector<shared::View> one = {small_view()}, two = {make_view(beside), small_view()};
  const auto same = [&] {
    Visibility visibility(chunked.gpu_model);
    bool all_same = true;
    for (const auto& views : {two, one, two, one}) {
      const auto again = visibility.measure(views, {}, chunked.chunks), alone = chunked.measure(views);
      for (std::size_t v = 0; v < views.size(); ++v) {
        for (std::size_t p = 0; p < indices.size(); ++p)
          all_same = all_same && again[v][p].area == alone[v][p].area &&
                     again[v][p].distance == alone[v][p].distance;
      }
    }
    return all_same;
  };
  EXPECT_TRUE(same());
  const test::FaultyShaders faulty("chunk_visibility.comp", "if (sum != uvec2(0)) sums[from] = uvec2(0);",
                                   "");
  EXPECT_FALSE(same());
}

TEST(Visibility, HalfPrecisionIsClose) {
  const Model model = test::random_model(97, 2000, 1);
  const Indices indices = dealt_indices(model.count(), 3);
  const auto full = Chunked(model, indices).measure({small_view()}).at(0);
  const auto half =
      Chunked(model, indices, 0, PRECISION_HALF).measure({small_view()}, {.precision = PRECISION_HALF}).at(0);
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(half[p].area, full[p].area, 0.02 * full[p].area);
    EXPECT_NEAR(half[p].distance, full[p].distance, 0.02 * full[p].distance);
    EXPECT_NE(half[p].area, full[p].area);
  }
}

// The blend can store visibility in each pixel instead of depth: the sums are equal.
TEST(Visibility, PixelSumsMatchChunks) {
  const Model model = test::random_model(95, 4000, 0);
  const shared::View view = small_view();
  const auto all = Chunked(model, {[&] {
                             std::vector<std::uint32_t> indices(model.count());
                             std::iota(indices.begin(), indices.end(), 0u);
                             return indices;
                           }()})
                       .measure({view})
                       .at(0)
                       .at(0)
                       .area;
  const auto in_pixels = [&](const FrameSettings& settings) {
    render::Frame frame(test::gl_context(), model);
    frame.draw({&view, 1}, settings, {.visibility_as_depth = true});
    const Picture picture = frame.read_pictures().front();
    return std::accumulate(picture.z_sum.begin(), picture.z_sum.end(), 0.0);
  };
  for (const Projection projection : {Projection::affine, Projection::tangent}) {
    FrameSettings settings{{.projection = projection}};
    // The tangent projection shows slightly different splats.
    const double bound = projection == Projection::affine ? 1e-4 : 0.2;
    EXPECT_NEAR(in_pixels(settings), all, bound * all);
    settings.tiles = TILES_ALL;  // drawn by the blend for any GPU
    EXPECT_NEAR(in_pixels(settings), all, bound * all);
  }
  const test::FaultyShaders faulty("blend_depth.glsl", "z_sum[p] += weight * transmittance[p]",
                                   "z_sum[p] += weight");
  EXPECT_GT(std::abs(in_pixels({}) - all), 0.1 * all);
}

TEST(Visibility, ComparesPictures) {
  const Model all = test::random_model(3, 60, 1), other = test::random_model(4, 20, 1);
  Chunked chunked(all, {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20}});
  Visibility visibility(chunked.gpu_model);
  const shared::View view = small_view();
  const auto picture = [&] {
    render::Frame frame(test::gl_context(), chunked.model);
    frame.draw({&view, 1}, {});
    return frame.read_pictures();
  };
  const auto before = picture();
  visibility.keep_picture(view, {});
  EXPECT_EQ(visibility.picture_error(view, {}), 0.0);
  chunked.chunks.replace(chunked.model, 1, other);
  const auto after = picture();
  double sum = 0.0;
  for (std::size_t i = 0; i < after[0].colour.size(); ++i) {
    const auto shown = [&](const Picture& p) { return glm::clamp(glm::dvec3(p.colour[i]), 0.0, 1.0); };
    const glm::dvec3 apart = shown(before[0]) - shown(after[0]);
    sum += glm::dot(apart, apart) / 3.0;
  }
  EXPECT_EQ(visibility.picture_error(view, {}), 0.0) << "injected: not uploaded";
  chunked.gpu_model->reload(chunked.chunks.take_changes());
  const double expected = sum / static_cast<double>(after[0].colour.size());
  EXPECT_GT(expected, 1e-4);
  EXPECT_NEAR(visibility.picture_error(view, {}), expected, 1e-3 * expected);
}

}  // namespace
}  // namespace binosplat
