// binosplat trim, and the numbers of info about views.

#include "app/scene.h"
#include "formats/models/model_file.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

constexpr std::size_t visible = 42, useless = 60;

// Returns two layers of a wall that transmit 0.01002 % of the light, so that every third alpha ends a pixel,
// and small Gaussians in front of it.
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

// Returns seen() with Gaussians that no pixel shows: behind the wall, behind the cameras, or fainter than
// tau.
Model model_with_unseen() {
  Model model = seen();
  for (std::size_t i = 0; i < useless; ++i) {
    const float x = 0.03f * static_cast<float>(i % 30) - 0.45f;
    const float z = i < 30 ? 5.5f : i < 50 ? -3.0f : 3.0f;
    test::add(model, {x, 0.1f, z}, glm::vec3(0.1f), i < 50 ? 0.9f : 0.003f, {1, 0, 1});
  }
  return model;
}

struct TrimTest : SceneTest {
  TrimTest() { add_row_of_cameras(6); }

  Outcome trim(const std::string& to, const Words& more) const {
    return run_program(joined({"trim", model, "-o", folder / to, "--json", folder / "r.json"}, more));
  }
  json report() const { return load_json(folder / "r.json"); }
  Model trimmed(const std::string& file) const { return load_model(folder / file); }
};

TEST_F(TrimTest, RemovesExactlyUnseen) {
  save_ply(model, model_with_unseen());
  const Outcome outcome = checked(trim("m.ply", {"--quality", "65"}));
  const Model left = trimmed("m.ply");
  EXPECT_EQ(left.position, seen().position) << outcome.out;
  EXPECT_EQ(report()["unseen"], useless);
  EXPECT_EQ(report()["as_it_was"], false);
  EXPECT_EQ(report()["views_weighed"], 3);
  const json steps = report()["steps"];
  EXPECT_EQ(steps.front()["gaussians"], visible + useless);
  EXPECT_EQ(steps.front()["bytes"], fs::file_size(model));
  EXPECT_EQ(steps.back()["gaussians"], visible);
  EXPECT_EQ(steps.back()["bytes"], fs::file_size(folder / "m.ply"));
  EXPECT_EQ(steps.back()["degree"], 0) << "no Gaussian has harmonics";
  EXPECT_EQ(steps.back()["validation"]["mean_db"], 100) << "the pictures are equal";
  EXPECT_EQ(steps.back()["validation"]["views"].size(), 3);
  EXPECT_TRUE(has(outcome.out, "60 of 102 Gaussians touch no pixel"));
  EXPECT_TRUE(has(outcome.out, "fewer Gaussians"));

  // One of these Gaussians becomes visible: it stays.
  Model one_less = model_with_unseen();
  one_less.position[visible].z = 2.0f;
  save_ply(model, one_less);
  ASSERT_TRUE(good(trim("m.ply", {"--quality", "65"})));
  EXPECT_EQ(report()["unseen"], useless - 1);
  EXPECT_EQ(trimmed("m.ply").count(), visible + 1);
}

TEST_F(TrimTest, RefitAllowsSmallerModel) {
  save_ply(model, test::random_model(8, 200, 1));
  const auto left = [&](const Words& more) {
    EXPECT_TRUE(good(trim("m.ply", joined({"--quality", "32"}, more))));
    EXPECT_GE(report()["steps"].back()["validation"]["mean_db"].get<double>(), 32.0);
    return trimmed("m.ply").count();
  };
  const std::size_t fitted = left({"--refit"}), as_they_were = left({});
  EXPECT_LT(fitted, as_they_were);
  EXPECT_LT(as_they_were, 200u) << "the bound allows to leave more out than what nothing shows";
  EXPECT_GT(fitted, 0u);
}

TEST_F(TrimTest, KeepsModelThatNeedsAll) {
  Model whole = seen();
  whole.degree = 0;
  whole.sh.clear();
  for (std::size_t k = 0; k < 3 * visible; ++k) whole.sh.push_back(seen().sh[48 * (k / 3) + k % 3]);
  save_ply(model, whole);
  const Outcome outcome = checked(trim("m.ply", {"--quality", "65"}));
  EXPECT_EQ(read_text(folder / "m.ply"), read_text(model));
  EXPECT_TRUE(has(outcome.out, "m.ply: the unchanged model"));
  EXPECT_EQ(report()["as_it_was"], true);
  // The loss of the format alone exceeds the bound.
  EXPECT_TRUE(ended(trim("m.sog", {"--quality", "65"}), 2, "the format alone exceeds the bound"));
  EXPECT_FALSE(fs::exists(folder / "m.sog"));
  ASSERT_TRUE(good(run_program({"convert", model, "-o", folder / "a.spz"})));
  const Outcome same =
      checked(run_program({"trim", folder / "a.spz", "-o", folder / "b.spz", "--quality", "99"}));
  EXPECT_EQ(read_text(folder / "a.spz"), read_text(folder / "b.spz"));
}

