// Damaged compressed ply files. real_files_test tests that values are decoded right.

#include <gtest/gtest.h>

#include "support/fixtures.h"
#include "support/load.h"

namespace binosplat {
namespace {

using test::replaced;

TEST(CompressedPlyErrors, CountsAndProperties) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "cply/supersplat-guitar-cut-sh0.compressed.ply");
  const std::string sh = test::read_text(folder / "cply/st-train-sh1.compressed.ply");
  const std::string count = "element vertex 2148";
  const std::vector<test::BrokenFile> refusals = {
      {replaced(good, "element chunk 9", "element chunk 8"), {"'chunk' has 8 rows, too few for 2148"}},
      {replaced(good, "float max_b", "float other"), {"element 'chunk' has no property 'max_b'"}},
      {replaced(good, "float max_scale_x", "float other"), {"'chunk' has no property 'max_scale_x'"}},
      {replaced(good, "float min_x", "int min_x"), {"'min_x' of element 'chunk' is not of type float"}},
      {replaced(good, "uint packed_scale", "uint other"), {"'vertex' has no property 'packed_scale'"}},
      {replaced(good, count, "element vertex 18446744073709551615"),
       {"'vertex', more than any file can hold"}},
      {replaced(good, count, "element vertex 4000000000"), {"cut short", "4000000000 x 16 = "}},
      {replaced(good, count, "element vertex 0"), {"holds no Gaussians"}},
      {replaced(good, count, "element other 2148"), {"without element 'vertex'"}},
      {replaced(good, "binary_little_endian", "binary_big_endian"), {"binary_little_endian"}},
      {replaced(good, "uint packed_scale", "list uchar uint packed_scale"), {"has a list"}},
      {replaced(sh, "element sh 1000", "element sh 999"), {"element 'sh' has 999 rows for 1000"}},
      {replaced(sh, "uchar f_rest_8", "uchar f_rest_9"), {"element 'sh' has no property 'f_rest_8'"}},
      {replaced(sh, "property uchar f_rest_8\n", ""), {"element 'sh' has 8 properties"}},
  };
  test::expect_no_models("bad.ply", refusals);
}

TEST(CompressedPlyErrors, CutShort) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "cply/st-train-sh1.compressed.ply");
  const std::size_t data = good.find("end_header\n") + 11;
  const std::size_t vertices = data + 4 * 72, harmonics = vertices + 16000;
  ASSERT_EQ(good.size(), harmonics + 9000);
  const std::vector<test::BrokenFile> refusals = {
      {good.substr(0, data), {"cut short", "element 'chunk' needs 4 x 72 = 288 bytes"}},
      {good.substr(0, vertices - 1), {"element 'chunk' needs", "has only 287 there"}},
      {good.substr(0, vertices), {"element 'vertex' needs 1000 x 16 = 16000", "has only 0 there"}},
      {good.substr(0, harmonics - 1), {"element 'vertex'"}},
      {good.substr(0, harmonics), {"element 'sh' needs 1000 x 9"}},
      {good.substr(0, good.size() - 1), {"element 'sh'"}},
  };
  test::expect_no_models("bad.ply", refusals);
}

TEST(CompressedPly, LoadsUnusualFiles) {
  REQUIRE_FIXTURES(folder);
  // Bounds that are not finite lose only their own chunk.
  const std::string good = test::read_text(folder / "cply/supersplat-guitar-cut-sh0.compressed.ply");
  const std::size_t chunk = good.find("end_header\n") + 11 + std::size_t{8} * 72;
  const std::string odd = test::patched(good, chunk + 12, test::little(std::nanf("")));
  const Model model = test::load_model_of(odd, "odd.ply");
  EXPECT_EQ(model.count(), 2048u);
  EXPECT_EQ(model.left_out, 100u);
  // For degree 0, gsplat writes an element without properties.
  const std::string empty = replaced(good, "end_header", "element sh 2148\nend_header");
  EXPECT_EQ(test::load_model_of(empty, "odd.ply").degree, 0);
}

TEST(CompressedPly, DiscsHaveNoThickness) {
  REQUIRE_FIXTURES(folder);
  const std::string plain = test::read_text(folder / "cply/st-train-sh1.compressed.ply");
  const std::string discs = replaced(plain, "element chunk", "comment SplatRenderMode: 2dgs\nelement chunk");
  const Model thick = test::load_model_of(plain, "thick.ply"), flat = test::load_model_of(discs, "flat.ply");
  EXPECT_FALSE(thick.flat);
  EXPECT_TRUE(flat.flat);
  EXPECT_EQ(flat.format, "compressed ply, flat Gaussians of 2DGS");
  ASSERT_EQ(flat.count(), thick.count());
  for (std::size_t i = 0; i < flat.count(); ++i)
    ASSERT_EQ(flat.scale[i], glm::vec3(thick.scale[i].x, thick.scale[i].y, 0.0f));
}

}  // namespace
}  // namespace binosplat
