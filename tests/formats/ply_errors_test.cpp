// Broken and foreign files: each ends with an Error that names the file, the place and what is wrong.

#include <gtest/gtest.h>

#include <functional>

#include "formats/model_file.h"
#include "formats/ply.h"
#include "support/broken.h"
#include "support/errors.h"
#include "support/ply.h"
#include "support/program.h"

namespace binosplat {
namespace {

using test::PlyFile;

testing::AssertionResult refuses_ply(const std::string& bytes, std::initializer_list<std::string> parts) {
  return test::refuses_file(bytes, "bad.ply", parts, [](const auto& path) { load_model(path); });
}

/// 100 Gaussians of degree 3: a header of a few lines, then rows of 248 bytes.
std::string good_bytes() { return to_bytes(test::inria_file(3, 100)); }

using test::replaced;

TEST(PlyErrors, TheFileItself) {
  const test::TempFolder folder;
  EXPECT_TRUE(test::fails_saying([&] { load_model(folder / "none.ply"); }, {"none.ply", "No such file"}));
  EXPECT_TRUE(test::fails_saying([&] { load_model(folder.path()); },
                                 {"is a folder without a model", "lod-meta.json", "point_cloud.ply"}));
}

TEST(PlyErrors, CutShort) {
  const std::string good = good_bytes();
  const std::size_t header = good.size() - 100 * 248;
  EXPECT_TRUE(refuses_ply(good.substr(0, header + 10000),
                          {"cut short", fmt::format("needs 100 x 248 = 24800 bytes from byte {} on", header),
                           "but 10000 are there", "number 40 of 100"}));
  EXPECT_TRUE(refuses_ply(good.substr(0, good.size() - 1), {"but 24799 are there", "number 99 of 100"}));
  EXPECT_TRUE(refuses_ply(good.substr(0, header), {"but 0 are there", "number 0 of 100"}));
  EXPECT_TRUE(refuses_ply(good.substr(0, header - 1), {"no 'end_header' line"}));
  EXPECT_TRUE(refuses_ply(good.substr(0, 300), {"no 'end_header' line"}));

  PlyFile ascii = test::inria_file(0, 10);
  ascii.format = "ascii";
  const std::string text = to_bytes(ascii);
  EXPECT_TRUE(refuses_ply(text.substr(0, text.size() - 2 - ascii.rows.size()), {"element 'vertex' 9"}));
  // Whole lines are missing.
  const std::size_t start = header_of(ascii).size();
  std::size_t end = start;
  for (int i = 0; i < 7; ++i) end = text.find('\n', end) + 1;
  EXPECT_TRUE(refuses_ply(text.substr(0, end), {"cut short", "with 7 of 10 lines of element 'vertex'"}));
}

TEST(PlyErrors, CountsThatNoFileHolds) {
  const std::string good = good_bytes();
  const std::string line = "element vertex 100";
  EXPECT_TRUE(refuses_ply(replaced(good, line, "element vertex 4000000000"),
                          {"4000000000 x 248 = 992000000000 bytes"}));
  EXPECT_TRUE(refuses_ply(replaced(good, line, "element vertex 18446744073709551615"),
                          {"18446744073709551615 of element 'vertex'", "more than any file can hold"}));
  // 2^64 / 248, rounded up: the product wraps to a small number.
  EXPECT_TRUE(
      refuses_ply(replaced(good, line, "element vertex 74382032555280451"), {"more than any file can hold"}));
  EXPECT_TRUE(refuses_ply(replaced(good, line, "element vertex 18446744073709551616"),
                          {"line 3", "no count of elements"}));
  EXPECT_TRUE(refuses_ply(replaced(good, line, "element vertex -5"), {"line 3", "'-5' is no count"}));
  EXPECT_TRUE(refuses_ply(replaced(good, line, "element vertex 1e2"), {"'1e2' is no count"}));
  EXPECT_TRUE(refuses_ply(replaced(good, line, "element vertex 0"), {"holds no Gaussians"}));

  const std::string many = "element vertex 9000000000000000000";
  EXPECT_TRUE(
      refuses_ply(replaced(replaced(good, line, many), "binary_little_endian", "ascii"), {"cut short"}));
  // A list adds a byte to every row at least: room is made for no more Gaussians than that allows.
  const std::string lists = replaced(good, "end_header", "property list uchar int l\nend_header");
  EXPECT_TRUE(
      refuses_ply(replaced(lists, line, many), {"cut short", "element 'vertex' 99 of 9000000000000000000"}));
  EXPECT_TRUE(refuses_ply(replaced(lists, line, "element vertex 20000"), {"element 'vertex' 99 of 20000"}));
}

TEST(PlyErrors, Header) {
  const std::string good = good_bytes();
  EXPECT_TRUE(refuses_ply(replaced(good, "end_header\n", ""),
                          {"is no word of a ply header; is its 'end_header' line missing?"}));
  std::string endless = "ply\nformat ascii 1.0\n";
  while (endless.size() < 2000000) endless += "comment x\n";
  EXPECT_TRUE(refuses_ply(endless, {"no 'end_header' line in its first 1048576 bytes"}));
  EXPECT_TRUE(
      refuses_ply(replaced(good, "format binary_little_endian 1.0\n", ""), {"without a 'format' line"}));
  EXPECT_TRUE(
      refuses_ply(replaced(good, "binary_little_endian 1.0", "binary_little_endian 2.0"), {"line 2", "1.0"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "binary_little_endian", "binary_middle_endian"),
                          {"line 2", "expected 'format'"}));
  EXPECT_TRUE(
      refuses_ply(replaced(good, "property float x", "property real x"), {"line 4", "'real' is no type"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "property float x", "property float"),
                          {"line 4", "expected 'property TYPE NAME'"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "property float x", "property list float int x"),
                          {"line 4", "integer type"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "property float x", "properly float x"),
                          {"line 4", "'properly' is no word"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "element vertex 100", "property float a"),
                          {"line 3", "before any element"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "element vertex 100", "element vertex"),
                          {"line 3", "expected 'element NAME COUNT'"}));
  EXPECT_TRUE(
      refuses_ply(replaced(good, "property float nx", "property float x"), {"line 7", "'x' occurs twice"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "end_header", "element vertex 1\nend_header"),
                          {"element 'vertex' occurs twice"}));
}

TEST(PlyErrors, MissingAndWrongProperties) {
  const std::string good = good_bytes();
  for (const char* name : {"x", "f_dc_1", "opacity", "scale_1", "rot_2"}) {
    const std::string line = fmt::format("property float {}\n", name);
    EXPECT_TRUE(refuses_ply(replaced(good, line, "property float other\n"),
                            {fmt::format("element 'vertex' has no property '{}'", name)}));
    EXPECT_TRUE(
        refuses_ply(replaced(good, line, fmt::format("property list uchar float {}\n", name)),
                    {fmt::format("property '{}' of element 'vertex' is a list; expected one number", name)}));
  }
  EXPECT_TRUE(refuses_ply(replaced(good, "float f_rest_44", "float other"),
                          {"44 properties f_rest_*", "0, 9, 24 or 45"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "float f_rest_44", "float f_rest_45"), {"no property 'f_rest_44'"}));
}

TEST(PlyErrors, Text) {
  PlyFile file = test::inria_file(0, 3);
  file.format = "ascii";
  for (auto& row : file.rows) std::fill(row.begin(), row.end(), 0.25);
  const std::string good = to_bytes(file);  // 21 lines of header
  EXPECT_TRUE(refuses_ply(replaced(good, "0.25", "0,25"),
                          {"line 22", "'0,25' is no number", "property 'x' of element 'vertex' 0"}));
  EXPECT_TRUE(refuses_ply(replaced(good, "0.25", "0.2x"), {"'0.2x' is no number"}));
  EXPECT_TRUE(
      refuses_ply(replaced(good, "0.25 ", ""), {"line 22", "'vertex' 0 ends before property 'rot_3'"}));
  EXPECT_TRUE(
      refuses_ply(replaced(good, "0.25", "1 0.25"), {"line 22", "'vertex' 0 has more values than its 17"}));
  const std::string list = replaced(good, "property float nx", "property list uchar float nx");
  EXPECT_TRUE(refuses_ply(list, {"line 22", "list 'nx' of element 'vertex' 0 has length 0.25"}));
}

TEST(PlyErrors, ListsBeyondTheEnd) {
  PlyFile file = test::inria_file(0, 3);
  file.header_after = "element face 1\nproperty list uchar int indices\n";
  file.data_after = std::string("\x03", 1) + std::string(12, '\0');
  EXPECT_FALSE(refuses_ply(to_bytes(file), {}));
  file.data_after[0] = '\xff';
  EXPECT_TRUE(refuses_ply(to_bytes(file), {"cut short", "element 'face' 0 of 1"}));
  file.data_after.clear();
  EXPECT_TRUE(refuses_ply(to_bytes(file), {"cut short", "element 'face' 0 of 1"}));
  file.header_after = "element face 1\nproperty list char int indices\n";
  file.data_after = "\xff";
  EXPECT_TRUE(refuses_ply(to_bytes(file), {"element 'face' 0 of 1"}));
}

TEST(PlyErrors, FilesThatHoldSomethingElse) {
  const auto ply = [](const std::string& elements) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n0 0 0 1 2 3\n";
  };
  const std::string points =
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\n";
  EXPECT_TRUE(
      refuses_ply("ply\nformat binary_little_endian 1.0\nelement vertex_0 0\nproperty float x\nelement "
                  "codebook_centers 256\n"
                  "property float features_dc\nend_header\n",
                  {"Reduced-3DGS", "codebook_centers", "point_cloud.ply"}));
  EXPECT_TRUE(refuses_ply(ply(points), {"is a point cloud", "point_cloud/iteration_N/point_cloud.ply"}));
  EXPECT_TRUE(
      refuses_ply(ply(points + "element face 2\nproperty list uchar int i\n"), {"is a mesh of 2 faces"}));
  EXPECT_TRUE(refuses_ply(ply("element camera 1\nproperty float x\n"), {"no element 'vertex'"}));
  EXPECT_TRUE(refuses_ply(ply("element vertex 1\nproperty float x\nproperty float f_anchor_feat_0\n"),
                          {"Scaffold-GS"}));

  EXPECT_TRUE(refuses_ply("", {"an empty file"}));
  EXPECT_TRUE(
      refuses_ply("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", {"git lfs pull"}));
  EXPECT_TRUE(refuses_ply("\x89PNG\r\n\x1a\n1234", {"a PNG picture"}));
  EXPECT_TRUE(refuses_ply("<!DOCTYPE html>", {"an HTML or XML page"}));
  EXPECT_TRUE(refuses_ply("\xef\xbb\xbf [1]", {"a JSON file"}));
  EXPECT_TRUE(refuses_ply("hello", {"a text file"}));
  EXPECT_TRUE(refuses_ply("plywood", {"a text file"}));
  EXPECT_TRUE(refuses_ply("\x1f\x8b\x08", {"is cut short: its gzip data"}));
  EXPECT_TRUE(refuses_ply(std::string("\x01\x02\x00", 3), {"something unknown"}));

  PlyFile nothing = test::inria_file(0, 2);
  nothing.at(0, "x") = nothing.at(1, "x") = std::nan("");
  EXPECT_TRUE(refuses_ply(to_bytes(nothing), {"all of its 2 Gaussians"}));
}

}  // namespace
}  // namespace binosplat
