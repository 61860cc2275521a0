#include "formats/containers/complete_files.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "formats/pictures/exr.h"
#include "formats/pictures/image_file.h"
#include "support/broken.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::write_text;

/// Returns a picture of noise, which no format compresses well.
Picture noise_picture() {
  Picture picture(61, 45);
  Random random(1);
  for (glm::vec4& colour : picture.colour) {
    for (int c = 0; c < 4; ++c) colour[c] = static_cast<float>(random.uniform(0.0, 1.0));
  }
  return picture;
}

struct CompleteFiles : testing::Test {
  /// Expects that the file is whole, and that truncated copies and a copy of zeros are not.
  void expect_whole(const std::string& name) const {
    const fs::path file = folder / name, cut = folder / ("cut_" + name);
    EXPECT_TRUE(is_complete(file)) << name;
    const std::string bytes = read_text(file);
    for (const std::size_t left : {std::size_t{0}, std::size_t{1}, std::size_t{8}, std::size_t{20},
                                   std::size_t{100}, bytes.size() / 2, bytes.size() - 12, bytes.size() - 1}) {
      write_text(cut, bytes.substr(0, left));
      EXPECT_FALSE(is_complete(cut)) << name << " of " << left << " bytes";
    }
    write_text(cut, std::string(bytes.size(), '\0'));
    EXPECT_FALSE(is_complete(cut)) << name << " of zeros";
  }

  test::TempFolder folder;
};

TEST_F(CompleteFiles, OwnPictures) {
  const Picture picture = noise_picture();
  save_png(folder / "8.png", composite(picture, glm::vec3(0.0f)));
  save_png(folder / "16.png", composite(picture, std::nullopt),
           {.bits = 16, .notes = {{"Software", "test"}}});
  save_exr(folder / "half.exr", picture, {.half = true});
  save_exr(folder / "float.exr", picture, {.half = false, .background = std::nullopt});
  save_exr(folder / "both.exr", picture, picture, {});
  save_exr(folder / "zip.exr", picture, {.compression = ExrCompression::zip});
  save_exr(folder / "none.exr", picture, {.compression = ExrCompression::none});
  for (const char* name : {"8.png", "16.png", "half.exr", "float.exr", "both.exr", "zip.exr", "none.exr"})
    expect_whole(name);

  const std::string bytes = read_text(folder / "8.png");
  write_text(folder / "changed.png", test::patched(bytes, bytes.size() / 2, "flip"));
  EXPECT_FALSE(is_complete(folder / "changed.png"));
  write_text(folder / "zeros.png", bytes.substr(0, bytes.size() / 2) + std::string(bytes.size() / 2, '\0'));
  EXPECT_FALSE(is_complete(folder / "zeros.png"));
}

TEST_F(CompleteFiles, JsonAndSog) {
  write_text(folder / "a.json", R"({"list": [1, 2, 3]})");
  EXPECT_TRUE(is_complete(folder / "a.json"));
  write_text(folder / "a.json", R"({"list": [1, 2, 3])");
  EXPECT_FALSE(is_complete(folder / "a.json"));
  EXPECT_FALSE(is_complete(folder / "none.json"));
  EXPECT_FALSE(is_complete(folder.path()));
  write_text(folder / "a.txt", "words");
  EXPECT_FALSE(is_complete(folder / "a.txt"));

  std::vector<std::uint8_t> texels(17 * 9 * 4);
  for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = static_cast<std::uint8_t>(i * i * 37 / 5);
  write_text(folder / "a.webp", test::webp(17, 9, texels));
  expect_whole("a.webp");
  write_text(folder / "meta.json", R"({"means": {"files": ["a.webp", "b.webp"]}, "count": 3})");
  EXPECT_FALSE(is_whole_sog(folder / "meta.json")) << "b.webp is missing";
  fs::copy(folder / "a.webp", folder / "b.webp");
  EXPECT_TRUE(is_whole_sog(folder / "meta.json"));
  fs::resize_file(folder / "b.webp", fs::file_size(folder / "b.webp") - 1);
  EXPECT_FALSE(is_whole_sog(folder / "meta.json"));
  fs::resize_file(folder / "meta.json", 20);
  EXPECT_FALSE(is_whole_sog(folder / "meta.json"));
}

}  // namespace
}  // namespace binosplat
