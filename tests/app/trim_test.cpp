// binosplat trim, and what info says of views.

#include "app/scene.h"
#include "formats/image_file.h"
#include "formats/model_file.h"
#include "measure/metrics.h"
#include "support/fixtures.h"
#include "support/models.h"
#include "support/scaffold_files.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::ended;
using test::good;
using test::Outcome;
using test::run_program;
using test::save_ply;

constexpr std::size_t visible = 42, useless = 60;

// Two layers of a wall, of which 0.01002 % of the light is left, so that every third alpha ends a pixel; and
// small Gaussians before it.
Model seen() {
  Model model;
  model.degree = 3;
  test::Uniform uniform(7);
  for (const float z : {4.0f, 4.5f})
    test::add(model, {0, 0, z}, {3000.0f, 3000.0f, 0.01f}, 0.98999f, {0.3f, 0.4f, z - 4.0f});
  for (std::size_t i = 2; i < visible; ++i) {
    const glm::vec3 position(uniform(-1.2, 1.2), uniform(-0.9, 0.9), uniform(2.5, 3.5));
    const glm::vec3 colour(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    test::add(model, position, glm::vec3(static_cast<float>(uniform(0.05, 0.12))), 0.8f, colour);
  }
  return model;
}

// The same among Gaussians that no pixel sees: behind the wall, behind the cameras, fainter than a step.
Model with_useless() {
  Model model = seen();
  for (std::size_t i = 0; i < useless; ++i) {
    const float x = 0.03f * static_cast<float>(i % 30) - 0.45f;
    const float z = i < 30 ? 5.5f : i < 50 ? -3.0f : 3.0f;
    test::add(model, {x, 0.1f, z}, glm::vec3(0.1f), i < 50 ? 0.9f : 0.003f, {1, 0, 1});
  }
  return model;
}

struct TrimTest : test::SceneTest {
  TrimTest() { add_row_of_cameras(6); }

  Outcome trim(const std::string& to, std::vector<std::string> more) const {
    more.insert(more.begin(), {"trim", model, "-o", folder / to, "--json", folder / "r.json"});
    return run_program(more);
  }
  json report() const { return test::load_json(folder / "r.json"); }
  Model trimmed(const std::string& file) const { return load_model(folder / file); }
};

TEST_F(TrimTest, FindsExactlyWhatNoPixelSees) {
  save_ply(model, with_useless());
  const Outcome outcome = trim("m.ply", {"--quality", "65"});
  ASSERT_TRUE(good(outcome));
  const Model left = trimmed("m.ply");
  EXPECT_EQ(left.position, seen().position) << outcome.out;
  EXPECT_EQ(report()["unseen"], useless);
  EXPECT_EQ(report()["as_it_was"], false);
  EXPECT_EQ(report()["views_weighed"], 3);
  const json steps = report()["steps"];
  EXPECT_EQ(steps.front()["gaussians"], visible + useless);
  EXPECT_EQ(steps.front()["bytes"], std::filesystem::file_size(model));
  EXPECT_EQ(steps.back()["gaussians"], visible);
  EXPECT_EQ(steps.back()["bytes"], std::filesystem::file_size(folder / "m.ply"));
  EXPECT_EQ(steps.back()["degree"], 0) << "no Gaussian has harmonics";
  EXPECT_EQ(steps.back()["held_back"]["mean_db"], 100) << "the pictures are equal";
  EXPECT_EQ(steps.back()["held_back"]["views"].size(), 3);
  EXPECT_NE(outcome.out.find("60 of 102 Gaussians touch no pixel"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("fewer Gaussians"), std::string::npos) << outcome.out;

  // One of them where it is seen: it stays.
  Model one_less = with_useless();
  one_less.position[visible].z = 2.0f;
  save_ply(model, one_less);
  ASSERT_TRUE(good(trim("m.ply", {"--quality", "65"})));
  EXPECT_EQ(report()["unseen"], useless - 1);
  EXPECT_EQ(trimmed("m.ply").count(), visible + 1);
}

TEST_F(TrimTest, ALowerBoundLeavesLess) {
  save_ply(model, seen());
  const auto left = [&](const char* db) {
    EXPECT_TRUE(good(trim("m.ply", {"--quality", db})));
    const double reached = report()["steps"].back()["held_back"]["mean_db"];
    EXPECT_GE(reached, std::stod(db));
    return trimmed("m.ply").count();
  };
  const std::size_t few = left("22"), some = left("30"), all = left("65");
  EXPECT_LT(few, some);
  EXPECT_LT(some, all);
  EXPECT_EQ(all, visible);
}

TEST_F(TrimTest, WithColoursFittedAgainLessIsLeft) {
  save_ply(model, test::random_model(8, 600, 1));
  const auto left = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--quality", "32"});
    EXPECT_TRUE(good(trim("m.ply", more)));
    EXPECT_GE(report()["steps"].back()["held_back"]["mean_db"].get<double>(), 32.0);
    return trimmed("m.ply").count();
  };
  const std::size_t fitted = left({"--refit"}), as_they_were = left({});
  EXPECT_LT(fitted, as_they_were);
  EXPECT_GT(fitted, 0u);
}

TEST_F(TrimTest, AModelThatNeedsAllIsReturnedAsItWas) {
  Model whole = seen();
  whole.degree = 0;
  whole.sh.clear();
  for (std::size_t k = 0; k < 3 * visible; ++k) whole.sh.push_back(seen().sh[48 * (k / 3) + k % 3]);
  save_ply(model, whole);
  const Outcome outcome = trim("m.ply", {"--quality", "65"});
  ASSERT_TRUE(good(outcome));
  EXPECT_EQ(test::read_text(folder / "m.ply"), test::read_text(model));
  EXPECT_NE(outcome.out.find("m.ply: the model as it was"), std::string::npos) << outcome.out;
  EXPECT_EQ(report()["as_it_was"], true);
  // What the format alone loses is more than the bound.
  EXPECT_TRUE(
      ended(trim("m.sog", {"--quality", "65"}), 2, "the format alone costs more than the bound allows"));
  EXPECT_FALSE(std::filesystem::exists(folder / "m.sog"));
  ASSERT_TRUE(good(run_program({"convert", model, "-o", folder / "a.spz"})));
  const Outcome same = run_program({"trim", folder / "a.spz", "-o", folder / "b.spz", "--quality", "99"});
  ASSERT_TRUE(good(same));
  EXPECT_EQ(test::read_text(folder / "a.spz"), test::read_text(folder / "b.spz"));
}

// 3DGUT's, whose run's file beside it says that there is hardly a low-pass.
TEST_F(TrimTest, CandidatesHaveTheModelsLowPassAndItsLossIsSaid) {
  Model thin = seen();
  for (glm::vec3& scale : thin.scale) scale *= glm::vec3(1.0f, 0.05f, 0.05f);
  save_ply(model, thin);
  test::write_text(folder / "cfg.yml", "result_dir: x\nwith_eval3d: true\nwith_ut: true\n");
  std::filesystem::create_directories(folder / "to");
  const std::string sentence = "does not tell the low-pass of 0.001 px^2: draw it with --kernel-px2 0.001";
  const auto said_of = [&](std::vector<std::string> words) {
    const Outcome outcome = run_program(words);
    EXPECT_TRUE(good(outcome));
    return outcome.err;
  };
  for (const char* name : {"t.ply", "t.spz", "t.sog"}) {
    const std::string to = folder / "to" / name;
    EXPECT_TRUE(test::has(said_of({"trim", model, "--quality", "30", "-o", to, "--json", folder / "r.json"}),
                          sentence))
        << name;
    for (const json& step : report()["steps"])
      EXPECT_GE(step["held_back"]["mean_db"].get<double>(), 30.0) << step;  // 22 dB with the usual low-pass
  }
  run_program({"refit", model, "--against", "exact", "--rounds", "1", "--order", "distance", "-o",
               folder / "to" / "r.ply", "--json", folder / "r.json"});
  const json steps = report()["steps"];
  EXPECT_NEAR(steps[steps.size() - 1]["held_back_db"].get<double>(),
              steps[steps.size() - 2]["held_back_db"].get<double>(), 0.1)
      << "what is written loses nothing of its own";
  EXPECT_TRUE(test::has(said_of({"levels", model, "--levels", "2", "-o", folder / "levels"}), sentence));
  std::filesystem::remove(folder / "cfg.yml");
  EXPECT_FALSE(
      test::has(said_of({"trim", model, "--quality", "30", "-o", folder / "to" / "u.ply"}), sentence));
}

TEST_F(TrimTest, WritesEveryFormat) {
  for (const ModelFormat format : written_formats()) {
    const std::string file = "t." + word_of(format);
    ASSERT_TRUE(good(trim(file, {"--quality", "12"}))) << file;
    EXPECT_TRUE(load_model(folder / file).format.starts_with(row_of(format).name)) << file;
  }
}

TEST_F(TrimTest, HarmonicsThatDoNotCountGo) {
  Model shiny = seen();
  for (std::size_t i = 0; i < visible; ++i) {
    float* sh = &shiny.sh[48 * i];
    for (std::size_t k = 3; k < 48; ++k) sh[k] = k < 12 ? 0.8f : 1e-5f;
  }
  save_ply(model, shiny);
  ASSERT_TRUE(good(trim("m.ply", {"--quality", "55"})));
  EXPECT_EQ(trimmed("m.ply").degree, 1);
  EXPECT_EQ(trimmed("m.ply").count(), visible);
  // Of one Gaussian only they count: in spz all others can do without.
  for (std::size_t i = 0; i < visible; ++i) {
    for (std::size_t k = 3; k < 48; ++k) shiny.sh[48 * i + k] = i == 20 ? 0.8f : 1e-4f;
  }
  save_ply(model, shiny);
  const Outcome outcome = trim("m.spz", {"--quality", "38"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.out.find("lower degrees for"), std::string::npos) << outcome.out;
  EXPECT_GE(report()["steps"].back()["held_back"]["mean_db"], 38.0);
  EXPECT_LE(trimmed("m.spz").count(), visible);
}

TEST_F(TrimTest, DropsAreAgainstPhotosAndTestViewsDecideNothing) {
  Model blurred = with_useless();  // the photos' model: no picture of ours is equal to them
  for (glm::vec3& scale : blurred.scale) scale *= 1.2f;
  save_ply(model, blurred);
  ASSERT_TRUE(good(render({"--mono", "--view", "all", "-o", folder / "photos"})));
  save_ply(model, with_useless());
  const Outcome outcome = trim(
      "m.ply", {"--photos", folder / "photos", "--max-drop", "0.5", "--views", "2", "--test", "view1,view3"});
  ASSERT_TRUE(good(outcome));
  const json last = report()["steps"].back();
  EXPECT_LE(last["held_back"]["mean_db"], 0.5);
  EXPECT_EQ(last["held_back"]["views"].size(), 2);
  EXPECT_EQ(last["test"]["views"].size(), 2);
  EXPECT_EQ(last["test"]["views"][1]["name"], "view3");
  EXPECT_EQ(report()["views_weighed"], 2);
  EXPECT_LE(last["gaussians"], visible);
  for (const json& view : last["held_back"]["views"])
    EXPECT_TRUE(view["name"] != "view1" && view["name"] != "view3") << view;
  std::filesystem::remove(folder / "photos/view3.png");
  EXPECT_TRUE(ended(trim("m.ply", {"--photos", folder / "photos", "--max-drop", "1", "--test", "view3"}), 2,
                    "there is no photo of view view3"));
}

// What holds in small pictures may not hold in the cameras' own: specks, of which a pixel of a small picture
// sees the nearest few, since each is at least about a pixel wide.
TEST_F(TrimTest, ABoundHoldsInTheCamerasOwnSizeToo) {
  Model specks;
  test::Uniform uniform(5);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 position(uniform(-2.0, 2.0), uniform(-1.4, 1.4), uniform(3.3, 3.7));
    test::add(specks, position, glm::vec3(0.01f), 0.9f, {uniform(0.2, 1), uniform(0.2, 1), uniform(0.2, 1)});
  }
  save_ply(model, specks);
  const auto own_db = [&](const std::string& file) {
    double sum = 0.0;
    for (const char* view : {"view1", "view3", "view5"}) {
      for (const std::string& which : {model, std::string(folder / file)})
        EXPECT_TRUE(good(run_program({"render", which, "--cameras", folder / "cameras.json", "--mono",
                                      "--view", view, "--bits", "16", "-o", which + ".png"})));
      sum += measure::psnr(load_image(model + ".png"), load_image((folder / file).string() + ".png"));
    }
    return sum / 3.0;
  };
  const std::vector<std::string> judges = {"--quality", "32",          "--size",
                                           "12x8",      "--held-back", "view1,view3,view5"};
  const Outcome outcome = trim("m.ply", judges);
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.out.find("at 12 x 8 px and, as `own`, at the cameras' own 72 x 48 px"), std::string::npos)
      << outcome.out;
  const json last = report()["steps"].back();
  EXPECT_GE(last["held_back"]["mean_db"], 32.0);
  EXPECT_GE(last["held_back_own_size"]["mean_db"], 32.0);
  EXPECT_GT(own_db("m.ply"), 31.9);
  const std::size_t left = trimmed("m.ply").count();

  // Cameras that are as small are judged in that size alone, and their bound does not hold in the larger one.
  json small = test::load_json(folder / "cameras.json");
  const json large = small;
  for (json& camera : small) camera.update({{"width", 12}, {"height", 8}, {"fx", 10.0}, {"fy", 10.0}});
  test::write_text(folder / "cameras.json", small.dump());
  ASSERT_TRUE(good(trim("s.ply", judges)));
  EXPECT_FALSE(report()["steps"].back().contains("held_back_own_size"));
  test::write_text(folder / "cameras.json", large.dump());
  EXPECT_LT(own_db("s.ply"), 31.0) << "a bound of small pictures goes unnoticed";
  EXPECT_LT(trimmed("s.ply").count(), left);
}

