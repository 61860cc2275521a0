// render FOLDER --fps N: draws the models of a folder one after the other.

#include "app/scene.h"

namespace binosplat {
namespace {

struct Sequence : SceneTest {
  const std::string frames = folder / "frames";
  const Words common = {"--cameras", folder / "cameras.json", "--mono", "--size", "36x24"};

  Sequence() {
    add_cameras();
    fs::create_directory(frames);
    for (const int n : {1, 2, 10}) save_frame(n);
  }

  Outcome render(const Words& words) const { return run_into_out(joined({"render", frames}, words)); }

  /// Writes a model whose brightness depends on its number.
  void save_frame(int n) const {
    PlyFile file = small_model();
    for (auto& row : file.rows) row[file.column("f_dc_0")] += 0.1 * n;
    write_text(frames + "/f_" + std::to_string(n) + ".ply", to_bytes(file));
  }
};

TEST_F(Sequence, DrawsEachModelAsByItself) {
  ASSERT_TRUE(good(render(joined(common, {"--fps", "10", "--json", folder / "r.json"}))));
  Words order;
  const json report = load_json(folder / "r.json");
  for (const auto& view : report.at("views")) order.push_back(view.at("name"));
  EXPECT_EQ(order, (Words{"f_1.ply", "f_2.ply", "f_10.ply"}));  // sorted by their numbers
  std::vector<Image> pictures;
  for (const char* name : {"f_1", "f_2", "f_10"}) {
    const std::string alone = folder / (std::string(name) + ".png");
    ASSERT_TRUE(good(run_program(joined({"render", frames + "/" + name + ".ply", "-o", alone}, common))));
    pictures.push_back(load_image(out + "/" + name + ".png"));
    EXPECT_EQ(pictures.back().data, load_image(alone).data) << name;
  }
  // Planted fault: the previous model.
  EXPECT_NE(pictures[0].data, pictures[1].data);
  EXPECT_NE(pictures[1].data, pictures[2].data);
}

TEST_F(Sequence, FollowsAPath) {
  json path;
  for (int k = 0; k < 2; ++k) path.push_back(camera_json("p" + std::to_string(k), 0.2 * k));
  EXPECT_TRUE(ended(render({"--path", save("path.json", path), "--fps", "1", "--seconds", "1", "--mono",
                            "--size", "36x24", "-o", out}),
                    0, "3 models and 2 views: the first 2 of both are drawn"));
  EXPECT_TRUE(fs::exists(out + "/f_2.png"));
  EXPECT_FALSE(fs::exists(out + "/f_10.png"));
}

TEST_F(Sequence, IsAVideo) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  ASSERT_TRUE(good(render(joined(common, {"--fps", "10", "-o", folder / "a.mp4"}))));
  const std::string facts = facts_of(folder / "a.mp4");
  EXPECT_TRUE(has(facts, "nb_read_frames=3"));
  EXPECT_TRUE(has(facts, "r_frame_rate=10/1"));
}

TEST_F(Sequence, SaysWhatDoesNotGoTogether) {
  const Words line = joined({"render", frames}, common), moving = joined(line, {"--fps", "10"});
  expect_refused_after(line, {{{}, "is a folder with 3 models. Name one of them, or use --fps"}});
  expect_refused_after(moving, {{{"--resume"}, "--resume is for one model"},
                                {{"-o", folder / "a.png"}, "a.png is one file for 3 views"}});
  expect_refused({{{"--fps", "10"}, "--fps is for videos, --tour, --path and folders"}});
  write_text(frames + "/f_11.ply", "ply");
  EXPECT_TRUE(ended(run_into_out(moving), 2, "f_11.ply"));
  save_frame(11);
  PlyFile flat = small_model();
  flat.columns[flat.column("scale_2")] = "other";
  write_text(frames + "/f_12.ply", to_bytes(flat));
  EXPECT_TRUE(
      ended(run_into_out(moving), 2, "f_12.ply is ply, flat Gaussians of 2DGS, and the models before"));
}

}  // namespace
}  // namespace binosplat
