// Flat Gaussians (2D Gaussian Splatting), and other kernels than Gaussians.

#include <gtest/gtest.h>

#include <algorithm>

#include "formats/models/model_file.h"
#include "support/load.h"
#include "support/ply.h"
#include "support/ply_models.h"
#include "support/round_trip.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

/// Returns a file as the trainer of 2D Gaussian Splatting writes it.
test::PlyFile flat_file(const std::string& format = "binary_little_endian") {
  test::PlyFile file = test::inria_file(1, 5);
  file.format = format;
  const std::size_t third = file.column("scale_2");
  file.columns.erase(file.columns.begin() + static_cast<std::ptrdiff_t>(third));
  for (auto& row : file.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(third));
  return file;
}

Model load_file(const test::PlyFile& file) { return test::load_model_of(to_bytes(file), "a.ply"); }

bool tells_of_discs(const test::Written& written) {
  return std::ranges::any_of(
      written.losses, [](const std::string& loss) { return loss.find("discs (2DGS)") != std::string::npos; });
}

float largest_thickness(const Model& model) {
  float most = 0.0f;
  for (const glm::vec3& scale : model.scale) most = std::max(most, scale.z);
  return most;
}

TEST(FlatGaussians, AreReadAsFlat) {
  Model expected = load_file(test::inria_file(1, 5));
  EXPECT_FALSE(test::equal(load_file(flat_file()), expected));
  for (glm::vec3& scale : expected.scale) scale.z = 0.0f;
  for (const char* format : {"binary_little_endian", "binary_big_endian", "ascii"}) {
    testing::internal::CaptureStderr();
    const Model read = load_file(flat_file(format));
    EXPECT_NE(testing::internal::GetCapturedStderr().find("flat (2D Gaussian Splatting)"), std::string::npos);
    EXPECT_TRUE(test::equal(read, expected)) << format;
    EXPECT_EQ(read.format, "ply, flat Gaussians of 2DGS");
  }
  test::PlyFile named = test::inria_file(1, 5);
  named.comments = "comment SplatRenderMode: 2dgs\n";
  EXPECT_TRUE(test::equal(load_file(named), expected));
}

TEST(FlatGaussians, StayFlatInEveryFormat) {
  const Model flat = load_file(flat_file());
  for (const ModelFormat format : test::formats) {
    const Model model = test::in_axes_of(flat, format);
    const test::Written written = test::round_trip(model, format);
    ASSERT_EQ(written.model.count(), flat.count()) << test::name_of(format);
    for (const glm::vec3& scale : written.model.scale) {
      // Only ply stores a scale of 0. The other formats store one far smaller than the other two scales.
      EXPECT_LE(std::min({scale.x, scale.y, scale.z}), 1e-4f) << test::name_of(format);
      EXPECT_GT(std::max({scale.x, scale.y, scale.z}), 1e-3f) << test::name_of(format);
    }
    const bool is_kept = format != ModelFormat::spz;
    EXPECT_EQ(written.model.flat, is_kept) << test::name_of(format);
    if (is_kept) {
      EXPECT_EQ(written.model.scale[0].z, 0.0f);
    }
    EXPECT_EQ(tells_of_discs(written), !is_kept) << test::name_of(format);
  }
}

TEST(FlatGaussians, AntialiasedOnesKeepBoth) {
  Model model = load_file(flat_file());
  model.antialiased = true;
  for (const ModelFormat format : {ModelFormat::ply, ModelFormat::sog}) {
    const test::Written written = test::round_trip(model, format);
    EXPECT_TRUE(written.model.flat && written.model.antialiased) << test::name_of(format);
  }
}

// A reader of the word draws all Gaussians as discs.
TEST(FlatGaussians, AmongOthersKeepThickness) {
  Model model = load_file(flat_file());
  model.scale[1].z = 0.02f;
  for (const ModelFormat format : {ModelFormat::ply, ModelFormat::sog}) {
    const test::Written written = test::round_trip(model, format);
    EXPECT_FALSE(written.model.flat) << test::name_of(format);
    EXPECT_NEAR(largest_thickness(written.model), 0.02f, 1e-3f) << test::name_of(format);
    EXPECT_TRUE(tells_of_discs(written)) << test::name_of(format);
  }
}

TEST(NonGaussianKernels, AreRejectedByName) {
  std::vector<test::BrokenFile> refusals;
  for (const std::string colour : {"f_dc_0", "sh0_0"}) {  // Trainers of Beta kernels name the colour sh0_0.
    for (const auto& [property, kind] :
         {std::pair("beta", "Beta kernels (Deformable Beta Splatting)"),
          std::pair("binding_0", "triangles of a mesh"), std::pair("sb_params_0", "spherical Betas"),
          std::pair("trbf_center", "Spacetime Gaussians")}) {
      test::PlyFile file = test::inria_file(0, 2);
      file.columns[file.column("f_dc_0")] = colour;
      file.columns.emplace_back(property);
      for (auto& row : file.rows) row.push_back(1);
      refusals.push_back({to_bytes(file), {kind, property}});
    }
  }
  test::PlyFile colourless = test::inria_file(0, 2);
  colourless.columns[colourless.column("f_dc_0")] = "feature_0";
  refusals.push_back({to_bytes(colourless), {"no known colours", "neither f_dc_0 to f_dc_2 nor red"}});
  test::expect_no_models("bad.ply", refusals);
}

TEST(Undrawn, PartsAreNamed) {
  const test::TempFolder folder;
  const fs::path run = folder / "run/point_cloud/iteration_7", model = run / "point_cloud.ply";
  fs::create_directories(run);
  const auto warnings = [&](const std::string& property) {
    test::PlyFile file = test::inria_file(0, 2);
    file.columns.push_back(property);
    for (auto& row : file.rows) row.push_back(1);
    test::write_text(model, to_bytes(file));
    testing::internal::CaptureStderr();
    load_model(model);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(warnings("semantic"), "");
  EXPECT_NE(warnings("extra_level").find("leaves out fine levels far away"), std::string::npos);
  EXPECT_NE(warnings("refl_strength").find("reflections"), std::string::npos);
  const fs::path one = run / "deformation.pth", other = folder / "run/deform/iteration_7/deform.pth";
  for (const fs::path& network : {one, other}) {
    fs::create_directories(network.parent_path());
    test::write_text(network, "x");
    EXPECT_NE(warnings("semantic").find("with time; they are drawn unmoved"), std::string::npos) << network;
    fs::remove(network);
    EXPECT_EQ(warnings("semantic"), "") << network;
  }
}

}  // namespace
}  // namespace binosplat
