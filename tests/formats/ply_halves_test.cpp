// Models whose numbers are halves (IEEE 754 binary16), which ply has no type for.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats/ply.h"
#include "support/errors.h"
#include "support/ply.h"
#include "support/ply_models.h"
#include "support/program.h"

namespace binosplat {
namespace {

using test::PlyFile;

using test::equal;
using test::load;

/// By the definition of the format, in float64.
double from_bits(int bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double size = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return bits >= 0x8000 ? -size : size;
}

/// The same file with every number as a half holds it.
PlyFile rounded(PlyFile file) {
  for (auto& row : file.rows) {
    for (double& value : row) value = from_bits(test::half_bits(value));
  }
  return file;
}

TEST(PlyHalves, AreTheSameModelInEveryFormat) {
  for (int degree = 0; degree <= 3; ++degree) {
    const PlyFile plain = rounded(test::inria_file(degree, 30));
    const Model model = load(plain);
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      for (const char* type : {"ushort", "uint16", "half", "float16"}) {
        PlyFile file = plain;
        file.format = format;
        file.type = type;
        EXPECT_TRUE(equal(load(file), model)) << format << ' ' << type;
        // Planted fault: one number by the smallest step of a half.
        double& value = file.at(29, "scale_2");
        value = from_bits(test::half_bits(value) ^ 1);
        EXPECT_FALSE(equal(load(file), model)) << format << ' ' << type;
      }
    }
  }
}

TEST(PlyHalves, MayStandBesideOtherTypes) {
  PlyFile plain = rounded(test::inria_file(2, 30));
  for (auto& row : plain.rows) row.push_back(0.25);
  plain.columns.emplace_back("filter_3D");
  const Model model = load(plain);
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
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

TEST(PlyHalves, AllOfThemAreRead) {
  // As positions of Gaussians that are else alike.
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
  // Infinite ones and those that are no numbers are left out: exponent 31, both signs.
  ASSERT_EQ(model.count(), 63488u);
  EXPECT_EQ(model.left_out, 2048u);
  std::size_t wrong = 0, at = 0;
  for (int bits = 0; bits < 65536; ++bits) {
    if ((bits >> 10 & 31) == 31) continue;
    const float x = model.position[at++].x;
    if (x != from_bits(bits) || std::signbit(x) != (bits >= 0x8000)) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(model.position[1].x, 0x1p-24f);  // the smallest of all
}

TEST(PlyHalves, InfiniteOnesAreAsInfiniteFloats) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  PlyFile file = rounded(test::inria_file(0, 2));
  file.at(0, "opacity") = inf;
  file.at(1, "opacity") = -inf;
  file.at(0, "scale_2") = -inf;
  file.type = "ushort";
  for (const char* format : {"ascii", "binary_little_endian"}) {
    file.format = format;
    const Model model = load(file);
    EXPECT_EQ(model.opacity, (std::vector<float>{1.0f, 0.0f}));
    EXPECT_EQ(model.scale[0].z, 0.0f);
  }
}

TEST(PlyHalves, InTextAreWholeNumbers) {
  PlyFile file = rounded(test::inria_file(0, 2));
  file.format = "ascii";
  file.types["y"] = "ushort";
  const std::string good = to_bytes(file), bits = fmt::format(" {} ", test::half_bits(file.at(1, "y")));
  for (const char* bad : {" 0.5 ", " -1 ", " 65536 ", " nan "}) {
    std::string bytes = good;
    bytes.replace(bytes.rfind(bits), bits.size(), bad);
    EXPECT_TRUE(test::fails_saying([&] { load(bytes); }, {"line", "'y'", "ushort", "half"})) << bad;
  }
}

TEST(PlyHalves, OfOtherMattersAreWholeNumbers) {
  // Lengths of lists, and colours beside halves.
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
  // Colours that are floats: of 0 to 1, or of 0 to 255, whatever the other type.
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
  EXPECT_GT(farthest(with_colours("float", 0.5 / 255.0)), 0.1f) << "the planted fault: half as bright";
  EXPECT_TRUE(test::fails_saying([&] { with_colours("float", 257.0); }, {"red, green and blue reach 31354"}));
  EXPECT_TRUE(test::fails_saying([&] { with_colours("ushort", 1.0); }, {"'red'", "uchar or float"}));
  // The length of a list is never a half.
  file.header_before = "element strip 1\nproperty list half uchar indices\n";
  EXPECT_TRUE(test::fails_saying([&] { load(file); }, {"length of a list", "'half'"}));
}

}  // namespace
}  // namespace binosplat