TEST_F(TrimTest, ViewsThatSeeNothingHaveNoSay) {
  save_ply(model, seen());
  json cameras = test::load_json(folder / "cameras.json");
  const auto turned = [&](std::size_t from) {
    json away = cameras;
    for (std::size_t k = from; k < away.size(); ++k)
      away[k]["rotation"] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
    test::write_text(folder / "cameras.json", away.dump());
  };
  turned(0);
  EXPECT_TRUE(ended(trim("m.ply", {"--quality", "25"}), 2, "none of its views sees anything of the model"));
  EXPECT_TRUE(ended(run_program({"refit", model, "--against", "exact", "-o", folder / "m.ply"}), 2,
                    "none of its views sees anything"));
  EXPECT_FALSE(std::filesystem::exists(folder / "m.ply"));
  turned(4);
  const Outcome outcome = trim("m.ply", {"--quality", "25"});
  ASSERT_TRUE(ended(outcome, 0, "2 of 6 views see nothing of the model and are left out (view4, view5)"));
  const json judged = report()["steps"].back()["held_back"]["views"];
  for (const json& view : judged) {
    EXPECT_TRUE(view["name"] != "view4" && view["name"] != "view5") << view;
    EXPECT_LT(view["db"], 100.0) << view;
  }
  EXPECT_TRUE(ended(trim("n.ply", {"--quality", "25", "--held-back", "view4,view5"}), 2,
                    "none of the views held back to judge by sees anything"));
  EXPECT_TRUE(ended(trim("n.ply", {"--quality", "25", "--held-back", "view0,view1,view2,view3"}), 2,
                    "none of the views to learn from sees anything"));
}

