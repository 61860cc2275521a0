#include "formats/ply.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "formats/model_file.h"
#include "support/errors.h"
#include "support/ply.h"
#include "support/ply_models.h"
#include "support/program.h"

namespace binosplat {
namespace {

using test::PlyFile;

using test::equal;
using test::load;

/// What docs/method.md 1 makes of a file, in float64 and written by itself.
struct Expected {
  std::vector<std::vector<double>> values;  // per Gaussian: position, scale, rotation, opacity, coefficients
};

Expected decoded(const PlyFile& file, int degree) {
  Expected expected;
  const int higher = sh_count(degree) - 1;
  for (std::size_t i = 0; i < file.rows.size(); ++i) {
    const auto get = [&](const std::string& name) { return file.at(i, name); };
    std::vector<double>& out = expected.values.emplace_back();
    for (const char* name : {"x", "y", "z"}) out.push_back(get(name));
    for (const char* name : {"scale_0", "scale_1", "scale_2"}) out.push_back(std::exp(get(name)));
    const double length =
        std::hypot(std::hypot(get("rot_0"), get("rot_1")), std::hypot(get("rot_2"), get("rot_3")));
    for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3"}) out.push_back(get(name) / length);
    out.push_back(1 / (1 + std::exp(-get("opacity"))));
    for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2"}) out.push_back(get(name));
    for (int k = 0; k < higher; ++k) {
      for (int c = 0; c < 3; ++c) out.push_back(get(fmt::format("f_rest_{}", c * higher + k)));
    }
  }
  return expected;
}

bool close(const Model& model, const Expected& expected) {
  if (model.count() != expected.values.size()) return false;
  const std::size_t values = model.sh.size() / model.count();
  double worst = 0;
  for (std::size_t i = 0; i < model.count(); ++i) {
    std::vector<double> found;
    const auto add = [&](const float* first, std::size_t count) {
      found.insert(found.end(), first, first + count);
    };
    add(&model.position[i].x, 3);
    add(&model.scale[i].x, 3);
    add(&model.rotation[i].x, 4);
    add(&model.opacity[i], 1);
    add(&model.sh[i * values], values);
    if (found.size() != expected.values[i].size()) return false;
    for (std::size_t k = 0; k < found.size(); ++k) {
      worst = std::max(worst, std::abs(found[k] - expected.values[i][k]) / (1 + std::abs(found[k])));
    }
  }
  return worst <= 2e-7;
}

/// The same columns with what `rename` makes of their names: a reader that mistakes one for the other.
PlyFile renamed(PlyFile file, const std::function<std::string(const std::string&)>& rename) {
  for (std::string& column : file.columns) column = rename(column);
  return file;
}

TEST(Ply, IsDecodedAsTheMethodSays) {
  for (int degree = 0; degree <= 3; ++degree) {
    const PlyFile file = test::inria_file(degree, 50);
    const Model model = load(file);
    EXPECT_EQ(model.degree, degree);
    EXPECT_EQ(model.name, "model.ply");
    EXPECT_TRUE(close(model, decoded(file, degree)));

    // Planted faults: w last, two scales swapped, coefficients of one channel and of the next swapped, or
    // transposed.
    const auto faulty = [&](auto rename) { return decoded(renamed(file, rename), degree); };
    EXPECT_FALSE(close(model, faulty([](const std::string& name) {
                         return name.starts_with("rot_") ? fmt::format("rot_{}", (name[4] - '0' + 1) % 4)
                                                         : name;
                       })));
    EXPECT_FALSE(close(model, faulty([](const std::string& name) {
                         return name == "scale_0" ? "scale_1" : name == "scale_1" ? "scale_0" : name;
                       })));
    if (degree == 0) continue;
    EXPECT_FALSE(close(model, faulty([](const std::string& name) {
                         return name == "f_rest_0" ? "f_rest_1" : name == "f_rest_1" ? "f_rest_0" : name;
                       })));
    const int higher = sh_count(degree) - 1;
    EXPECT_FALSE(close(model, faulty([&](const std::string& name) {
                         if (!name.starts_with("f_rest_")) return name;
                         const int i = std::stoi(name.substr(7));
                         return fmt::format("f_rest_{}", i % higher * 3 + i / higher);
                       })));
  }
}

TEST(Ply, IsTheSameModelInEveryFormat) {
  const PlyFile plain = test::inria_file(3, 40);
  const Model model = load(plain);
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const char* type : {"float", "double"}) {
      for (const char* newline : {"\n", "\r\n"}) {
        PlyFile file = plain;
        file.format = format;
        file.type = type;
        file.newline = newline;
        EXPECT_TRUE(equal(load(file), model)) << format << ' ' << type;
        // Planted fault: one number of one Gaussian in the smallest step of a float.
        file.at(39, "f_rest_44") = std::nextafter(static_cast<float>(file.at(39, "f_rest_44")), 9.0f);
        EXPECT_FALSE(equal(load(file), model)) << format << ' ' << type;
      }
    }
  }
}

TEST(Ply, MayHaveItsPropertiesInAnyOrder) {
  const PlyFile plain = test::inria_file(2, 20);
  PlyFile file = plain;
  std::reverse(file.columns.begin(), file.columns.end());
  for (auto& row : file.rows) std::reverse(row.begin(), row.end());
  EXPECT_TRUE(equal(load(file), load(plain)));
}

