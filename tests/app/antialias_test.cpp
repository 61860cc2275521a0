// Models that were trained with anti-aliasing, by their tags and by --antialias.

#include <gtest/gtest.h>

#include "app/scene.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::has;
struct Antialias : test::SceneTest {
  Antialias() {
    add_cameras();
    // Far away, so that all are smaller than a pixel.
    for (std::size_t i = 0; i < file.rows.size(); ++i) {
      for (const char* scale : {"scale_0", "scale_1", "scale_2"}) file.at(i, scale) -= 3;
    }
  }

  /// The picture of `file` with the options; what was said goes to `said`.
  Image drawn(const test::Words& more = {}) {
    test::write_text(model, to_bytes(file));
    const test::Outcome outcome =
        render(joined(more, {"--view", "front", "--mono", "-o", folder / "a.png", "--bits", "16"}));
    EXPECT_TRUE(test::good(outcome));
    said = outcome.err;
    return load_image(folder / "a.png");
  }

  test::PlyFile file = test::small_model();
  std::string said;
};

double sum(const Image& image) {
  double total = 0;
  for (const float v : image.data) total += v;
  return total;
}

TEST_F(Antialias, TagsAndOptionsMeanTheSame) {
  const Image plain = drawn();
  EXPECT_FALSE(has(said, "anti-aliasing"));
  const Image forced = drawn({"--antialias"});
  EXPECT_LT(sum(forced), 0.5 * sum(plain));
  file.comments = "comment SplatRenderMode: mip\n";
  EXPECT_EQ(drawn().data, forced.data);
  EXPECT_TRUE(has(said, "was trained with anti-aliasing, says a comment of the ply, and is drawn so"));
  EXPECT_EQ(drawn({"--no-antialias"}).data, plain.data);
  const Image narrow = drawn({"--kernel-px2", "0.1"});
  EXPECT_NE(narrow.data, forced.data);
  // Mip-Splatting's files say by their filter that their kernel is the narrow one.
  file.comments = "";
  file.columns.emplace_back("filter_3D");
  for (auto& row : file.rows) row.push_back(0.0);
  EXPECT_EQ(drawn().data, narrow.data);
  EXPECT_EQ(drawn({"--kernel-px2", "0.3"}).data, forced.data);
}

TEST_F(Antialias, OfAFileThatSaysNothingIsThatOfTheRunBesideIt) {
  const Image plain = drawn(), forced = drawn({"--antialias"});
  const std::string run = folder / "cfg.yml";
  const auto trained = [&](const char* how) {
    test::write_text(run, std::string("antialiased: ") + how + "\nresult_dir: results\n");
  };
  trained("true");
  EXPECT_EQ(drawn().data, forced.data);
  EXPECT_TRUE(has(said, "was trained with anti-aliasing, says " + run));
  EXPECT_EQ(drawn({"--no-antialias"}).data, plain.data);
  file.comments = "comment SplatRenderMode: default\n";
  EXPECT_EQ(drawn().data, plain.data);
  EXPECT_TRUE(has(said, "a comment of the ply says that it was trained without anti-aliasing"));
  file.comments = "";
  trained("false");
  EXPECT_EQ(drawn().data, plain.data);
  EXPECT_EQ(drawn({"--antialias"}).data, forced.data);
  test::write_text(run, "antialiased: true\n");  // of another program
  EXPECT_EQ(drawn().data, plain.data);
}

TEST_F(Antialias, WhatWasTrainedAlongRaysHasHardlyALowPass) {
  const Image plain = drawn(), narrow = drawn({"--kernel-px2", "0.001"});
  EXPECT_NE(plain.data, narrow.data);
  const std::string run = folder / "cfg.yml";
  test::write_text(run, "antialiased: false\nresult_dir: results\nwith_eval3d: true\n");
  EXPECT_EQ(drawn().data, narrow.data);
  EXPECT_TRUE(has(said, "warning: " + run + ": it was trained by 3DGUT"));
  EXPECT_EQ(drawn({"--kernel-px2", "0.3"}).data, plain.data);
}

}  // namespace
}  // namespace binosplat
