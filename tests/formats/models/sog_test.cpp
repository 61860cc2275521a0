// SOG in folders and archives, and its levels of detail. real_files_test tests that values are decoded right.

#include <gtest/gtest.h>

#include "stream/load_within.h"
#include "stream/lod_files.h"
#include "support/fixtures.h"
#include "support/load.h"
#include "support/ply_models.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Copy;

/// Whether `b` equals the Gaussians of `a` from `first` on, to the bit.
bool equal_from(const Model& a, std::size_t first, const Model& b) {
  const std::size_t values = b.sh.size() / b.count();
  for (std::size_t i = 0; i < b.count(); ++i) {
    const std::size_t k = first + i;
    if (a.position[k] != b.position[i] || a.scale[k] != b.scale[i] || a.rotation[k] != b.rotation[i])
      return false;
    if (a.opacity[k] != b.opacity[i]) return false;
    if (!std::equal(&b.sh[i * values], &b.sh[i * values] + values, &a.sh[k * values])) return false;
  }
  return true;
}

TEST(Sog, LevelsAreSelected) {
  REQUIRE_FIXTURES(folder);
  const fs::path lod = folder / "sog/st-lod";
  const Model fine = load_model(lod / "0_0"), coarse = load_model(lod / "1_0");
  const Model chosen = load_model(lod);
  ASSERT_EQ(chosen.count(), 1000u);
  EXPECT_TRUE(equal_from(chosen, 0, fine));
  EXPECT_FALSE(equal_from(chosen, 0, coarse)) << "injected: the other level";
  EXPECT_TRUE(equal_from(load_model(lod / "lod-meta.json", {.lod = 0}), 0, fine));
  const Model level = load_model(lod, {.lod = 1});
  ASSERT_EQ(level.count(), 250u);
  EXPECT_TRUE(equal_from(level, 0, coarse));
  EXPECT_ERROR(load_model(lod, {.lod = 2}), "level of detail 2", "lod-meta.json", "0 to 1");
  EXPECT_ERROR(load_model(lod / "0_0", {.lod = 0}), "level of detail 0", "no levels of detail");
}

TEST(Sog, ReadsPartialLevelsAndEnvironment) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](json& meta) {
    meta["environment"] = "1_0/meta.json";
    meta["tree"]["children"][0]["lods"].erase("0");  // this leaf has nothing to draw at level 0
  });
  const Model model = load_model(copy.path());
  const Model fine = load_model(copy.path() / "0_0"), coarse = load_model(copy.path() / "1_0");
  ASSERT_EQ(model.count(), 495u + 250u);
  EXPECT_EQ(model.position[0], fine.position[505]);
  EXPECT_EQ(model.opacity[494], fine.opacity[999]);
  EXPECT_TRUE(equal_from(model, 495, coarse));
}

// The three leaves have 505 and 120, 247 and 65, and 248 and 65 Gaussians at their two levels.
TEST(Sog, LevelsFitBudget) {
  REQUIRE_FIXTURES(folder);
  const fs::path lod = folder / "sog/st-lod";
  const Model fine = load_model(lod / "0_0"), coarse = load_model(lod / "1_0");
  const auto load = [&](std::size_t most, const glm::dvec3& eye) {
    const auto gaussians = [most](int degree) { return degree == 3 ? most : 0; };
    return load_within(lod, {gaussians, {eye}});
  };
  EXPECT_TRUE(equal_from(load(1000, {0, 0, 0}), 0, fine));
  EXPECT_TRUE(equal_from(load(250, {0, 0, 0}), 0, coarse));
  // The eye is next to the leaf that is last in the files, then next to the first one.
  const Model last = load(450, {6, 0, 13});
  ASSERT_EQ(last.count(), 120u + 65 + 248);
  EXPECT_EQ(last.position[0], fine.position[752]);
  EXPECT_EQ(last.position[248], coarse.position[0]);
  EXPECT_EQ(last.opacity[432], coarse.opacity[184]);
  const Model first = load(650, {-14, -1, 0});
  ASSERT_EQ(first.count(), 505u + 65 + 65);
  EXPECT_EQ(first.position[0], fine.position[0]);
  EXPECT_EQ(first.position[505], coarse.position[120]);
  EXPECT_TRUE(test::fails_saying(
      [&] {
        load_within(lod / "0_0", {[](int) { return std::size_t{1}; }, {}});
      },
      {"no levels of detail"}));
  const Copy copy(lod);  // Missing files are not chosen.
  fs::remove_all(copy.path() / "0_0");
  const auto all = [](int) { return std::size_t{5000}; };
  EXPECT_TRUE(equal_from(load_within(copy.path(), {all, {}}), 0, coarse));
  fs::remove_all(copy.path() / "1_0");
  EXPECT_TRUE(test::fails_saying(
      [&] {
        load_within(copy.path(), {all, {}});
      },
      {"lod-meta.json", "all its levels of detail are missing"}));
}

