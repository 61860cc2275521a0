// .splat and .ksplat have no magic number: which files are recognized as them, and damaged ones.

#include <gtest/gtest.h>

#include "support/fixtures.h"
#include "support/load.h"
#include "support/models.h"

namespace binosplat {
namespace {

using test::little;
using test::patched;

TEST(Splat, IsDetectedByContent) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "splat/antimatter15-train.splat");
  EXPECT_EQ(test::load_model_of(good, "model").count(), 1000u);
  EXPECT_EQ(test::load_model_of(good, "model.ply").count(), 1000u);
  test::Uniform uniform(1);
  std::string noise;
  for (int i = 0; i < 3200; ++i) noise += static_cast<char>(uniform(0, 256));
  const std::string text = "AAAAAAAAAAAA????????????\xc3\xa4\xe2\x82\xac\xc3\xb6\xc3";
  test::expect_no_models("model", {{noise, {"something unknown"}}, {text, {"a text file"}}});
  test::expect_no_models("a.splat", {{noise, {"is not a .splat file"}}, {"", {"an empty file"}}});
  // No byte is below 0x20, but the file is not text: 0x80 cannot begin a character in UTF-8.
  EXPECT_EQ(test::load_model_of("AAAAAAAAAAAA????????????\x80\x80\x80\xf0\xff\x80\x80\x80", "model").count(),
            1u);
}

// Converters of point clouds leave quaternions of 255, 255, 255, 255, or scale them.
TEST(Splat, NormalisesQuaternions) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "splat/antimatter15-train.splat");
  const Model model = test::load_model_of(good, "a.splat");
  std::string halved = good, full = good;
  for (std::size_t at = 28; at < good.size(); ++at) {
    if (at % 32 < 28) continue;
    halved[at] = static_cast<char>((static_cast<unsigned char>(good[at]) - 128) / 2 + 128);
    full[at] = '\xff';
  }
  testing::internal::CaptureStderr();
  const Model of_halved = test::load_model_of(halved, "a.splat"),
              of_full = test::load_model_of(full, "a.splat");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("do not have length 1"), std::string::npos);
  ASSERT_EQ(of_halved.count(), model.count());
  for (std::size_t i = 0; i < model.count(); ++i) {
    EXPECT_LT(glm::distance(of_halved.rotation[i], model.rotation[i]), 0.05f) << i;
    EXPECT_LT(glm::distance(of_full.rotation[i], glm::vec4(0.5f)), 1e-6f) << i;
  }
  EXPECT_EQ(test::load_model_of(full, "A.SPLAT").count(), model.count());
  full[31] = full[30] = full[29] = full[28] = '\x80';  // no direction at all
  EXPECT_EQ(test::load_model_of(full, "a.splat").left_out, 1u);
  test::expect_no_models("model", {{full, {"something unknown"}}});  // without the name, content decides
  // Points without a size are read, too; a file of zeros is none of points.
  std::string points = good;
  for (std::size_t at = 0; at < good.size(); ++at) {
    if (at % 32 >= 12 && at % 32 < 24) points[at] = '\0';
  }
  EXPECT_EQ(test::load_model_of(points, "a.splat").count(), model.count());
  test::expect_no_models("a.splat", {{std::string(3200, '\0'), {"is not a .splat file"}}});
}

TEST(Splat, DamageIsReported) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "splat/antimatter15-train.splat");
  const std::vector<test::BrokenFile> refusals = {
      {good + "1234567", {"32007 bytes are no whole number of .splat's records of 32"}},
      {good.substr(0, 31), {"31 bytes are no whole number"}}};
  test::expect_no_models("a.splat", refusals);
  EXPECT_EQ(test::load_model_of(good.substr(0, 32), "a.splat").count(), 1u);
  const Model model = test::load_model_of(patched(good, 12, "\xff\xff\xff\xff"), "a.splat");
  EXPECT_EQ(model.count(), 999u);
  EXPECT_EQ(model.left_out, 1u);
  EXPECT_EQ(test::load_model_of(patched(good, 32 + 16, little(-0.5f)), "a.splat").left_out,
            1u);  // because of a negative scale
}

TEST(Ksplat, DamageIsReported) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "ksplat/gs3d-train-l1-sh1.ksplat");
  EXPECT_EQ(test::load_model_of(good, "model").count(), 1000u) << "content decides";
  const auto with = [&](std::size_t at, const std::string& bytes) { return patched(good, at, bytes); };
  // The data after the header of the section begins with the lengths of the partly filled buckets.
  const std::size_t section = 4096, data = section + 1024;
  std::vector<test::BrokenFile> refusals = {
      {with(1, std::string(1, '\0')), {"unknown .ksplat version 0.0"}},
      {with(0, "\x01"), {"unknown .ksplat version 1.1"}},
      {with(4, little(0x40000000u)), {"has room for 1073741824 sections"}},
      {with(16, little(1001u)), {"promises 1001 Gaussians, at byte 16, but its sections have 1000"}},
      {with(20, little(std::uint16_t{3})), {"compression level 3, at byte 20"}},
      {with(section, little(1001u)), {"section 0 has 1001 Gaussians and room for 1000"}},
      {with(section + 20, little(std::uint16_t{4})), {"buckets of 4 bytes"}},
      {with(section + 40, little(std::uint16_t{4})), {"harmonics of degree 4"}},
      {with(section + 40, little(std::uint16_t{3})), {"is cut short: section 0 takes"}},
      {with(data, little(0xffffffffu)), {"has 4294967295 Gaussians, but its section has only"}},
      {with(data, little(0u)), {"its buckets have"}},
      {with(section + 32, little(0u)), {"its buckets have"}},
      {with(section + 32, little(0x00ffffffu)), {"full and"}},
  };
  for (const std::size_t at : {4u, 12u, 36u})
    refusals.push_back({with(section + at, little(0xffffffffu)), {"is cut short: section 0 takes"}});
  // Truncation at every boundary.
  for (const std::size_t end : {std::size_t{4}, std::size_t{4095}, section, data - 1})
    refusals.push_back({good.substr(0, end), {"cut short"}});
  for (const std::size_t end : {data, data + 4, data + 40, good.size() - 1})
    refusals.push_back({good.substr(0, end), {"is cut short: section 0 takes"}});
  test::expect_no_models("a.ksplat", refusals);
}

}  // namespace
}  // namespace binosplat
