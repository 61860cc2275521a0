// --axes: a model stored in another frame than its cameras' world.

#include <gtest/gtest.h>

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"

namespace binosplat {
namespace {

using test::SceneTest;
using AxesOption = SceneTest;

/// The small model with x, y and z times signs, in all that it takes (FORMATS: quaternions and harmonics,
/// too).
test::PlyFile flipped(double dx, double dy, double dz) {
  test::PlyFile file = test::small_model();
  const double sign[] = {dy, dz, dx};  // of the three harmonics of degree 1
  for (std::size_t i = 0; i < file.rows.size(); ++i) {
    file.at(i, "x") *= dx;
    file.at(i, "y") *= dy;
    file.at(i, "z") *= dz;
    file.at(i, "rot_1") *= dy * dz;
    file.at(i, "rot_2") *= dx * dz;
    file.at(i, "rot_3") *= dx * dy;
    for (int k = 0; k < 9; ++k) file.at(i, fmt::format("f_rest_{}", k)) *= sign[k % 3];
  }
  return file;
}

double largest_difference(const Image& a, const Image& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i)
    largest = std::max(largest, double{std::abs(a.data[i] - b.data[i])});
  return largest;
}

TEST_F(AxesOption, CamerasEnterTheModelsFrame) {
  add_cameras();
  const auto drawn = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--view", "side", "-o", folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome = render(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return load_image(folder / name);
  };
  const Image expected = drawn("expected.png", {});
  EXPECT_GT(measure::psnr(expected, expected), 100);
  test::write_text(model, to_bytes(flipped(1, -1, -1)));
  EXPECT_LE(largest_difference(drawn("rub.png", {"--axes", "rub"}), expected), 1.01 / 255);
  EXPECT_GT(largest_difference(drawn("plain.png", {}), expected), 0.5);  // planted fault: as if it were RDF
  test::write_text(model, to_bytes(flipped(-1, -1, -1)));                // a mirrored frame
  EXPECT_LE(largest_difference(drawn("lub.png", {"--axes", "LUB"}), expected), 1.01 / 255);
}

TEST_F(AxesOption, WhatIsNoFrameIsRefused) {
  const test::Outcome outcome = render({"--axes", "xyz"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("axes 'XYZ': expected three letters"), std::string::npos) << outcome.err;
  const test::Outcome room = test::run_program({"render", "demo:room", "--axes", "rub"});
  EXPECT_EQ(room.code, 2);
  EXPECT_NE(room.err.find("--axes is for model files"), std::string::npos) << room.err;
}

}  // namespace
}  // namespace binosplat
