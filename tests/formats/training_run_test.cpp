// Files next to a model that describe its training, for each trainer, and files that do not.

#include "formats/training_run.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/output_file.h"
#include "base/text.h"
#include "formats/files_of_model.h"
#include "formats/flat_values.h"
#include "formats/model_file.h"
#include "formats/model_output.h"
#include "support/broken.h"
#include "support/ply.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

TEST(FlatValues, OfYamlAreThoseOfItsMappings) {
  const FlatValues values = yaml_values("f.yml",
                                        "!!python/object:nerfstudio.engine.trainer.TrainerConfig\r\n"
                                        "steps:\n- 7000\n- name: x\n"
                                        "pipeline: &id001 !!python/object:nerfstudio.Pipeline\n"
                                        "  _target: !!python/name:nerfstudio.Pipeline ''\n"
                                        "  path: !!python/object/apply:pathlib.PosixPath\n  - /\n  - data\n"
                                        "  model: !!python/object:nerfstudio.Model\n"
                                        "    camera_optimizer: !!python/object:nerfstudio.Optimizer\n"
                                        "      mode: 'off'   # for now\n"
                                        "    sh_degree: 3   # at most\n"
                                        "    grid: [1, 2]\n"
                                        "    other: *id001\n"
                                        "  after: \"a: b # c\"\n"
                                        "last: !!str yes\n");
  const FlatValues expected = {{"pipeline._target", ""},
                               {"pipeline.model.camera_optimizer.mode", "off"},
                               {"pipeline.model.sh_degree", "3"},
                               {"pipeline.after", "a: b # c"},
                               {"last", "yes"}};
  EXPECT_EQ(values, expected);
  EXPECT_TRUE(yaml_values("f.yml", "").empty() || yaml_values("f.yml", "").begin()->second == "null");
}

// Trainers write and read YAML with PyYAML; the expected values are PyYAML's.
TEST(FlatValues, OfYamlAreWhatYamlSays) {
  const auto a = [](const std::string& text) {
    const FlatValues values = yaml_values("f.yml", text);
    const auto found = values.find("a");
    return found == values.end() ? std::string("none") : found->second;
  };
  for (const char* yes : {"true", "True", "TRUE", "yes", "on", "ON", "!!bool 'true'", "\n  true"})
    EXPECT_EQ(a(std::string("a: ") + yes + "\n"), "true") << yes;
  for (const char* no : {"false", "no", "Off", "\n  false"})
    EXPECT_EQ(a(std::string("a: ") + no + "\n"), "false") << no;
  // Quoted text and other spellings are not Booleans.
  for (const char* text : {"'true'", "\"true\"", "!!str true", "tRUE"})
    EXPECT_EQ(lowered(a(std::string("a: ") + text + "\n")), "'true'") << text;
  EXPECT_EQ(a("a: |\n  b: 1\n  a: true\n"), "b: 1\na: true\n") << "what is text is no key";
  EXPECT_EQ(a("{a: yes, b: [1, {a: no}]}"), "true");
  EXPECT_EQ(a("a:\n"), "null");
  EXPECT_EQ(a("b: &x on\na: *x\n"), "true");
  // Of duplicate keys the last one counts, with everything in it.
  EXPECT_EQ(a("a: true\na: false\n"), "false");
  const FlatValues last = yaml_values("f.yml", "m: {a: 1, n: {b: 2}}\nm: {c: 4}\n");
  EXPECT_EQ(last, (FlatValues{{"m.c", "4"}}));
}

TEST(FlatValues, OfHostileYamlAreAnError) {
  std::string deep, bomb = "a0: &a0 {x: 1, y: 2}\n", flat;
  for (int i = 0; i < 20000; ++i) deep += "{a: ";
  for (int i = 1; i < 40; ++i) bomb += fmt::format("a{0}: &a{0} {{x: *a{1}, y: *a{1}}}\n", i, i - 1);
  for (int i = 0; i < 30000; ++i) flat += fmt::format("k{}: 1\n", i);
  const std::vector<test::BrokenFile> refusals = {
      {"a: [1\n", {"f.yml, line "}},
      {std::string("a: 1\nb\0: 2\n", 11), {"f.yml, line 2: the control character 0"}},
      {"a: tr\4ue\n", {"f.yml, line 1: the control character 4"}},
      {std::string(1 << 16, '['), {}},
      {deep, {}},
      {bomb, {"more than 20000 values"}},
      {flat, {"more than 20000 values"}},
  };
  test::expect_refusals("f.yml", refusals, [](const std::string& text) { yaml_values("f.yml", text); });
}