// A file that has less of each Gaussian than what is written.
TEST_F(TrimTest, AModelThatGetsNoSmallerIsSaidToBeSo) {
  test::PlyFile lean = test::small_model();
  const auto normals = static_cast<std::ptrdiff_t>(lean.column("nx"));
  lean.columns.erase(lean.columns.begin() + normals, lean.columns.begin() + normals + 3);
  for (std::vector<double>& row : lean.rows) row.erase(row.begin() + normals, row.begin() + normals + 3);
  for (const std::size_t behind : {5u, 6u}) lean.at(behind, "z") = -5.0;
  test::write_text(model, to_bytes(lean));
  const Outcome outcome = trim("m.ply", {"--quality", "90"});
  ASSERT_TRUE(good(outcome));
  const json last = report()["steps"].back();
  EXPECT_LT(last["gaussians"], 300);
  EXPECT_NE(outcome.out.find(fmt::format("the model as it was, {} bytes: with what can be left out gone it "
                                         "would take {}",
                                         std::filesystem::file_size(model), last["bytes"].get<int>())),
            std::string::npos)
      << outcome.out;
  EXPECT_EQ(outcome.out.find("nothing can be left out"), std::string::npos) << outcome.out;
  EXPECT_EQ(test::read_text(folder / "m.ply"), test::read_text(model));
}

