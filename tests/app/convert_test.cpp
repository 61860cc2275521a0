// binosplat convert, from the command line.

#include <gtest/gtest.h>

#include "app/scene.h"
#include "support/fixtures.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::ended;
using test::good;
using test::has;
using test::Outcome;
using test::run_program;
using test::Words;

struct ConvertTest : test::SceneTest {
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
  // Degree 1, whose harmonics are far beyond what real ones are: only what keeps them comes close.
  for (const Case& c : {Case{"m.spz", "spz", 15, 60}, Case{"m.sog", "SOG", 35, 90}}) {
    const Outcome outcome = convert(c.file, {"--report", "2", "--json", folder / "r.json"});
    ASSERT_TRUE(good(outcome));
    const json report = test::load_json(folder / "r.json");
    EXPECT_EQ(report["gaussians"], 300);
    EXPECT_EQ(report["bytes"], std::filesystem::file_size(folder / c.file));
    EXPECT_EQ(report["model_bytes"], std::filesystem::file_size(model));
    EXPECT_EQ(report["views"].size(), 2);
    EXPECT_GT(report["worst"]["psnr_db"], c.least) << c.file;
    EXPECT_LT(report["worst"]["psnr_db"], c.most) << c.file;
    EXPECT_TRUE(has(outcome.out, fmt::format("worst: {}, ", report["worst"]["name"].get<std::string>())));
    for (const auto& loss : report["losses"])
      EXPECT_TRUE(has(outcome.err, "warning: " + loss.get<std::string>()));
    EXPECT_TRUE(has(run_program({"info", folder / c.file}).out, c.format));
  }
  // A ply is drawn the same to the bit, and whoever reads that would see that a difference is one.
  const Outcome same = convert("m.ply", {"--report", "3", "--size", "36x24", "--json", folder / "r.json"});
  ASSERT_TRUE(good(same));
  const json report = test::load_json(folder / "r.json");
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
  ASSERT_TRUE(good(around));
  EXPECT_TRUE(has(around.err, "no cameras beside"));
  EXPECT_TRUE(has(around.out, "orbit_001"));
  add_cameras();
  const Outcome named = convert("m.spz", {"--report", "3", "--view", "side"});
  ASSERT_TRUE(good(named));
  EXPECT_TRUE(has(named.out, "worst: side"));
  EXPECT_FALSE(has(named.out, "front"));
  EXPECT_TRUE(ended(convert("m.spz", {"--report", "3", "--view", "nowhere"}), 2, "nowhere"));
}

// There and back by other axes, and a file whose numbers are not what its format says.
TEST_F(ConvertTest, AxesAreTurned) {
  add_cameras();
  ASSERT_TRUE(good(convert("m.spz")));
  const auto run = [&](const std::string& from, const std::string& to, const Words& more = {}) {
    return run_program(joined({"convert", folder / from, "-o", folder / to, "--report", "2"}, more));
  };
  const Outcome back = run("m.spz", "back.ply");
  ASSERT_TRUE(good(back));
  EXPECT_TRUE(has(back.err, "turned from RUB to RDF"));
  EXPECT_TRUE(has(back.out, "equal"));
  const Outcome as_ply = run("m.spz", "as-ply.ply", {"--axes", "rdf"});
  ASSERT_TRUE(good(as_ply));
  EXPECT_FALSE(has(as_ply.err, "turned"));
  EXPECT_NE(test::read_text(folder / "as-ply.ply"), test::read_text(folder / "back.ply"));
}

// Axes that change places mix harmonics; the pictures differ by their last bits.
TEST_F(ConvertTest, HarmonicsAreTurned) {
  test::PlyFile file = test::inria_file(3, 300);
  for (std::size_t i = 0; i < 300; ++i) {
    for (const char* scale : {"scale_0", "scale_1", "scale_2"}) file.at(i, scale) -= 2;
  }
  test::write_text(model, to_bytes(file));
  const auto cost = [&](const char* to, const char* harmonic_bits = nullptr) {
    Words words = {"--axes", "rfu", "--report", "2", "--size", "64x64", "--json", folder / "r.json"};
    if (harmonic_bits != nullptr) words.insert(words.end(), {"--sh-bits", harmonic_bits});
    EXPECT_TRUE(good(convert(to, words)));
    return test::load_json(folder / "r.json")["worst"];
  };
  const json ply = cost("m.ply");
  EXPECT_TRUE(ply["equal"] || ply["psnr_db"] > 70) << ply;
  EXPECT_LT(cost("m.spz", "1")["psnr_db"], 30) << "harmonics do not count in these pictures";
}

