// Models so far from zero that rounding to floats would be visible: drawn, converted, and as levels.

#include "app/scene.h"

namespace binosplat {
namespace {

struct LargeCoordinates : SceneTest {
  static constexpr double far[] = {455000.25, 5411000.5, 312.125};

  /// Returns the small model at that position, with positions in doubles.
  static PlyFile far_model() {
    PlyFile file = small_model();
    for (const char* name : {"x", "y", "z"}) file.types[name] = "double";
    for (std::size_t i = 0; i < file.rows.size(); ++i)
      for (int c = 0; c < 3; ++c) file.at(i, std::string(1, static_cast<char>('x' + c))) += far[c];
    return file;
  }

  LargeCoordinates() {
    json camera = camera_json("near", 0.0);
    save("near.json", json{camera});
    camera["position"] = far;
    save("far.json", json{camera});
  }

  Image drawn(const std::string& scene, const std::string& cameras, const Words& more = {}) const {
    const std::string picture = folder / "drawn.png";
    EXPECT_TRUE(good(run_program(joined(
        {"render", scene, "--cameras", folder / cameras, "--mono", "--view", "all", "-o", picture}, more))));
    return load_image(picture);
  }
};

TEST_F(LargeCoordinates, DrawAsNearOrigin) {
  const Image expected = drawn(model, "near.json");
  const auto psnr = [&](const PlyFile& file, const std::string& cameras) {
    write_text(folder / "far.ply", to_bytes(file));
    return measure::psnr(drawn(folder / "far.ply", cameras), expected);
  };
  PlyFile file = far_model();
  EXPECT_GT(psnr(file, "far.json"), 60.0);
  // Injected faults: cameras that ignore the origin, and positions in floats.
  EXPECT_LT(psnr(file, "near.json"), 40.0);
  for (const char* name : {"x", "y", "z"}) file.types[name] = "float";
  EXPECT_LT(psnr(file, "far.json"), 40.0);
  file = far_model();
  for (const char* format : {"ascii", "binary_big_endian"}) {
    file.format = format;
    EXPECT_GT(psnr(file, "far.json"), 60.0) << format;
  }
  // In text files the digits count, whatever type the header names.
  file.format = "ascii";
  std::string text = to_bytes(file);
  for (const char* name : {" x", " y", " z"})
    text.replace(text.find(std::string("double") + name), 6, "float");
  write_text(folder / "far.ply", text);
  EXPECT_GT(measure::psnr(drawn(folder / "far.ply", "far.json"), expected), 60.0);
  // Doubles near zero equal floats.
  file = small_model();
  file.type = "double";
  EXPECT_EQ(psnr(file, "near.json"), INFINITY);
}

TEST_F(LargeCoordinates, FormatsKeepPositions) {
  const Image expected = drawn(model, "near.json");
  const std::string there = folder / "far.ply";
  write_text(there, to_bytes(far_model()));
  const auto converted = [&](const std::string& from, const std::string& to) {
    return run_program({"convert", from, "-o", folder / to});
  };
  ASSERT_TRUE(good(converted(model, "near.sog")));
  const double of_near = measure::psnr(drawn(folder / "near.sog", "near.json"), expected);
  const Outcome ply = converted(there, "again.ply"), sog = converted(there, "far.sog");
  EXPECT_TRUE(has(ply.err, "written as doubles"));
  EXPECT_GT(measure::psnr(drawn(folder / "again.ply", "far.json"), expected), 60.0);
  EXPECT_FALSE(has(sog.err, "so far from zero"));
  EXPECT_GT(measure::psnr(drawn(folder / "far.sog", "far.json"), expected), of_near - 1.0);
  EXPECT_TRUE(has(converted(there, "far.spz").err, "positions so far from zero are rounded by up to 0."));
  const Outcome info = run_program({"info", there});
  EXPECT_TRUE(has(info.out, "origin         4550"));
}

TEST_F(LargeCoordinates, KeepsPositionsInLevels) {
  const Image expected = drawn(model, "near.json");
  write_text(folder / "far.ply", to_bytes(far_model()));
  for (const char* name : {"model", "far"})
    EXPECT_TRUE(good(run_program({"levels", folder / (std::string(name) + ".ply"), "-o",
                                  folder / "levels" / name, "--chunk", "64", "--levels", "2"})));
  for (const Words& how : {Words{}, Words{"--detail", "0.01"}, Words{"--detail", "45dB"}}) {
    const double of_near = measure::psnr(drawn(folder / "levels/model", "near.json", how), expected);
    EXPECT_GT(of_near, 35.0);
    EXPECT_GT(measure::psnr(drawn(folder / "levels/far", "far.json", how), expected), of_near - 2.0);
  }
}

// A generated camera stands in front of the model, wherever the model is.
TEST_F(LargeCoordinates, DefaultCameraFramesModel) {
  write_text(folder / "far.ply", to_bytes(far_model()));
  const auto framed = [&](const std::string& scene) {
    EXPECT_TRUE(
        good(run_program({"render", scene, "--mono", "--size", "72x48", "-o", folder / "framed.png"})));
    return load_image(folder / "framed.png");
  };
  EXPECT_GT(measure::psnr(framed(folder / "far.ply"), framed(model)), 60.0);
}

}  // namespace
}  // namespace binosplat