TEST(FlatValues, OfANamespaceMayHoldCommasInQuotesAndBrackets) {
  const FlatValues values =
      namespace_values("Namespace(eval=True, path='a, b=c\\'d', steps=[1, (2, 3)], odd=\"x)\", none=None)\n");
  const FlatValues expected = {
      {"eval", "True"}, {"path", "a, b=c\\'d"}, {"steps", "[1, (2, 3)]"}, {"odd", "x)"}, {"none", "None"}};
  EXPECT_EQ(values, expected);
  for (const char* other : {"", "namespace", "Namespace(", "Namespace(a", "Namespace(a='"})
    EXPECT_LE(namespace_values(other).size(), 1u) << other;
}

TEST(FlatValues, OfJsonAreByTheirKeys) {
  const FlatValues values = json_values("f.json", R"({"a": {"b": true, "c": "x"}, "d": [1.5, null]})");
  const FlatValues expected = {{"a.b", "true"}, {"a.c", "x"}, {"d.0", "1.5"}, {"d.1", "null"}};
  EXPECT_EQ(values, expected);
}

/// A model in a folder as trainers leave it, with a file that describes the run.
struct TrainingRunTest : testing::Test {
  /// Writes the model and the file of the run. Returns the run that is found for the model.
  std::optional<TrainingRun> found(const std::string& model, const std::string& name,
                                   const std::string& text) {
    fs::remove_all(folder / "run");
    fs::create_directories((folder / model).parent_path());
    test::write_text(folder / model, test::to_bytes(test::inria_file(0, 5)));
    test::write_text(folder / name, text);
    return find_training_run(folder / model);
  }

  static std::string otherwise(const std::optional<TrainingRun>& run) {
    std::string all;
    for (const std::string& sentence : run->differences) all += sentence + "\n";
    return all;
  }

  test::TempFolder folder;
};

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string gsplat_ply = "run/ply/point_cloud_29999.ply";

std::string gsplat_with(const std::string& more) {
  return "absgrad: false\nantialiased: false\napp_opt: false\ncamera_model: pinhole\npost_processing: null\n"
         "pose_opt: false\nresult_dir: results/garden\nsh_degree: 3\n"
         "strategy: !!python/object:gsplat.strategy.default.DefaultStrategy\n  absgrad: true\n" +
         more;
}

TEST_F(TrainingRunTest, OfGsplatSaysWhatIsDrawnOtherwise) {
  const auto plain = found(gsplat_ply, "run/cfg.yml", gsplat_with("with_eval3d: false\nwith_ut: false\n"));
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->trainer, "gsplat");
  EXPECT_EQ(plain->file, folder / "run/cfg.yml");
  EXPECT_EQ(plain->antialiased, false);
  EXPECT_TRUE(plain->differences.empty()) << otherwise(plain);
  const std::pair<std::string, std::string> degree("sh_degree", "3");
  EXPECT_EQ(std::ranges::count(plain->settings, degree), 1);
  EXPECT_TRUE(plain->advice.empty());
  const auto moved = found(gsplat_ply, "run/cfg.yml", gsplat_with("normalize_world_space: true\n"));
  ASSERT_EQ(moved->advice.size(), 1u);
  EXPECT_TRUE(says(moved->advice[0], "COLMAP's cameras"));
  const std::pair<const char*, const char*> changed[] = {
      {"with_eval3d: true\nwith_ut: true", "3DGUT"},
      {"with_ut: true", "unscented transform"},
      {"use_bilateral_grid: true", "bilateral grid"},
      {"camera_model: fisheye", "another lens"},
      {"app_opt: true", "app_opt"},
      {"post_processing: ppisp", "ppisp"},
      {"post_processing: bilateral_grid", "bilateral grid"},
      {"pose_opt: true", "cameras were optimised"}};
  for (const auto& [line, part] : changed) {
    const auto run = found(gsplat_ply, "run/cfg.yml", gsplat_with(std::string(line) + "\n"));
    ASSERT_EQ(run->differences.size(), 1u) << line << otherwise(run);
    EXPECT_TRUE(says(run->differences[0], part)) << run->differences[0];
  }
  EXPECT_EQ(found(gsplat_ply, "run/cfg.yml", gsplat_with("antialiased: true\n"))->antialiased, true);
}

