// Models trained with anti-aliasing, or with hardly any low-pass: detected by their tags and by the files of
// the training run, or set by options.

#include "app/scene.h"

namespace binosplat {
namespace {

struct Antialias : SceneTest {
  Antialias() {
    add_cameras();
    // Shrinks all Gaussians to less than a pixel.
    for (std::size_t i = 0; i < file.rows.size(); ++i) {
      for (const char* scale : {"scale_0", "scale_1", "scale_2"}) file.at(i, scale) -= 3;
    }
  }

  /// Returns the picture of `file` with the options; `said` receives the output.
  Image drawn(const Words& more = {}) {
    write_text(model, to_bytes(file));
    const Outcome outcome =
        checked(render(joined(more, {"--view", "front", "--mono", "-o", folder / "a.png", "--bits", "16"})));
    said = outcome.err;
    return load_image(folder / "a.png");
  }

  PlyFile file = small_model();
  std::string said;
};

double sum(const Image& image) {
  double total = 0;
  for (const float v : image.data) total += v;
  return total;
}

TEST_F(Antialias, OptionOverridesFile) {
  const Image plain = drawn();
  EXPECT_FALSE(has(said, "anti-aliasing"));
  const Image forced = drawn({"--antialias"}), thin = drawn({"--eps2d", "0.001"});
  EXPECT_LT(sum(forced), 0.5 * sum(plain));
  EXPECT_NE(plain.data, thin.data);
  const std::string run = folder / "cfg.yml", ours = "\nresult_dir: results\n",
                    mip = "comment SplatRenderMode: mip\n", usual = "comment SplatRenderMode: default\n",
                    aliased = "antialiased: true" + ours, unaliased = "antialiased: false" + ours,
                    along_rays = unaliased + "with_eval3d: true\n";
  const struct {
    std::string comments, run;
    Words options;
    const Image& expected;
    std::string said;
  } cases[] = {
      {mip, "", {}, forced, "was trained with anti-aliasing, says a comment of the ply, and is drawn so"},
      {mip, "", {"--no-antialias"}, plain, ""},
      {"", aliased, {}, forced, "was trained with anti-aliasing, says " + run},
      {"", aliased, {"--no-antialias"}, plain, ""},
      {usual,
       aliased,
       {},
       plain,
       "a comment of the ply and " + run + " disagree about its anti-aliasing; the first one counts"},
      {"", unaliased, {}, plain, ""},
      {"", unaliased, {"--antialias"}, forced, ""},
      {"", "antialiased: true\n", {}, plain, ""},  // from another program
      {"", along_rays, {}, thin, "warning: " + run + ": its trainer evaluates Gaussians along each ray"},
      {"", along_rays, {"--eps2d", "0.3"}, plain, ""},
  };
  for (const auto& one : cases) {
    file.comments = one.comments;
    write_text(run, one.run);
    if (one.run.empty()) fs::remove(run);
    EXPECT_EQ(drawn(one.options).data, one.expected.data) << one.comments << one.run;
    EXPECT_TRUE(has(said, one.said));
  }
}

// The filter in Mip-Splatting's files implies its narrow kernel.
TEST_F(Antialias, MipFilterImpliesNarrowKernel) {
  const Image wide = drawn({"--antialias"}), narrow = drawn({"--antialias", "--eps2d", "0.1"});
  EXPECT_NE(narrow.data, wide.data);
  file.columns.emplace_back("filter_3D");
  for (auto& row : file.rows) row.push_back(0.0);
  EXPECT_EQ(drawn().data, narrow.data);
  EXPECT_EQ(drawn({"--eps2d", "0.3"}).data, wide.data);
}

}  // namespace
}  // namespace binosplat
