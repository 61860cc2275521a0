// Compares the stage decode on the GPU with its float64 reference. Other tests compare the reference with the
// trainer's values.

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "formats/models/scaffold_file.h"
#include "reference/decode.h"
#include "render/support.h"
#include "support/fixtures.h"
#include "support/scaffold.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

/// Returns the Gaussians of one view, by id.
std::map<std::size_t, reference::Decoded> read_decoding(test::StageRun& run, std::uint32_t view) {
  std::map<std::size_t, reference::Decoded> found;
  const std::uint32_t offsets = run.plan.offset_count;
  const std::vector<render::ModelBuffers::Page>& pages = run.drawn.model_buffers().pages;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    const render::ModelBuffers::Page& page = pages[p];
    const std::size_t first = std::size_t{view} * page.count;
    const auto gaussians = page.gaussians->read<shared::Gaussian>(page.count, first);
    const auto colours = page.harmonics->read<glm::vec4>(page.count, first);
    const auto kept =
        run.frame.kept[p]->read<std::uint32_t>(page.anchors->count, std::size_t{view} * page.anchors->count);
    for (std::size_t i = 0; i < page.count; ++i) {
      if ((kept[i / offsets] >> (i % offsets) & 1u) == 0) continue;
      const shared::Gaussian& g = gaussians[i];
      reference::Decoded& d = found[page.first + i];
      d.id = page.first + i;
      d.gaussian = {glm::dvec3(g.position), glm::dvec3(g.scale), glm::dvec4(g.rotation), g.position.w};
      d.colour = glm::dvec3(colours[i]) * test::sh_c0 + 0.5;
    }
  }
  return found;
}

struct Difference {
  double value = 0.0;     // the largest, over all Gaussians that both keep
  std::size_t kept = 0;   // number of Gaussians that both keep
  std::size_t alone = 0;  // number of Gaussians that only one keeps, with an alpha not within 1e-5 of 0
};

Difference compare_decoded(const std::map<std::size_t, reference::Decoded>& found,
                           const std::vector<reference::Decoded>& expected) {
  Difference difference;
  const auto apart = [&](const auto& a, const auto& b) {
    for (int c = 0; c < a.length(); ++c) difference.value = std::max(difference.value, std::abs(a[c] - b[c]));
  };
  std::set<std::size_t> alone;
  for (const auto& [id, d] : found) {
    if (d.gaussian.opacity > 1e-5) alone.insert(id);
  }
  for (const reference::Decoded& d : expected) {
    const auto at = found.find(d.id);
    if (at == found.end()) {
      if (d.gaussian.opacity > 1e-5) ++difference.alone;
      continue;
    }
    alone.erase(d.id);
    ++difference.kept;
    const reference::Gaussian& g = at->second.gaussian;
    apart(g.position, d.gaussian.position);
    apart(g.scale, d.gaussian.scale);
    apart(g.rotation, d.gaussian.rotation);
    apart(glm::dvec1(g.opacity), glm::dvec1(d.gaussian.opacity));
    apart(at->second.colour, d.colour);
  }
  difference.alone += alone.size();
  return difference;
}

shared::View front_view(double x = 0.0) {
  Camera camera = test::front_camera(96, 80, 96.0);
  camera.position.x = x;
  return make_view(camera, glm::vec3(0.0f), near_default);
}

Model model_of(Scaffold scaffold) {
  return placeholder_model(std::make_shared<Scaffold>(std::move(scaffold)));
}

Difference difference_of(const Model& model, const std::vector<shared::View>& views,
                         const render::FrameSettings& settings = {}) {
  test::StageRun run(model, views, settings);
  run.run_until(render::Stage::decode);
  Difference all;
  for (std::uint32_t v = 0; v < views.size(); ++v) {
    const Difference one = compare_decoded(
        read_decoding(run, v), reference::decode(*model.scaffold, views[v], settings.anchor_cull));
    all.value = std::max(all.value, one.value);
    all.kept += one.kept;
    all.alone += one.alone;
  }
  return all;
}