TEST_F(TrainingRunTest, TextIsNoTruthValue) {
  const auto said = [&](const std::string& line) {
    const auto run = found(gsplat_ply, "run/cfg.yml", gsplat_with(line));
    return run ? run->antialiased : std::optional<bool>();
  };
  EXPECT_EQ(said("antialiased: yes\n"), true);
  EXPECT_EQ(said("antialiased:\n  false\n"), false);
  for (const char* text : {"|\n  true\n", "'true'\n", "99999999999999999999\n", "\n", "[true]\n"})
    EXPECT_EQ(said(std::string("antialiased: ") + text), std::nullopt) << text;
  EXPECT_FALSE(found(gsplat_ply, "run/cfg.yml", gsplat_with("x: [y\n"))) << "with a warning";
}

TEST_F(TrainingRunTest, OfNerfstudioIsNested) {
  const auto config = [](const std::string& mode, const std::string& more) {
    return "!!python/object:nerfstudio.engine.trainer.TrainerConfig\n"
           "method_name: splatfacto\n"
           "pipeline: !!python/object:nerfstudio.pipelines.base_pipeline.VanillaPipelineConfig\n"
           "  datamanager: !!python/object:nerfstudio.data.X\n    camera_optimizer: null\n"
           "  model: !!python/object:nerfstudio.models.splatfacto.SplatfactoModelConfig\n"
           "    camera_optimizer: !!python/object:nerfstudio.cameras.CameraOptimizerConfig\n"
           "      mode: '" +
           mode + "'\n    cull_alpha_thresh: 0.1\n" + more;
  };
  const std::string ply = "run/exports/splat/splat.ply";
  const auto plain = found(ply, "run/config.yml", config("off", "    rasterize_mode: classic\n"));
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->antialiased, false);
  EXPECT_TRUE(plain->differences.empty()) << otherwise(plain);
  const auto all = found(ply, "run/config.yml",
                         config("SO3xR3",
                                "    rasterize_mode: antialiased\n    use_bilateral_grid: true\n"
                                "    background_color: white\n"));
  EXPECT_EQ(all->antialiased, true);
  EXPECT_TRUE(says(otherwise(all), "bilateral grid") && says(otherwise(all), "cameras were optimised"));
  ASSERT_EQ(all->advice.size(), 1u);
  EXPECT_TRUE(says(all->advice[0], "--background 1,1,1"));
  // The config.yml of another program, and one in a folder too far above the model.
  EXPECT_FALSE(found(ply, "run/config.yml", "model:\n  rasterize_mode: antialiased\n"));
  EXPECT_FALSE(found("run/a/b/c/splat.ply", "run/config.yml", config("off", "")));
}

