// AdaGScale's analyses on scenes whose every number is known.

#include "lab/analyses.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/chromium.h"
#include "lab/contributions.h"
#include "scene/axes.h"
#include "support/gl.h"
#include "support/models.h"
#include "support/scenes.h"

namespace binosplat::lab {
namespace {

void expect_near(double got, double wanted, const std::string& what) {
  EXPECT_NEAR(got, wanted, 0.01 * std::abs(wanted)) << what;
}

/// Walls of one alpha everywhere, at depths 1 to 4.
constexpr double wall_alpha[] = {0.3, 0.9, 0.2, 0.8};
constexpr double wall_light[] = {1.0, 0.7, 0.07, 0.056};

Contributions of_walls() {
  Model model;
  model.name = "walls";
  for (int i = 0; i < 4; ++i)
    test::add(model, {0, 0, 1 + i}, glm::vec3(1e4f, 1e4f, 1e-3f), static_cast<float>(wall_alpha[i]));
  const ContributionView view{"front", make_view(test::front_camera(32, 24, 32.0)), {}};
  const DepthTable table{5.0f, {1.0f, 1.0f, 1.0f, 0.1f, 1.0f}};
  int views = 0;
  Contributions found = contributions(model, std::span(&view, 1), table, table, [&] { ++views; });
  EXPECT_EQ(views, 1);
  return found;
}

TEST(Contributions, ByDepthAreThoseOfTheWalls) {
  std::size_t walls = 0;
  for (const DepthBin& bin : of_walls().by_depth) {
    if (bin.gaussians == 0) {
      EXPECT_TRUE(std::isnan(bin.transmittance.largest));
      continue;
    }
    ASSERT_EQ(bin.gaussians, 1u);
    const std::size_t i = walls;
    for (double Spread::*which : {&Spread::median, &Spread::p90, &Spread::largest}) {
      expect_near(bin.transmittance.*which, wall_light[i], "light");
    }
    ++walls;
  }
  EXPECT_EQ(walls, 4u);
}

TEST(Contributions, SkippingCostsWhatTheWallsContribute) {
  // White walls over black: the picture is 1 - T. Skipped are by alpha T the third, the last, the first; by
  // alpha the third, the first, the last.
  const Contributions found = of_walls();
  const auto rest = [](std::initializer_list<int> kept) {
    double t = 1.0;
    for (const int i : kept) t *= 1.0 - wall_alpha[i];
    return t;
  };
  const auto db = [&](double t) { return -20.0 * std::log10(t - rest({0, 1, 2, 3})); };
  const struct {
    std::size_t curve;
    double quarter, half, most;
  } wanted[] = {{0, db(rest({0, 1, 3})), db(rest({0, 1})), db(rest({1}))},
                {1, db(rest({0, 1, 3})), db(rest({0, 1})), db(rest({1}))},
                {2, db(rest({0, 1, 3})), db(rest({1, 3})), db(rest({1}))},
                {3, db(rest({0, 1, 3})), db(rest({1, 3})), db(rest({1}))}};
  for (const auto& w : wanted) {
    const auto& [by, points] = found.skipping[w.curve];
    expect_near(points[2].share, 0.25, by);  // of up to 30 %
    expect_near(points[2].psnr_db, w.quarter, by + ", one");
    expect_near(points[4].psnr_db, w.half, by + ", two");
    expect_near(points[7].psnr_db, w.most, by + ", three");
    EXPECT_EQ(points[0].psnr_db, 100.0) << by << ": nothing is skipped yet";
  }
  EXPECT_GT(std::abs(db(rest({0, 1})) - db(rest({1, 3}))), 1.0) << "the rules could be mistaken";
}

/// Spots, each alone in a tile: what a tolerance leaves out and what that costs follows from their sizes.
struct Spots : testing::Test {
  static constexpr int columns = 6, rows = 2, tile = 16;
  static constexpr double focal = 100.0, depth = 10.0;
  struct Spot {
    double variance;  // px^2, low-pass included
    double opacity;
    bool left;
  };
  std::vector<Spot> spots;
  Model model;
  std::vector<CalibrationView> whole, left;

  Spots() {
    model.name = "spots";
    Camera camera = test::front_camera(columns * tile, rows * tile, focal);
    camera.name = "whole";
    whole.push_back({camera, {}});
    for (int n = 0; n < columns * rows; ++n) {
      const double variance = 1.5 + 0.06 * n, opacity = 0.1 + 0.07 * n;
      const int column = n % columns, row = n / columns;
      const double x = (column + 0.5) * tile - 0.5 * camera.width;
      const double y = (row + 0.5) * tile - 0.5 * camera.height;
      const auto scale = static_cast<float>(std::sqrt(variance - 0.3) * depth / focal);
      test::add(model, glm::vec3(x, y, focal) * static_cast<float>(depth / focal),
                glm::vec3(scale, scale, 1e-6f), static_cast<float>(opacity));
      spots.push_back({variance, opacity, n % columns < columns / 2});
    }
    camera.name = "left";
    camera.width /= 2;  // the principal point stays: what the left half of the picture shows
    left.push_back({camera, {}});
  }

