// Cases that every sub-command must handle: empty arguments, outputs that are inputs, full disks, unusual
// names.

#include "app/scene.h"

namespace binosplat {
namespace {

struct EdgeCases : SceneTest {
  EdgeCases() { add_cameras(); }
  const Words one = {"--view", "front", "--mono", "--size", "36x24"};
};

TEST_F(EdgeCases, RejectsEmptyArguments) {
  EXPECT_TRUE(ended(run_program({"compare", model, model, "--min-psnr", ""}), 2,
                    "--min-psnr '': its value is empty"));
  EXPECT_TRUE(ended(run_program({"compare", model, ""}), 2, "argument 3 is empty"));
  EXPECT_TRUE(ended(render({"-o", ""}), 2, "-o '': its value is empty"));
  EXPECT_TRUE(ended(run_program({"view", ""}), 2, "argument 2 is empty"));
}

TEST_F(EdgeCases, InputsAreNeverOverwritten) {
  const std::string cameras = folder / "cameras.json", a = folder / "a.png", b = folder / "b.png",
                    photos = folder / "images";
  ASSERT_TRUE(good(render(joined(one, {"-o", a}))));
  fs::copy(a, b);
  fs::create_symlink(model, folder / "link.ply");
  fs::create_hard_link(model, folder / "link.spz");
  fs::create_directories(photos);
  fs::copy(a, photos + "/front.png");
  const std::string ply = folder / "trained/point_cloud/iteration_7/point_cloud.ply";
  fs::create_directories(fs::path(ply).parent_path());
  fs::copy(model, ply);
  const std::vector<Words> cases = {
      {"calibrate", model, "-o", model, "--quality", "40"},
      {"calibrate", model, "-o", folder / "link.ply", "--quality", "40"},
      {"render", model, "--json", model, "-o", out},
      {"render", model, "--json", cameras, "-o", out},  // found in the model's folder
      {"render", model, "--cameras", cameras, "--json", cameras, "-o", out},
      joined(joined({"render", model}, one), {"--photos", photos, "-o", photos}),
      joined(joined({"render", model}, one), {"--photos", "beside", "-o", photos}),
      {"convert", model, "-o", model},
      {"convert", model, "-o", folder / "link.spz"},
      {"convert", folder / "trained", "-o", ply},
      {"info", model, "--json", model},
      {"compare", a, b, "--difference", a},
      {"compare", a, b, "--json", b},
  };
  const auto contents = [&] {
    auto all = contents_of(folder.path());
    std::erase_if(all, [](const auto& file) { return file.first.starts_with("out/"); });
    return all;
  };
  const auto before = contents();
  for (const Words& words : cases) {
    EXPECT_TRUE(ended(run_program(words), 2, "it is an input of this run")) << words[0];
    EXPECT_TRUE(contents() == before) << words[0];
  }
  // A run may overwrite its own outputs.
  EXPECT_TRUE(good(render(joined(one, {"-o", a}))));
}

TEST_F(EdgeCases, OutputsAreDistinctFiles) {
  fs::create_symlink(folder / "q.png", folder / "link.png");
  fs::create_directory_symlink(folder.path(), folder / "here");
  const std::string q = folder / "q.png";
  const auto one_view = [&](const std::string& output, const std::string& json, const Words& more = {}) {
    return render(joined(joined(one, {"-o", output, "--json", json}), more));
  };
  for (const char* same : {"q.png", "./q.png", "here/q.png", "link.png", "photos/../q.png"})
    EXPECT_TRUE(ended(one_view(q, folder / same), 2, "--output writes the same file")) << same;
  EXPECT_TRUE(ended(one_view(folder.path(), folder / "front.png"), 2, "it is the picture of front"));
  EXPECT_TRUE(ended(one_view(q, folder / "q.exr", {"--exr", "half"}), 2, "it is the picture of front"));
  EXPECT_TRUE(ended(run_program({"convert", model, "-o", folder / "a.sog", "--json", folder / "./a.sog"}), 2,
                    "--output writes the same file"));
  EXPECT_FALSE(fs::exists(q));
  EXPECT_TRUE(good(one_view(q, folder / "q.json"))) << "injected: others are not one file";
  EXPECT_TRUE(ended(run_program({"compare", q, q, "--difference", folder / "d", "--json", folder / "./d"}), 2,
                    "--json writes the same file"));
}

// A wide picture whose tiles list so many Gaussians that llvmpipe ends the loops of its own blend early.
TEST_F(EdgeCases, LongTileListsDrawEqualPictures) {
  const auto drawn = [&](const char* tiles) {
    const std::string file = folder / (std::string(tiles) + ".png");
    EXPECT_TRUE(good(run_program({"render",
                                  "demo:room",
                                  "--size",
                                  "160x67",
                                  "--projection",
                                  "tangent",
                                  "--mono",
                                  "--near",
                                  "0.001",
                                  "--eps2d",
                                  "0.1",
                                  "--eye",
                                  "-1.503,-1.246,-2.901",
                                  "--at",
                                  "-0.495,-0.834,2.578",
                                  "--fov",
                                  "170",
                                  "--tiles",
                                  tiles,
                                  "-o",
                                  file})));
    return load_image(file).data;
  };
  EXPECT_EQ(drawn("ellipse"), drawn("snug"));
}

TEST_F(EdgeCases, ReportsCyclicLinks) {
  fs::create_symlink(folder / "b", folder / "a");
  fs::create_symlink(folder / "a", folder / "b");
  fs::create_symlink(folder / "nowhere", folder / "dangling");
  for (const char* to : {"a", "dangling/deeper"}) {
    for (const Words& line : {Words{"levels", model}, {"bench", model}, {"render", model, "--resume"}})
      EXPECT_TRUE(ended(run_program(joined(line, {"-o", folder / to})), 2, "symbolic link")) << to;
  }
  fs::create_symlink(folder / "c.png", folder / "c.png");
  EXPECT_TRUE(ended(render({"--mono", "-o", folder / "c.png"}), 2, "lead in a circle"));
}

TEST_F(EdgeCases, EveryViewHasUniqueFile) {
  json cameras;
  for (const char* name :
       {"a_left", "a_right", "a", "a.jpg", "a_2", "a.png", "A", "b/c", "b_c", "b_c_2", ".", ".."})
    cameras.push_back(camera_json(name, 0.1 * static_cast<double>(cameras.size())));
  save("cameras.json", cameras);
  const auto files = [&](const Words& words) {
    fs::remove_all(out);
    EXPECT_TRUE(good(render(joined(words, {"--view", "all"}))));
    return std::distance(fs::directory_iterator(out), {});
  };
  EXPECT_EQ(files({}), 2 * 11) << "the first two are a pair";
  EXPECT_EQ(files({"--mono"}), 12);
}

TEST_F(EdgeCases, FullStandardOutputIsError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string run =
      std::string(BINOSPLAT_PROGRAM) + " info " + model + " > /dev/full 2> " + (folder / "err").string();
  EXPECT_EQ(WEXITSTATUS(std::system(run.c_str())), 2);
  EXPECT_TRUE(has(read_text(folder / "err"), "cannot write to standard output: No space left"));
}

// binosplat and the driver store compiled shaders in separate cache folders.
TEST_F(EdgeCases, ShaderCachesUseSeparateFolders) {
  const TempFolder here, home, mesa;
  // Tests binosplat's own cache. Mesa's cache has a separate folder if `mesas_own`.
  const auto draw = [&](const std::string& caches, bool mesas_own = true) {
    std::map<std::string, std::string> variables = {{"HOME", home.path()}, {"XDG_CACHE_HOME", caches}};
    if (mesas_own)
      variables.insert(
          {{"MESA_SHADER_CACHE_DISABLE", "false"}, {"MESA_SHADER_CACHE_DIR", mesa.path().string()}});
    return checked(render(one, {.folder = here.path(), .variables = variables})).err;
  };
  const char* const full = "the disk is full; drivers cache no shaders there";
  EXPECT_TRUE(has(draw("/proc"), full));
  // Below a file nothing can be written. The program says so once, and the driver does not.
  write_text(here / "file", "");
  const std::string said = draw(here / "file/caches", false);
  EXPECT_TRUE(has(said, "file: nothing can be written there; drivers cache no shaders there in this run"));
  EXPECT_FALSE(has(said, "disabling"));
  fs::remove(here / "file");
  // A relative path is ignored.
  EXPECT_FALSE(has(draw("./caches"), full));
  EXPECT_TRUE(here.names().empty());
  const fs::path programs = home / ".cache/binosplat/programs";
  EXPECT_FALSE(fs::is_empty(programs));
  // A folder in place of a program's file is ignored.
  for (const auto& entry : fs::directory_iterator(programs)) {
    fs::remove(entry.path());
    fs::create_directory(entry.path());
  }
  draw("");
}

}  // namespace
}  // namespace binosplat