// A model of 3DGUT, whose training run's file says that there is hardly any low-pass.
TEST_F(TrimTest, UsesTrainingLowPass) {
  Model thin = seen();
  for (glm::vec3& scale : thin.scale) scale *= glm::vec3(1.0f, 0.05f, 0.05f);
  save_ply(model, thin);
  write_text(folder / "cfg.yml", "result_dir: x\nwith_eval3d: true\nwith_ut: true\n");
  fs::create_directories(folder / "to");
  const std::string sentence = "does not store the low-pass of 0.001 px^2: draw it with --eps2d 0.001";
  const auto trimmed_to = [&](const char* name) {
    return run_program(
        {"trim", model, "--quality", "30", "-o", folder / "to" / name, "--json", folder / "r.json"});
  };
  EXPECT_TRUE(ended(trimmed_to("t.spz"), 0, sentence));
  const json tried = report();
  for (const json& step : tried["steps"])
    EXPECT_GE(step["validation"]["mean_db"].get<double>(), 30.0) << step;  // 22 dB with the usual low-pass
  run_program({"refit", model, "--against", "exact", "--rounds", "1", "--order", "distance", "-o",
               folder / "to" / "r.ply", "--json", folder / "r.json"});
  const json steps = report()["steps"];
  EXPECT_NEAR(steps[steps.size() - 1]["validation_db"].get<double>(),
              steps[steps.size() - 2]["validation_db"].get<double>(), 0.1)
      << "what is written loses nothing of its own";
  EXPECT_TRUE(good(run_program({"levels", model, "--levels", "2", "-o", folder / "levels"})));
  EXPECT_EQ(load_model(folder / "levels").kernel_px2, 0.001) << "SOGs keep it";
  fs::remove(folder / "cfg.yml");
  EXPECT_FALSE(has(trimmed_to("u.ply").err, sentence));
}

TEST_F(TrimTest, WritesEveryFormat) {
  for (const ModelFormat format : written_formats()) {
    const std::string file = "t." + word_of(format);
    ASSERT_TRUE(good(trim(file, {"--quality", "12"}))) << file;
    EXPECT_TRUE(load_model(folder / file).format.starts_with(row_of(format).name)) << file;
  }
}

TEST_F(TrimTest, RemovesUnusedHarmonics) {
  Model shiny = seen();
  for (std::size_t i = 0; i < visible; ++i) {
    float* sh = &shiny.sh[48 * i];
    for (std::size_t k = 3; k < 48; ++k) sh[k] = k < 12 ? 0.8f : 1e-5f;
  }
  save_ply(model, shiny);
  ASSERT_TRUE(good(trim("m.ply", {"--quality", "55"})));
  EXPECT_EQ(trimmed("m.ply").degree, 1);
  EXPECT_EQ(trimmed("m.ply").count(), visible);
  // The harmonics of only one Gaussian matter: spz can store the others without harmonics.
  for (std::size_t i = 0; i < visible; ++i) {
    for (std::size_t k = 3; k < 48; ++k) shiny.sh[48 * i + k] = i == 20 ? 0.8f : 1e-4f;
  }
  save_ply(model, shiny);
  const Outcome outcome = checked(trim("m.spz", {"--quality", "38"}));
  EXPECT_TRUE(has(outcome.out, "lower degrees for"));
  EXPECT_GE(report()["steps"].back()["validation"]["mean_db"], 38.0);
  EXPECT_LE(trimmed("m.spz").count(), visible);
}

TEST_F(TrimTest, DropIgnoresTestViews) {
  Model blurred = model_with_unseen();  // the photos' model: no picture of the tested model equals the photos
  for (glm::vec3& scale : blurred.scale) scale *= 1.2f;
  save_ply(model, blurred);
  ASSERT_TRUE(good(render({"--mono", "--view", "all", "-o", folder / "photos"})));
  save_ply(model, model_with_unseen());
  const Outcome outcome = checked(trim("m.ply", {"--photos", folder / "photos", "--max-drop", "0.5",
                                                 "--views", "2", "--test", "view1,view3"}));
  const json last = report()["steps"].back();
  EXPECT_LE(last["validation"]["mean_db"], 0.5);
  EXPECT_EQ(last["validation"]["views"].size(), 2);
  EXPECT_EQ(last["test"]["views"].size(), 2);
  EXPECT_EQ(last["test"]["views"][1]["name"], "view3");
  EXPECT_EQ(report()["views_weighed"], 2);
  EXPECT_LE(last["gaussians"], visible);
  for (const json& view : last["validation"]["views"])
    EXPECT_TRUE(view["name"] != "view1" && view["name"] != "view3") << view;
  fs::remove(folder / "photos/view3.png");
  EXPECT_TRUE(ended(trim("m.ply", {"--photos", folder / "photos", "--max-drop", "1", "--test", "view3"}), 2,
                    "there is no photo of view view3"));
}

