// --axes: a model stored in another frame than its cameras' world.

#include <gtest/gtest.h>

#include "app/scene.h"
#include "formats/content.h"
#include "formats/gzip.h"
#include "formats/image_file.h"
#include "measure/metrics.h"
#include "support/broken.h"

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

/// What a writer leaves that says nothing of axes.
std::string without_axes(const std::string& spz) {
  const auto bytes = GzipReader("spz", std::as_bytes(std::span(spz))).read(std::size_t{1} << 24);
  std::string raw(as_text(bytes));
  raw[14] = static_cast<char>(raw[14] & ~2);
  raw.resize(raw.size() - 12);
  return test::gzipped(raw);
}

// Both conventions of spz, and our own, which says what it is.
TEST_F(AxesOption, CamerasTellThoseOfAnSpz) {
  add_cameras();
  const auto run = [&](const std::string& file, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {
        "render", folder / file,       "--view", "side", "--mono", "--cameras", folder / "cameras.json",
        "-o",     folder / "drawn.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome = test::run_program(arguments);
    EXPECT_TRUE(test::good(outcome));
    return outcome.err;
  };
  const auto convert = [&](const std::string& to, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"convert", model, "-o", folder / to};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome = test::run_program(arguments);
    EXPECT_TRUE(test::good(outcome));
    return outcome.err;
  };
  EXPECT_NE(
      convert("said.spz").find("said.spz: its axes are RUB, as the format has them and as the file says"),
      std::string::npos);
  EXPECT_EQ(run("said.spz").find("its axes"), std::string::npos);
  const Image expected = load_image(folder / "drawn.png");
  test::write_text(folder / "rub.spz", without_axes(test::read_text(folder / "said.spz")));
  convert("lies.spz", {"--axes", "rub"});  // the ply's numbers as they are
  test::write_text(folder / "rdf.spz", without_axes(test::read_text(folder / "lies.spz")));
  const auto close = [&] { return measure::psnr(load_image(folder / "drawn.png"), expected) > 25; };
  EXPECT_NE(run("rub.spz").find("rub.spz: its axes are taken as RUB, in which its cameras have"),
            std::string::npos);
  EXPECT_TRUE(close());
  EXPECT_NE(run("rdf.spz").find("rdf.spz: its axes are taken as RDF, in which its cameras have"),
            std::string::npos);
  EXPECT_TRUE(close());
  EXPECT_NE(run("lies.spz").find("though its file says that (--axes rub to take them so)"),
            std::string::npos);
  EXPECT_TRUE(close());
  // Planted fault, and what an option says goes before all.
  EXPECT_EQ(run("rdf.spz", {"--axes", "rub"}).find("are taken as"), std::string::npos);
  EXPECT_FALSE(close());
  // By the cameras that lie beside it, where none are named: of a model that is turned, too.
  const test::Outcome turned = test::run_program({"convert", folder / "rdf.spz", "-o", folder / "back.ply"});
  EXPECT_TRUE(test::good(turned));
  EXPECT_NE(turned.err.find("taken as RDF"), std::string::npos) << turned.err;
  EXPECT_EQ(turned.err.find("are turned from"), std::string::npos) << turned.err;
  const test::Outcome info = test::run_program({"info", folder / "rdf.spz"});
  EXPECT_NE(info.out.find("axes           RDF"), std::string::npos) << info.out;
  // Nothing tells.
  std::filesystem::remove(folder / "cameras.json");
  const test::Outcome alone = test::run_program({"info", folder / "rdf.spz"});
  EXPECT_NE(alone.err.find("nothing else tells: taken as RUB, as the format says (--axes rdf if it lies"),
            std::string::npos)
      << alone.err;
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
