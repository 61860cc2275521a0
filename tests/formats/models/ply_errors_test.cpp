// Broken and foreign files: each ends with an Error that names the file, the position and the cause.

#include <gtest/gtest.h>

#include "support/load.h"
#include "support/ply.h"

namespace binosplat {
namespace {

using test::PlyFile;

void expect_refused(const std::vector<test::BrokenFile>& refusals) {
  test::expect_no_models("bad.ply", refusals);
}

/// 100 Gaussians of degree 3: a header of a few lines, then rows of 248 bytes.
std::string good_bytes() { return to_bytes(test::inria_file(3, 100)); }

using test::replaced;

TEST(PlyErrors, MissingFileOrFolder) {
  const test::TempFolder folder;
  EXPECT_ERROR(load_model(folder / "none.ply"), "none.ply", "No such file");
  EXPECT_ERROR(load_model(folder.path()), "is a folder without a model", "lod-meta.json", "point_cloud.ply");
}

TEST(PlyErrors, CutShort) {
  const std::string good = good_bytes();
  const std::size_t header = good.size() - 100 * 248;
  PlyFile ascii = test::inria_file(0, 10);
  ascii.format = "ascii";
  const std::string text = to_bytes(ascii);
  std::size_t lines = header_of(ascii).size();  // The header has seven lines.
  for (int i = 0; i < 7; ++i) lines = text.find('\n', lines) + 1;
  expect_refused({
      {good.substr(0, header + 10000),
       {"cut short", fmt::format("needs 100 x 248 = 24800 bytes from byte {} on", header),
        "has only 10000 there", "row 40 of 100"}},
      {good.substr(0, good.size() - 1), {"has only 24799 there", "row 99 of 100"}},
      {good.substr(0, header), {"has only 0 there", "row 0 of 100"}},
      {good.substr(0, header - 1), {"no 'end_header' line"}},
      {good.substr(0, 300), {"no 'end_header' line"}},
      {text.substr(0, text.size() - 2 - ascii.rows.size()), {"element 'vertex' 9"}},
      {text.substr(0, lines), {"cut short", "with 7 of 10 lines of element 'vertex'"}},
  });
}

TEST(PlyErrors, ExcessiveCounts) {
  const std::string good = good_bytes();
  const auto with = [&](const std::string& count) {
    return replaced(good, "element vertex 100", "element vertex " + count);
  };
  const std::string many = with("9000000000000000000");
  // A list takes at least one byte per row, so the file's size limits the number of Gaussians that memory is
  // allocated for.
  const std::string end = "end_header", list = "property list uchar int l\nend_header";
  expect_refused({
      {with("4000000000"), {"4000000000 x 248 = 992000000000 bytes"}},
      {with("18446744073709551615"), {"18446744073709551615 of element 'vertex'", "than any file can hold"}},
      // 2^64 / 248, rounded up: the product would wrap around to a small number.
      {with("74382032555280451"), {"more than any file can hold"}},
      {with("18446744073709551616"), {"line 3", "not a number of elements"}},
      {with("-5"), {"line 3", "'-5' is not a number"}},
      {with("1e2"), {"'1e2' is not a number"}},
      {with("0"), {"holds no Gaussians"}},
      {replaced(many, "binary_little_endian", "ascii"), {"cut short"}},
      {replaced(many, end, list), {"cut short", "element 'vertex' 99 of 9000000000000000000"}},
      {replaced(with("20000"), end, list), {"element 'vertex' 99 of 20000"}},
  });
}

TEST(PlyErrors, HeaderFaultsAreNamed) {
  const std::string good = good_bytes();
  const auto with = [&](const char* from, const char* to) { return replaced(good, from, to); };
  std::string endless = "ply\nformat ascii 1.0\n";
  while (endless.size() < 2000000) endless += "comment x\n";
  const char *format = "binary_little_endian", *x = "property float x", *vertices = "element vertex 100";
  expect_refused({
      {with("end_header\n", ""), {"is not a keyword of a ply header; is its 'end_header' line missing?"}},
      {endless, {"no 'end_header' line in its first 1048576 bytes"}},
      {with("format binary_little_endian 1.0\n", ""), {"without a 'format' line"}},
      {with("binary_little_endian 1.0", "binary_little_endian 2.0"), {"line 2", "1.0"}},
      {with(format, "binary_middle_endian"), {"line 2", "expected 'format'"}},
      {with(x, "property real x"), {"line 4", "'real' is not a type"}},
      {with(x, "property float"), {"line 4", "expected 'property TYPE NAME'"}},
      {with(x, "property list float int x"), {"line 4", "integer type"}},
      {with(x, "properly float x"), {"line 4", "'properly' is not a keyword"}},
      {with(vertices, "property float a"), {"line 3", "before any element"}},
      {with(vertices, "element vertex"), {"line 3", "expected 'element NAME COUNT'"}},
      {with("property float nx", x), {"line 7", "'x' occurs twice"}},
      {with("end_header", "element vertex 1\nend_header"), {"element 'vertex' occurs twice"}},
  });
}

TEST(PlyErrors, MissingAndWrongProperties) {
  const std::string good = good_bytes();
  std::vector<test::BrokenFile> refusals = {
      {replaced(good, "float f_rest_44", "float other"), {"44 properties f_rest_*", "0, 9, 24 or 45"}},
      {replaced(good, "float f_rest_44", "float f_rest_45"), {"no property 'f_rest_44'"}}};
  for (const std::string name : {"x", "f_dc_1", "opacity", "scale_1", "rot_2"}) {
    const std::string line = "property float " + name + "\n";
    refusals.push_back({replaced(good, line, "property float other\n"),
                        {"element 'vertex' has no property '" + name + "'"}});
    refusals.push_back({replaced(good, line, "property list uchar float " + name + "\n"),
                        {"property '" + name + "' of element 'vertex' is a list; expected one number"}});
  }
  expect_refused(refusals);
}

TEST(PlyErrors, TextFaultsAreNamed) {
  PlyFile file = test::inria_file(0, 3);
  file.format = "ascii";
  for (auto& row : file.rows) std::fill(row.begin(), row.end(), 0.25);
  const std::string good = to_bytes(file);  // 21 lines of header
  expect_refused({
      {replaced(good, "0.25", "0,25"), {"line 22", "'0,25' is not a number", "'x' of element 'vertex' 0"}},
      {replaced(good, "0.25", "0.2x"), {"'0.2x' is not a number"}},
      {replaced(good, "0.25 ", ""), {"line 22", "'vertex' 0 ends before property 'rot_3'"}},
      {replaced(good, "0.25", "1 0.25"), {"line 22", "'vertex' 0 has more values than its 17"}},
      {replaced(good, "property float nx", "property list uchar float nx"),
       {"line 22", "list 'nx' of element 'vertex' 0 has length 0.25"}},
  });
}

TEST(PlyErrors, ListsBeyondTheEnd) {
  const auto with = [](const char* type, const std::string& data) {
    PlyFile file = test::inria_file(0, 3);
    file.header_after = fmt::format("element face 1\nproperty list {} int indices\n", type);
    file.data_after = data;
    return to_bytes(file);
  };
  const std::string twelve(12, '\0');
  EXPECT_EQ(test::load_model_of(with("uchar", "\x03" + twelve), "good.ply").count(), 3u);
  expect_refused({{with("uchar", "\xff" + twelve), {"cut short", "element 'face' 0 of 1"}},
                  {with("uchar", ""), {"cut short", "element 'face' 0 of 1"}},
                  {with("char", "\xff"), {"element 'face' 0 of 1"}}});
}

TEST(PlyErrors, ForeignContent) {
  const auto ply = [](const std::string& elements) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n0 0 0 1 2 3\n";
  };
  const std::string points =
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\n";
  const std::string codebook =
      "element vertex_0 0\nproperty float x\nelement codebook_centers 256\nproperty float features_dc\n";
  PlyFile nothing = test::inria_file(0, 2);
  nothing.at(0, "x") = nothing.at(1, "x") = std::nan("");
  expect_refused({
      {ply(codebook), {"Reduced-3DGS", "codebook_centers", "point_cloud.ply"}},
      {ply(points), {"is a point cloud", "point_cloud/iteration_N/point_cloud.ply"}},
      {ply(points + "element face 2\nproperty list uchar int i\n"), {"is a mesh of 2 faces"}},
      {ply("element camera 1\nproperty float x\n"), {"no element 'vertex'"}},
      {ply("element vertex 1\nproperty float x\nproperty float f_anchor_feat_0\n"), {"Scaffold-GS"}},
      {"", {"an empty file"}},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", {"git lfs pull"}},
      {"\x89PNG\r\n\x1a\n1234", {"a PNG picture"}},
      {"<!DOCTYPE html>", {"an HTML or XML page"}},
      {"\xef\xbb\xbf [1]", {"a JSON file"}},
      {"hello", {"a text file"}},
      {"plywood", {"a text file"}},
      {"\x1f\x8b\x08", {"is cut short: its gzip data"}},
      {std::string("\x01\x02\x00", 3), {"something unknown"}},
      {to_bytes(nothing), {"all of its 2 Gaussians"}},
  });
}

}  // namespace
}  // namespace binosplat