TEST(Sog, LevelsFallBackToAvailable) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/playbot-streamed-cut");
  copy.write(test::read_text(folder / "sog/playbot-lod-meta-original.json"), "lod-meta.json");
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_model(copy.path()).count(), 3000u);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("0_0/meta.json is missing); level 5 is drawn"), std::string::npos) << said;
  EXPECT_EQ(load_model(copy.path(), {.lod = 6}).count(), 1873u);
  EXPECT_ERROR(load_model(copy.path(), {.lod = 3}), "level of detail 3", "3_0/meta.json is missing",
               "finest complete level is 5");
  fs::remove_all(copy.path() / "5_0");
  fs::remove_all(copy.path() / "6_0");
  EXPECT_ERROR(load_model(copy.path()), "lod-meta.json", "no level of detail is complete");
}

/// Expects that a copy of a folder is refused for each replacement of a file's bytes.
void expect_refused_with(const fs::path& original, const std::string& file,
                         const std::vector<test::BrokenFile>& refusals) {
  const Copy copy(original);
  test::expect_refusals(file, refusals, [&](const std::string& bytes) {
    copy.write(bytes, file);
    load_model(copy.path());
  });
}

/// Returns an image of one colour, which takes few bytes whatever its size.
std::string grey_webp(int width, int height) {
  return test::webp(width, height,
                    std::vector<std::uint8_t>(static_cast<std::size_t>(4 * width * height), 77));
}

TEST(Sog, EmptyLevelsAreSkipped) {
  REQUIRE_FIXTURES(folder);
  // As a converter writes it that is given one model as level 1: the tree has no level 0.
  const Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](json& meta) {
    const json patch = json::parse(R"([{"op": "remove", "path": "/tree/children/0/lods/0"},
      {"op": "remove", "path": "/tree/children/1/children/0/lods/0"},
      {"op": "remove", "path": "/tree/children/1/children/1/lods/0"}])");
    meta = meta.patch(patch);
  });
  const Model coarse = load_model(folder / "sog/st-lod", {.lod = 1});
  testing::internal::CaptureStderr();
  EXPECT_TRUE(test::equal(load_model(copy.path()), coarse));
  EXPECT_EQ(testing::internal::GetCapturedStderr().find("warning"), std::string::npos);
  EXPECT_ERROR(load_model(copy.path(), {.lod = 0}),
               "level of detail 0: ", "has no Gaussians there; the finest complete level is 1");
}

TEST(SogErrors, MetaFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const json good = test::load_json(folder / "sog/playbot-lod6/meta.json");
  const auto with = [&](const std::string& pointer, const json& value) {
    return test::with_value(good, pointer, value);
  };
  const std::vector<test::BrokenFile> refusals = {
      {with("/count", 5000), {"5000 Gaussians are promised, but means_l.webp has 44 x 44 texels"}},
      {with("/count", 1e300), {"key 'count'", "expected a whole number"}},
      {with("/count", 0), {"its count is 0"}},
      {with("/quats", nullptr), {"the key 'quats' is missing"}},
      {with("/scales/codebook/3", nullptr), {"key 'scales.codebook'", "expected 256 values, found 255"}},
      {with("/sh0/codebook/7", "x"), {"key 'sh0.codebook[7]'", "finite number"}},
      {with("/quats/files/0", "../quats.webp"), {"key 'quats.files[0]'", "beside meta.json"}},
      {with("/quats/files/0", "/etc/passwd"), {"key 'quats.files[0]'", "beside meta.json"}},
      {with("/version", 3), {"key 'version'", "unknown SOG version 3"}},
      {with("/means/mins/0", nullptr), {"key 'means.mins'", "expected 3 values, found 2"}},
      {with("/shN/bands", 3), {"shN_centroids.webp", "for a palette of 1024 entries", "degree 3"}},
      {with("/shN/bands", 4), {"key 'shN.bands'"}},
      {with("/shN/count", 65536), {"for a palette of 65536 entries"}},
      {good.dump().substr(0, 7000), {"not valid JSON at line 1, byte 7000"}},
  };
  expect_refused_with(folder / "sog/playbot-lod6", "meta.json", refusals);
}

