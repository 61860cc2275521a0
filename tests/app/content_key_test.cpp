// Resumed runs identify their model by all files from which it is read, and by no others.

#include "app/content_key.h"

#include "app/scene.h"
#include "support/gltf.h"

namespace binosplat {
namespace {

/// A glTF file with a camera, and with a buffer in a file whose extension is not a model's.
struct GltfScene : testing::Test {
  const TempFolder folder;
  const std::string model = folder / "m.gltf";
  std::string binary;

  GltfScene() {
    test::Glb glb = test::gltf_of(test::random_model(3, 400, 1));
    glb.root["buffers"][0]["uri"] = "m%C3%B6del.dat";
    binary = glb.binary;
    write_text(model, glb.root.dump());
    write_text(buffer(), binary);
  }
  fs::path buffer() const { return folder / "m\303\266del.dat"; }
};

TEST_F(GltfScene, HasAKeyOfAllThatItIsReadFrom) {
  const std::string key = app::content_key(model);
  EXPECT_EQ(key, app::content_key(folder.path()));
  std::string other = binary;
  ++other[100];
  write_text(buffer(), other);
  EXPECT_NE(app::content_key(model), key);
  write_text(buffer(), binary);
  EXPECT_EQ(app::content_key(model), key);
  // Other files in the folder do not count, whatever their names are.
  for (const char* name : {"other.bin", "other.ply", "meta.json", "a.webp", "b.pt"})
    write_text(folder / name, "not of it");
  fs::create_directories(folder / "out/0");
  write_text(folder / "out/0/meta.json", "what a run wrote below it");
  EXPECT_EQ(app::content_key(model), key);
  const std::string text = read_text(model);
  write_text(model, text + " ");
  EXPECT_NE(app::content_key(model), key);
  // Neither another folder nor another form of the path makes another model.
  const TempFolder elsewhere;
  fs::copy(buffer(), elsewhere.path());
  write_text(elsewhere / "m.gltf", text);
  EXPECT_EQ(app::content_key(elsewhere / "m.gltf"), key);
  EXPECT_EQ(app::content_key(elsewhere.path() / "." / "m.gltf"), key);
  fs::remove(elsewhere / buffer().filename());
  EXPECT_NE(app::content_key(elsewhere / "m.gltf"), key);
}

// Pictures of an independent float64 renderer, for glTF files that were once refused or drawn wrong.
TEST(GltfPictures, AreRight) {
  REQUIRE_FIXTURES(fixtures);
  const fs::path field = fixtures.parent_path() / "broken/field";
  if (!fs::is_directory(field)) GTEST_SKIP() << field << " is not there";
  const std::pair<const char*, const char*> models[] = {
      {"gltf-extensions/hidden", "m.glb"},
      {"gltf-extensions/instancing", "m.glb"},
      {"gltf-accessor-without-view/zeros", "m.glb"},
      {"gltf-turned-harmonics/rx90_4", "m.glb"},
      {"gltf-turned-harmonics/trs_4", "m.glb"},
      {"gltf-uri/space", "m.gltf"},
      {"gltf-uri/umlaut", "m.gltf"},
  };
  const TempFolder folder;
  for (const auto& [name, file] : models) {
    const fs::path of = field / name;
    ASSERT_TRUE(good(run_program(
        {"render", of / file, "--cameras", of / "cameras.json", "--mono", "-o", folder / "p.png"})))
        << name;
    EXPECT_GE(psnr_of_files(of / "expected.png", folder / "p.png"), 60.0) << name;
  }
  const fs::path unknown = field / "gltf-extensions/required_unknown";
  EXPECT_TRUE(ended(run_program({"render", unknown / "m.glb", "--mono", "-o", folder / "p.png"}), 2,
                    "'VENDOR_unknown'"));
  // Planted fault: the picture of another file.
  EXPECT_LT(psnr_of_files(field / models[0].first / "expected.png", field / models[1].first / "expected.png"),
            40.0);
}

}  // namespace
}  // namespace binosplat
