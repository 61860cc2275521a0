// Damaged compressed plys. That values are decoded right is real_files_test's matter.

#include <gtest/gtest.h>

#include "formats/model_file.h"
#include "support/broken.h"
#include "support/fixtures.h"

namespace binosplat {
namespace {

using test::replaced;

testing::AssertionResult refuses_compressed(const std::string& bytes,
                                            std::initializer_list<std::string> parts) {
  return test::refuses_file(bytes, "bad.ply", parts, [](const auto& path) { load_model(path); });
}

TEST(CompressedPlyErrors, CountsAndProperties) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "cply/supersplat-guitar-cut-sh0.compressed.ply");
  EXPECT_TRUE(refuses_compressed(replaced(good, "element chunk 9", "element chunk 8"),
                                 {"element 'chunk' has 8 rows, too few for 2148"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "float max_b", "float other"),
                                 {"element 'chunk' has no property 'max_b'"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "float max_scale_x", "float other"),
                                 {"element 'chunk' has no property 'max_scale_x'"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "float min_x", "int min_x"),
                                 {"property 'min_x' of element 'chunk' is not of type float"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "uint packed_scale", "uint other"),
                                 {"element 'vertex' has no property 'packed_scale'"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "element vertex 2148", "element vertex 18446744073709551615"),
                                 {"element 'vertex', more than any file can hold"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "element vertex 2148", "element vertex 4000000000"),
                                 {"cut short", "4000000000 x 16 = "}));
  EXPECT_TRUE(
      refuses_compressed(replaced(good, "element vertex 2148", "element vertex 0"), {"holds no Gaussians"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "element vertex 2148", "element other 2148"),
                                 {"without element 'vertex'"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "binary_little_endian", "binary_big_endian"),
                                 {"binary_little_endian"}));
  EXPECT_TRUE(refuses_compressed(replaced(good, "uint packed_scale", "list uchar uint packed_scale"),
                                 {"has a list"}));

  const std::string sh = test::read_text(folder / "cply/st-train-sh1.compressed.ply");
  EXPECT_TRUE(refuses_compressed(replaced(sh, "element sh 1000", "element sh 999"),
                                 {"element 'sh' has 999 rows for 1000"}));
  EXPECT_TRUE(refuses_compressed(replaced(sh, "uchar f_rest_8", "uchar f_rest_9"),
                                 {"element 'sh' has no property 'f_rest_8'"}));
  EXPECT_TRUE(
      refuses_compressed(replaced(sh, "property uchar f_rest_8\n", ""), {"element 'sh' has 8 properties"}));
}

TEST(CompressedPlyErrors, CutShort) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "cply/st-train-sh1.compressed.ply");
  const std::size_t data = good.find("end_header\n") + 11;
  const std::size_t vertices = data + 4 * 72, harmonics = vertices + 16000;
  ASSERT_EQ(good.size(), harmonics + 9000);
  EXPECT_TRUE(
      refuses_compressed(good.substr(0, data), {"cut short", "element 'chunk' needs 4 x 72 = 288 bytes"}));
  EXPECT_TRUE(
      refuses_compressed(good.substr(0, vertices - 1), {"element 'chunk' needs", "but 287 are there"}));
  EXPECT_TRUE(refuses_compressed(good.substr(0, vertices),
                                 {"element 'vertex' needs 1000 x 16 = 16000", "but 0 are there"}));
  EXPECT_TRUE(refuses_compressed(good.substr(0, harmonics - 1), {"element 'vertex'"}));
  EXPECT_TRUE(refuses_compressed(good.substr(0, harmonics), {"element 'sh' needs 1000 x 9"}));
  EXPECT_TRUE(refuses_compressed(good.substr(0, good.size() - 1), {"element 'sh'"}));
}

TEST(CompressedPly, WhatIsOddButLoads) {
  REQUIRE_FIXTURES(folder);
  const test::TempFolder temporary;
  const auto load = [&](const std::string& bytes) {
    test::write_text(temporary / "odd.ply", bytes);
    return load_model(temporary / "odd.ply");
  };
  // Bounds that are not finite: only their chunk is lost.
  const std::string good = test::read_text(folder / "cply/supersplat-guitar-cut-sh0.compressed.ply");
  const std::size_t chunk = good.find("end_header\n") + 11 + std::size_t{8} * 72;
  const Model model = load(test::patched(good, chunk + 12, test::little(std::nanf(""))));
  EXPECT_EQ(model.count(), 2048u);
  EXPECT_EQ(model.left_out, 100u);
  // gsplat writes an element without properties for degree 0.
  EXPECT_EQ(load(replaced(good, "end_header", "element sh 2148\nend_header")).degree, 0);
}

}  // namespace
}  // namespace binosplat
