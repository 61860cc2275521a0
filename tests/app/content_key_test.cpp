// Runs that go on where one ended know the model that they are of: all files that it is read from, no others.

#include "app/content_key.h"

#include <gtest/gtest.h>

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"
#include "support/fixtures.h"
#include "support/gltf.h"
#include "support/models.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::ended;
using test::good;
using test::has;
using test::run_program;
using Arguments = std::vector<std::string>;

/// A glTF with a buffer in a file whose ending is of no model, before a camera.
struct GltfScene : testing::Test {
  const test::TempFolder folder;
  const std::string model = folder / "m.gltf", out = folder / "out";
  std::string binary;

  GltfScene() {
    test::Glb glb = test::gltf_of(test::random_model(3, 400, 1));
    glb.root["buffers"][0]["uri"] = "m%C3%B6del.dat";
    binary = glb.binary;
    test::write_text(model, glb.root.dump());
    test::write_text(buffer(), binary);
  }
  fs::path buffer() const {
    return folder /
           "m\xc3\xb6"
           "del.dat";
  }
};

TEST_F(GltfScene, HasAKeyOfAllThatItIsReadFrom) {
  const std::string key = app::content_key(model);
  EXPECT_EQ(key, app::content_key(folder.path()));
  std::string other = binary;
  ++other[100];
  test::write_text(buffer(), other);
  EXPECT_NE(app::content_key(model), key);
  test::write_text(buffer(), binary);
  EXPECT_EQ(app::content_key(model), key);
  // What lies beside it, whatever it is called.
  for (const char* name : {"other.bin", "other.ply", "meta.json", "a.webp", "b.pt"})
    test::write_text(folder / name, "not of it");
  EXPECT_EQ(app::content_key(model), key);
  const std::string text = test::read_text(model);
  test::write_text(model, text + " ");
  EXPECT_NE(app::content_key(model), key);
  // Another folder makes no other model, nor does the way in which it is named.
  const test::TempFolder elsewhere;
  fs::copy(buffer(), elsewhere.path());
  test::write_text(elsewhere / "m.gltf", text);
  EXPECT_EQ(app::content_key(elsewhere / "m.gltf"), key);
  EXPECT_EQ(app::content_key(elsewhere.path() / "." / "m.gltf"), key);
  fs::remove(elsewhere / buffer().filename());
  EXPECT_NE(app::content_key(elsewhere / "m.gltf"), key);
}

// Also where the folder is one that the model's own is above.
TEST_F(GltfScene, HasLevelsBesideItThatGoOn) {
  const Arguments line = {"levels", model, "-o", out, "--leaf", "64", "--levels", "2"};
  ASSERT_TRUE(good(run_program(line)));
  const std::string meta = test::read_text(out + "/lod-meta.json");
  fs::remove(out + "/lod-meta.json");  // as if it had been ended before
  const test::Outcome again = run_program(line);
  ASSERT_TRUE(good(again));
  EXPECT_TRUE(has(again.err, "SOGs were in"));
  EXPECT_EQ(test::read_text(out + "/lod-meta.json"), meta);
}

// Pictures by an independent renderer in float64, of glTF files that once were refused or drawn wrong.
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
  const test::TempFolder folder;
  for (const auto& [name, file] : models) {
    const fs::path of = field / name;
    ASSERT_TRUE(good(run_program(
        {"render", of / file, "--cameras", of / "cameras.json", "--mono", "-o", folder / "p.png"})))
        << name;
    const double psnr = measure::psnr(load_image(of / "expected.png"), load_image(folder / "p.png"));
    EXPECT_GE(psnr, 60.0) << name;
  }
  const fs::path unknown = field / "gltf-extensions/required_unknown";
  EXPECT_TRUE(ended(run_program({"render", unknown / "m.glb", "--mono", "-o", folder / "p.png"}), 2,
                    "'VENDOR_unknown'"));
  // Planted fault: another file's picture.
  EXPECT_LT(measure::psnr(load_image(field / models[0].first / "expected.png"),
                          load_image(field / models[1].first / "expected.png")),
            40.0);
}

}  // namespace
}  // namespace binosplat