TEST(Ply, MayLackNormalsAndHaveMore) {
  const PlyFile plain = test::inria_file(1, 20);
  PlyFile bare = plain;
  bare.columns.erase(bare.columns.begin() + 3, bare.columns.begin() + 6);
  for (auto& row : bare.rows) row.erase(row.begin() + 3, row.begin() + 6);
  EXPECT_TRUE(equal(load(bare), load(plain)));
  PlyFile more = plain;
  more.columns.insert(more.columns.begin() + 2, {"confidence", "f_semantic_0"});
  for (auto& row : more.rows) row.insert(row.begin() + 2, {7.0, 8.0});
  EXPECT_TRUE(equal(load(more), load(plain)));
}

TEST(Ply, HeaderMayHaveCommentsAndRunsOfBlanks) {
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

/// Elements of every kind around the Gaussians: fixed rows, lists, rows of no bytes.
PlyFile among_others(PlyFile file) {
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

TEST(Ply, MayHaveOtherElementsBeforeAndAfter) {
  const PlyFile plain = test::inria_file(1, 20);
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    PlyFile file = plain;
    file.format = format;
    file = among_others(file);
    EXPECT_TRUE(equal(load(file), load(plain))) << format;
    // Planted fault: a list that is one longer than its length says shifts all that follows.
    if (file.format == "ascii") continue;
    file.data_before.insert(18 + 1, 2, '\0');
    EXPECT_TRUE(test::fails_saying(
        [&] {
          if (!equal(load(file), load(plain))) fail("another model");
        },
        {}));
  }
}

TEST(Ply, MayHaveListsAmongItsProperties) {
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

TEST(Ply, LeavesOutWhatIsNotFinite) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const char* format : {"ascii", "binary_little_endian"}) {
    PlyFile file = test::inria_file(3, 100);
    file.format = format;
    PlyFile good = file;
    file.at(10, "x") = nan;
    file.at(20, "scale_0") = inf;
    file.at(30, "opacity") = nan;
    for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3"}) file.at(40, name) = 0;
    file.at(99, "f_rest_44") = -inf;
    for (const std::size_t row : {99, 40, 30, 20, 10})
      good.rows.erase(good.rows.begin() + static_cast<int>(row));
    Model expected = load(good);
    expected.left_out = 5;
    EXPECT_TRUE(equal(load(file), expected)) << format;
    expected.left_out = 4;  // planted fault
    EXPECT_FALSE(equal(load(file), expected)) << format;

    // Infinite logits and a log-scale of -inf decode to numbers.
    file = test::inria_file(3, 2);
    file.format = format;
    file.at(0, "opacity") = inf;
    file.at(1, "opacity") = -inf;
    file.at(0, "scale_2") = -inf;
    const Model model = load(file);
    EXPECT_EQ(model.opacity, (std::vector<float>{1.0f, 0.0f}));
    EXPECT_EQ(model.scale[0].z, 0.0f);
    EXPECT_EQ(model.left_out, 0u);
  }
}

TEST(Ply, LeavesOutAcrossManyBlocks) {
  PlyFile file = test::inria_file(0, 70000);
  PlyFile good = file;
  good.rows.clear();
  for (std::size_t i = 0; i < file.rows.size(); ++i) {
    if (i % 7 == 3) {
      file.at(i, "y") = std::numeric_limits<double>::quiet_NaN();
    } else {
      good.rows.push_back(file.rows[i]);
    }
  }
  Model expected = load(good);
  expected.left_out = 10000;
  EXPECT_TRUE(equal(load(file), expected));
}

TEST(Ply, ReportsWhatWasLeftOut) {
  const test::TempFolder folder;
  PlyFile file = test::inria_file(0, 5);
  file.at(3, "z") = std::numeric_limits<double>::infinity();
  test::write_text(folder / "model.ply", to_bytes(file));
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_model(folder / "model.ply").left_out, 1u);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("model.ply: 1 of 5 Gaussians left out"),
            std::string::npos);
}

TEST(Ply, CutsDegreeFourToThree) {
  PlyFile file = test::inria_file(0, 4);
  const std::vector<std::vector<double>> rest = test::inria_file(3, 4, 9).rows;
  PlyFile expected = file;
  // Coefficient k of channel c is f_rest[c * 24 + k] in one and f_rest[c * 15 + k] in the other.
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

TEST(Ply, FoldsTheFilterOfMipSplatting) {
  PlyFile file = test::inria_file(0, 3);
  const Model plain = load(file);
  file.columns.emplace_back("filter_3D");
  file.rows[0].push_back(0);
  file.rows[1].push_back(0.25);
  file.rows[2].push_back(3e38);
  file.at(2, "scale_0") = 88.7;  // e^88.7 fits a float, but not with the filter
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

TEST(Ply, CommentsTellAntialiasedModels) {
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

TEST(Ply, CommentsTellHowAModelIsSeen) {
  const auto seen = [](const std::string& comments) {
    PlyFile file = test::inria_file(0, 2);
    file.comments = comments;
    return load(file).perspective;
  };
  EXPECT_EQ(seen(""), Perspective{});
  EXPECT_EQ(seen("comment sortingMethod: cameraDistance\n"), (Perspective{.order = ORDER_DISTANCE}));
  EXPECT_EQ(seen("comment projection: tangential \ncomment sortingMethod: zDepth\n"),
            (Perspective{.projection = PROJECTION_TANGENT}));
  EXPECT_EQ(seen("comment projection: fisheye\n"), Perspective{});  // with a warning
}

TEST(Ply, WarnsOfTrailingBytes) {
  testing::internal::CaptureStderr();
  load(to_bytes(test::inria_file(0, 2)) + "abc");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("3 bytes after the last element"), std::string::npos);
}

}  // namespace
}  // namespace binosplat