TEST(SogErrors, UnusualFilesLoad) {
  REQUIRE_FIXTURES(folder);
  const Model good = load_model(folder / "sog/playbot-lod6");
  const Copy copy(folder / "sog/playbot-lod6");
  copy.edit("meta.json", [](json& m) {
    json& book = m["scales"]["codebook"];
    book[0] = nullptr;  // written by old tools
  });
  EXPECT_EQ(load_model(copy.path()).count(), good.count());

  // Flat Gaussians.
  const Copy flat(folder / "sog/playbot-lod6");
  flat.edit("meta.json", [](json& m) { m["model"] = "2dgs"; });
  const Model flattened = load_model(flat.path());
  EXPECT_EQ(flattened.format, "SOG, flat Gaussians of 2DGS");
  for (std::size_t i = 0; i < good.count(); ++i)
    ASSERT_EQ(flattened.scale[i], glm::vec3(good.scale[i].x, good.scale[i].y, 0.0f));

  // A label beyond the palette gives no harmonics.
  copy.write(test::webp(44, 44, std::vector<std::uint8_t>(std::size_t{4} * 44 * 44, 255)), "shN_labels.webp");
  const Model plain = load_model(copy.path());
  const std::size_t values = plain.sh.size() / plain.count();
  for (std::size_t i = 0; i < plain.count(); ++i) {
    EXPECT_EQ(plain.sh[i * values], good.sh[i * values]);
    for (std::size_t k = 3; k < values; ++k) ASSERT_EQ(plain.sh[i * values + k], 0.0f);
  }
  // A quaternion whose fourth byte names no component becomes the identity.
  copy.write(test::webp(44, 44, std::vector<std::uint8_t>(std::size_t{4} * 44 * 44, 0)), "quats.webp");
  EXPECT_EQ(load_model(copy.path()).rotation[17], glm::vec4(1, 0, 0, 0));
}

TEST(Sog, UnusedMetaMayBeNaN) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/playbot-lod6");
  const std::string meta = copy.read("meta.json");
  copy.write(test::replaced(meta, "{", R"({"loss": NaN, "asset2": [-Infinity],)"), "meta.json");
  EXPECT_EQ(load_model(copy.path()).count(), 1873u);
  copy.write(test::replaced(meta, "\"mins\"", R"("mins": [NaN, 0, 0], "unused")"), "meta.json");
  EXPECT_ERROR(load_model(copy.path()), "meta.json, key 'means.mins[0]'", "a finite number");
}

TEST(SogErrors, PictureFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const fs::path sog = folder / "sog/playbot-lod6";
  const std::string small = grey_webp(4, 4);
  const std::vector<std::uint8_t> grey(std::size_t{4} * 44 * 44, 77);
  const std::pair<std::string, std::vector<test::BrokenFile>> of_files[] = {
      {"quats.webp",
       {{small, {"meta.json: quats.webp", "4 x 4 texels do not fit 1873 Gaussians"}},
        {test::webp(44, 44, grey, false), {"lossy compression"}}}},
      {"means_l.webp", {{small, {"means_l.webp has 4 x 4 texels"}}}},
      {"shN_centroids.webp", {{small, {"for a palette of"}}}},
      {"sh0.webp",
       {{"RIFF12345W", {"damaged or cut short"}},
        {"\x89PNG\r\n\x1a\n", {"broken PNG: the file is cut short"}},
        {"GIF89a", {"expected a WebP or PNG picture, but it looks like a text file"}}}}};
  for (const auto& [name, refusals] : of_files) expect_refused_with(sog, name, refusals);
  for (const char* name : {"means_l.webp", "means_u.webp", "quats.webp", "scales.webp", "sh0.webp",
                           "shN_centroids.webp", "shN_labels.webp"}) {
    const Copy copy(sog);
    const std::string bytes = copy.read(name);
    expect_refused_with(sog, name,
                        {{bytes.substr(0, bytes.size() / 2), {"meta.json", "damaged or cut short"}}});
    fs::remove(copy.path() / name);
    EXPECT_ERROR(load_model(copy.path()), "meta.json", name, "is missing");
  }
}

