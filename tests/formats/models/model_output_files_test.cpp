// Written models of other programs, losses of each format, and models that cannot be written.

#include <gtest/gtest.h>

#include "formats/containers/gzip.h"
#include "formats/training/trainer_keys.h"
#include "scene/scaffold.h"
#include "support/errors.h"
#include "support/fixtures.h"
#include "support/full_disk.h"
#include "support/round_trip.h"

namespace binosplat {
namespace {

using test::difference;
using test::formats;
using test::hard_model;
using test::in_axes_of;
using test::name_of;
using test::round_trip;
using test::Written;

/// Returns the format of a loaded file if binosplat can write that format.
std::optional<ModelFormat> own_format(const Model& model) {
  if (model.format == "ply") return ModelFormat::ply;
  if (model.format.starts_with("spz")) return ModelFormat::spz;
  if (model.format == "SOG") return ModelFormat::sog;
  return std::nullopt;
}

TEST(ModelOutputFiles, ForeignModelsStayWithinQuantisation) {
  REQUIRE_FIXTURES(folder);
  int own = 0, exact = 0;
  const nlohmann::json models = test::load_json(folder / "truth.json")["models"];
  for (const auto& [name, truth] : models.items()) {
    const Model read = load_model(folder / name);
    for (const ModelFormat format : formats) {
      // model_output_test writes models of every kind in every format.
      if (own_format(read) != format && !test::switched_on("BINOSPLAT_LONG")) continue;
      const Model model = in_axes_of(read, format);
      const Written written = round_trip(model, format);
      EXPECT_EQ(difference(model, written.model, format), "") << name << " as " << name_of(format);
      if (own_format(read) != format) continue;
      ++own;
      EXPECT_EQ(written.model.antialiased, model.antialiased) << name;
      // Folding Mip-Splatting's filter into scales and opacities leaves numbers that no logit decodes to.
      if (format != ModelFormat::ply || model.kernel_by == by_filter) continue;
      ++exact;
      EXPECT_TRUE(test::same_bits(written.model, model)) << name;
    }
  }
  EXPECT_EQ(own, 37);
  EXPECT_EQ(exact, 13);
}

// The bytes of each attribute are the same again. Only spz rotations may differ: the largest of two nearly
// equal components may be the other one.
TEST(ModelOutputFiles, SpzRoundTripsBytes) {
  REQUIRE_FIXTURES(folder);
  const auto unpacked = [](const std::string& text) {
    return GzipReader("spz", std::as_bytes(std::span(text))).read(std::size_t{1} << 24);
  };
  const std::string file = test::read_text(folder / "spz/st-train-v3-sh3.spz");
  const Model model = load_model(folder / "spz/st-train-v3-sh3.spz");
  std::vector<std::byte> before = unpacked(file);
  // Files that binosplat writes name the axes in an extension, which adds 12 bytes at the end.
  before[14] |= std::byte{2};
  const std::vector<std::byte> after = unpacked(round_trip(model, ModelFormat::spz).bytes);
  ASSERT_EQ(before.size() + 12, after.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::size_t rotations = 16 + 16 * model.count();
    const bool rotation = i >= rotations && i < rotations + 4 * model.count();
    if (before[i] != after[i] && rotation) ++different;
    EXPECT_TRUE(before[i] == after[i] || rotation) << i;
  }
  EXPECT_LT(different, model.count() / 20);
}

TEST(ModelOutputFiles, TagsAreKeptOrReported) {
  Model model = hard_model(0, 3);
  model.antialiased = true;
  for (const ModelFormat format : formats) {
    const Written written = round_trip(in_axes_of(model, format), format);
    EXPECT_TRUE(written.model.antialiased) << name_of(format);
    EXPECT_EQ(written.model.kernel_px2, KERNEL_PX2);
  }
  model.antialiased = false;
  model.perspective = {Order::distance, Projection::tangent};
  for (const ModelFormat format : formats) {
    const Written written = round_trip(in_axes_of(model, format), format);
    const bool is_kept = format != ModelFormat::spz;
    EXPECT_EQ(written.model.perspective, is_kept ? model.perspective : Perspective{});
    EXPECT_EQ(!written.losses.empty() &&
                  written.losses.back().find("`order` distance `projection` tangent") != std::string::npos,
              !is_kept);
  }
  model.perspective = {};
  model.antialiased = true;
  model.kernel_px2 = 0.1;
  model.near_plane = 0.015;
  for (const ModelFormat format : {ModelFormat::ply, ModelFormat::sog}) {
    const Written written = round_trip(model, format);
    EXPECT_EQ(written.model.kernel_px2, 0.1);
    EXPECT_EQ(written.model.near_plane, 0.015);
    EXPECT_EQ(written.losses, std::vector<std::string>());
  }
  const std::vector<std::string> lost = {
      "spz does not store the low-pass of 0.1 px^2: draw it with `eps2d` 0.1",
      "spz does not store the near plane of 0.015: draw it with `near` 0.015"};
  const auto spz = round_trip(in_axes_of(model, ModelFormat::spz), ModelFormat::spz).losses;
  ASSERT_GE(spz.size(), lost.size());
  EXPECT_EQ(std::vector(spz.end() - 2, spz.end()), lost);
}

TEST(ModelOutputFiles, ReportsClampedValues) {
  Model model;
  model.degree = 1;
  for (int i = 0; i < 5; ++i) test::add(model, glm::vec3(i), glm::vec3(0.1f), 0.5f);
  const auto losses = [&](ModelFormat format, int bits = 8) {
    return round_trip(in_axes_of(model, format), format, bits).losses;
  };
  using Texts = std::vector<std::string>;
  for (const ModelFormat format : formats) EXPECT_EQ(losses(format), Texts{}) << name_of(format);
  model.scale[1].y = 1e-5f;
  model.sh[1] = 3.5f;
  model.sh[12 + 9] = 0.97f;
  EXPECT_EQ(losses(ModelFormat::spz),
            (Texts{"1 of 5 Gaussians have scales beyond e^-10 to e^5.94, which spz clips",
                   "1 of 5 Gaussians have base colours beyond those of spz, which clips them"}));
  EXPECT_EQ(losses(ModelFormat::spz, 4).size(), 3u) << "1 - 1/32 is the last that rounds to a step";
  model.scale[1].y = 0.0f;
  model.sh[12 + 9] = -4.5f;
  EXPECT_TRUE(losses(ModelFormat::ply).empty());
  model.position[0].x = 3000.0f;
  EXPECT_EQ(losses(ModelFormat::spz).front(),
            "the model is so large that spz keeps positions in steps of 0.0004883 only");
}

TEST(ModelOutputFiles, FaultsAreNamed) {
  const test::TempFolder folder;
  const auto path = folder / "model.spz";
  const auto write = [&](const Model& model, ModelFormat format) {
    OutputFile file(path);
    write_model(file, model, format);
    file.commit();
  };
  Model model = hard_model(3, 5000);
  EXPECT_ERROR(write(model, ModelFormat::spz), "its axes are RDF, but spz requires RUB");
  Model far = in_axes_of(model, ModelFormat::spz);
  far.position[3].z = -9e6f;
  EXPECT_ERROR(write(far, ModelFormat::spz), "reach 9e+06", "8388607");
  for (const ModelFormat format : formats) {
    const test::FullDisk full(50000);
    EXPECT_ERROR(write(in_axes_of(model, format), format), "cannot write", "model.spz") << name_of(format);
  }
  model.scaffold = std::make_shared<Scaffold>();
  EXPECT_ERROR(write(model, ModelFormat::ply), "Scaffold-GS");
  EXPECT_TRUE(folder.names().empty());
}

TEST(ModelOutputFiles, SizesArePredicted) {
  for (const ModelFormat format : formats) {
    if (format == ModelFormat::sog) continue;  // SOG's images are padded, and have channels without numbers.
    for (int degree = 0; degree <= 3; ++degree) {
      const Model model = in_axes_of(hard_model(degree, 1000), format);
      const std::string bytes = round_trip(model, format).bytes;
      const std::size_t header = bytes.starts_with("ply") ? bytes.find("end_header\n") + 11 : 0;
      if (format == ModelFormat::spz) {
        const auto raw = GzipReader("spz", std::as_bytes(std::span(bytes))).read(std::size_t{1} << 24);
        EXPECT_EQ(bytes_in(format, 1000, degree), raw.size() - 16 - 12)
            << "header, and the extension that names the axes";
      } else {
        EXPECT_EQ(bytes_in(format, 1000, degree), bytes.size() - header) << name_of(format);
      }
    }
  }
}

TEST(ModelOutputFiles, ExtensionsGiveFormat) {
  EXPECT_EQ(model_format_of("a/b.ply"), ModelFormat::ply);
  EXPECT_EQ(model_format_of("b.Compressed.PLY"), std::nullopt) << "it is read, and not written";
  EXPECT_EQ(model_format_of("b.splat"), std::nullopt);
  EXPECT_EQ(model_format_of("b.ply.spz"), ModelFormat::spz);
  EXPECT_EQ(model_format_of("b.SOG"), ModelFormat::sog);
  EXPECT_EQ(model_format_of("ply"), std::nullopt);
  EXPECT_EQ(model_format_of("b.ply.gz"), std::nullopt);
  EXPECT_EQ(word_of(ModelFormat::spz), "spz");
}

TEST(Morton, OrderKeepsNeighboursTogether) {
  std::vector<glm::vec3> positions;
  for (const float x : {3.0f, 0.0f, 2.0f, 1.0f}) {
    for (const float y : {0.0f, 1.0f, 1.0f}) positions.emplace_back(x, y, 7.0f);
  }
  // x 0 to 1 with y 0 to 1 is the first block. Equal positions keep their order.
  EXPECT_EQ(morton_order(positions), (std::vector<std::uint32_t>{3, 9, 6, 0, 4, 5, 10, 11, 7, 8, 1, 2}));
  EXPECT_TRUE(morton_order({}).empty());
}

}  // namespace
}  // namespace binosplat
