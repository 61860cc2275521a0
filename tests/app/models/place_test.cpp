// --place: adds other models to the world of a scene.

#include "app/scene.h"
#include "support/broken.h"

namespace binosplat {
namespace {

struct PlaceOption : SceneTest {
  PlaceOption() { add_cameras(); }

  void list(const nlohmann::json& entries) const { write_text(folder / "list.json", entries.dump()); }
  Image drawn(const Words& more) const {
    EXPECT_TRUE(good(render(joined(more, {"--view", "side", "-o", folder / "drawn.png"}))));
    return load_image(folder / "drawn.png");
  }
};

/// Returns every second Gaussian, from `from` on.
PlyFile half_of(PlyFile file, std::size_t from) {
  PlyFile half = file;
  half.rows.clear();
  for (std::size_t i = from; i < file.rows.size(); i += 2) half.rows.push_back(file.rows[i]);
  return half;
}

TEST_F(PlaceOption, SplitModelEqualsWhole) {
  const Image expected = drawn({});
  write_text(folder / "second.ply", to_bytes(half_of(small_model(), 1)));
  write_text(model, to_bytes(half_of(small_model(), 0)));
  list({{{"model", "second.ply"}}});
  const Words placed = {"--place", folder / "list.json"};
  EXPECT_LE(measure::largest_difference(drawn(placed), expected).max, 1.01 / 255);
  EXPECT_GT(measure::largest_difference(drawn({}), expected).max, 0.1) << "injected: one half";
  EXPECT_NE(checked(run_program({"info", model, "--place", folder / "list.json"})).out.find("300"),
            std::string::npos);
}

// A matrix acts in the cameras' world, whatever the axes of the two files are.
TEST_F(PlaceOption, MatrixAppliesInWorldFrame) {
  PlyFile moved = small_model();
  for (std::size_t i = 0; i < moved.rows.size(); ++i) moved.at(i, "x") += 0.5;
  write_text(model, to_bytes(moved));
  const Image expected = drawn({});
  PlyFile none = small_model();
  none.rows.resize(1);
  none.at(0, "opacity") = -20;
  write_text(model, to_bytes(none));
  write_text(folder / "other.ply", to_bytes(small_model()));
  const auto at = [&](double x) {
    list({{{"model", "other.ply"}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1}}}});
    return Words{"--place", folder / "list.json"};
  };
  EXPECT_LE(measure::largest_difference(drawn(at(0.5)), expected).max, 1.01 / 255);
  EXPECT_GT(measure::largest_difference(drawn(at(-0.5)), expected).max, 0.1);
  EXPECT_LE(measure::largest_difference(drawn(joined(at(0.5), {"--axes", "rub"})), expected).max, 1.01 / 255);
}

TEST_F(PlaceOption, AcceptsBuiltInScenes) {
  list({{{"model", "demo:room"}, {"translation", {0, 0, 9}}}});
  const Outcome info = checked(run_program({"info", model, "--place", folder / "list.json"}));
  EXPECT_TRUE(has(info.err, " Gaussians of demo:room"));
  EXPECT_FALSE(has(info.out, "Gaussians      300\n")) << "injected: the model alone";
  const Words run = {"--place", folder / "list.json", "--view", "front", "--resume", "-o", folder / "out"};
  EXPECT_TRUE(good(render(run)));
  EXPECT_TRUE(good(render(run)));
  list({{{"model", "demo:town"}}});
  EXPECT_TRUE(ended(render({"--place", folder / "list.json"}), 2, "expected demo:room or demo:city"));
}

TEST_F(PlaceOption, CopiesAreLoggedOnce) {
  PlyFile cracked = small_model();
  cracked.at(7, "x") = NAN;
  write_text(folder / "chair.ply", to_bytes(cracked));
  json entries;
  for (int i = 0; i < 50; ++i) entries.push_back({{"model", "chair.ply"}, {"translation", {0.1 * i, 0, 0}}});
  list(entries);
  const Outcome info = checked(run_program({"info", model, "--place", folder / "list.json"}));
  EXPECT_TRUE(has(info.out, "Gaussians      15250"));  // 300 and 50 x 299
  EXPECT_TRUE(has(info.err, "list.json: 50 x 299 Gaussians of "));
  EXPECT_TRUE(has(info.err, "1 of 300 Gaussians left out"));
  EXPECT_EQ(std::ranges::count(info.err, '\n'), 2) << info.err;
}

