// files_of_model() lists the files that a model is read from: all of them are needed, and no other is.

#include "formats/models/files_of_model.h"

#include <gtest/gtest.h>

#include "support/fixtures.h"
#include "support/gltf.h"
#include "support/models.h"
#include "support/scaffold_files.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using FileNames = std::set<std::string>;

/// Returns the model's files, relative to `folder`.
FileNames names_of_files(const fs::path& path, const fs::path& folder) {
  FileNames names;
  for (const fs::path& file : files_of_model(path)) names.insert(file.lexically_relative(folder).string());
  return names;
}

/// Succeeds if the model in `folder` is read from exactly these files.
testing::AssertionResult is_read_from(const fs::path& folder, const std::string& model,
                                      const FileNames& expected) {
  const fs::path path = model.empty() ? folder : folder / model;
  const FileNames names = names_of_files(path, folder);
  if (names != expected)
    return testing::AssertionFailure() << "others are told: " << testing::PrintToString(names);
  const Model whole = load_model(path);
  const test::TempFolder copies;
  for (const std::string& name : names) {
    fs::create_directories((copies / name).parent_path());
    fs::copy(folder / name, copies / name);
  }
  const fs::path copy = model.empty() ? copies.path() : copies / model;
  if (load_model(copy).position != whole.position) return testing::AssertionFailure() << "another model";
  for (const std::string& name : names) {
    fs::rename(copies / name, copies / "away");
    try {
      load_model(copy);
      return testing::AssertionFailure() << "it is read without " << name << ", too";
    } catch (const Error&) {
    }
    fs::rename(copies / "away", copies / name);
  }
  return testing::AssertionSuccess();
}

TEST(FilesOfModel, SingleFile) {
  const test::TempFolder folder;
  test::write_text(folder / "m.glb", test::gltf_of(test::random_model(1, 5, 0)).bytes());
  test::write_text(folder / "other.bin", "not of it");
  test::write_text(folder / "color_mlp.pt", "not of it");
  EXPECT_TRUE(is_read_from(folder.path(), "m.glb", {"m.glb"}));
  // The folder stands for m.glb.
  EXPECT_EQ(files_of_model(folder.path()), files_of_model(folder / "m.glb"));
  EXPECT_ERROR(files_of_model(folder / "none.glb"), "none.glb");
  test::write_text(folder / "broken.gltf", "{\"asset\": 1, \"buffers\"");
  EXPECT_ERROR(files_of_model(folder / "broken.gltf"), "not valid JSON");
}

TEST(FilesOfModel, GltfIncludesBuffers) {
  const test::TempFolder folder;
  test::Glb glb = test::gltf_of(test::random_model(2, 5, 0));
  const std::size_t half = glb.root["bufferViews"][2]["byteOffset"];
  for (std::size_t i = 2; i < glb.root["bufferViews"].size(); ++i) {
    nlohmann::json& view = glb.root["bufferViews"][i];
    view["byteOffset"] = view["byteOffset"].get<std::size_t>() - half;
    view["buffer"] = 1;
  }
  glb.root["buffers"] = {{{"uri", "my%20model.dat"}, {"byteLength", half}},
                         {{"uri", "sub/second"}, {"byteLength", glb.binary.size() - half}}};
  fs::create_directory(folder / "sub");
  test::write_text(folder / "my model.dat", glb.binary.substr(0, half));
  test::write_text(folder / "sub/second", glb.binary.substr(half));
  test::write_text(folder / "sub/third.bin", "not of it");
  test::write_text(folder / "other.ply", "not of it");
  test::write_text(folder / "m.gltf", glb.root.dump());
  EXPECT_TRUE(is_read_from(folder.path(), "m.gltf", {"m.gltf", "my model.dat", "sub/second"}));
  // Neither data in the JSON nor a missing buffer that no view uses is listed.
  glb.root["buffers"].push_back({{"uri", "data:,abc"}, {"byteLength", 3}});
  glb.root["buffers"].push_back({{"uri", "missing.bin"}, {"byteLength", 3}});
  test::write_text(folder / "m.gltf", glb.root.dump());
  EXPECT_TRUE(is_read_from(folder.path(), "m.gltf", {"m.gltf", "my model.dat", "sub/second"}));
}

TEST(FilesOfModel, SogIncludesPictures) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  fs::copy(fixtures / "sog/st-lod/0_0", folder.path());
  for (const char* other : {"notes.webp", "other.ply"}) test::write_text(folder / other, "not of it");
  const FileNames names = {"meta.json",   "means_l.webp", "means_u.webp",       "quats.webp",
                           "scales.webp", "sh0.webp",     "shN_centroids.webp", "shN_labels.webp"};
  EXPECT_TRUE(is_read_from(folder.path(), "meta.json", names));
  EXPECT_EQ(names_of_files(folder.path(), folder.path()), names);
}

TEST(FilesOfModel, SogStreamIncludesAllLevels) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  fs::copy(fixtures / "sog/st-lod", folder.path(), fs::copy_options::recursive);
  for (const char* other : {"0_0/notes.webp", "meta.webp"}) test::write_text(folder / other, "not of it");
  fs::copy(folder / "0_0", folder / "2_0");  // a folder that no level uses
  FileNames names = {"lod-meta.json"};
  for (const char* level : {"0_0/", "1_0/"}) {
    for (const char* name : {"meta.json", "means_l.webp", "means_u.webp", "quats.webp", "scales.webp",
                             "sh0.webp", "shN_centroids.webp", "shN_labels.webp"})
      names.insert(std::string(level) + name);
  }
  EXPECT_EQ(names_of_files(folder.path(), folder.path()), names);
  EXPECT_EQ(names_of_files(folder / "lod-meta.json", folder.path()), names);
  // A missing level, as while it is still downloaded, is not listed.
  fs::remove_all(folder / "0_0");
  std::erase_if(names, [](const std::string& name) { return name.starts_with("0_0/"); });
  EXPECT_TRUE(is_read_from(folder.path(), "", names));
}

TEST(FilesOfModel, ScaffoldIncludesNetworks) {
  const test::TempFolder folder;
  const fs::path latest = folder / "point_cloud/iteration_20";
  for (const fs::path& of : {folder / "point_cloud/iteration_7", latest}) {
    fs::create_directories(of);
    test::write_scaffold(of, test::random_scaffold(1, {.anchors = 20, .appearances = 3}));
  }
  test::write_text(latest / "optimizer.pt", "not of it");
  EXPECT_TRUE(is_read_from(
      latest, "point_cloud.ply",
      {"point_cloud.ply", "opacity_mlp.pt", "cov_mlp.pt", "color_mlp.pt", "embedding_appearance.pt"}));
  EXPECT_EQ(files_of_model(folder.path()), files_of_model(latest / "point_cloud.ply"));
}

}  // namespace
}  // namespace binosplat
