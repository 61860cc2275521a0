#include "formats/models/ply.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/errors.h"
#include "support/load.h"
#include "support/ply.h"
#include "support/ply_models.h"

namespace binosplat {
namespace {

using test::PlyFile;

using test::equal;
using test::load;

/// Returns the numbers of a file in the places that section 1 of docs/method.md gives them.
/// Model.DecodesRawValues tests their conversion.
Model decoded(const PlyFile& file, int degree) {
  Model model;
  model.degree = degree;
  const int higher = sh_count(degree) - 1;
  for (std::size_t i = 0; i < file.rows.size(); ++i) {
    const auto get = [&](const std::string& name) { return static_cast<float>(file.at(i, name)); };
    std::vector<float> sh = {get("f_dc_0"), get("f_dc_1"), get("f_dc_2")};
    for (int k = 0; k < higher; ++k) {
      for (int c = 0; c < 3; ++c) sh.push_back(get(fmt::format("f_rest_{}", c * higher + k)));
    }
    test::append_raw(model, {{get("x"), get("y"), get("z")},
                             {get("scale_0"), get("scale_1"), get("scale_2")},
                             {get("rot_0"), get("rot_1"), get("rot_2"), get("rot_3")},
                             get("opacity"),
                             sh.data()});
  }
  return model;
}

/// Decodes a half by the definition in IEEE 754 (binary16), in float64.
double half_of(int bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double size = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return bits >= 0x8000 ? -size : size;
}

/// Returns the file with every number rounded to half precision.
PlyFile rounded(PlyFile file) {
  for (auto& row : file.rows) {
    for (double& value : row) value = half_of(test::half_bits(value));
  }
  return file;
}

const char* const encodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};

TEST(Ply, DecodesByMethod) {
  for (int degree = 0; degree <= 3; ++degree) {
    const PlyFile file = test::inria_file(degree, 50);
    const Model model = load(file);
    EXPECT_EQ(model.name, "model.ply");
    EXPECT_TRUE(equal(model, decoded(file, degree))) << degree;
    Model faulty = model;  // injected fault: two channels swapped
    std::swap(faulty.sh[0], faulty.sh[1]);
    EXPECT_FALSE(equal(faulty, decoded(file, degree))) << degree;
  }
}

TEST(Ply, EncodingsAgree) {
  // The ply format has no type for halves. Programs store them as ushort, or use type names such as half.
  for (const int degree : {0, 3}) {
    const PlyFile plain = rounded(test::inria_file(degree, 40));
    const Model model = load(plain);
    for (const std::string format : encodings) {
      for (const std::string type : {"float", "double", "ushort", "uint16", "half", "float16"}) {
        PlyFile file = plain;
        file.format = format;
        file.type = type;
        file.newline = type == "double" ? "\r\n" : "\n";
        EXPECT_TRUE(equal(load(file), model)) << format << ' ' << type;
        // Injected fault: one number of one Gaussian is off by the smallest step of a half.
        double& value = file.at(39, "scale_2");
        value = half_of(test::half_bits(value) ^ 1);
        EXPECT_FALSE(equal(load(file), model)) << format << ' ' << type;
      }
    }
  }
}

TEST(Ply, AcceptsPropertiesInAnyOrder) {
  const PlyFile plain = test::inria_file(2, 20);
  const auto changed = [&](const auto& change) {
    PlyFile file = plain;
    change(file.columns);
    for (auto& row : file.rows) change(row);
    return load(file);
  };
  EXPECT_TRUE(equal(changed([](auto& row) { std::reverse(row.begin(), row.end()); }), load(plain)));
  EXPECT_TRUE(equal(changed([](auto& row) { row.erase(row.begin() + 3, row.begin() + 6); }), load(plain)));
  PlyFile more = plain;
  more.columns.insert(more.columns.begin() + 2, {"confidence", "f_semantic_0"});
  for (auto& row : more.rows) row.insert(row.begin() + 2, {7.0, 8.0});
  EXPECT_TRUE(equal(load(more), load(plain)));
}

TEST(Ply, SpheresHaveOneScale) {
  PlyFile file = test::inria_file(1, 20);
  for (std::size_t i = 0; i < file.rows.size(); ++i)
    file.at(i, "scale_1") = file.at(i, "scale_2") = file.at(i, "scale_0");
  const Model spheres = load(file);
  const auto remove = [&](const std::string& name) {
    const auto column = static_cast<std::ptrdiff_t>(file.column(name));
    file.columns.erase(file.columns.begin() + column);
    for (auto& row : file.rows) row.erase(row.begin() + column);
  };
  remove("scale_1");
  EXPECT_ERROR(load(file), "no property 'scale_1'");
  remove("scale_2");
  EXPECT_TRUE(equal(load(file), spheres));
  EXPECT_FALSE(load(file).flat);
}

TEST(Ply, HeaderMayHaveCommentsAndBlanks) {
  const PlyFile plain = test::inria_file(0, 3);
  std::string bytes = to_bytes(plain);
  const auto replace = [&](const std::string& from, const std::string& to) {
    bytes.replace(bytes.find(from), from.size(), to);
  };
  replace("format binary_little_endian 1.0\n",
          "format   binary_little_endian\t1.0  \ncomment end_header\ncomment\nobj_info x\n\n");
  replace("element vertex 3\n", "  element vertex          0000000003 \n");
  replace("property float x\n", "property  float32 \t x\t\n");
  EXPECT_TRUE(equal(load(bytes), load(plain)));
}

/// Adds elements of every kind around the Gaussians: fixed rows, lists, and rows of no bytes.
PlyFile with_other_elements(PlyFile file) {
  file.header_before =
      "element camera 2\nproperty double a\nproperty uchar b\nelement face 3\nproperty list uchar short "
      "indices\n"
      "property float quality\nproperty list short double weights\nelement none 1000000\n";
  file.header_after = "element edge 1\nproperty list uchar uchar ends\nelement last 2\nproperty short s\n";
  const auto add = [&](std::string& data, std::initializer_list<std::pair<const char*, double>> values) {
    for (const auto& [type, value] : values) test::append_value(data, file.format, type, value);
    if (file.format == "ascii") data += "\n";
  };
  for (int i = 0; i < 2; ++i) add(file.data_before, {{"double", 1.5}, {"uchar", 7}});
  add(file.data_before, {{"uchar", 3}, {"short", 1}, {"short", 2}, {"short", 3}, {"float", 1}, {"short", 0}});
  add(file.data_before, {{"uchar", 0}, {"float", 2}, {"short", 1}, {"double", 5}});
  add(file.data_before,
      {{"uchar", 1}, {"short", -1}, {"float", 3}, {"short", 2}, {"double", 5}, {"double", 6}});
  add(file.data_after, {{"uchar", 2}, {"uchar", 0}, {"uchar", 1}});
  for (int i = 0; i < 2; ++i) add(file.data_after, {{"short", i}});
  return file;
}

TEST(Ply, AcceptsOtherElements) {
  const PlyFile plain = test::inria_file(1, 20);
  for (const char* format : encodings) {
    PlyFile file = plain;
    file.format = format;
    file = with_other_elements(file);
    EXPECT_TRUE(equal(load(file), load(plain))) << format;
    // Injected fault: a list with one element more than its length says shifts everything after it.
    if (file.format == "ascii") continue;
    file.data_before.insert(18 + 1, 2, '\0');
    EXPECT_TRUE(test::fails_saying(
        [&] {
          if (!equal(load(file), load(plain))) fail("another model");
        },
        {}));
  }
}

TEST(Ply, AcceptsListProperties) {
  const PlyFile plain = test::inria_file(0, 20);
  for (const char* format : {"ascii", "binary_big_endian"}) {
    std::string bytes = header_of(plain);
    bytes.replace(bytes.find("binary_little_endian"), 20, format);
    bytes.insert(bytes.find("property float z"), "property list uchar short tags\n");
    for (std::size_t i = 0; i < plain.rows.size(); ++i) {
      for (std::size_t k = 0; k < plain.columns.size(); ++k) {
        if (plain.columns[k] == "z") {
          test::append_value(bytes, format, "uchar", static_cast<double>(i % 3));
          for (std::size_t tag = 0; tag < i % 3; ++tag) test::append_value(bytes, format, "short", 12345);
        }
        test::append_value(bytes, format, "float", plain.rows[i][k]);
      }
      if (std::string(format) == "ascii") bytes += '\n';
    }
    EXPECT_TRUE(equal(load(bytes), load(plain))) << format;
  }
}

// The rows fill many blocks. Infinite logits and log-scales of -inf decode to finite numbers.
TEST(Ply, SkipsNonFiniteRows) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double inf = std::numeric_limits<double>::infinity();
  const std::pair<const char*, double> bad[] = {
      {"y", nan}, {"scale_0", inf}, {"opacity", nan}, {"f_dc_2", -inf}};
  for (const char* format : {"ascii", "binary_little_endian"}) {
    PlyFile file = test::inria_file(0, 70000);
    file.format = format;
    file.at(0, "opacity") = inf;
    file.at(1, "opacity") = -inf;
    file.at(1, "scale_2") = -inf;
    PlyFile good = file;
    good.rows.clear();
    for (std::size_t i = 0; i < file.rows.size(); ++i) {
      if (i % 7 == 3)
        file.at(i, bad[i / 7 % 4].first) = bad[i / 7 % 4].second;
      else
        good.rows.push_back(file.rows[i]);
    }
    Model expected = load(good);
    EXPECT_EQ(expected.opacity[0], 1.0f);
    EXPECT_EQ(expected.opacity[1], 0.0f);
    EXPECT_EQ(expected.scale[1].z, 0.0f);
    expected.left_out = 10000;
    testing::internal::CaptureStderr();
    EXPECT_TRUE(equal(test::load_model_of(to_bytes(file), "model.ply"), expected)) << format;
    EXPECT_NE(testing::internal::GetCapturedStderr().find("model.ply: 10000 of 70000 Gaussians left out"),
              std::string::npos);
  }
}