  static double error(const Spot& spot) {
    return spot.opacity * spot.opacity * M_PI * spot.variance;  // the integral of alpha^2 over the pixels
  }

  /// What the first `count` of a rule's victims cost: dB of the whole picture, and of the left half.
  struct Known {
    double whole_db, left_db, removed_left;
  };
  Known known(std::vector<Spot> order, double target) const {
    double all = 0.0, of_left = 0.0, removed = 0.0;
    Known k{100.0, 100.0, 0.0};
    const double pixels = columns * rows * tile * tile;
    for (const Spot& spot : order) {
      all += error(spot);
      const double db = -10.0 * std::log10(all / pixels);
      if (db < target) break;
      of_left += spot.left ? error(spot) : 0.0;
      removed += spot.left ? 2.0 / (columns * rows) : 0.0;
      k = {db, of_left > 0.0 ? -10.0 * std::log10(of_left / (0.5 * pixels)) : 100.0, removed};
    }
    return k;
  }
};

TEST_F(Spots, TolerancesCostWhatTheSpotsAreWorth) {
  const std::vector<double> targets = {30.0, 23.0};
  AnalysisSettings settings{.scene = "spots", .kind = CalibrationTarget::Kind::quality, .targets = targets};
  settings.frames = 1;
  std::map<std::string, std::size_t> told;
  const Analysis analysis = analyse(test::gl_context(), model, whole, left, settings,
                                    [&](const std::string& what, std::size_t done, std::size_t of) {
                                      EXPECT_LE(done, of);
                                      told[what] = done;
                                    });
  EXPECT_EQ(analysis.test_views, std::vector<std::string>{"left"});
  EXPECT_EQ(told["tolerances"], 2 * 2 * (calibrated_settings().size() + 1));

  const auto ordered = [&](auto worth) {
    std::vector<Spot> order = spots;
    std::sort(order.begin(), order.end(), [&](const Spot& a, const Spot& b) { return worth(a) < worth(b); });
    return order;
  };
  // Left out whole where Th > sigma (docs/method.md 5).
  const auto peripheral =
      ordered([](const Spot& s) { return (s.opacity - 1.0 / 255) * 2 * M_PI * s.variance; });
  const auto squared = ordered([](const Spot& s) { return s.opacity * s.opacity * M_PI * s.variance; });
  std::size_t checked = 0;
  EXPECT_EQ(analysis.depth_table.far, paper_far);
  EXPECT_NEAR(analysis.fitted_table.far, depth, 1e-3);
  for (const AnalysedSystem& entry : analysis.found) {
    const Known k = known(entry.settings.th == TH_PERIPHERAL ? peripheral : squared, *entry.target_db);
    const std::string what = fmt::format("{} at {}", entry.name, *entry.target_db);
    expect_near(*entry.reached_db, k.whole_db, what + ", calibration view");
    expect_near(entry.mean_db, k.left_db, what + ", test view");
    EXPECT_NEAR(entry.pairs_removed, k.removed_left, 1e-9) << what;
    EXPECT_EQ(entry.worst_view, "left");
    EXPECT_GT(k.removed_left, 0.0) << "of nothing this could not fail";
    ++checked;
  }
  EXPECT_EQ(checked, 2 * 7u);
  // Tuned on the test views themselves, what they lose is what was aimed at: equal drops.
  ASSERT_EQ(analysis.tuned.size(), analysis.found.size());
  for (const AnalysedSystem& entry : analysis.tuned) {
    EXPECT_EQ(entry.mean_db, *entry.reached_db) << entry.name;
    EXPECT_GE(entry.mean_db, *entry.target_db) << entry.name;
  }

  for (const AnalysedSystem& system : analysis.systems) {
    double sum = 0.0;
    for (const gl::StageTime& stage : system.times.stages) sum += stage.ms;
    expect_near(system.times.frame_ms, sum, system.name);
    if (system.settings.th != TH_TAU) continue;
    EXPECT_EQ(system.times.pairs, columns * rows / 2) << system.name;
  }
  EXPECT_EQ(analysis.systems.size(), 7u);
  EXPECT_EQ(analysis.systems.back().name, "binosplat, 23 dB");

  const Page page = analysis_page(analysis);
  for (const Section& section : page.sections) {
    EXPECT_EQ(section.problem, "") << section.id;
    EXPECT_EQ(section.sentence.find("nan"), std::string::npos) << section.sentence;
  }
}

TEST_F(Spots, ModelsOfOtherAxesAreSeenFromTheSameSide) {
  bring_into_axes(model, "RUB");
  const AnalysisSettings settings{
      .scene = "spots", .kind = CalibrationTarget::Kind::quality, .targets = {23.0}, .frames = 1};
  const Analysis analysis = analyse(test::gl_context(), model, whole, left, settings,
                                    [](const std::string&, std::size_t, std::size_t) {});
  int shown = 0;
  for (const DepthBin& bin : analysis.contributions.by_depth) shown += static_cast<int>(bin.gaussians);
  EXPECT_EQ(shown, columns * rows / 2);
  EXPECT_EQ(analysis.systems[0].times.pairs, columns * rows / 2);
}

/// Results of a run as analyse() leaves them, small.
Analysis sample_analysis() {
  const auto system = [](const std::string& name, const render::FrameSettings& settings, double db,
                         double removed) {
    return AnalysedSystem{
        db,      1.25 * db, "b",
        removed, {},        {},
        name,    settings,  {4.0 * (1 - removed), 100.0, {{"project", 1.0}, {"blend", 3.0 - 4.0 * removed}}}};
  };
  Analysis a{.device = "llvmpipe",
             .scene = "fox",
             .gaussians = 5,
             .calibration_views = {"a"},
             .test_views = {"b", "c"},
             .width = 30,
             .height = 20,
             .calibration_photo_db = 31.5,
             .test_photo_db = 30.25,
             .depth_table = {100.0f, {1.0f, 0.5f, 0.0f}},
             .fitted_table = {2.0f, {1.0f, 0.5f}}};
  for (const char* by : {"alpha T", "alpha max(T)", "alpha T_upper(depth)", "alpha"}) {
    SkippingCurve& curve = a.contributions.skipping.emplace_back(SkippingCurve{by, {}});
    for (int n = 1; n < 10; ++n) curve.points.push_back({0.1 * n, 80.0 - 5 * n, 0.01 * n});
  }
  a.contributions.by_distance = {{0.0, 1.0, 4, 3.0, 0.9}, {1.0, 1.4, 8, 1.0, 0.25}};
  a.contributions.by_depth = {{0.0, 1.0, 0, {}, 1.0}, {1.0, 2.0, 7, {0.75, 0.75, 0.75}, 0.5}};
  a.systems = {system("3D-GS", {.tiles = TILES_AABB}, 0.0, 0.0),
               system("FlashGS, AdR-Gaussian", {}, 0.0, 0.0)};
  for (const double target : {0.1, 0.2}) {
    const render::FrameSettings settings{
        .th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST, .tolerance = 0.5f};
    a.found.push_back(system("squared, last", settings, target + 0.03125, 2 * target));
    a.found.back().target_db = a.found.back().reached_db = target;
    a.tuned.push_back(a.found.back());
  }
  return a;
}

TEST(AnalysisPage, JsonHasWhatIsKnown) {
  const auto json = nlohmann::ordered_json::parse(to_json(sample_analysis()).dump());
  EXPECT_EQ(json["views"],
            nlohmann::ordered_json({{"calibration", {"a"}}, {"test", {"b", "c"}}, {"chosen", ""}}));
  EXPECT_EQ(json["photo_db"]["test"], 30.25);
  EXPECT_TRUE(json["contributions"]["by_depth"][0]["light"]["p90"].is_null());
  EXPECT_EQ(json["contributions"]["skipping"][3]["points"][0]["drop_db"], 0.01);
  EXPECT_FALSE(json["systems"][0].contains("target_db"));
  EXPECT_EQ(json["contributions"]["by_distance"][1]["fragments"], 8);
  EXPECT_EQ(json["found"][1]["target_db"], 0.2);
  EXPECT_EQ(json["found"][1]["settings"]["tolerance"], 0.5);
  EXPECT_EQ(json["tuned"][1]["stages_ms"]["project"], 1.0);
  EXPECT_EQ(json["fitted_table"]["far"], 2.0);
}

TEST(AnalysisPage, SaysWhatItShows) {
  const Page page = analysis_page(sample_analysis());
  std::vector<std::string> ids;
  for (const Section& section : page.sections) ids.push_back(section.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"scene", "systems", "skipping", "contributions", "light",
                                           "real-drops", "removed", "speed"}));
  EXPECT_NE(page.sections[1].sentence.find("25, 0, 0, 75 %"), std::string::npos) << page.sections[1].sentence;
  EXPECT_NE(
      page.sections[2].sentence.find("cost 0.08 dB (the paper's four scenes: 0.60), 60 % by alpha max(T) "
                                     "0.06 (0.41), 50 % by alpha T_upper(depth) 0.05 (0.51)"),
      std::string::npos)
      << page.sections[2].sentence;
  EXPECT_NE(page.sections[3].title.find("distance between Gaussian and pixel"), std::string::npos);
  EXPECT_EQ(page.sections[3].table->rows[1], row(1.0, 1.4, std::uint64_t{8}, 0.125, 0.25, 100.0));
  EXPECT_NE(page.sections[3].sentence.find("within 1.4 px"), std::string::npos) << page.sections[3].sentence;
  EXPECT_NE(page.sections[4].sentence.find("In 1 of 1 bins"), std::string::npos) << page.sections[4].sentence;
  EXPECT_NE(page.sections[4].sentence.find("Of the paper's 3 bins over [0, 100] 1 are 1, and 1 have no"),
            std::string::npos)
      << page.sections[4].sentence;
  EXPECT_NE(page.sections[5].sentence.find("at most 0.031 dB more than the target"), std::string::npos)
      << page.sections[5].sentence;
  EXPECT_NE(page.sections[6].sentence.find(
                "“squared, last” removes the most pairs of the exact ellipse test: 40.0 % at 0.2 dB"),
            std::string::npos)
      << page.sections[6].sentence;
  EXPECT_NE(page.sections[7].sentence.find("1.67 times as fast"), std::string::npos)
      << page.sections[7].sentence;
  EXPECT_EQ(page.sections[5].table->rows[1],
            row("squared, last", 0.2, 0.2, 0.23125, 1.25 * 0.23125, "b", 0.5));
  // The paper's own figures stand beside, for a drop alone.
  EXPECT_EQ(page.sections[6].table->rows.size(), 2u + 5);
  Analysis quality = sample_analysis();
  quality.kind = CalibrationTarget::Kind::quality;
  EXPECT_EQ(analysis_page(quality).sections[6].table->rows.size(), 2u);
}

