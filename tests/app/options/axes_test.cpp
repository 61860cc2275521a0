// --axes: a model in another frame than the world of its cameras.

#include "app/scene.h"
#include "formats/containers/content.h"
#include "formats/containers/gzip.h"
#include "support/broken.h"

namespace binosplat {
namespace {

struct AxesOption : SceneTest {
  AxesOption() { add_cameras(); }

  /// Returns what a successful command prints.
  std::string said_by(const Words& words) const { return checked(run_program(words)).err; }
};

/// Returns the small model with x, y and z multiplied by signs, in all values: also quaternions and
/// harmonics.
PlyFile flipped(double dx, double dy, double dz) {
  PlyFile file = small_model();
  const double sign[] = {dy, dz, dx};  // for the three harmonics of degree 1
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

TEST_F(AxesOption, TransformsCamerasToModelFrame) {
  const auto drawn = [&](const Words& more) {
    EXPECT_TRUE(good(render(joined(more, {"--view", "side", "-o", folder / "drawn.png"}))));
    return load_image(folder / "drawn.png");
  };
  const Image expected = drawn({});
  const auto largest = [&](const Image& image) { return measure::largest_difference(image, expected).max; };
  write_text(model, to_bytes(flipped(1, -1, -1)));
  EXPECT_LE(largest(drawn({"--axes", "rub"})), 1.01 / 255);
  EXPECT_GT(largest(drawn({})), 0.5);                // injected fault: read as RDF
  write_text(model, to_bytes(flipped(-1, -1, -1)));  // a frame with a reflection
  EXPECT_LE(largest(drawn({"--axes", "LUB"})), 1.01 / 255);
}

/// Removes the axes from an spz file, as writers do that do not store them.
std::string without_axes(const std::string& spz) {
  const auto bytes = GzipReader("spz", std::as_bytes(std::span(spz))).read(std::size_t{1} << 24);
  std::string raw(as_text(bytes));
  raw[14] = static_cast<char>(raw[14] & ~2);
  raw.resize(raw.size() - 12);
  return test::gzipped(raw);
}

// Both conventions of spz files, and files of this program, which name their axes.
TEST_F(AxesOption, DetectsSpzAxesFromCameras) {
  const std::string drawn = folder / "drawn.png";
  const auto run = [&](const std::string& file, const Words& more = {}) {
    return said_by(joined({"render", folder / file, "--view", "side", "--mono", "--cameras",
                           folder / "cameras.json", "-o", drawn},
                          more));
  };
  EXPECT_TRUE(has(said_by({"convert", model, "-o", folder / "said.spz"}),
                  "said.spz: its axes are RUB, as the format has them and as the file says"));
  EXPECT_FALSE(has(run("said.spz"), "its axes"));
  fs::rename(drawn, folder / "expected.png");
  const auto close = [&] { return psnr_of_files(drawn, folder / "expected.png") > 25; };
  write_text(folder / "rub.spz", without_axes(read_text(folder / "said.spz")));
  said_by({"convert", model, "-o", folder / "lies.spz", "--axes", "rub"});  // keeps the ply's numbers
  write_text(folder / "rdf.spz", without_axes(read_text(folder / "lies.spz")));
  for (const auto& [file, said] : {
           std::pair{"rub.spz", "rub.spz: its axes are taken as RUB, in which its cameras have"},
           {"rdf.spz", "rdf.spz: its axes are taken as RDF, in which its cameras have"},
           {"lies.spz", "though its file says that (--axes rub to take them so)"},
       }) {
    EXPECT_TRUE(has(run(file), said));
    EXPECT_TRUE(close()) << file;
  }
  // Injected fault. It also shows that an option has precedence.
  EXPECT_FALSE(has(run("rdf.spz", {"--axes", "rub"}), "are taken as"));
  EXPECT_FALSE(close());
  // Without named cameras, the cameras in the file's folder decide, also for convert.
  const std::string turned = said_by({"convert", folder / "rdf.spz", "-o", folder / "back.ply"});
  EXPECT_TRUE(has(turned, "taken as RDF"));
  EXPECT_FALSE(has(turned, "are turned from"));
  EXPECT_TRUE(has(run_program({"info", folder / "rdf.spz"}).out, "axes           RDF"));
  // Without cameras nothing decides.
  fs::remove(folder / "cameras.json");
  EXPECT_TRUE(has(said_by({"info", folder / "rdf.spz"}),
                  "it does not name its axes: taken as RUB, as files like it have (--axes rdf if it lies"));
}

}  // namespace
}  // namespace binosplat