TEST(Ply, ReducesDegreeFourToThree) {
  PlyFile file = test::inria_file(0, 4);
  const std::vector<std::vector<double>> rest = test::inria_file(3, 4, 9).rows;
  PlyFile expected = file;
  // Coefficient k of channel c is f_rest[c * 24 + k] for degree 4, and f_rest[c * 15 + k] for degree 3.
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 24; ++k) {
      file.columns.push_back(fmt::format("f_rest_{}", c * 24 + k));
      if (k < 15) expected.columns.push_back(fmt::format("f_rest_{}", c * 15 + k));
      for (std::size_t i = 0; i < 4; ++i) {
        const double value = k < 15 ? rest[i][c * 15 + k] : 99;
        file.rows[i].push_back(value);
        if (k < 15) expected.rows[i].push_back(value);
      }
    }
  }
  EXPECT_TRUE(equal(load(file), load(expected)));
  EXPECT_TRUE(load(file).lacks_degree_4);
  EXPECT_FALSE(load(expected).lacks_degree_4);
}

TEST(Ply, FoldsMipSplattingFilter) {
  PlyFile file = test::inria_file(0, 3);
  const Model plain = load(file);
  file.columns.emplace_back("filter_3D");
  file.rows[0].push_back(0);
  file.rows[1].push_back(0.25);
  file.rows[2].push_back(3e38);
  file.at(2, "scale_0") = 88.7;  // e^88.7 fits a float, but its sum with the filter does not.
  const Model model = load(file);
  EXPECT_TRUE(model.antialiased);
  EXPECT_FALSE(plain.antialiased);
  ASSERT_EQ(model.count(), 2u);
  EXPECT_EQ(model.left_out, 1u);
  EXPECT_EQ(model.scale[0], plain.scale[0]);
  EXPECT_EQ(model.opacity[0], plain.opacity[0]);
  double mass = 1;
  for (int c = 0; c < 3; ++c) {
    const double wide = std::hypot(plain.scale[1][c], 0.25);
    EXPECT_FLOAT_EQ(model.scale[1][c], static_cast<float>(wide));
    mass *= plain.scale[1][c] / wide;
  }
  EXPECT_FLOAT_EQ(model.opacity[1], static_cast<float>(plain.opacity[1] * mass));
}