// As in Python, where "opacity" multiplies each Gaussian's.
TEST_F(PlaceOption, OpacitiesMultiply) {
  write_text(folder / "second.ply", to_bytes(half_of(small_model(), 1)));
  write_text(model, to_bytes(half_of(small_model(), 0)));
  const auto at = [&](double opacity) {
    list({{{"model", "second.ply"}, {"opacity", opacity}}});
    return drawn({"--place", folder / "list.json"});
  };
  EXPECT_EQ(measure::psnr(at(0.0), drawn({})), INFINITY);
  const Image half = at(0.5);
  PlyFile faint = half_of(small_model(), 1);
  for (std::size_t i = 0; i < faint.rows.size(); ++i) {
    const double opacity = 0.5 / (1.0 + std::exp(-faint.at(i, "opacity")));
    faint.at(i, "opacity") = std::log(opacity / (1.0 - opacity));
  }
  write_text(folder / "second.ply", to_bytes(faint));
  EXPECT_LE(measure::largest_difference(at(1.0), half).max, 1.01 / 255);
  EXPECT_GT(measure::largest_difference(at(0.5), half).max, 0.02) << "injected: twice";
}

// Models, copies and cameras 4,200 km from the scene look as they do near it.
TEST_F(PlaceOption, KeepsDoublePrecision) {
  const double far[] = {4200000.0, -1400000.0, 2940000.25};
  const auto camera_at = [](const std::string& name, const double* by) {
    json camera = camera_json(name, 0.5);
    for (std::size_t c = 0; c < 3; ++c)
      camera["position"][c] = camera["position"][c].get<double>() + (by != nullptr ? by[c] : 0.0);
    return camera;
  };
  const std::string there = save("there.json", json::array({camera_at("side", far)}));
  const std::string both = save("both.json", {camera_at("front", nullptr), camera_at("side", far)});
  const auto run = [&](const Words& more) {
    return render(joined(more, {"--mono", "--view", "side", "-o", folder / "drawn.png"}));
  };
  ASSERT_TRUE(good(run({})));
  const Image expected = load_image(folder / "drawn.png");
  const auto psnr = [&](const Words& more) {
    EXPECT_TRUE(good(run(more)));
    return measure::psnr(load_image(folder / "drawn.png"), expected);
  };
  list({{{"model", "model.ply"}, {"translation", far}}});
  const std::string places = folder / "list.json";
  EXPECT_GT(psnr({"--place", places, "--cameras", there}), 60.0);
  EXPECT_LT(psnr({"--place", places, "--cameras", both}), 30.0) << "injected: the first camera is far away";
  EXPECT_TRUE(
      has(run({"--place", places, "--cameras", both}).err, "models far from camera front are rounded"));
  EXPECT_TRUE(has(checked(run_program({"convert", model, "--place", places, "-o", folder / "all.ply"})).err,
                  "models far from the first are rounded"));
  EXPECT_GT(psnr({"--place", places, "--cameras", there, "--axes", "rub"}), 60.0);
  const double aside[] = {6500000.0, 0.0, 0.0};
  const std::string copy = save("copy.json", json::array({camera_at("side", aside)}));
  const Words copies = {"--repeat", "2x1", "--spacing", "6500000", "--cameras"};
  EXPECT_GT(psnr(joined(copies, {copy})), 60.0);
  list({{{"model", "model.ply"}, {"scale", {0, 0, 0}}, {"translation", aside}}});
  EXPECT_FALSE(has(run({"--place", places}).err, "rounded")) << "it has no size";
}