// A bound that holds in small pictures may fail in the cameras' full size. Specks show that: each is at least
// about a pixel wide, so a pixel of a small picture shows only the nearest few.
TEST_F(TrimTest, BoundHoldsAtCameraSize) {
  Model specks;
  test::Uniform uniform(5);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 position(uniform(-2.0, 2.0), uniform(-1.4, 1.4), uniform(3.3, 3.7));
    test::add(specks, position, glm::vec3(0.01f), 0.9f, {uniform(0.2, 1), uniform(0.2, 1), uniform(0.2, 1)});
  }
  save_ply(model, specks);
  const auto own_db = [&](const std::string& file) {
    const std::string other = folder / file;
    double sum = 0.0;
    for (const char* view : {"view1", "view3", "view5"}) {
      for (const std::string& which : {model, other})
        EXPECT_TRUE(good(run_program({"render", which, "--cameras", folder / "cameras.json", "--mono",
                                      "--view", view, "--bits", "16", "-o", which + ".png"})));
      sum += psnr_of_files(model + ".png", other + ".png");
    }
    return sum / 3.0;
  };
  const Words validation = {"--quality", "32", "--size", "12x8", "--validation", "view1,view3,view5"};
  const Outcome outcome = checked(trim("m.ply", validation));
  EXPECT_TRUE(has(outcome.out, "at 12 x 8 px and, as `own`, at the cameras' own 72 x 48 px"));
  const json last = report()["steps"].back();
  EXPECT_GE(last["validation"]["mean_db"], 32.0);
  EXPECT_GE(last["validation_own_size"]["mean_db"], 32.0);
  EXPECT_GT(own_db("m.ply"), 31.9);
  const std::size_t left = trimmed("m.ply").count();

  // If the cameras are as small, only that size is checked, and the bound fails in the larger one.
  json small = load_json(folder / "cameras.json");
  const json large = small;
  for (json& camera : small) camera.update({{"width", 12}, {"height", 8}, {"fx", 10.0}, {"fy", 10.0}});
  save("cameras.json", small);
  ASSERT_TRUE(good(trim("s.ply", validation)));
  EXPECT_FALSE(report()["steps"].back().contains("validation_own_size"));
  save("cameras.json", large);
  EXPECT_LT(own_db("s.ply"), 31.0) << "a bound of small pictures goes unnoticed";
  EXPECT_LT(trimmed("s.ply").count(), left);
}

TEST_F(TrimTest, SkipsEmptyViews) {
  save_ply(model, seen());
  json cameras = load_json(folder / "cameras.json");
  for (const std::size_t k : {4u, 5u}) cameras[k]["rotation"] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  save("cameras.json", cameras);
  ASSERT_TRUE(ended(trim("m.ply", {"--quality", "25"}), 0,
                    "the model is not visible in 2 of 6 views, which are skipped (view4, view5)"));
  const json measured_views = report()["steps"].back()["validation"]["views"];
  for (const json& view : measured_views) {
    EXPECT_TRUE(view["name"] != "view4" && view["name"] != "view5") << view;
    EXPECT_LT(view["db"], 100.0) << view;
  }
  EXPECT_TRUE(ended(trim("n.ply", {"--quality", "25", "--validation", "view4,view5"}), 2,
                    "the model is visible in none of the validation views"));
  EXPECT_TRUE(ended(trim("n.ply", {"--quality", "25", "--validation", "view0,view1,view2,view3"}), 2,
                    "the model is visible in no training view"));
}

