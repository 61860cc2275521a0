// Positions of a SOG's files within an archive, and archives in place of the folders of a streamed SOG.

#include <gtest/gtest.h>

#include "formats/models/streamed_sog.h"
#include "scene/reduce.h"
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
using test::ZipEntries;

/// Returns the files of a folder, with `before` prepended to their names.
ZipEntries files_in(const fs::path& folder, const std::string& before = "") {
  ZipEntries files;
  for (const auto& entry : fs::directory_iterator(folder))
    files.emplace_back(before + entry.path().filename().string(), test::read_text(entry.path()));
  return files;
}

void add(ZipEntries& files, const ZipEntries& more) { files.insert(files.end(), more.begin(), more.end()); }

Model load_archive(const ZipEntries& files, bool deflated = false) {
  return test::load_model_of(test::zipped(files, deflated), "m.sog");
}

TEST(SogArchive, AcceptsSubfolder) {
  REQUIRE_FIXTURES(fixtures);
  const fs::path sog = fixtures / "sog/playbot-lod6";
  const Model whole = load_model(sog);
  for (const char* before : {"", "./", "scene/", "./scene/", "a/b/c d/", "scene\\", ".\\a\\b\\", "/scene/"}) {
    for (const bool deflated : {false, true})
      EXPECT_TRUE(test::equal(load_archive(files_in(sog, before), deflated), whole)) << before;
    // Injected fault: the images are in another folder than meta.json.
    ZipEntries files = files_in(sog, before);
    for (auto& [name, bytes] : files) {
      if (!name.ends_with("json")) name = "other/" + name;
    }
    test::expect_no_models("m.sog",
                           {{test::zipped(files), {"m.sog: there is no file", ".webp' in the archive"}}});
  }
}

TEST(SogArchive, AcceptsOtherFiles) {
  REQUIRE_FIXTURES(fixtures);
  const fs::path sog = fixtures / "sog/playbot-lod6";
  const Model whole = load_model(sog);
  ZipEntries files = {{"__MACOSX/scene/._meta.json", "x"}, {"__MACOSX/meta.json", "x"}, {"read me.txt", "x"}};
  add(files, files_in(sog, "scene/"));
  EXPECT_TRUE(test::equal(load_archive(files), whole));
  // The meta.json with the fewest folders in its path counts, wherever it is in the archive.
  add(files, {{"scene/old/meta.json", "x"}, {"a/b/meta.json", "x"}});
  EXPECT_TRUE(test::equal(load_archive(files), whole));
  files.emplace_back("other/meta.json", "x");
  const std::vector<std::string> said = {"holds several SOG models", "'other/meta.json'",
                                         "'scene/meta.json'"};
  test::expect_no_models("m.sog", {{test::zipped(files), said}});
}

TEST(SogArchive, RequiresExactlyOneModel) {
  const std::vector<test::BrokenFile> refusals = {
      {test::zipped({{"meta.json.txt", "x"}}), {"m.sog is a zip archive without a meta.json"}},
      {test::zipped({{"__MACOSX/meta.json", "x"}}), {"m.sog is a zip archive without a meta.json"}},
      {test::zipped({{"meta.json", "x"}, {"./meta.json", "x"}}), {"m.sog holds several SOG models"}},
      {test::zipped({{"a/meta.json", "x"}, {"a\\meta.json", "x"}}), {"m.sog holds several SOG models"}},
      {test::zipped({{"lod-meta.json", "{}"}, {"0_0/meta.json", "{}"}}), {"holds a streamed SOG", "unpack"}},
  };
  test::expect_no_models("m.sog", refusals);
}

TEST(Checkpoints, ErrorSaysHowToExport) {
  const std::string checkpoint = test::zipped({{"archive/data.pkl", "x"}, {"archive/data/0", "x"}});
  for (const char* file : {"step-000029999.ckpt", "ckpt_29999_rank0.pt"})
    test::expect_no_models(file, {{checkpoint, {file, "checkpoint of PyTorch", "ns-export", "--save-ply"}}});
  // The folder of a trainer that wrote nothing else.
  for (const auto& [before, last] :
       {std::pair("ckpts/ckpt_6999_rank0.pt", "ckpts/ckpt_29999_rank0.pt"),
        std::pair("nerfstudio_models/step-000002000.ckpt", "nerfstudio_models/step-000029999.ckpt"),
        std::pair("config.yml", "ckpt_last.pt")}) {
    const test::TempFolder run;
    for (const char* file : {before, last}) {
      fs::create_directories((run / file).parent_path());
      test::write_text(run / file, checkpoint);
    }
    EXPECT_ERROR(load_model(run.path()), last, "checkpoint of PyTorch", "Export a ply");
    test::write_text(run / "model.ply", "ply\n");
    EXPECT_ERROR(load_model(run.path()), "model.ply");
  }
}