/// Returns the meta.json of a SOG whose image files are all a.webp.
std::string meta_of(int count) {
  json meta = {{"version", 2}, {"count", count}};
  meta["means"] = {{"mins", {0, 0, 0}}, {"maxs", {1, 1, 1}}, {"files", {"a.webp", "a.webp"}}};
  meta["scales"] = {{"codebook", std::vector<float>(256, 0.0f)}, {"files", {"a.webp"}}};
  meta["sh0"] = meta["scales"];
  meta["quats"] = {{"files", {"a.webp"}}};
  return meta.dump();
}

TEST(SogErrors, ExcessiveCounts) {
  const auto padded = [](int width, int height, std::size_t padding) {
    const std::string picture = grey_webp(width, height) + std::string(padding, '\0');
    return test::zipped({{"meta.json", meta_of(width * height)}, {"a.webp", picture}}, true);
  };
  const std::vector<test::BrokenFile> refusals = {
      {padded(2048, 2048, 0), {"m.sog: 4194304 Gaussians are promised"}},
      // The archive entry is padded with zeros, which compress to nearly nothing.
      {padded(2048, 1024, 100000), {"m.sog: 2097152 Gaussians are promised"}},
      {padded(2048, 1024, 3000000), {"m.sog: its file 'a.webp' promises 3000", "at most 2"}}};
  test::expect_no_models("m.sog", refusals);
}

TEST(SogErrors, ExcessiveTotalOfFiles) {
  const test::TempFolder folder;
  json levels = {{"lodLevels", 1}, {"filenames", json::array()}, {"tree", {{"children", json::array()}}}};
  for (int i = 0; i < 2; ++i) {
    const std::string name = std::to_string(i);
    fs::create_directory(folder / name);
    test::write_text(folder / name / "meta.json", meta_of(1024 * 600));
    test::write_text(folder / name / "a.webp", grey_webp(1024, 600) + std::string(3000, '\0'));
    levels["filenames"].push_back(name + "/meta.json");
    const json lod = {{"file", i}, {"offset", 0}, {"count", 1024 * 600}};
    levels["tree"]["children"].push_back(
        {{"bound", {{"min", {0, 0, 0}}, {"max", {1, 1, 1}}}}, {"lods", {{"0", lod}}}});
  }
  test::write_text(folder / "lod-meta.json", levels.dump());
  const std::vector<std::string> parts = {"lod-meta.json: it refers to 1228800 Gaussians",
                                          "too few to hold them"};
  EXPECT_EQ(load_model(folder / "0").count(), 614400u);
  EXPECT_TRUE(test::fails_saying([&] { load_model(folder / "lod-meta.json"); }, parts));
  const LodFiles files(folder / "lod-meta.json");
  const LevelChoice choice = choose_levels(files.chunks(), {}, {});
  const std::vector<std::size_t> none(2, LodFiles::not_read);
  EXPECT_TRUE(
      test::fails_saying([&] { files.read(none, choice, [](const LodFiles::LoadedChunk&) {}); }, parts));
}

