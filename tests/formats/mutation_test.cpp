// Files damaged at random: each loads, or ends with an Error that names it. Crashes and bad reads show under
// the address sanitizer; BINOSPLAT_LONG=1 tries many more.

#include <gtest/gtest.h>

#include <functional>

#include "formats/cameras_file.h"
#include "formats/exr.h"
#include "formats/image_file.h"
#include "formats/model_file.h"
#include "support/errors.h"
#include "support/ply.h"
#include "support/program.h"
#include "support/scenes.h"
#include "support/usd.h"

namespace binosplat {
namespace {

/// Flips, overwrites, cuts, inserts, removes or repeats bytes; or puts a number that is hard to bear in
/// another's place.
std::string damaged(std::string bytes, test::Uniform& uniform) {
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(uniform(0, static_cast<double>(n)));
  };
  for (std::size_t steps = 1 + below(4); steps > 0 && !bytes.empty(); --steps) {
    // Headers are small and worth half of the tries.
    const std::size_t at = below(below(2) == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 1000));
    const std::string hard[] = {
        "0",   "-1", "4294967296", "18446744073709551615", "99999999999",      "1e400",
        "nan", "{}", "[[[",        "\xff\xff\xff\xff",     "\xff\xff\xff\x7f", std::string(4, '\0')};
    const std::string& number = hard[below(12)];
    switch (below(7)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(at, 1, "09-.e \n\r,:\""[below(11)]);
        break;
      case 4:
        bytes.erase(at, 1 + below(8));
        break;
      case 5:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(64)));
        break;
      default: {
        const std::size_t digit = bytes.find_first_of("0123456789", at);
        const std::size_t from = below(2) == 0 && digit != std::string::npos ? digit : at;
        bytes.replace(from, number.size(), number);
      }
    }
  }
  return bytes;
}

void try_damaged(const std::vector<std::string>& files,
                 const std::function<void(const std::filesystem::path&)>& load) {
  const test::TempFolder folder;
  test::Uniform uniform(1);
  int loaded = 0;
  int refused = 0;
  // What is said of each file, thousands of times, is not for the test's log.
  testing::internal::CaptureStderr();
  for (const std::string& file : files) {
    for (int i = 0; i < (test::switched_on("BINOSPLAT_LONG") ? 10000 : 200); ++i) {
      test::write_text(folder / "damaged", damaged(file, uniform));
      try {
        load(folder / "damaged");
        ++loaded;
      } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("damaged"), std::string::npos) << error.what();
        EXPECT_EQ(error.code(), ExitCode::bad_input);
        ++refused;
      } catch (const std::exception& error) {
        ADD_FAILURE() << "not an Error: " << error.what();
      }
    }
  }
  testing::internal::GetCapturedStderr();
  EXPECT_GT(loaded, 0);
  EXPECT_GT(refused, 0);
}

TEST(DamagedFiles, Ply) {
  std::vector<std::string> files;
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    test::PlyFile file = test::inria_file(1, 10);
    file.format = format;
    files.push_back(to_bytes(file));
    file.header_before = "element face 1\nproperty list uchar uchar i\n";
    file.data_before = file.format == "ascii" ? "2 1 1\n" : "\x02\x01\x01";
    files.push_back(to_bytes(file));
  }
  try_damaged(files, [](const auto& path) { load_model(path); });
}

TEST(DamagedFiles, Usd) {
  Model model;
  test::add(model, {1, 2, 3}, glm::vec3(0.1f), 0.5f);
  try_damaged({test::usd_file("def Xform \"World\" (active = true) {\nfloat3 xformOp:rotateXYZ = (1, 2, 3)\n"
                              "uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\"]\n" +
                              test::usd_prim(model) + "}\n")},
              [](const auto& path) { load_model(path); });
}

TEST(DamagedFiles, Cameras) {
  const std::string camera =
      R"({"img_name": "1", "width": 4, "height": 3, "position": [1, 2.5, -3e0], "fx": 5, "fy": 6.5,
          "rotation": [[0, 0, 1], [0, -1, 0], [1, 0, 0]], "cx": 2, "time": 0.5})";
  std::string other = camera;
  other.replace(other.find("\"1\""), 3, "\"2\"");
  try_damaged({"[" + camera + ",\n" + other + "]"}, [](const auto& path) { load_cameras(path); });
}

TEST(DamagedFiles, Pictures) {
  const test::TempFolder folder;
  Picture picture(20, 10);
  for (std::size_t k = 0; k < picture.colour.size(); ++k)
    picture.colour[k] = glm::vec4(0.001f * static_cast<float>(k));
  save_png(folder / "8.png", composite(picture, glm::vec3(0)), {.bits = 8});
  save_png(folder / "16.png", composite(picture, {}), {.bits = 16});
  save_exr(folder / "half.exr", picture, {});
  save_exr(folder / "float.exr", picture, {.half = false, .background = glm::vec3(0)});
  std::vector<std::string> files;
  for (const char* name : {"8.png", "16.png", "half.exr", "float.exr"})
    files.push_back(test::read_text(folder / name));
  try_damaged(files, [](const auto& path) { load_image(path); });
}

}  // namespace
}  // namespace binosplat
