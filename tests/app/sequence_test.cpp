// render FOLDER --fps N: models of a folder, one after the other.

#include "app/scene.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::has;
using test::Outcome;
using test::Words;
using test::write_text;

struct Sequence : test::SceneTest {
  const std::string frames = folder / "frames";
  const std::string cameras = folder / "cameras.json";
  const Words common = {"--cameras", cameras, "--mono", "--size", "36x24"};

  Sequence() {
    add_cameras();
    std::filesystem::create_directory(frames);
    for (const int n : {1, 2, 10}) save(n);
  }

  Outcome render(Words words, const std::string& scene) const {
    words.insert(words.begin(), {"render", scene});
    return test::run_program(words);
  }
  Outcome render(const Words& words) const { return render(words, frames); }

  /// Of each number another light.
  void save(int n) const {
    test::PlyFile file = test::small_model();
    for (auto& row : file.rows) row[file.column("f_dc_0")] += 0.1 * n;
    write_text(frames + "/f_" + std::to_string(n) + ".ply", to_bytes(file));
  }
};

TEST_F(Sequence, DrawsEachModelAsByItself) {
  ASSERT_TRUE(good(render(joined(common, {"--fps", "10", "-o", out, "--json", folder / "r.json"}))));
  std::vector<std::string> order;
  const nlohmann::json report = test::load_json(folder / "r.json");
  for (const auto& view : report.at("views")) order.push_back(view.at("name"));
  EXPECT_EQ(order, (Words{"f_1.ply", "f_2.ply", "f_10.ply"}));  // by their numbers
  std::vector<Image> pictures;
  for (const char* name : {"f_1", "f_2", "f_10"}) {
    const std::string alone = folder / (std::string(name) + ".png");
    ASSERT_TRUE(good(render(joined(common, {"-o", alone}), frames + "/" + name + ".ply")));
    pictures.push_back(load_image(out + "/" + name + ".png"));
    EXPECT_EQ(pictures.back().data, load_image(alone).data) << name;
  }
  // Planted fault: the model before it.
  EXPECT_NE(pictures[0].data, pictures[1].data);
  EXPECT_NE(pictures[1].data, pictures[2].data);
}

TEST_F(Sequence, FollowsAPath) {
  nlohmann::json path;
  for (int k = 0; k < 2; ++k) path.push_back(test::camera_json("p" + std::to_string(k), 0.2 * k));
  write_text(folder / "path.json", path.dump());
  const auto outcome = render({"--path", folder / "path.json", "--fps", "1", "--seconds", "1", "--mono",
                               "--size", "36x24", "-o", out});
  ASSERT_TRUE(good(outcome));
  EXPECT_TRUE(has(outcome.err, "3 models and 2 views: the first 2 of both are drawn"));
  EXPECT_TRUE(std::filesystem::exists(out + "/f_2.png"));
  EXPECT_FALSE(std::filesystem::exists(out + "/f_10.png"));
}

TEST_F(Sequence, IsAVideo) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  ASSERT_TRUE(good(render(joined(common, {"--fps", "10", "-o", folder / "a.mp4"}))));
  const std::string facts = facts_of(folder / "a.mp4");
  EXPECT_TRUE(has(facts, "nb_read_frames=3"));
  EXPECT_TRUE(has(facts, "r_frame_rate=10/1"));
}

TEST_F(Sequence, SaysWhatDoesNotGoTogether) {
  const auto refused = [&](const Words& words, const std::string& said) {
    return ended(render(joined(common, words)), 2, said);
  };
  EXPECT_TRUE(
      refused({"-o", out}, "is a folder with 3 models; name one of them, or give render or view --fps N"));
  EXPECT_TRUE(refused({"-o", out, "--fps", "10", "--resume"}, "--resume is for one model"));
  EXPECT_TRUE(refused({"-o", folder / "a.png", "--fps", "10"}, "a.png is one file, and 3 views"));
  write_text(frames + "/f_11.ply", "ply");
  EXPECT_TRUE(refused({"-o", out, "--fps", "10"}, "f_11.ply"));
  EXPECT_TRUE(
      ended(render({"--fps", "10", "-o", out}, model), 2, "--fps is for videos, --tour, --path and folders"));
  save(11);
  test::PlyFile flat = test::small_model();
  flat.columns[flat.column("scale_2")] = "other";
  write_text(frames + "/f_12.ply", to_bytes(flat));
  EXPECT_TRUE(
      refused({"-o", out, "--fps", "10"}, "f_12.ply is ply, flat Gaussians of 2DGS, and the models before"));
}

}  // namespace
}  // namespace binosplat