TEST_F(PlaceOption, LevelsApplyToAllModels) {
  const std::string levels = folder / "levels";
  ASSERT_TRUE(good(run_program({"levels", model, "-o", levels, "--chunk", "64", "--levels", "2"})));
  const auto counts = [&](const std::string& scene, const std::string& lod) {
    const Outcome run = run_program({"render", scene, "--lod", lod, "--place", folder / "list.json", "--size",
                                     "8x8", "--mono", "-o", out});
    EXPECT_TRUE(good(run));
    std::vector<int> found;
    for (std::size_t at = run.err.find(" Gaussians"); at != std::string::npos;
         at = run.err.find(" Gaussians", at + 1))
      found.push_back(std::stoi(run.err.substr(run.err.rfind(' ', at - 1) + 1)));
    return found;  // of the placed model, and of all
  };
  list({{{"model", "levels"}}, {{"model", "levels"}, {"translation", {1, 0, 0}}}});
  const auto fine = counts(model, "0"), coarse = counts(model, "1"), both = counts(levels, "1");
  EXPECT_EQ(fine, (std::vector<int>{300, 900}));
  ASSERT_EQ(coarse.size(), 2U);
  EXPECT_LT(coarse[0], 200);
  EXPECT_EQ(coarse[1], 300 + 2 * coarse[0]);
  EXPECT_EQ(both, (std::vector<int>{coarse[0], 3 * coarse[0]}));
  list({{{"model", "model.ply"}}});
  EXPECT_EQ(counts(levels, "1"), (std::vector<int>{300, 300 + coarse[0]}));
  const Words placed = {"--lod", "1", "--place", folder / "list.json"};
  EXPECT_TRUE(ended(render(placed), 2, "have no levels of detail"));
  EXPECT_TRUE(ended(run_into_out(joined({"render", "demo:room"}, placed)), 2, "have no levels of detail"));
}

// A run is the same only if the placed models are.
TEST_F(PlaceOption, ResumeRejectsChangedModels) {
  write_text(folder / "second.ply", to_bytes(half_of(small_model(), 1)));
  list({{{"model", "second.ply"}}});
  const Words run = {"--place", folder / "list.json", "--view", "all", "--resume", "-o", folder / "out"};
  EXPECT_TRUE(good(render(run)));
  EXPECT_TRUE(good(render(run)));
  write_text(folder / "second.ply", to_bytes(half_of(small_model(), 0)));
  EXPECT_TRUE(ended(render(run), 2, "has pictures of another run"));
}

TEST_F(PlaceOption, RejectsInvalidEntries) {
  const auto refused = [&](const nlohmann::json& entries, const Words& parts) {
    list(entries);
    const auto result = render({"--place", folder / "list.json"});
    EXPECT_EQ(result.code, 2);
    for (const std::string& part : parts) EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  refused({{{"model", "absent.ply"}}}, {"absent.ply"});
  refused({{{"matrix", {1}}}}, {"list.json", "[0]", "model"});
  refused({{{"model", "model.ply"}, {"matrix", {1, 2}}}}, {"list.json", "[0].matrix", "16"});
  refused({{{"model", "model.ply"}, {"matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}},
          {"[0].matrix", "last row"});
  const json shift = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1};
  refused({{{"model", "model.ply"}}, {{"model", "model.ply"}, {"martix", shift}}},
          {"list.json", "[1]", "unknown key 'martix'", "opacity, matrix, translation, rotation, scale"});
  refused({{{"model", "model.ply"}, {"Scale", {2, 2, 2}}}}, {"unknown key 'Scale'"});
  refused({{{"model", "model.ply"}, {"matrix", shift}, {"scale", {2, 2, 2}}}},
          {"unknown key 'scale' beside 'matrix'"});
  for (const json& opacity : {json(1.5), json(-0.1), json("half")})
    refused({{{"model", "model.ply"}, {"opacity", opacity}}}, {"list.json", "[0].opacity", "expected"});
  for (const double scale : {1e30, -1e30, 1e16, 1e90})
    refused({{{"model", "model.ply"}, {"scale", {scale, scale, scale}}}}, {"list.json", "[0]", "1e13"});
  refused({{{"model", "model.ply"}, {"matrix", {1e30, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}},
          {"1e13"});
  EXPECT_EQ(render({"--place", folder / "absent.json"}).code, 2);
}

}  // namespace
}  // namespace binosplat
