// The first picture of a model without cameras, or with cameras that do not see it, as `render FILE` draws
// it.

#include "app/scene.h"
#include "formats/pictures/image_file.h"

namespace binosplat {
namespace {

struct DefaultCamera : SceneTest {
  const Words into_out = {"-o", out};

  DefaultCamera() { save_ply(model, ball()); }

  /// A ball of 1,500 Gaussians with a radius of 1 around the origin.
  static Model ball() {
    Model made;
    for (int i = 0; i < 1500; ++i) {
      const double y = 1.0 - 2.0 * (i + 0.5) / 1500, ring = std::sqrt(1.0 - y * y), turn = 2.399963 * i;
      test::add(made, glm::dvec3(ring * std::cos(turn), y, ring * std::sin(turn)), glm::vec3(0.05f), 0.9f,
                {i % 2 == 0 ? 0.9f : 0.2f, 0.5f, 0.2f});
    }
    return made;
  }

  std::string said(const Words& words, const char* size = "72x48") const {
    return checked(render(joined(joined(into_out, {"--size", size}), words))).err;
  }

  /// Returns the alpha of a picture, from 0 to 1, in its middle and the largest on its border.
  std::pair<float, float> alpha(const std::string& name) const {
    const Image image = load_image(fs::path(out) / name);
    EXPECT_EQ(image.channels, 4);
    float border = 0.0f;
    const auto at = [&](int x, int y) { return image.at(x, y, 3); };
    for (int x = 0; x < image.width; ++x) border = std::max({border, at(x, 0), at(x, image.height - 1)});
    for (int y = 0; y < image.height; ++y) border = std::max({border, at(0, y), at(image.width - 1, y)});
    return {at(image.width / 2, image.height / 2), border};
  }
};

TEST_F(DefaultCamera, ObjectIsWholeInBothEyes) {
  for (const char* size : {"144x96", "80x160"}) {
    fs::remove_all(out);
    said({"--background", "none"}, size);
    for (const char* eye : {"framed_left.png", "framed_right.png"}) {
      const auto [middle, border] = alpha(eye);
      EXPECT_GT(middle, 0.9f) << size << " " << eye;
      EXPECT_LT(border, 0.1f) << size << " " << eye;
    }
  }
  // Injected fault: a camera that is too near.
  fs::remove_all(out);
  said({"--background", "none", "--mono", "--eye", "0,0,-1.3", "--at", "0,0,0"});
  EXPECT_GT(alpha(fs::directory_iterator(out)->path().filename()).second, 0.1f);
}

TEST_F(DefaultCamera, FrameOptionShowsAllOrCentre) {
  const auto distance = [&](const Words& words) {
    const json eye = reported(joined({"--size", "72x48", "--mono"}, words))["views"][0]["eyes"][0];
    const auto at = eye["position"].get<std::vector<double>>();
    return std::hypot(at[0], at[1], at[2]);
  };
  add_cameras();
  const double all = distance({"--frame", "all"}), middle = distance({"--frame", "middle"});
  EXPECT_GT(all, 2.0);
  EXPECT_NE(all, middle);
  EXPECT_TRUE(ended(render({"--frame", "all", "--view", "front"}), 2, "--frame with --view"));
  EXPECT_TRUE(ended(render({"--frame", "half"}), 2, "all"));
}

TEST_F(DefaultCamera, ReplacesCamerasThatMissModel) {
  json away = {camera_json("a", 0.0), camera_json("b", 0.3)};
  for (json& camera : away) camera["position"] = {0.0, 0.0, 5.0};
  save("cameras.json", away);
  const std::string text = said({"--background", "none"});
  EXPECT_TRUE(has(text, "cameras.json: none of its 2 cameras sees the model (--view a draws one)"));
  EXPECT_TRUE(has(text, "the whole of it, from outside"));
  EXPECT_GT(alpha("framed_left.png").first, 0.9f);
  // Who asks for such a camera gets it.
  EXPECT_TRUE(has(said({"--view", "a"}), "the pictures are empty: view a looks away from the model"));
  // One camera that sees it is enough.
  away[1]["position"] = {0.0, 0.0, -5.0};
  save("cameras.json", away);
  EXPECT_FALSE(has(said({}), "none of its"));
}

TEST_F(DefaultCamera, MovesOutOfOpaqueModel) {
  Model solid = ball();
  for (int i = 0; i < 200; ++i)
    test::add(solid, {0.001f * static_cast<float>(i), 0, 0}, glm::vec3(0.3f), 0.99f);
  save_ply(model, solid);
  save("cameras.json", json::array({camera_json("within", 0.0)}));
  said({"--background", "none"});
  EXPECT_LT(alpha("framed_left.png").second, 0.1f);
  EXPECT_EQ(said({"--view", "within"}).find("one camera for"), std::string::npos) << "it was asked for";
}

TEST_F(DefaultCamera, ExplainsUniformPicture) {
  Model fog;
  for (int i = 0; i < 50; ++i) test::add(fog, glm::vec3(0.0f), glm::vec3(2.0f), 0.99f);
  save_ply(model, fog);
  const char* why = "the pictures have one colour: the camera stands within Gaussians";
  EXPECT_TRUE(has(said({"--eye", "0,0,-0.5", "--at", "0,0,0"}), why));
  EXPECT_FALSE(has(said({"--eye", "0,0,-30", "--at", "0,0,0"}), why));
}

TEST_F(DefaultCamera, EyeDistanceIsComfortable) {
  Model near = ball();
  for (glm::vec3& p : near.position) p *= 0.3f;
  save_ply(model, near);
  const std::string text = said({});
  EXPECT_TRUE(has(text, "for comfort (--ipd 63mm: as a head sees it)"));
  EXPECT_FALSE(has(text, "tire most eyes"));
  EXPECT_TRUE(has(said({"--ipd", "63mm"}), "tire most eyes")) << "the way back";
  json camera = camera_json("front", 0.0);
  camera["position"] = {0.0, 0.0, -1.0};
  EXPECT_LT(reported({"--size", "72x48"})["views"][0]["ipd_metres"], 0.063);
  save("cameras.json", json::array({camera}));
  EXPECT_DOUBLE_EQ(reported({"--size", "72x48"})["views"][0]["ipd_metres"], 0.063)
      << "a camera of the user's";
}

}  // namespace
}  // namespace binosplat