TEST(DecodeStage, MatchesReferenceForEveryKind) {
  std::vector<test::ScaffoldKind> kinds = {
      {},
      {.anchors = 300,
       .offsets = 4,
       .features = 8,
       .hidden = 7,
       .distances = true,
       .appearances = 2,
       .bank = true},
      {.anchors = 2, .offsets = 31, .features = 1, .hidden = 1},
  };
  // One option at a time, since each makes another shader; the kinds above combine them.
  if (test::switched_on("BINOSPLAT_LONG") || !test::gl_context().software())
    kinds.insert(kinds.end(), {{.distances = true}, {.appearances = 3}, {.bank = true}});
  for (const test::ScaffoldKind& kind : kinds) {
    Scaffold scaffold = test::random_scaffold(11, kind);
    if (kind.appearances > 0) choose_appearance(scaffold, 1);
    const Model model = model_of(std::move(scaffold));
    const Difference difference = difference_of(model, {front_view(-0.1), front_view(0.1)});
    EXPECT_LT(difference.value, 1e-5) << kind.offsets;
    EXPECT_EQ(difference.alone, 0u) << kind.offsets;
    EXPECT_GT(difference.kept, kind.anchors > 2 ? kind.anchors : 0) << kind.offsets;
  }
}

TEST(DecodeStage, DetectsInjectedFaults) {
  const Model good = model_of(test::random_scaffold(11, {.appearances = 3}));
  const std::vector<shared::View> views{front_view()};
  const auto differs = [&](const auto& inject) {
    Scaffold wrong = *good.scaffold;
    inject(wrong);
    const Model model = model_of(std::move(wrong));
    test::StageRun run(model, views);
    run.run_until(render::Stage::decode);
    const Difference difference =
        compare_decoded(read_decoding(run, 0), reference::decode(*good.scaffold, views[0]));
    return difference.value > 1e-5 || difference.alone > 0;
  };
  EXPECT_FALSE(differs([](Scaffold&) {}));
  EXPECT_TRUE(differs([](Scaffold& s) { s.colour.first[32] += 1e-2f; }));
  EXPECT_TRUE(differs([](Scaffold& s) { s.offset_scale.swap(s.scale); })) << "the anchor cull, too";
}

TEST(DecodeStage, WithoutCullDecodesHiddenAnchors) {
  const Model model = model_of(test::random_scaffold(13, {.anchors = 200}));
  const std::vector<shared::View> views{front_view()};
  const Difference culled = difference_of(model, views);
  const Difference whole = difference_of(model, views, {.anchor_cull = false});
  EXPECT_EQ(culled.alone + whole.alone, 0u);
  EXPECT_LT(whole.value, 1e-5);
  EXPECT_GT(whole.kept, culled.kept + 100);
}

TEST(DecodeStage, MatchesFixtureAndRealModel) {
  REQUIRE_FIXTURES(formats);
  REQUIRE_SCENE("scaffold", scenes);
  const Model fixture = placeholder_model(
      load_scaffold(OpenedFile(formats.parent_path() / "scaffold" / "fixture" / "point_cloud.ply")));
  const Difference of_fixture = difference_of(fixture, {front_view()}, {.anchor_cull = false});
  EXPECT_LT(of_fixture.value, 1e-3);
  EXPECT_EQ(of_fixture.alone, 0u);
  const Model fox = placeholder_model(load_scaffold(OpenedFile(scenes / "fox" / "point_cloud.ply")));
  Camera camera = test::front_camera(518, 944, 687.28);
  camera.position = {-2.63, 0.9, -3.28};
  const std::vector<shared::View> views{make_view(camera)};
  const Difference of_fox = difference_of(fox, views);
  EXPECT_LT(of_fox.value, 1e-3);
  // At the cull's edge, fp32 decides differently about a few anchors.
  EXPECT_LT(of_fox.alone, 20u);
  EXPECT_GT(of_fox.kept, 50000u);
  RecordProperty("fox_difference", std::to_string(of_fox.value));
  RecordProperty("fox_alone", std::to_string(of_fox.alone));
}

}  // namespace
}  // namespace binosplat