TEST(Checkpoints, CompressionOfGsplatIsNoSog) {
  const json range = {{"shape", {16, 3}}, {"dtype", "float32"}, {"mins", {0, 0, 0}}, {"maxs", {1, 1, 1}}};
  const json meta = {{"means", range}, {"scales", range}, {"opacities", range}, {"sh0", range}};
  test::expect_no_models("meta.json", {{meta.dump(), {"meta.json", "gsplat's compression", "--save-ply"}}});
}

/// Packs the SOG in each folder of a streamed SOG, and replaces the folders by the archives.
void pack(const Copy& copy, const std::string& before) {
  copy.edit("lod-meta.json", [&](json& meta) {
    const auto packed = [&](json& name) {
      const fs::path chunk = copy.path() / fs::path(name.get<std::string>()).parent_path();
      const std::string archive = chunk.filename().string() + ".sog";
      if (fs::exists(chunk)) {
        copy.write(test::zipped(files_in(chunk, before)), archive);
        fs::remove_all(chunk);
      }
      name = archive;
    };
    for (json& name : meta["filenames"]) packed(name);
    if (meta.contains("environment")) packed(meta["environment"]);
  });
}

TEST(StreamedSogArchives, EqualFolders) {
  REQUIRE_FIXTURES(fixtures);
  const Copy folders(fixtures / "sog/st-lod");
  folders.edit("lod-meta.json", [&](json& meta) { meta["environment"] = "around/meta.json"; });
  fs::copy(fixtures / "sog/playbot-lod6", folders.path() / "around");
  for (const char* before : {"", "inside/"}) {
    const Copy archives(folders.path());
    pack(archives, before);
    EXPECT_FALSE(fs::exists(archives.path() / "0_0")) << before;
    for (const int lod : {0, 1}) {
      const Model model = load_model(folders.path(), {.lod = lod});
      EXPECT_TRUE(test::equal(load_model(archives.path(), {.lod = lod}), model)) << before;
      // Injected fault: the other level of detail.
      EXPECT_FALSE(test::equal(load_model(archives.path(), {.lod = 1 - lod}), model)) << before;
    }
    const DetailBudget budget{[](int) { return std::size_t{2500}; }, {}};
    EXPECT_TRUE(test::equal(load_within(archives.path(), budget), load_within(folders.path(), budget)));
    // The same as read while frames are drawn.
    const auto read = [](const fs::path& path) {
      const LodFiles files(path);
      const std::vector<std::size_t> none(files.chunks().size(), LodFiles::not_read);
      Model all = files.environment();
      files.read(none, choose_levels(files.chunks(), {}, {}), [&](const LodFiles::LoadedChunk& loaded) {
        append(all, loaded.model, 0, loaded.model.count());
      });
      return all;
    };
    EXPECT_TRUE(is_streamed_sog(archives.path()));
    EXPECT_TRUE(test::equal(read(archives.path()), read(folders.path()))) << before;
  }
}

TEST(StreamedSogArchives, ReportDamagedArchives) {
  REQUIRE_FIXTURES(fixtures);
  const Copy copy(fixtures / "sog/st-lod");
  pack(copy, "");
  const std::string good = copy.read("0_0.sog");
  const auto with = [&](const std::string& bytes, const std::vector<std::string>& parts) {
    copy.write(bytes, "0_0.sog");
    return test::fails_saying([&] { load_model(copy.path()); }, parts) &&
           test::fails_saying([&] { LodFiles files(copy.path()); }, parts);
  };
  EXPECT_TRUE(with(good.substr(0, good.size() / 2), {"0_0.sog: the zip archive is damaged or cut short"}));
  EXPECT_TRUE(with(test::zipped({{"a", "b"}}), {"0_0.sog is a zip archive without a meta.json"}));
  EXPECT_TRUE(with("\x89PNG\r\n\x1a\n", {"0_0.sog", "it looks like a PNG picture"}));
  fs::remove(copy.path() / "0_0.sog");
  EXPECT_EQ(load_model(copy.path()).count(), 250u);  // the coarser level is there
}

}  // namespace
}  // namespace binosplat