TEST_F(TrainingRunTest, OfOthers) {
  const std::string inria = "run/point_cloud/iteration_30000/point_cloud.ply";
  const auto args = found(inria, "run/cfg_args",
                          "Namespace(data_device='cuda', eval=True, images='images', sh_degree=3, "
                          "source_path='/a, b', train_test_exp=True, white_background=True)");
  ASSERT_TRUE(args);
  EXPECT_FALSE(args->antialiased) << "INRIA's trainer does not write it";
  EXPECT_EQ(args->advice.size(), 1u);
  EXPECT_TRUE(says(otherwise(args), "their exposure.json is missing"));
  test::write_text(folder / "run/exposure.json", "{}");
  EXPECT_TRUE(find_training_run(folder / inria)->differences.empty());
  EXPECT_EQ(found(inria, "run/cfg_args", "Namespace(antialiasing=True, sh_degree=3)")->antialiased, true);
  const auto lichtfeld = found("run/splat_30000.ply", "run/training_config.json",
                               R"({"dataset": {}, "optimization": {"antialiasing": true, "gut": true,
                                   "pose_optimization": "none", "sh_degree": 3}})");
  ASSERT_TRUE(lichtfeld);
  EXPECT_EQ(lichtfeld->antialiased, true);
  EXPECT_EQ(lichtfeld->differences.size(), 1u) << otherwise(lichtfeld);
  const std::string grut = "model:\n  background:\n    color: black\nrender:\n  method: ";
  const auto traced =
      found("run/export_last.ply", "run/parsed.yaml", grut + "3dgrt\n  particle_kernel_degree: 4\n");
  ASSERT_TRUE(traced);
  EXPECT_FALSE(traced->antialiased);
  EXPECT_TRUE(says(otherwise(traced), "3DGRT"));
  const auto splatted =
      found("run/export_last.ply", "run/parsed.yaml", grut + "3dgut\n  splat:\n    global_z_order: false\n");
  EXPECT_TRUE(says(otherwise(splatted), "3DGUT") && says(otherwise(splatted), "--order distance"));
}

TEST_F(TrainingRunTest, IsTheNearestThatCanBeRead) {
  ASSERT_TRUE(found(gsplat_ply, "run/cfg.yml", gsplat_with("")));
  test::write_text(folder / "run/ply/cfg_args", "Namespace(sh_degree=3)");
  EXPECT_EQ(find_training_run(folder / gsplat_ply)->file, folder / "run/ply/cfg_args");
  // A broken file, another program's and a folder are ignored.
  for (const char* other : {"", "\xff\xfe", "a list", "Namespace(a=1)"}) {
    test::write_text(folder / "run/ply/cfg_args", other);
    EXPECT_EQ(find_training_run(folder / gsplat_ply)->file, folder / "run/cfg.yml") << other;
  }
  fs::remove(folder / "run/ply/cfg_args");
  test::write_text(folder / "run/ply/training_config.json", "{\"optimization\": ");
  fs::create_directory(folder / "run/ply/parsed.yaml");
  EXPECT_EQ(find_training_run(folder / gsplat_ply)->file, folder / "run/cfg.yml");
  EXPECT_FALSE(find_training_run(folder / "none/model.ply"));
}

TEST_F(TrainingRunTest, DecidesOnlyWhatTheModelDoesNotSay) {
  ASSERT_TRUE(found(gsplat_ply, "run/cfg.yml", gsplat_with("antialiased: true\n")));
  const fs::path ply = folder / gsplat_ply;
  const auto loaded = [&](const std::string& comments) {
    test::PlyFile file = test::inria_file(0, 5);
    file.comments = comments;
    test::write_text(ply, test::to_bytes(file));
    return load_model(ply);
  };
  EXPECT_TRUE(loaded("").antialiased);
  EXPECT_EQ(loaded("").antialiased_by, (folder / "run/cfg.yml").string());
  EXPECT_FALSE(load_model_alone(ply).antialiased);
  const std::vector<fs::path> files = files_of_model(ply);
  EXPECT_EQ(std::ranges::count(files, folder / "run/cfg.yml"), 1) << "a run with another is another";
  EXPECT_FALSE(loaded("comment SplatRenderMode: default\n").antialiased);
  EXPECT_EQ(loaded("comment antialiased 0\n").antialiased_by, "a comment of the ply");
  // A model written next to a run has its own tag, antialiased or not, which has precedence over the run.
  for (const bool antialiased : {true, false}) {
    Model model = loaded(antialiased ? "" : "comment antialiased 0\n");
    OutputFile file(ply.parent_path() / "a.ply");
    write_model(file, model, ModelFormat::ply);
    file.commit();
    EXPECT_EQ(load_model_alone(ply.parent_path() / "a.ply").antialiased, antialiased);
    EXPECT_EQ(load_model(ply.parent_path() / "a.ply").antialiased, antialiased);
  }
}

}  // namespace
}  // namespace binosplat