TEST_F(ConvertTest, ErrorsSayWhatToDo) {
  const std::string none = folder / "none.ply";
  EXPECT_TRUE(ended(convert("m.obj"), 2, "its ending names no format that can be written"));
  EXPECT_TRUE(ended(convert("m.spz", {"--to", "ksplat"}), 2, "--to"));
  EXPECT_TRUE(ended(convert("m.ply", {"--sh-bits", "4"}), 2, "only spz"));
  EXPECT_TRUE(ended(convert("m.spz", {"--sh-bits", "9"}), 2, "--sh-bits"));
  EXPECT_TRUE(ended(convert("m.spz", {"--report", "0"}), 2, "--report"));
  EXPECT_TRUE(ended(convert("m.spz", {"--size", "36x24"}), 2, "--report"));
  EXPECT_TRUE(ended(convert("model.ply/m.spz"), 2, "is a file where a folder is needed"));
  EXPECT_TRUE(ended(run_program({"convert", model, "-o", "/proc/m.spz"}), 2, "cannot write /proc/m.spz"));
  EXPECT_TRUE(ended(run_program({"convert", none, "-o", out}), 2, "its ending names"));
  EXPECT_TRUE(ended(run_program({"convert", none, "-o", out, "--to", "ply"}), 2, "none.ply"));
  EXPECT_EQ(folder.files(), (std::set<std::string>{"model.ply"}));
  // --to wins over the ending, and a full disk leaves nothing.
  ASSERT_TRUE(good(convert("m.ply", {"--to", "spz"})));
  EXPECT_TRUE(has(run_program({"info", folder / "m.ply"}).out, "spz"));
  const Outcome full =
      run_program({"convert", model, "-o", folder / "full.ply"}, {.limits = {{RLIMIT_FSIZE, 9000}}});
  EXPECT_TRUE(ended(full, 2, "cannot write"));
  EXPECT_FALSE(std::filesystem::exists(folder / "full.ply"));
}

TEST(ConvertBuiltIn, TheRoom) {
  const test::TempFolder folder;
  const Outcome outcome =
      run_program({"convert", "demo:room", "-o", folder / "room.spz", "--report", "1", "--size", "160x90"});
  ASSERT_TRUE(good(outcome));
  EXPECT_TRUE(has(outcome.out, "98230 Gaussians"));
}

TEST(ConvertScenes, FoxCostsWhatItShould) {
  REQUIRE_SCENE("fox", scene);
  const test::TempFolder folder;
  struct Case {
    const char* file;
    Words more;
    double least, most;   // dB of the worst view
    double bytes;         // a Gaussian, at most
    bool always = false;  // without BINOSPLAT_LONG as well: formats by themselves are held by their steps
  };
  // Measured at 240 x 160: 50.7, 36.5 and 41.0 dB.
  for (const Case& c : {Case{"a.spz", {}, 49, 53, 39, true}, Case{"b.spz", {"--sh-bits", "4"}, 35, 38, 24.5},
                        Case{"e.sog", {}, 40, 43, 30, true}}) {
    if (!c.always && !test::switched_on("BINOSPLAT_LONG")) continue;
    ASSERT_TRUE(good(
        run_program(test::SceneTest::joined({"convert", scene / "fox.ply", "-o", folder / c.file, "--report",
                                             "2", "--size", "240x160", "--json", folder / "r.json"},
                                            c.more))));
    const json report = test::load_json(folder / "r.json");
    EXPECT_GT(report["worst"]["psnr_db"], c.least) << c.file;
    EXPECT_LT(report["worst"]["psnr_db"], c.most) << c.file;
    EXPECT_LE(report["bytes_per_gaussian"], c.bytes) << c.file;
  }
}

}  // namespace
}  // namespace binosplat