TEST_F(TrimTest, ErrorsSayWhatToDo) {
  EXPECT_TRUE(ended(trim("m.ply", {}), 2, "trim needs a bound"));
  EXPECT_TRUE(ended(trim("m.ply", {"--quality", "40", "--max-drop", "1"}), 2, "trim needs a bound"));
  EXPECT_TRUE(ended(trim("m.ply", {"--max-drop", "1"}), 2, "--max-drop and --photos go together"));
  EXPECT_TRUE(ended(trim("m.ply", {"--max-drop", "1", "--photos", folder.path()}), 2,
                    "there is no photo of any view"));
  EXPECT_TRUE(ended(trim("m.obj", {"--quality", "40"}), 2, "its ending names no format that can be written"));
  EXPECT_TRUE(ended(trim("model.ply", {"--quality", "40"}), 2, "this run reads it"));
  EXPECT_TRUE(ended(trim("m.ply", {"--quality", "40", "--test", "nowhere"}), 2, "nowhere"));
  EXPECT_TRUE(ended(trim("m.ply", {"--quality", "40", "--test", "view0,view1,view2,view3,view4"}), 2,
                    "which needs two at least"));
  std::filesystem::create_directories(folder / "photos");
  std::filesystem::copy(model, folder / "photos/view0.png");
  EXPECT_TRUE(ended(trim("m.ply", {"--max-drop", "1", "--photos", folder / "photos"}), 2, "view0.png"));
  std::filesystem::remove(folder / "cameras.json");
  EXPECT_TRUE(ended(trim("m.ply", {"--quality", "40"}), 2, "name their file with --cameras"));
  EXPECT_EQ(folder.files(), (std::set<std::string>{"model.ply", "photos/view0.png"}))
      << "something is left behind";
}

