// Files of other programs: photos of many kinds, cameras in glTF, a model packed with gzip, a single camera.

#include <cstring>

#include "app/scene.h"
#include "support/gltf.h"
#include "support/load.h"

namespace binosplat {
namespace {

struct ForeignFiles : SceneTest {
  const Words size = {"--size", "72x48", "--mono", "-o", folder / "a.png"};
};

TEST_F(ForeignFiles, PhotosOfManyKindsAreAccepted) {
  add_cameras();
  fs::create_directories(folder / "photos");
  const Words compared = {"--view", "front", "--mono", "--photos", folder / "photos"};
  const auto with = [&](const std::string& name, const std::string& bytes) {
    write_text(folder / "photos" / name, bytes);
    const Outcome result = render(compared);
    fs::remove(folder / "photos" / name);
    return result;
  };
  EXPECT_TRUE(ended(render(compared), 2, "no photo"));
  EXPECT_TRUE(good(with("front.Png", png_bytes(Image(72, 48, 3)))));
  EXPECT_TRUE(
      ended(with("front.webp", test::webp(72, 48, std::vector<std::uint8_t>(std::size_t{4} * 72 * 48, 9))), 2,
            "front.webp is not a picture that can be read"));
  EXPECT_TRUE(ended(with("front.HEIC", std::string("\0\0\0\x18"
                                                   "ftypheic",
                                                   12)),
                    2, "a HEIF or AVIF picture"));
}

TEST_F(ForeignFiles, GltfCameraEqualsJsonCamera) {
  Model dots;
  for (int i = 0; i < 50; ++i)
    test::add(dots,
              {0.05f * static_cast<float>(i % 7 - 3), 0.03f * static_cast<float>(i % 5),
               3.0f + 0.1f * static_cast<float>(i % 3)},
              glm::vec3(0.05f), 0.9f, {0.1f * static_cast<float>(i % 9), 0.5f, 0.9f});
  test::Glb glb = test::gltf_of(dots);
  glb.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"aspectRatio", 1.5}}}}};
  glb.root["nodes"].push_back(
      {{"name", "Shot"}, {"camera", 0}, {"translation", {0.2, 0.1, 0}}, {"rotation", {0, 1, 0, 0}}});
  glb.root["scenes"][0]["nodes"] = {0, 1};
  const std::string file = folder / "a.glb";
  write_text(file, glb.bytes());
  ASSERT_TRUE(good(run_program(joined({"render", file}, size))));
  const Image drawn = load_image(folder / "a.png");
  nlohmann::json camera = camera_json("b", -0.2);
  camera["position"][1] = -0.1;
  camera["fx"] = camera["fy"] = 24 / std::tan(0.3);
  save("b.json", nlohmann::json::array({camera}));
  ASSERT_TRUE(good(run_program(joined({"render", file, "--cameras", folder / "b.json"}, size))));
  EXPECT_GT(measure::psnr(drawn, load_image(folder / "a.png")), 90.0);
  ASSERT_TRUE(good(run_program(joined({"render", file, "--cameras", file, "--view", "Shot"}, size))));
  EXPECT_EQ(load_image(folder / "a.png").data, drawn.data);
  camera["position"][0] = 0.2;  // injected: the format's x is not the world's
  save("b.json", nlohmann::json::array({camera}));
  ASSERT_TRUE(good(run_program(joined({"render", file, "--cameras", folder / "b.json"}, size))));
  EXPECT_LT(measure::psnr(drawn, load_image(folder / "a.png")), 40.0);
}

TEST_F(ForeignFiles, RejectsGzippedPlyAndSingleCamera) {
  write_text(folder / "m.ply.gz", test::gzipped(read_text(model)));
  EXPECT_TRUE(
      ended(run_program({"info", folder / "m.ply.gz"}), 2, "looks like a ply file; unpack it (gunzip)"));
  nlohmann::json away = camera_json("a", 0.0);
  away["position"] = {0.0, 0.0, 9.0};
  save("cameras.json", nlohmann::json::array({away}));
  EXPECT_TRUE(
      has(checked(render(size)).err, "cameras.json: its camera does not see the model (--view a draws one)"));
}

// A disc of 2D Gaussian Splatting, turned by 60 degrees about y, 4 units away: z = 4 / (1 + tan(60) x / z).
TEST_F(ForeignFiles, FlatGaussianHasPlaneDepth) {
  test::PlyFile disc;
  disc.columns = {"x",       "y",       "z",     "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
                  "scale_0", "scale_1", "rot_0", "rot_1",  "rot_2",  "rot_3"};
  disc.rows = {{0, 0, 4, 1, 0, -1, 7, std::log(0.8), std::log(0.8), std::sqrt(0.75), 0, 0.5, 0}};
  write_text(model, to_bytes(disc));
  save("cameras.json", nlohmann::json::array({camera_json("front", 0.0)}));
  const auto farthest_off = [&](const Words& more, double tangent) {
    EXPECT_TRUE(good(render(joined({"--mono", "--exr", "float", "--exr-compression", "none", "--background",
                                    "none", "-o", folder / "z.exr"},
                                   more))));
    const std::string file = read_text(folder / "z.exr");
    // The file ends with 48 rows, each with eight bytes, then A, B, G, R and Z of 72 px.
    const std::size_t row = 8 + 5 * 72 * sizeof(float), rows = file.size() - 48 * row;
    double off = 0.0, nearest = INFINITY, farthest = 0.0;
    for (std::size_t y = 0; y < 48; ++y) {
      for (std::size_t x = 0; x < 72; ++x) {
        float z = 0.0f;
        std::memcpy(&z, &file[rows + y * row + 8 + (4 * 72 + x) * sizeof(float)], sizeof(float));
        if (std::isinf(z)) continue;
        const double slope = (static_cast<double>(x) + 0.5 - 36.0) / 60.0;
        off = std::max(off, std::abs(z - 4.0 / (1.0 + tangent * slope)));
        nearest = std::min<double>(nearest, z);
        farthest = std::max<double>(farthest, z);
      }
    }
    if (tangent != 0.0) {
      EXPECT_LT(nearest, 3.43);
      EXPECT_GT(farthest, 4.72);
    }
    return off;
  };
  for (const Words& more : {Words{}, Words{"--exr-depth", "median"}, Words{"--projection", "tangent"}}) {
    EXPECT_LT(farthest_off(more, std::sqrt(3.0)), 1e-4);
    EXPECT_GT(farthest_off(more, 0.0), 0.5) << "the depth of the mean goes unnoticed";
  }
}

}  // namespace
}  // namespace binosplat
