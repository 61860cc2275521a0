// Damaged spz files, and unusual ones that load. real_files_test tests that values are decoded right.

#include <gtest/gtest.h>

#include "formats/containers/gzip.h"
#include "formats/containers/size_limits.h"
#include "formats/models/spz.h"
#include "formats/models/spz_container.h"
#include "support/fixtures.h"
#include "support/load.h"

namespace binosplat {
namespace {

using test::little;
using test::patched;

std::string unpacked(const std::string& text) {
  const auto bytes = GzipReader("a fixture", std::as_bytes(std::span(text))).read(std::size_t{1} << 24);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Model load_spz(const std::string& bytes) { return test::load_model_of(bytes, "bad.spz"); }

void expect_spz_refused(const std::vector<test::BrokenFile>& refusals) {
  test::expect_no_models("bad.spz", refusals);
}

/// Returns the messages on standard error while `bytes` are loaded.
std::string said_of(const std::string& bytes) {
  testing::internal::CaptureStderr();
  load_spz(bytes);
  return testing::internal::GetCapturedStderr();
}

TEST(SpzErrors, GzipFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "spz/st-train-v3-sh3.spz"), raw = unpacked(good);
  ASSERT_EQ(raw.size(), 16u + 1000 * 65);
  std::vector<test::BrokenFile> refusals = {
      {good.substr(0, 1), {}},
      {patched(good, good.size() - 8, std::string(1, static_cast<char>(good[good.size() - 8] ^ 1))),
       {"is damaged: incorrect data check"}},
      {test::gzipped("hello, this is no model"), {"is not an spz model", "NGSP"}},
      {test::gzipped(raw.substr(0, 15)), {"an spz header has 16 bytes, and 15 are there"}},
      {test::gzipped(raw.substr(0, 16)), {"promises 1000 Gaussians of degree 3, which"}},
      // The same without gzip, which some files lack.
      {raw.substr(0, 60000), {"take 65000 bytes after the header, and 59984 are there"}},
      {raw.substr(0, 12), {"an spz header has 16 bytes, and 12 are there"}},
  };
  EXPECT_EQ(load_spz(raw).count(), 1000u);
  for (const std::size_t size : {10u, 20u, 3000u, 10000u, 21655u})
    refusals.push_back({good.substr(0, size), {"is cut short: its gzip data ends"}});
  // Truncation at every boundary between attributes, and one byte before it.
  for (const std::size_t bytes : {9u, 10u, 13u, 16u, 20u, 65u}) {
    for (const std::size_t end : {1000 * bytes, 1000 * bytes - 1}) {
      if (end < 65000)
        refusals.push_back({test::gzipped(raw.substr(0, 16 + end)),
                            {fmt::format("take 65000 bytes after the header, and {} are there", end)}});
    }
  }
  expect_spz_refused(refusals);
}

TEST(SpzErrors, HeaderFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const std::string raw = unpacked(test::read_text(folder / "spz/st-train-v3-sh3.spz"));
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return test::gzipped(patched(raw, at, bytes));
  };
  expect_spz_refused({
      {with(4, little(9u)), {"unknown spz version 9"}},
      {with(4, little(0u)), {"unknown spz version 0"}},
      {with(4, little(4u)), {"version 4 within gzip"}},
      {with(8, little(1001u)), {"its 1001 Gaussians of degree 3 take 65065 bytes", "65000 are there"}},
      {with(8, little(0x80000000u)), {"promises 2147483648 Gaussians of degree 3, which"}},
      {with(8, little(0u)), {"holds no Gaussians"}},
      {with(12, "\x07"), {"degree 7, at byte 12"}},
      {with(13, "\xff"), {"255 bits of fraction, at byte 13"}},
      {with(14, "\x80"), {"tree of levels of detail (Spark)"}},
  });
}

TEST(SpzErrors, DecompressionIsLimited) {
  REQUIRE_FIXTURES(folder);
  const std::string raw = unpacked(test::read_text(folder / "spz/minimal-v3.spz"));
  const std::string bomb = test::gzipped(raw + std::string(std::size_t{1} << 25, '\0'));
  EXPECT_NE(said_of(bomb).find("bytes after the last attribute are ignored"), std::string::npos);
  EXPECT_EQ(load_spz(bomb).count(), 4u);
  // The same for extensions, which may take up to a megabyte.
  const std::string extended = patched(raw, 14, "\x02");
  expect_spz_refused(
      {{test::gzipped(extended + little(1u) + little(0xfffffff0u) + std::string(std::size_t{1} << 22, '\0')),
        {"an extension of 4294967280 bytes runs past"}}});
  EXPECT_EQ(load_spz(test::gzipped(extended + little(0xadbe0003u) + little(4u) + little(7u))).axes.letters,
            "LUF");
}

TEST(SpzErrors, StreamFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "spz/adobe-train-v4-sh3-rdf2rub-aa.spz");
  constexpr std::size_t toc = 32, frames = toc + 96;
  EXPECT_NE(said_of(good + "!").find("bytes after the last attribute are ignored"), std::string::npos);
  std::vector<test::BrokenFile> refusals = {
      {patched(good, 16, little(31u)), {"table of 6 streams stands at byte 31"}},
      {patched(good, 16, little(static_cast<std::uint32_t>(good.size()))),
       {"table of 6 streams stands at byte 37656 of"}},
      {patched(good, 16, little(0xffffffffu)), {"stands at byte 4294967295"}},
      {patched(good, 15, "\x05"), {"5 streams, at byte 15; a model of degree 3 has 6"}},
      {patched(good, 15, "\x07"), {"7 streams, at byte 15"}},
      {patched(good, toc, little(std::uint64_t{1} << 63)), {"its positions take 9223372036854775808 bytes"}},
      {patched(good, toc + 8, little(std::uint64_t{9001})), {"promises 9001 bytes of positions"}},
      {patched(good, frames, "?"), {"is damaged: its positions", "cannot be unpacked"}},
      {patched(good, 8, little(0x7fffffffu)), {"2147483647 Gaussians of degree 3, which"}},
      {good.substr(0, 20), {"the header has 32 bytes, and 20 are there"}},
      {good.substr(0, frames - 1), {"table of 6 streams"}},
  };
  // Truncation at every boundary between streams.
  std::size_t end = frames;
  for (std::size_t stream = 0; stream < 6; ++stream) {
    refusals.push_back({good.substr(0, end), {"is cut short: its"}});
    std::uint64_t size = 0;
    std::memcpy(&size, &good[toc + 16 * stream], 8);
    end += size;
    refusals.push_back({good.substr(0, end - 1), {"is cut short: its"}});
  }
  EXPECT_EQ(end, good.size());
  expect_spz_refused(refusals);
}