TEST(SogErrors, ArchiveFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const std::string good = test::read_text(folder / "sog/playbot-lod6-stored.sog");
  /// Returns the archive with a number replaced in each entry of its table.
  const auto with_each = [](std::string archive, std::size_t at, std::uint32_t number) {
    for (std::size_t entry = archive.find("PK\x01\x02"); entry != std::string::npos;
         entry = archive.find("PK\x01\x02", entry + 4))
      archive = test::patched(archive, entry + at, test::little(number));
    return archive;
  };
  const std::string bomb =
      with_each(test::read_text(folder / "sog/playbot-lod6-deflated.sog"), 24, 0xfffffffe);
  const std::string cut = R"({"version": 2, "count": 5, "means": {"files": ["a", "b"]}})";
  std::vector<test::BrokenFile> refusals = {
      {good.substr(0, good.size() - 10), {"m.sog: the zip archive is damaged or cut short"}},
      {test::patched(good, good.find("PK\x01\x02") + 42, test::little(std::uint32_t{0x7fffffff})), {}},
      {bomb, {"promises 4294967294 bytes, which"}},
      // The compressed size is also forged (found by fuzz_sog_archive).
      {with_each(bomb, 20, 0xf0000000), {"promises 4026531840 compressed bytes in an archive of"}},
      {test::zipped({{"model/meta.txt", "{}"}}), {"without a meta.json", "'model/meta.txt'"}},
      {test::zipped({{"meta.json", "{"}}), {"m.sog: meta.json is not valid JSON"}},
      {test::zipped({{"meta.json", cut}}), {"'quats' is missing"}},
  };
  // Truncation at every boundary, and within each file.
  for (std::size_t at = good.find("PK"); at != std::string::npos; at = good.find("PK", at + 2)) {
    refusals.push_back({good.substr(0, at), {}});
    refusals.push_back({good.substr(0, at + 20), {}});
  }
  for (const std::size_t at : {5000u, 20000u, 40000u, 60000u})
    refusals.push_back({test::patched(good, at, "?!?!"), {"is damaged"}});
  test::expect_no_models("m.sog", refusals);
  // An entry whose name leads out of the archive is harmless, as no file of the model has its name.
  test::ZipEntries files = {{"../../etc/x", "x"}};
  for (const auto& entry : fs::directory_iterator(folder / "sog/playbot-lod6"))
    files.emplace_back(entry.path().filename(), test::read_text(entry.path()));
  EXPECT_EQ(test::load_model_of(test::zipped(files, true), "m.sog").count(), 1873u);
}

TEST(SogErrors, LevelFaultsAreNamed) {
  REQUIRE_FIXTURES(folder);
  const json good = test::load_json(folder / "sog/st-lod/lod-meta.json");
  const auto with = [&](const std::string& pointer, const json& value) {
    return test::with_value(good, pointer, value);
  };
  const std::string leaf = "/tree/children/0/lods/0/",
                    duplicate = "./" + good["filenames"][0].get<std::string>();
  std::string deep = R"({"lodLevels": 1, "filenames": [], "tree": )";
  for (int i = 0; i < 100000; ++i) deep += R"({"children":[)";
  for (int i = 0; i < 100000; ++i) deep += "]}";
  const std::vector<test::BrokenFile> refusals = {
      {with(leaf + "file", 9), {"key 'tree.children[0].lods.0.file'", "there is no file 9"}},
      {with(leaf + "count", -1), {"lods.0.count'", "whole number"}},
      {with(leaf + "offset", 1e10), {"lods.0.offset'", "whole number"}},
      {with(leaf + "count", 506), {"two leaves of the tree share Gaussian 505 of", "0_0/meta.json"}},
      {with("/tree/children/1/children/1/lods/0/count", 249),
       {"Gaussians 752 to 1000 of", "0_0/meta.json", "which has 1000"}},
      {with("/filenames/0", "../0_0/meta.json"), {"key 'filenames[0]'", "must lie below"}},
      {with("/filenames/-", duplicate), {"key 'filenames[", "named twice"}},
      {with("/lodLevels", 1000000), {"key 'lodLevels'", "from 0 to 100"}},
      {with("/lodLevels", 0), {"key 'lodLevels'", "one level at least"}},
      {with("/tree", nullptr), {"the key 'tree' is missing"}},
      {with("/tree/children", nullptr), {"holds no Gaussians (streamed SOG, level 0 of 2)"}},
      {deep + "}", {"nested more than 500 deep"}},
  };
  expect_refused_with(folder / "sog/st-lod", "lod-meta.json", refusals);
}

}  // namespace
}  // namespace binosplat
