// binosplat info, from the command line.

#include "app/scene.h"
#include "base/clock.h"

namespace binosplat {
namespace {

using Info = SceneTest;

TEST_F(Info, TextEqualsJson) {
  const Outcome outcome = run_program({"info", model, "--json", folder / "info.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json json = load_json(folder / "info.json");
  EXPECT_EQ(json["gaussians"], 300);
  EXPECT_EQ(json["format"], "ply");
  EXPECT_EQ(json["degree"], 1);
  EXPECT_EQ(json["axes"], "RDF");
  EXPECT_EQ(json["degrees_in_use"], (std::vector<int>{0, 300, 0, 0}));
  std::size_t tenths = 0;
  for (const auto& count : json["opacity"]["tenths"]) tenths += count.get<std::size_t>();
  EXPECT_EQ(tenths, 300u);
  EXPECT_GT(json["gpu_bytes"]["model"], 300 * 48);
  EXPECT_EQ(json["file_bytes"]["ply"], 300 * 104);
  for (const char* part :
       {"model.ply (ply)", "Gaussians      300\n", "degree 1", "x right, y down, z forward", "2 to 98 %",
        "GPU memory", "as a file      ply 0.0 MB", "never visible"})
    EXPECT_TRUE(has(outcome.out, part)) << part;
}

TEST_F(Info, TreeMemoryIsLinear) {
  // Many nodes at the end of a long path. If nodes stored their paths, each would store all of it.
  std::string tree = "{}";
  for (int i = 0; i < 400000; ++i) tree += ",{}";
  for (int i = 0; i < 240; ++i) tree = R"({"children":[)" + tree + "]}";
  write_text(folder / "lod-meta.json",
             R"({"lodLevels":100,"filenames":["0/meta.json"],"tree":)" + tree + "}");
  const Clock::time_point start = Clock::now();
  const Outcome outcome = run_program({"info", folder / "lod-meta.json"});
  const double ms = ms_since(start);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(has(outcome.err, "lod-meta.json holds no Gaussians"));
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(ms, 5000.0);                   // takes 0.3 s; a walk for each of 100 levels takes 9 s
  EXPECT_LT(outcome.peak_kib, 300 << 10);  // stored paths would take 1.2 GB
#endif
}

TEST_F(Info, DescribesBuiltInScene) {
  EXPECT_TRUE(has(run_program({"info", "demo:room"}).out, "demo:room (built in)\nGaussians      98230\n"));
}

TEST(InfoOfFixtures, RecognizesFormats) {
  REQUIRE_FIXTURES(folder);
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"spz/adobe-train-v4-sh3-rdf2rub-aa.spz", "(spz 4, axes assumed)"},
      {"spz/st-train-v3-sh3.spz", "x right, y up, z back"},
      {"cply/st-train-sh1.compressed.ply", "(compressed ply)"},
      {"splat/minimal.splat", "(.splat)"},
      {"ksplat/st-minimal.ksplat", "(.ksplat)"},
      {"sog/playbot-lod6", "(SOG)"},
      {"sog/st-lod", "(streamed SOG, level 0 of 2)"}};
  for (const auto& [file, part] : expected) {
    EXPECT_TRUE(has(run_program({"info", folder / file}).out, part)) << file << ":\n";
  }
}

}  // namespace
}  // namespace binosplat