TEST(Ply, CommentSetsAntialiasing) {
  const auto antialiased = [](const std::string& comments) {
    PlyFile file = test::inria_file(0, 2);
    file.comments = comments;
    return load(file).antialiased;
  };
  EXPECT_FALSE(antialiased(""));
  EXPECT_FALSE(antialiased("comment SplatRenderMode: default\n"));
  EXPECT_TRUE(antialiased("comment SplatRenderMode: mip\n"));
  EXPECT_TRUE(antialiased("comment Antialiased 1\n"));
  EXPECT_FALSE(antialiased("comment antialiased 1\ncomment antialiased 0\n"));
}

TEST(Ply, CommentSetsUp) {
  const auto up = [](const std::string& comments) {
    PlyFile file = test::inria_file(0, 2);
    file.comments = comments;
    return load(file).up;
  };
  EXPECT_FALSE(up(""));
  EXPECT_EQ(up("comment Generated by Nerstudio 1.1.5\ncomment Vertical Axis: z\n"), glm::dvec3(0, 0, 1));
  EXPECT_EQ(up("comment Exported from Brush\ncomment Vertical axis: 0.0 -2.0 0.0\n"), glm::dvec3(0, -1, 0));
  EXPECT_FALSE(up("comment Exported from Brush\ncomment Vertical axis: y\n")) << "as in any ply";
  // Brush turns x and y of its direction down, and keeps z.
  const std::string tilted = "comment Vertical axis: 0 -0.8 0.6\n";
  EXPECT_EQ(up("comment Exported from Brush\n" + tilted), glm::dvec3(0, -0.8, -0.6));
  EXPECT_EQ(up(tilted), glm::dvec3(0, -0.8, 0.6));
  EXPECT_FALSE(up("comment Vertical axis: 0 0 0\n"));
}

