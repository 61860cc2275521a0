// Formats that carry no mark of their own, .splat and .ksplat: what is taken for them, and damaged ones.

#include <gtest/gtest.h>

#include "formats/model_file.h"
#include "support/broken.h"
#include "support/fixtures.h"
#include "support/models.h"

namespace binosplat {
namespace {

using test::little;
using test::patched;

Model load_named(const std::string& bytes, const std::string& name) {
  const test::TempFolder folder;
  test::write_text(folder / name, bytes);
  return load_model(folder / name);
}

testing::AssertionResult refuses_named(const std::string& bytes, const std::string& name,
                                       std::initializer_list<std::string> parts) {
  return test::refuses_file(bytes, name, parts, [](const auto& path) { load_model(path); });
}

TEST(Splat, ContentDecides) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "splat/antimatter15-train.splat");
  EXPECT_EQ(load_named(good, "model").count(), 1000u);
  EXPECT_EQ(load_named(good, "model.ply").count(), 1000u);
  test::Uniform uniform(1);
  std::string noise;
  for (int i = 0; i < 3200; ++i) noise += static_cast<char>(uniform(0, 256));
  EXPECT_TRUE(refuses_named(noise, "noise", {"something unknown"}));
  EXPECT_TRUE(refuses_named(noise, "noise.splat", {"does not hold .splat's records"}));
  EXPECT_TRUE(refuses_named("", "empty.splat", {"an empty file"}));
  // No byte below 0x20, and yet no text: 0x80 begins no character.
  EXPECT_EQ(load_named("AAAAAAAAAAAA????????????\x80\x80\x80\xf0\xff\x80\x80\x80", "model").count(), 1u);
  EXPECT_TRUE(
      refuses_named("AAAAAAAAAAAA????????????\xc3\xa4\xe2\x82\xac\xc3\xb6\xc3", "model", {"a text file"}));
}

TEST(Splat, Damaged) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "splat/antimatter15-train.splat");
  EXPECT_TRUE(refuses_named(good + "1234567", "a.splat",
                            {"32007 bytes are no whole number of .splat's records of 32"}));
  EXPECT_TRUE(refuses_named(good.substr(0, 31), "a.splat", {"31 bytes are no whole number"}));
  EXPECT_EQ(load_named(good.substr(0, 32), "a.splat").count(), 1u);
  const Model model = load_named(patched(good, 12, "\xff\xff\xff\xff"), "a.splat");
  EXPECT_EQ(model.count(), 999u);
  EXPECT_EQ(model.left_out, 1u);
  EXPECT_EQ(load_named(patched(good, 32 + 16, little(-0.5f)), "a.splat").left_out, 1u);  // a negative scale
}

TEST(Ksplat, ContentDecides) {
  REQUIRE_FIXTURES(folder);
  EXPECT_EQ(load_named(test::read_text(folder / "ksplat/gs3d-train-l1-sh1.ksplat"), "model").count(), 1000u);
}

TEST(Ksplat, Damaged) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "ksplat/gs3d-train-l1-sh1.ksplat");
  const auto with = [&](std::size_t at, const std::string& bytes, std::initializer_list<std::string> parts) {
    return refuses_named(patched(good, at, bytes), "a.ksplat", parts);
  };
  const std::size_t section = 4096;
  EXPECT_TRUE(with(1, std::string(1, '\0'), {".ksplat of version 0.0 is not known"}));
  EXPECT_TRUE(with(0, "\x01", {".ksplat of version 1.1 is not known"}));
  EXPECT_TRUE(with(4, little(0x40000000u), {"has room for 1073741824 sections"}));
  EXPECT_TRUE(with(16, little(1001u), {"promises 1001 Gaussians, at byte 16, but its sections have 1000"}));
  EXPECT_TRUE(with(20, little(std::uint16_t{3}), {"compression level 3, at byte 20"}));
  EXPECT_TRUE(with(section, little(1001u), {"section 0 has 1001 Gaussians and room for 1000"}));
  EXPECT_TRUE(with(section + 4, little(0xffffffffu), {"is cut short: section 0 takes"}));
  EXPECT_TRUE(with(section + 12, little(0xffffffffu), {"is cut short: section 0 takes"}));
  EXPECT_TRUE(with(section + 36, little(0xffffffffu), {"is cut short: section 0 takes"}));
  EXPECT_TRUE(with(section + 20, little(std::uint16_t{4}), {"buckets of 4 bytes"}));
  EXPECT_TRUE(with(section + 40, little(std::uint16_t{4}), {"harmonics of degree 4"}));
  EXPECT_TRUE(with(section + 40, little(std::uint16_t{3}), {"is cut short: section 0 takes"}));
  const std::size_t data = section + 1024;  // lengths of buckets that are not full
  EXPECT_TRUE(with(data, little(0xffffffffu), {"has 4294967295 Gaussians, more than the"}));
  EXPECT_TRUE(with(data, little(0u), {"its buckets have"}));
  EXPECT_TRUE(with(section + 32, little(0u), {"its buckets have"}));
  EXPECT_TRUE(with(section + 32, little(0x00ffffffu), {"full and"}));
  // Truncation at every boundary.
  for (const std::size_t end : {std::size_t{4}, std::size_t{4095}, section, data - 1})
    EXPECT_TRUE(refuses_named(good.substr(0, end), "a.ksplat", {"cut short"}));
  for (const std::size_t end : {data, data + 4, data + 40, good.size() - 1})
    EXPECT_TRUE(refuses_named(good.substr(0, end), "a.ksplat", {"is cut short: section 0 takes"}));
}

}  // namespace
}  // namespace binosplat