// A file that stores less for each Gaussian than the written one.
TEST_F(TrimTest, ReportsModelNotSmaller) {
  PlyFile lean = small_model();
  const auto normals = static_cast<std::ptrdiff_t>(lean.column("nx"));
  lean.columns.erase(lean.columns.begin() + normals, lean.columns.begin() + normals + 3);
  for (std::vector<double>& row : lean.rows) row.erase(row.begin() + normals, row.begin() + normals + 3);
  for (const std::size_t behind : {5u, 6u}) lean.at(behind, "z") = -5.0;
  write_text(model, to_bytes(lean));
  const Outcome outcome = checked(trim("m.ply", {"--quality", "90"}));
  const json last = report()["steps"].back();
  EXPECT_LT(last["gaussians"], 300);
  EXPECT_NE(outcome.out.find(fmt::format("the unchanged model, {} bytes: the trimmed one would have {}",
                                         fs::file_size(model), last["bytes"].get<int>())),
            std::string::npos)
      << outcome.out;
  EXPECT_FALSE(has(outcome.out, "nothing can be trimmed"));
  EXPECT_EQ(read_text(folder / "m.ply"), read_text(model));
}

TEST_F(TrimTest, ErrorsSuggestFix) {
  const std::string ply = folder / "m.ply";
  expect_refused_after(
      {"trim", model, "-o", ply},
      {{{}, "trim needs a bound"},
       {{"--quality", "40", "--max-drop", "1"}, "trim needs a bound"},
       {{"--max-drop", "1"}, "--max-drop and --photos go together"},
       {{"--quality", "40", "--test", "nowhere"}, "nowhere"},
       {{"--quality", "40", "--test", "view0,view1,view2,view3,view4"}, "which needs at least two"}});
  expect_refused_after({"trim", model, "--quality", "40"},
                       {{{"-o", folder / "m.obj"}, "its ending names no format that can be written"},
                        {{"-o", model}, "it is an input of this run"}});
  fs::remove(folder / "cameras.json");
  expect_refused_after({"trim", model, "-o", ply}, {{{"--quality", "40"}, "name their file with --cameras"}});
}

TEST_F(TrimTest, InfoReportsVisibleShare) {
  save_ply(model, model_with_unseen());
  const Outcome outcome = checked(
      run_program({"info", model, "--cameras", folder / "cameras.json", "--json", folder / "r.json"}));
  EXPECT_TRUE(has(outcome.out, "59 % of the Gaussians (60) touch no pixel in these 6 views"));
  EXPECT_EQ(report()["views"]["unseen"], useless);
  EXPECT_EQ(report()["views"]["count"], 6);
  EXPECT_LE(report()["views"]["gaussians_of_99_percent"], visible);
  EXPECT_EQ(run_program({"info", model}).out.find("touch no pixel"), std::string::npos);
}

// Returns a picture of half the size, each pixel the mean of four.
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

// docs/models.md has the measured numbers. Half the size of the photos, four validation views.
TEST(TrimScenes, HalvesFoxAtHalfDecibel) {
  REQUIRE_SCENE("fox", scene);
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "some minutes: set BINOSPLAT_LONG=1";
  const TempFolder folder;
  json cameras = load_json(scene / "cameras.json");
  for (json& camera : cameras) {
    for (const char* size : {"width", "height"}) camera[size] = camera[size].get<int>() / 2;
    for (const char* focal : {"fx", "fy"}) camera[focal] = camera[focal].get<double>() / 2;
  }
  write_text(folder / "cameras.json", cameras.dump());
  fs::create_directories(folder / "photos");
  for (const auto& photo : fs::directory_iterator(scene / "photos")) {
    save_png((folder / "photos" / photo.path().filename()).replace_extension(".png"),
             halved(load_image(photo.path())));
  }
  const Outcome outcome =
      checked(run_program({"trim", scene / "fox.ply", "--cameras", folder / "cameras.json", "--photos",
                           folder / "photos", "--max-drop", "0.5", "--views", "4", "--test", "0001,0089",
                           "-o", folder / "fox.spz", "--json", folder / "r.json"}));
  const json steps = load_json(folder / "r.json")["steps"];
  const json &first = steps.front(), &written = steps[1], &last = steps.back();
  EXPECT_LE(last["validation"]["mean_db"], 0.5);
  EXPECT_LT(last["test"]["mean_db"], 1.0);
  EXPECT_LT(last["gaussians"], 0.85 * first["gaussians"].get<double>());
  EXPECT_LT(last["validation"]["pairs"], 0.9 * first["validation"]["pairs"].get<double>());
  const auto bytes = static_cast<double>(fs::file_size(folder / "fox.spz"));
  EXPECT_LE(bytes, 0.5 * first["bytes"].get<double>()) << outcome.out;
  EXPECT_LE(bytes, 0.75 * written["bytes"].get<double>()) << "trimming saves what spz does anyway";
}

}  // namespace
}  // namespace binosplat