TEST(Ply, CommentsSetOrderAndProjection) {
  const auto seen = [](const std::string& comments) {
    PlyFile file = test::inria_file(0, 2);
    file.comments = comments;
    return load(file).perspective;
  };
  EXPECT_EQ(seen(""), Perspective{});
  EXPECT_EQ(seen("comment sortingMethod: cameraDistance\n"), (Perspective{.order = Order::distance}));
  EXPECT_EQ(seen("comment projection: tangential \ncomment sortingMethod: zDepth\n"),
            (Perspective{.projection = Projection::tangent}));
  EXPECT_EQ(seen("comment projection: fisheye\n"), Perspective{});  // with a warning
}

TEST(Ply, WarnsOfTrailingBytes) {
  testing::internal::CaptureStderr();
  load(to_bytes(test::inria_file(0, 2)) + "abc");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("3 bytes after the last element"), std::string::npos);
}

TEST(PlyHalves, MixWithOtherTypes) {
  PlyFile plain = rounded(test::inria_file(2, 30));
  for (auto& row : plain.rows) row.push_back(0.25);
  plain.columns.emplace_back("filter_3D");
  const Model model = load(plain);
  for (const char* format : encodings) {
    for (const char* halves : {"x", "f_", "opacity", "scale_", "rot_", "filter_3D", "n"}) {
      PlyFile file = plain;
      file.format = format;
      for (const std::string& column : file.columns) {
        if (column.starts_with(halves)) file.types[column] = "ushort";
      }
      file.types["rot_1"] = "double";
      EXPECT_TRUE(equal(load(file), model)) << format << ' ' << halves;
    }
  }
}