TEST(AnalysisPage, ScenesAreJoinedByGeometricMeans) {
  Analysis one = sample_analysis(), other = sample_analysis();
  one.systems[0].times.frame_ms = 8.0;     // 2 times as fast as 3D-GS
  other.systems[0].times.frame_ms = 32.0;  // 8 times
  const Analysis both[] = {one, other};
  const Table means = means_over_scenes(both);
  EXPECT_NEAR(std::get<double>(means.rows[1][1].value), 4.0, 1e-12);
  EXPECT_NEAR(std::get<double>(means.rows[1][2].value), 1.0, 1e-12);
}

// Scaffold-GS: the networks' share and what is gained without them (figure 8e).
TEST(AnalysisPage, NetworksAreToldApart) {
  Analysis a = sample_analysis();
  a.systems[0].times = {10.0, 100.0, {{"decode", 4.0}, {"blend", 6.0}}};
  a.systems[1].times = {7.0, 100.0, {{"decode", 4.0}, {"blend", 3.0}}};
  EXPECT_NE(
      analysis_page(a).sections[1].sentence.find(
          "Its networks take 40 % of that; without them “FlashGS, AdR-Gaussian” is 2.00 times as fast."),
      std::string::npos)
      << analysis_page(a).sections[1].sentence;
}