/// Returns zeros as a zstd frame of a few bytes, whose blocks repeat one byte.
std::string zeros_in_zstd(std::uint32_t size) {
  constexpr std::uint32_t most = 1u << 17, repeated = 1u << 1;
  std::string frame = "\x28\xb5\x2f\xfd\xa0" + little(size);
  for (std::uint32_t left = size; left > 0;) {
    const std::uint32_t block = std::min(left, most);
    left -= block;
    frame += little(block << 3 | repeated | (left == 0 ? 1u : 0u)).substr(0, 3) + std::string(1, '\0');
  }
  return frame;
}

TEST(SpzErrors, ExcessiveCounts) {
  // The extra bytes at the end pass the check of the file's size against its positions, because zstd has no
  // limit to its compression ratio.
  const auto of_zeros = [](std::uint32_t count) {
    std::string streams, table;
    for (const std::uint32_t bytes : {9u, 1u, 3u, 3u, 4u}) {
      const std::string frame = zeros_in_zstd(count * bytes);
      table += little(std::uint64_t{frame.size()}) + little(std::uint64_t{count} * bytes);
      streams += frame;
    }
    return "NGSP" + little(4u) + little(count) + std::string("\0\x0c\0\x05", 4) + little(32u) +
           std::string(12, '\0') + table + streams + std::string(20000, '\0');
  };
  EXPECT_EQ(load_spz(of_zeros(100000)).count(), 100000u);
  expect_spz_refused(
      {{of_zeros(2000000), {"promises 2000000 Gaussians of degree 0, which 2", "`max_memory`"}}});
  gaussians_allowed = 2000000;
  EXPECT_EQ(load_spz(of_zeros(2000000)).count(), 2000000u);
  expect_spz_refused({{of_zeros(2100000), {"promises 2100000 Gaussians"}}});
  gaussians_allowed = 0;
}

TEST(SpzErrors, ExtensionFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "spz/synthetic-v4-extensions.spz");
  EXPECT_EQ(load_spz(good).axes.letters, "RDF");
  const std::size_t axes = good.find(little(0xadbe0003u));
  ASSERT_NE(axes, std::string::npos);
  expect_spz_refused(
      {{patched(good, 36, little(0xfffffff0u)), {"an extension of 4294967280 bytes runs past"}},
       {patched(good, axes + 8, little(17u)), {"names the coordinate system 17"}}});
  EXPECT_EQ(load_spz(patched(good, axes + 8, little(0u))).axes.letters, "RDF") << "they are not said";
}

// Files that do not name their axes have those of their writer.
TEST(Spz, AxesFollowWriter) {
  const auto file = [](std::uint32_t version, int degree, int flags, char system) {
    const std::size_t bytes = spz_sizes(version, degree).sum();
    std::string raw = "NGSP" + little(version) + little(1u);
    for (const int byte : {degree, 12, flags, 0}) raw += static_cast<char>(byte);
    return patched(test::gzipped(raw + std::string(bytes, '\x40')), 9, std::string(1, system));
  };
  constexpr char unix_like = 3, windows = 10, apple = 19;
  const auto axes = [](const std::string& bytes) {
    const Model model = load_spz(bytes);
    EXPECT_TRUE(model.format.ends_with(axes_assumed));
    return model.axes.letters;
  };
  EXPECT_EQ(axes(file(2, 3, 1, apple)), "RUB") << "Scaniverse";
  EXPECT_EQ(axes(file(3, 3, 0, unix_like)), "RUB") << "LichtFeld Studio";
  EXPECT_EQ(axes(file(2, 0, 1, apple)), "RDF") << "Spark in a browser on a Mac";
  EXPECT_EQ(axes(file(2, 3, 0, windows)), "RDF") << "Niantic's converter";
  EXPECT_EQ(axes(file(3, 3, 1, windows)), "RDF") << "Spark";
}

TEST(Spz, ReportsTagsAndHighDegree) {
  REQUIRE_FIXTURES(folder);
  const Model model = load_model(folder / "spz/adobe-train-v4-sh3-rdf2rub-aa.spz");
  EXPECT_TRUE(model.antialiased);
  EXPECT_FALSE(load_model(folder / "spz/adobe-train-v3-sh3-rdf2rub.spz").antialiased);
  const std::string said = said_of(test::read_text(folder / "spz/adobe-v4-sh4.spz"));
  EXPECT_NE(said.find("harmonics of degree 4 are drawn up to degree 3"), std::string::npos) << said;
}

}  // namespace
}  // namespace binosplat
