// --place: adds other models to the world of a scene.

#include "app/scene.h"
#include "support/broken.h"

namespace binosplat {
namespace {

struct Place : SceneTest {
  Place() { add_cameras(); }

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

TEST_F(Place, ModelsAreDrawnAsOne) {
  const Image expected = drawn({});
  write_text(folder / "second.ply", to_bytes(half_of(small_model(), 1)));
  write_text(model, to_bytes(half_of(small_model(), 0)));
  list({{{"model", "second.ply"}}});
  const Words placed = {"--place", folder / "list.json"};
  EXPECT_LE(measure::largest_difference(drawn(placed), expected).max, 1.01 / 255);
  EXPECT_GT(measure::largest_difference(drawn({}), expected).max, 0.1) << "planted: one half";
  EXPECT_NE(well(run_program({"info", model, "--place", folder / "list.json"})).out.find("300"),
            std::string::npos);
}

// A matrix acts in the cameras' world, whatever the axes of the two files are.
TEST_F(Place, MatricesActInTheWorld) {
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

TEST_F(Place, BuiltInScenesArePlaced) {
  list({{{"model", "demo:room"}, {"translation", {0, 0, 9}}}});
  const Outcome info = well(run_program({"info", model, "--place", folder / "list.json"}));
  EXPECT_TRUE(has(info.err, " Gaussians of demo:room"));
  EXPECT_FALSE(has(info.out, "Gaussians      300\n")) << "planted: the model alone";
  const Words run = {"--place", folder / "list.json", "--view", "front", "--resume", "-o", folder / "out"};
  EXPECT_TRUE(good(render(run)));
  EXPECT_TRUE(good(render(run)));
  list({{{"model", "demo:town"}}});
  EXPECT_TRUE(ended(render({"--place", folder / "list.json"}), 2, "expected demo:room or demo:city"));
}

TEST_F(Place, CopiesAreOneLine) {
  PlyFile cracked = small_model();
  cracked.at(7, "x") = NAN;
  write_text(folder / "chair.ply", to_bytes(cracked));
  json entries;
  for (int i = 0; i < 50; ++i) entries.push_back({{"model", "chair.ply"}, {"translation", {0.1 * i, 0, 0}}});
  list(entries);
  const Outcome info = well(run_program({"info", model, "--place", folder / "list.json"}));
  EXPECT_TRUE(has(info.out, "Gaussians      15250"));  // 300 and 50 x 299
  EXPECT_TRUE(has(info.err, "list.json: 50 x 299 Gaussians of "));
  EXPECT_TRUE(has(info.err, "1 of 300 Gaussians left out"));
  EXPECT_EQ(std::ranges::count(info.err, '\n'), 2) << info.err;
}

// A run is the same only if the placed models are.
TEST_F(Place, ModelsThatChangeEndARun) {
  write_text(folder / "second.ply", to_bytes(half_of(small_model(), 1)));
  list({{{"model", "second.ply"}}});
  const Words run = {"--place", folder / "list.json", "--view", "all", "--resume", "-o", folder / "out"};
  EXPECT_TRUE(good(render(run)));
  EXPECT_TRUE(good(render(run)));
  write_text(folder / "second.ply", to_bytes(half_of(small_model(), 0)));
  EXPECT_TRUE(ended(render(run), 2, "has pictures of another run"));
}

TEST_F(Place, WhatCannotBePlacedIsRefused) {
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
  EXPECT_EQ(render({"--place", folder / "absent.json"}).code, 2);
}

}  // namespace
}  // namespace binosplat
