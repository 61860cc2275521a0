// binosplat convert, from the command line.

#include "app/scene.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

struct ConvertTest : SceneTest {
  Outcome convert(const std::string& to, const Words& more = {}) const {
    return run_program(joined({"convert", model, "-o", folder / to}, more));
  }
};

TEST_F(ConvertTest, WritesEveryFormatAndSaysWhatItCosts) {
  add_cameras();
  struct Case {
    const char* file;
    const char* format;
    double least, most;  // dB of the worst view
  };
  // Degree 1, with harmonics far larger than real ones: only formats that keep harmonics come close.
  for (const Case& c : {Case{"m.spz", "spz", 15, 60}, Case{"m.sog", "SOG", 35, 90}}) {
    const Outcome outcome = well(convert(c.file, {"--report", "2", "--json", folder / "r.json"}));
    const json report = load_json(folder / "r.json");
    EXPECT_EQ(report["gaussians"], 300);
    EXPECT_EQ(report["bytes"], fs::file_size(folder / c.file));
    EXPECT_EQ(report["model_bytes"], fs::file_size(model));
    EXPECT_EQ(report["views"].size(), 2);
    EXPECT_GT(report["worst"]["psnr_db"], c.least) << c.file;
    EXPECT_LT(report["worst"]["psnr_db"], c.most) << c.file;
    EXPECT_TRUE(has(outcome.out, fmt::format("worst: {}, ", report["worst"]["name"].get<std::string>())));
    for (const auto& loss : report["losses"])
      EXPECT_TRUE(has(outcome.err, "warning: " + loss.get<std::string>()));
    EXPECT_TRUE(has(run_program({"info", folder / c.file}).out, c.format));
  }
  const auto usual = fs::file_size(folder / "m.spz");
  ASSERT_TRUE(good(convert("m.spz", {"--sh-bits", "1"})));
  EXPECT_LT(fs::file_size(folder / "m.spz"), usual) << "harmonics of fewer bits";
  // A ply gives the same picture bit for bit, and the report detects differences.
  const Outcome same =
      well(convert("m.ply", {"--report", "3", "--size", "36x24", "--json", folder / "r.json"}));
  const json report = load_json(folder / "r.json");
  ASSERT_EQ(report["views"].size(), 3);
  for (const json& view : report["views"]) {
    EXPECT_EQ(view["width"], 36);
    EXPECT_EQ(view["equal"], true);
    EXPECT_EQ(view["psnr_db"], nullptr);
  }
  EXPECT_TRUE(has(same.out, "equal"));
}

TEST_F(ConvertTest, ViewsAreChosenOrMadeUp) {
  const Outcome around = convert("m.spz", {"--report", "2", "--size", "36x24"});
  ASSERT_TRUE(ended(around, 0, "no cameras beside"));
  EXPECT_TRUE(has(around.out, "orbit_001"));
  add_cameras();
  const Outcome named = well(convert("m.spz", {"--report", "3", "--view", "side"}));
  EXPECT_TRUE(has(named.out, "worst: side"));
  EXPECT_FALSE(has(named.out, "front"));
  EXPECT_TRUE(ended(convert("m.spz", {"--report", "3", "--view", "nowhere"}), 2, "nowhere"));
}

// Conversion to other axes and back, and a file whose axes are not those of its format.
TEST_F(ConvertTest, AxesAreTurned) {
  add_cameras();
  ASSERT_TRUE(good(convert("m.spz")));
  const auto run = [&](const std::string& from, const std::string& to, const Words& more = {}) {
    return run_program(joined({"convert", folder / from, "-o", folder / to, "--report", "2"}, more));
  };
  const Outcome back = run("m.spz", "back.ply");
  ASSERT_TRUE(ended(back, 0, "turned from RUB to RDF"));
  EXPECT_TRUE(has(back.out, "equal"));
  const Outcome as_ply = well(run("m.spz", "as-ply.ply", {"--axes", "rdf"}));
  EXPECT_FALSE(has(as_ply.err, "turned"));
  EXPECT_NE(read_text(folder / "as-ply.ply"), read_text(folder / "back.ply"));
}

TEST_F(ConvertTest, ErrorsSayWhatToDo) {
  const std::string none = folder / "none.ply";
  const auto to = [&](const char* name) { return std::string(folder / name); };
  expect_refused_after({"convert"},
                       {{{model, "-o", to("m.obj")}, "its ending names no format that can be written"},
                        {{model, "-o", to("m.spz"), "--to", "ksplat"}, "--to"},
                        {{model, "-o", to("m.ply"), "--sh-bits", "4"}, "only spz"},
                        {{model, "-o", to("m.spz"), "--sh-bits", "9"}, "--sh-bits"},
                        {{model, "-o", to("m.spz"), "--report", "0"}, "--report"},
                        {{model, "-o", to("m.spz"), "--size", "36x24"}, "--report"},
                        {{model, "-o", to("model.ply/m.spz")}, "is a file where a folder is needed"},
                        {{model, "-o", "/proc/m.spz"}, "cannot write /proc/m.spz"},
                        {{none}, "its ending names"},
                        {{none, "--to", "ply"}, "none.ply"}});
  // --to has precedence over the extension. A full disk leaves no file.
  ASSERT_TRUE(good(convert("m.ply", {"--to", "spz"})));
  EXPECT_TRUE(has(run_program({"info", folder / "m.ply"}).out, "spz"));
  const Outcome full =
      run_program({"convert", model, "-o", folder / "full.ply"}, {.limits = {{RLIMIT_FSIZE, 9000}}});
  EXPECT_TRUE(ended(full, 2, "cannot write"));
  EXPECT_FALSE(fs::exists(folder / "full.ply"));
}

TEST_F(ConvertTest, ABuiltInScene) {
  const Outcome outcome = well(
      run_program({"convert", "demo:room", "-o", folder / "room.spz", "--report", "1", "--size", "160x90"}));
  EXPECT_TRUE(has(outcome.out, "98230 Gaussians"));
}

// Measured at 240 x 160 px: 50.7 and 41.0 dB.
TEST_F(ConvertTest, FoxCostsWhatItShould) {
  REQUIRE_SCENE("fox", scene);
  struct Case {
    const char* file;
    double least, most;  // dB of the worst view
    double bytes;        // bytes per Gaussian, at most
  };
  for (const Case& c : {Case{"a.spz", 49, 53, 39}, Case{"e.sog", 40, 43, 30}}) {
    ASSERT_TRUE(good(run_program({"convert", scene / "fox.ply", "-o", folder / c.file, "--report", "2",
                                  "--size", "240x160", "--json", folder / "r.json"})));
    const json report = load_json(folder / "r.json");
    EXPECT_GT(report["worst"]["psnr_db"], c.least) << c.file;
    EXPECT_LT(report["worst"]["psnr_db"], c.most) << c.file;
    EXPECT_LE(report["bytes_per_gaussian"], c.bytes) << c.file;
  }
}

}  // namespace
}  // namespace binosplat