TEST_F(TrimTest, InfoSaysHowMuchTheViewsShow) {
  save_ply(model, with_useless());
  const Outcome outcome =
      run_program({"info", model, "--cameras", folder / "cameras.json", "--json", folder / "r.json"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.out.find("59 % of the Gaussians (60) never touch a pixel in these 6 views"),
            std::string::npos)
      << outcome.out;
  EXPECT_EQ(report()["views"]["unseen"], useless);
  EXPECT_EQ(report()["views"]["count"], 6);
  EXPECT_LE(report()["views"]["gaussians_of_99_percent"], visible);
  EXPECT_EQ(run_program({"info", model}).out.find("never touch"), std::string::npos);
}

// A picture of half the size, each pixel the mean of four.
Image halved(const Image& image) {
  Image half(image.width / 2, image.height / 2, image.channels);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      for (int c = 0; c < half.channels; ++c) {
        const auto at = [&](int dx, int dy) { return image.at(2 * x + dx, 2 * y + dy, c); };
        half.at(x, y, c) = 0.25f * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
      }
    }
  }
  return half;
}

// Measured: see docs/trimming.md. Half the size of the photos, four views held back.
TEST(TrimScenes, FoxAtHalfADecibelIsLessThanHalf) {
  REQUIRE_SCENE("fox", scene);
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "some minutes: set BINOSPLAT_LONG=1";
  const test::TempFolder folder;
  json cameras = test::load_json(scene / "cameras.json");
  for (json& camera : cameras) {
    for (const char* size : {"width", "height"}) camera[size] = camera[size].get<int>() / 2;
    for (const char* focal : {"fx", "fy"}) camera[focal] = camera[focal].get<double>() / 2;
  }
  test::write_text(folder / "cameras.json", cameras.dump());
  std::filesystem::create_directories(folder / "photos");
  for (const auto& photo : std::filesystem::directory_iterator(scene / "photos")) {
    save_png((folder / "photos" / photo.path().filename()).replace_extension(".png"),
             halved(load_image(photo.path())));
  }
  const Outcome outcome =
      run_program({"trim", scene / "fox.ply", "--cameras", folder / "cameras.json", "--photos",
                   folder / "photos", "--max-drop", "0.5", "--views", "4", "--test", "0001,0089", "-o",
                   folder / "fox.spz", "--json", folder / "r.json"});
  ASSERT_TRUE(good(outcome));
  const json steps = test::load_json(folder / "r.json")["steps"];
  const json &first = steps.front(), &written = steps[1], &last = steps.back();
  EXPECT_LE(last["held_back"]["mean_db"], 0.5);
  EXPECT_LT(last["test"]["mean_db"], 1.0);
  EXPECT_LT(last["gaussians"], 0.85 * first["gaussians"].get<double>());
  EXPECT_LT(last["held_back"]["pairs"], 0.9 * first["held_back"]["pairs"].get<double>());
  const auto bytes = static_cast<double>(std::filesystem::file_size(folder / "fox.spz"));
  EXPECT_LE(bytes, 0.5 * first["bytes"].get<double>()) << outcome.out;
  EXPECT_LE(bytes, 0.75 * written["bytes"].get<double>()) << "trimming saves what spz does anyway";
}

TEST(TrimScaffold, IsRefused) {
  const test::TempFolder folder;
  std::filesystem::create_directories(folder / "model");
  test::write_scaffold(folder / "model", test::random_scaffold(1, {.anchors = 10}));
  test::write_text(folder / "cameras.json",
                   json({test::camera_json("a", 0), test::camera_json("b", 1)}).dump());
  const std::string cameras = folder / "cameras.json";
  EXPECT_TRUE(ended(run_program({"trim", folder / "model", "-o", folder / "m.ply", "--quality", "40",
                                 "--cameras", cameras}),
                    2, "is a Scaffold-GS model"));
  EXPECT_TRUE(
      ended(run_program({"info", folder / "model", "--cameras", cameras}), 2, "is a Scaffold-GS model"));
}

}  // namespace
}  // namespace binosplat
