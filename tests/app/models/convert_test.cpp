// binosplat convert, from the command line.

#include <cmath>

#include "app/scene.h"

namespace binosplat {
namespace {

struct ConvertTest : SceneTest {
  Outcome convert(const std::string& to, const Words& more = {}) const {
    return run_program(joined({"convert", model, "-o", folder / to}, more));
  }
  /// Returns the PSNR between the pictures of two models.
  double psnr(const std::string& a, const std::string& b) const {
    for (const std::string& of : {a, b})
      EXPECT_TRUE(good(run_program({"render", folder / of, "--cameras", folder / "cameras.json", "--view",
                                    "front", "--mono", "-o", folder / (of + ".png")})));
    return psnr_of_files(folder / (a + ".png"), folder / (b + ".png"));
  }
};

TEST_F(ConvertTest, WritesEveryFormatAndReportsLosses) {
  add_cameras();
  struct Case {
    const char* file;
    const char* format;
    double least, most;  // dB
  };
  // Degree 1, with harmonics far larger than real ones: only formats that keep harmonics come close.
  for (const Case& c : {Case{"m.spz", "spz", 15, 60}, Case{"m.sog", "SOG", 35, 90}}) {
    const Outcome outcome = checked(convert(c.file, {"--json", folder / "r.json"}));
    const json report = load_json(folder / "r.json");
    EXPECT_EQ(report["gaussians"], 300);
    EXPECT_EQ(report["bytes"], fs::file_size(folder / c.file));
    EXPECT_EQ(report["model_bytes"], fs::file_size(model));
    const double db = psnr("model.ply", c.file);
    EXPECT_GT(db, c.least) << c.file;
    EXPECT_LT(db, c.most) << c.file;
    for (const auto& loss : report["losses"])
      EXPECT_TRUE(has(outcome.err, "warning: " + loss.get<std::string>()));
    EXPECT_TRUE(has(run_program({"info", folder / c.file}).out, c.format));
  }
  const auto usual = fs::file_size(folder / "m.spz");
  ASSERT_TRUE(good(convert("m.spz", {"--sh-bits", "1"})));
  EXPECT_LT(fs::file_size(folder / "m.spz"), usual) << "harmonics of fewer bits";
  ASSERT_TRUE(good(convert("m.ply")));
  EXPECT_TRUE(std::isinf(psnr("model.ply", "m.ply"))) << "a ply gives the same picture bit for bit";
}

// Conversion to other axes and back, and a file whose axes are not those of its format.
TEST_F(ConvertTest, ConvertsAxes) {
  add_cameras();
  ASSERT_TRUE(good(convert("m.spz")));
  const auto run = [&](const std::string& from, const std::string& to, const Words& more = {}) {
    return run_program(joined({"convert", folder / from, "-o", folder / to}, more));
  };
  const Outcome back = run("m.spz", "back.ply");
  ASSERT_TRUE(ended(back, 0, "turned from RUB to RDF"));
  EXPECT_TRUE(std::isinf(psnr("m.spz", "back.ply")));
  const Outcome as_ply = checked(run("m.spz", "as-ply.ply", {"--axes", "rdf"}));
  EXPECT_FALSE(has(as_ply.err, "turned"));
  EXPECT_NE(read_text(folder / "as-ply.ply"), read_text(folder / "back.ply"));
}

TEST_F(ConvertTest, ErrorsSuggestFix) {
  const std::string none = folder / "none.ply";
  const auto to = [&](const char* name) { return std::string(folder / name); };
  expect_refused_after({"convert"},
                       {{{model, "-o", to("m.obj")}, "its ending names no format that can be written"},
                        {{model, "-o", to("m.spz"), "--to", "ksplat"}, "--to"},
                        {{model, "-o", to("m.ply"), "--sh-bits", "4"}, "only spz"},
                        {{model, "-o", to("m.spz"), "--sh-bits", "9"}, "--sh-bits"},
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

TEST_F(ConvertTest, ConvertsBuiltInScene) {
  const Outcome outcome = checked(run_program({"convert", "demo:room", "-o", folder / "room.spz"}));
  EXPECT_TRUE(has(outcome.out, "98230 Gaussians"));
}

}  // namespace
}  // namespace binosplat
