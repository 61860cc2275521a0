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

using test::has;
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
  const auto drawn = [&](const std::string& name, const test::Words& more) {
    EXPECT_TRUE(test::good(render(joined(more, {"--view", "side", "-o", folder / name}))));
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
  const auto said_by = [&](const test::Words& words, const test::Words& more) {
    const test::Outcome outcome = test::run_program(joined(words, more));
    EXPECT_TRUE(test::good(outcome));
    return outcome.err;
  };
  const auto run = [&](const std::string& file, const test::Words& more = {}) {
    return said_by({"render", folder / file, "--view", "side", "--mono", "--cameras", folder / "cameras.json",
                    "-o", folder / "drawn.png"},
                   more);
  };
  const auto convert = [&](const std::string& to, const test::Words& more = {}) {
    return said_by({"convert", model, "-o", folder / to}, more);
  };
  EXPECT_TRUE(
      has(convert("said.spz"), "said.spz: its axes are RUB, as the format has them and as the file says"));
  EXPECT_FALSE(has(run("said.spz"), "its axes"));
  const Image expected = load_image(folder / "drawn.png");
  test::write_text(folder / "rub.spz", without_axes(test::read_text(folder / "said.spz")));
  convert("lies.spz", {"--axes", "rub"});  // the ply's numbers as they are
  test::write_text(folder / "rdf.spz", without_axes(test::read_text(folder / "lies.spz")));
  const auto close = [&] { return measure::psnr(load_image(folder / "drawn.png"), expected) > 25; };
  EXPECT_TRUE(has(run("rub.spz"), "rub.spz: its axes are taken as RUB, in which its cameras have"));
  EXPECT_TRUE(close());
  EXPECT_TRUE(has(run("rdf.spz"), "rdf.spz: its axes are taken as RDF, in which its cameras have"));
  EXPECT_TRUE(close());
  EXPECT_TRUE(has(run("lies.spz"), "though its file says that (--axes rub to take them so)"));
  EXPECT_TRUE(close());
  // Planted fault, and what an option says goes before all.
  EXPECT_FALSE(has(run("rdf.spz", {"--axes", "rub"}), "are taken as"));
  EXPECT_FALSE(close());
  // By the cameras that lie beside it, where none are named: of a model that is turned, too.
  const test::Outcome turned = test::run_program({"convert", folder / "rdf.spz", "-o", folder / "back.ply"});
  EXPECT_TRUE(test::good(turned));
  EXPECT_TRUE(has(turned.err, "taken as RDF"));
  EXPECT_FALSE(has(turned.err, "are turned from"));
  const test::Outcome info = test::run_program({"info", folder / "rdf.spz"});
  EXPECT_TRUE(has(info.out, "axes           RDF"));
  // Nothing tells.
  std::filesystem::remove(folder / "cameras.json");
  const test::Outcome alone = test::run_program({"info", folder / "rdf.spz"});
  EXPECT_TRUE(has(alone.err, "nothing else tells: taken as RUB, as the format says (--axes rdf if it lies"));
}

}  // namespace
}  // namespace binosplat