TEST(PlyHalves, AllValuesAreRead) {
  // Each half is the x of one of many Gaussians that are otherwise alike.
  PlyFile file = test::inria_file(0, 1);
  file.format = "binary_big_endian";
  file.types["x"] = "ushort";
  file.rows.assign(65536, file.rows[0]);
  std::string bytes = to_bytes(file);
  const std::size_t row = 2 + 4 * (file.columns.size() - 1), first = bytes.size() - 65536 * row;
  for (std::size_t i = 0; i < 65536; ++i) {
    bytes[first + i * row] = static_cast<char>(i >> 8);
    bytes[first + i * row + 1] = static_cast<char>(i);
  }
  const Model model = load(bytes);
  // Halves with exponent 31 are infinite or NaN, with both signs. Their Gaussians are left out.
  ASSERT_EQ(model.count(), 63488u);
  EXPECT_EQ(model.left_out, 2048u);
  std::size_t wrong = 0, at = 0;
  for (int bits = 0; bits < 65536; ++bits) {
    if ((bits >> 10 & 31) == 31) continue;
    const float x = model.position[at++].x;
    if (x != half_of(bits) || std::signbit(x) != (bits >= 0x8000)) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(model.position[1].x, 0x1p-24f);  // the smallest positive half
}

TEST(PlyHalves, AreIntegersInText) {
  PlyFile file = rounded(test::inria_file(0, 2));
  file.format = "ascii";
  file.types["y"] = "ushort";
  const std::string good = to_bytes(file), bits = fmt::format(" {} ", test::half_bits(file.at(1, "y")));
  for (const char* bad : {" 0.5 ", " -1 ", " 65536 ", " nan "}) {
    std::string bytes = good;
    bytes.replace(bytes.rfind(bits), bits.size(), bad);
    EXPECT_ERROR(load(bytes), "line", "'y'", "ushort", "half") << bad;
  }
}

TEST(PlyHalves, CountsAndColoursStayIntegers) {
  // Lengths of lists and colours stay integers in a file with halves.
  PlyFile file = rounded(test::inria_file(0, 3));
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string dc = fmt::format("f_dc_{}", c);
    for (std::size_t i = 0; i < 3; ++i) file.at(i, dc) = 100.0 + static_cast<double>(10 * i + c);
    const char* colours[] = {"red", "green", "blue"};
    file.columns[file.column(dc)] = colours[c];
    file.types[colours[c]] = "uchar";
  }
  const Model model = load(file);
  file.type = "ushort";
  file.header_before = "element strip 1\nproperty list ushort uchar indices\n";
  file.data_before = std::string("\2\0ab", 4);
  EXPECT_TRUE(equal(load(file), model));
  EXPECT_FLOAT_EQ(model.sh[0], static_cast<float>((100.0 / 255.0 - 0.5) / sh_c0));
  // Colours of type float may range from 0 to 1 or from 0 to 255, whatever the type of other properties.
  const auto with_colours = [&](const char* type, double scale) {
    PlyFile floats = file;
    for (const char* colour : {"red", "green", "blue"}) {
      floats.types[colour] = type;
      for (std::size_t i = 0; i < 3; ++i) floats.at(i, colour) *= scale;
    }
    return load(floats);
  };
  const auto farthest = [&](const Model& other) {
    float far = 0.0f;
    for (std::size_t k = 0; k < model.sh.size(); ++k)
      far = std::max(far, std::abs(other.sh[k] - model.sh[k]));
    return far;
  };
  EXPECT_LT(farthest(with_colours("float", 1.0)), 1e-6f);
  EXPECT_LT(farthest(with_colours("float", 1.0 / 255.0)), 1e-6f);
  EXPECT_LT(farthest(with_colours("double", 1.0 / 255.0)), 1e-6f);
  EXPECT_GT(farthest(with_colours("float", 0.5 / 255.0)), 0.1f) << "the injected fault: half as bright";
  EXPECT_ERROR(with_colours("float", 257.0), "red, green and blue reach 31354");
  EXPECT_ERROR(with_colours("ushort", 1.0), "'red'", "uchar or float");
  // A list's length cannot be a half.
  file.header_before = "element strip 1\nproperty list half uchar indices\n";
  EXPECT_ERROR(load(file), "length of a list", "'half'");
}

}  // namespace
}  // namespace binosplat