TEST(AnalysisPage, EmptyResultsAreShownAsSuch) {
  Analysis empty = sample_analysis();
  empty.contributions.by_depth.clear();
  empty.contributions.by_distance.clear();
  const Page page = analysis_page(empty);
  EXPECT_EQ(page.sections[3].problem, "No pixel blends anything.");
  EXPECT_EQ(page.sections[4].problem, "No pixel blends anything.");
}

// Long: the whole page in a browser, its tables against the JSON.
TEST(AnalysisPage, InChromiumHasTheJsonsNumbers) {
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "BINOSPLAT_LONG=1 opens the page in Chromium";
  ASSERT_TRUE(test::has_chromium()) << "install the package chromium (packages/long.txt)";
  const test::TempFolder folder;
  save_page(folder / "report.html", analysis_page(sample_analysis()), {});
  const test::Chromium chromium;
  for (const int width : {400, 1280}) {
    EXPECT_EQ(chromium.ask(folder / "report.html", width, width == 400,
                           "return [...[...document.querySelectorAll('#real-drops "
                           "table')].pop().tBodies[0].rows].map((row) =>"
                           "[1, 2, 3, 4, 6].map((i) => row.cells[i].dataset.value).join(' ')).join(';');"),
              "0.1 0.1 0.13125 0.1640625 0.5;0.2 0.2 0.23125 0.2890625 0.5");
    EXPECT_EQ(chromium.ask(folder / "report.html", width, false,
                           "return (document.documentElement.scrollWidth <= window.innerWidth) + ' ' +"
                           "document.querySelectorAll('figure svg').length;"),
              "true 7");
  }
}

}  // namespace
}  // namespace binosplat::lab
