// Files next to a model that describe its training, for each trainer, and files that do not.

#include "formats/training/training_run.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/output_file.h"
#include "base/text.h"
#include "formats/models/files_of_model.h"
#include "formats/models/model_file.h"
#include "formats/models/model_output.h"
#include "formats/training/flat_values.h"
#include "support/broken.h"
#include "support/ply.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

TEST(FlatValues, FlattenYamlMappings) {
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
TEST(FlatValues, MatchPyYaml) {
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

TEST(FlatValues, RejectHostileYaml) {
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

TEST(FlatValues, NamespacesMayNestCommas) {
  const FlatValues values =
      namespace_values("Namespace(eval=True, path='a, b=c\\'d', steps=[1, (2, 3)], odd=\"x)\", none=None)\n");
  const FlatValues expected = {
      {"eval", "True"}, {"path", "a, b=c\\'d"}, {"steps", "[1, (2, 3)]"}, {"odd", "x)"}, {"none", "None"}};
  EXPECT_EQ(values, expected);
  for (const char* other : {"", "namespace", "Namespace(", "Namespace(a", "Namespace(a='"})
    EXPECT_LE(namespace_values(other).size(), 1u) << other;
}

TEST(FlatValues, FlattenJsonKeys) {
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

TEST_F(TrainingRunTest, GsplatReportsDifferences) {
  const auto plain = found(gsplat_ply, "run/cfg.yml", gsplat_with("with_eval3d: false\nwith_ut: false\n"));
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->trainer, "gsplat");
  EXPECT_EQ(plain->file, folder / "run/cfg.yml");
  EXPECT_EQ(plain->antialiased, false);
  EXPECT_TRUE(plain->differences.empty()) << otherwise(plain);
  const std::pair<std::string, std::string> lens("camera_model", "pinhole");
  EXPECT_EQ(std::ranges::count(plain->keys, lens), 1);
  EXPECT_TRUE(plain->notes.empty());
  const auto moved = found(gsplat_ply, "run/cfg.yml", gsplat_with("normalize_world_space: true\n"));
  ASSERT_EQ(moved->notes.size(), 1u);
  EXPECT_TRUE(says(moved->notes[0], "COLMAP's cameras"));
  const std::pair<const char*, const char*> changed[] = {
      {"with_eval3d: true\nwith_ut: true", "along each ray"}, {"with_ut: true", "unscented transform"},
      {"use_bilateral_grid: true", "bilateral grid"},         {"camera_model: fisheye", "another lens"},
      {"app_opt: true", "an appearance for each photo"},      {"post_processing: ppisp", "ppisp"},
      {"post_processing: bilateral_grid", "bilateral grid"},  {"pose_opt: true", "cameras were optimised"}};
  for (const auto& [line, part] : changed) {
    const auto run = found(gsplat_ply, "run/cfg.yml", gsplat_with(std::string(line) + "\n"));
    ASSERT_EQ(run->differences.size(), 1u) << line << otherwise(run);
    EXPECT_TRUE(says(run->differences[0], part)) << run->differences[0];
  }
  EXPECT_EQ(found(gsplat_ply, "run/cfg.yml", gsplat_with("antialiased: true\n"))->antialiased, true);
}

TEST_F(TrainingRunTest, QuotedTextIsNotBoolean) {
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

TEST_F(TrainingRunTest, ReadsNestedNerfstudioConfig) {
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
  ASSERT_EQ(all->notes.size(), 1u);
  EXPECT_TRUE(says(all->notes[0], "`background` 1,1,1"));
  // The config.yml of another program, and one in a folder too far above the model.
  EXPECT_FALSE(found(ply, "run/config.yml", "model:\n  rasterize_mode: antialiased\n"));
  EXPECT_FALSE(found("run/a/b/c/splat.ply", "run/config.yml", config("off", "")));
}

TEST_F(TrainingRunTest, ReadsOtherTrainers) {
  const std::string inria = "run/point_cloud/iteration_30000/point_cloud.ply";
  const auto args = found(inria, "run/cfg_args",
                          "Namespace(data_device='cuda', eval=True, images='images', sh_degree=3, "
                          "source_path='/a, b', train_test_exp=True, white_background=True)");
  ASSERT_TRUE(args);
  EXPECT_FALSE(args->antialiased) << "INRIA's trainer does not write it";
  EXPECT_EQ(args->notes.size(), 1u);
  EXPECT_TRUE(says(otherwise(args), "their exposure.json is missing"));
  test::write_text(folder / "run/exposure.json", "{}");
  EXPECT_TRUE(find_training_run(folder / inria)->differences.empty());
  EXPECT_EQ(found(inria, "run/cfg_args", "Namespace(antialiasing=True, sh_degree=3)")->antialiased, true);
  const auto lichtfeld = found("run/splat_30000.ply", "run/training_config.json",
                               R"({"dataset": {}, "optimization": {"antialiasing": true, "gut": true,
                                   "pose_optimization": "none", "sh_degree": 3}})");
  ASSERT_TRUE(lichtfeld);
  EXPECT_EQ(lichtfeld->antialiased, false) << "3DGUT has no low-pass to compensate";
  EXPECT_EQ(lichtfeld->differences.size(), 1u) << otherwise(lichtfeld);
  const std::string grut = "model:\n  background:\n    color: black\nrender:\n  method: ";
  const auto traced =
      found("run/export_last.ply", "run/parsed.yaml", grut + "3dgrt\n  particle_kernel_degree: 4\n");
  ASSERT_TRUE(traced);
  EXPECT_FALSE(traced->antialiased);
  EXPECT_EQ(traced->kernel_px2, 0.001);
  EXPECT_TRUE(says(otherwise(traced), "along each ray") && says(otherwise(traced), "particle_kernel_degree"));
  const auto gaussians =
      found("run/export_last.ply", "run/parsed.yaml", grut + "3dgrt\n  particle_kernel_degree: 2\n");
  EXPECT_FALSE(says(otherwise(gaussians), "particle_kernel_degree"));
  const auto splatted =
      found("run/export_last.ply", "run/parsed.yaml", grut + "3dgut\n  splat:\n    global_z_order: false\n");
  EXPECT_TRUE(says(otherwise(splatted), "along each ray"));
  EXPECT_EQ(splatted->order, Order::distance);
  EXPECT_EQ(splatted->near_plane, 0.2);
}

// The trainers that came from INRIA's are told apart by the keys that only they have.
TEST_F(TrainingRunTest, DistinguishesInriaForks) {
  const std::string ply = "run/point_cloud/iteration_30000/point_cloud.ply";
  const auto run = [&](const std::string& keys) {
    return found(ply, "run/cfg_args", "Namespace(eval=True, " + keys + ", white_background=False)");
  };
  const struct {
    const char *keys, *trainer;
    double near_plane;
    std::optional<double> kernel_px2;
    std::optional<bool> antialiased;
  } cases[] = {
      {"sh_degree=3", "INRIA's trainer or one like it", 0.2, {}, {}},
      {"sh_degree=3, kernel_size=0.1", "Mip-Splatting", 0.2, 0.1, true},
      {"sh_degree=3, kernel_size=0.35", "Mip-Splatting", 0.2, 0.35, true},
      {"kernel_size=0.0, sh_degree=3, use_coord_map=False, use_decoupled_appearance=True", "RaDe-GS", 0.2,
       0.001, true},
      {"kernel_size=0.0, sh_degree=3, use_decoupled_appearance=False", "GOF", 0.2, 0.001, true},
      {"kernel_size=-1, sh_degree=3", "Mip-Splatting", 0.2, {}, true},
      {"sh_degree=3, source_path='a, kernel_size=9'", "INRIA's trainer or one like it", 0.2, {}, {}},
      {"load_allres=False, sample_more_highres=False, sh_degree=3", "Analytic-Splatting", 0.2, 1.0 / 12.0,
       true},
      {"latent_dim=16, sh_degree=3", "EAGLES", 0.1, {}, {}},
      {"fork=2, n_offsets=10", "Octree-GS", 0.2, {}, {}},
  };
  for (const auto& one : cases) {
    const auto read = run(one.keys);
    ASSERT_TRUE(read) << one.keys;
    EXPECT_EQ(read->trainer, one.trainer);
    EXPECT_EQ(read->near_plane, one.near_plane) << one.keys;
    EXPECT_EQ(read->kernel_px2, one.kernel_px2) << one.keys;
    EXPECT_EQ(read->antialiased, one.antialiased) << one.keys;
  }
  EXPECT_TRUE(
      says(otherwise(run("kernel_size=0.0, sh_degree=3, use_decoupled_appearance=False")), "along each ray"));
  EXPECT_TRUE(says(otherwise(run("kernel_size=nan, sh_degree=3")), "kernel_size 'nan' is ignored"));
  // StopThePop writes a file of its own beside cfg_args.
  ASSERT_TRUE(run("sh_degree=3"));
  test::write_text(folder / "run/config.json",
                   R"({"sort_settings": {"sort_mode": 3, "sort_order": 1}, "proper_ewa_scaling": true})");
  const auto popless = find_training_run(folder / ply);
  EXPECT_EQ(popless->trainer, "StopThePop");
  EXPECT_EQ(popless->order, Order::distance);
  EXPECT_EQ(popless->antialiased, true);
  EXPECT_TRUE(says(otherwise(popless), "sorted at each pixel"));
}

TEST_F(TrainingRunTest, GsplatSetsNearPlane) {
  const auto near = [&](const std::string& name, const std::string& text) {
    const auto run = found(gsplat_ply, "run/" + name, text);
    return run ? run->near_plane : std::optional<double>();
  };
  EXPECT_EQ(near("cfg.yml", gsplat_with("near_plane: 0.01\n")), 0.01);
  EXPECT_EQ(near("cfg.yml", gsplat_with("near_plane: 1.0e-03\n")), 0.001);
  EXPECT_EQ(near("cfg.yml", gsplat_with("near_plane: 0\n")), 1e-6) << "the smallest that can be drawn";
  EXPECT_EQ(near("cfg.yml", gsplat_with("")), 0.01) << "the trainer's default";
  EXPECT_EQ(near("cfg.json", R"({"result_dir": "results", "near_plane": 0.2, "model_type": "2dgs"})"), 0.2);
  EXPECT_EQ(near("cfg.json", R"({"near_plane": 0.2})"), std::nullopt) << "another program's file";
  for (const char* bad : {"-1", ".nan", "[0.1]", "x", "\n  near_plane: 0.5"})
    EXPECT_EQ(near("cfg.yml", gsplat_with(std::string("near_plane: ") + bad + "\n")), 0.01) << bad;
}

TEST_F(TrainingRunTest, ReadsAllLichtFeldVersions) {
  const auto read = [&](const std::string& keys, bool flat = false) {
    const std::string all = R"({"sh_degree": 3, )" + keys + "}";
    return found("run/splat_30000.ply", "run/training_config.json",
                 flat ? all : R"({"dataset": {}, "optimization": )" + all + "}");
  };
  for (const bool flat : {false, true}) {
    const auto mip = read(R"("mip_filter": true)", flat);
    EXPECT_EQ(mip->kernel_px2, 0.1);
    EXPECT_EQ(mip->antialiased, true);
    EXPECT_EQ(mip->near_plane, 0.01);
  }
  const auto rays = read(R"("mip_filter": true, "gut": true)");
  EXPECT_EQ(rays->kernel_px2, 0.001);
  EXPECT_EQ(rays->antialiased, false) << "3DGUT ignores the filter";
  const auto older = read(R"("antialiasing": true)");
  EXPECT_EQ(older->antialiased, true);
  EXPECT_FALSE(older->kernel_px2);
  EXPECT_EQ(read(R"("antialiasing": true, "save_sog": false)")->antialiased, false) << "ignored by then";
  for (const char* no_truth : {"\"true\"", "1", "null"})
    EXPECT_FALSE(read(std::string(R"("mip_filter": )") + no_truth)->antialiased) << no_truth;
  const auto notes = [&](const std::string& keys) { return read(keys)->notes; };
  const std::string grey = R"("bg_color": [0.5, 0.5, 0.25])";
  ASSERT_EQ(notes(R"("bg_mode": "solid_color", )" + grey).size(), 1u);
  EXPECT_TRUE(says(notes(R"("bg_mode": "solid_color", )" + grey)[0], "`background` 0.5,0.5,0.25"));
  EXPECT_TRUE(notes(R"("bg_mode": "random", )" + grey).empty());
  EXPECT_TRUE(notes(R"("bg_mode": "solid_color", "bg_color": [0.0, 0.0, 0.0])").empty());
  for (const char* key : {"use_ppisp", "use_bilateral_grid", "use_exposure_correction"})
    EXPECT_EQ(read(fmt::format(R"("{}": true)", key))->differences.size(), 1u) << key;
}

TEST_F(TrainingRunTest, WarnsOfPlyWithActivatedValues) {
  const auto said = [&](bool activated) {
    test::PlyFile file = test::inria_file(0, 50);
    for (std::size_t i = 0; activated && i < file.rows.size(); ++i) {
      for (const char* name : {"scale_0", "scale_1", "scale_2"}) file.at(i, name) = 0.02;
      file.at(i, "opacity") = 0.02 * static_cast<double>(i);
    }
    test::write_text(folder / "a.ply", test::to_bytes(file));
    testing::internal::CaptureStderr();
    load_model(folder / "a.ply");
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_FALSE(says(said(false), "not the logarithms"));
  EXPECT_TRUE(says(said(true), "it seems to hold scales and opacities, not the logarithms and logits"));
}

// Comments of a ply, as their writers write them.
TEST_F(TrainingRunTest, ReadsPlyComments) {
  const auto loaded = [&](const std::string& comments) {
    test::PlyFile file = test::inria_file(0, 5);
    file.comments = comments;
    test::write_text(folder / "a.ply", test::to_bytes(file));
    return load_model(folder / "a.ply");
  };
  const std::string brush = "comment Exported from Brush\ncomment Vertical axis: y\ncomment SH degree: 1\n";
  const std::string fvdb = "comment fvdb_ply_af_8198767135";
  const struct {
    std::string comments;
    std::optional<double> near_plane;
    double kernel_px2;
    bool antialiased;
  } cases[] = {
      {"", {}, 0.3, false},
      {brush + "comment SplatRenderMode: mip\n", 0.01, 0.1, true},
      {"comment splatrendermode:   MIP\ncomment  exported  from  BRUSH \n", 0.01, 0.1, true},
      {brush + "comment SplatRenderMode: default\n", 0.01, 0.3, false},
      {brush, 0.01, 0.3, false},
      {"comment SplatRenderMode: mip\n", {}, 0.3, true},
      {"comment SplatRenderMode: default\ncomment SplatRenderMode: mip\n", {}, 0.3, true},
      {"comment SplatRenderMode: other\n", {}, 0.3, false},
      {"comment not Exported from Brush, but SplatRenderMode: mip\n", {}, 0.3, false},
      {"comment Postshot v1.0.110\ncomment postshot.anti_aliasing=1\n", {}, 0.3, true},
      {"comment postshot.anti_aliasing=0\n", {}, 0.3, false},
      {"comment Generated by Nerstudio 1.1.5\ncomment Vertical Axis: z\n", 0.01, 0.3, false},
      {"comment Generated by opensplat at iteration 30000\n", 0.01, 0.3, false},
      {fvdb + "near_plane|double|0.05000000000000000\n" + fvdb + "eps2d|double|0.20000000000000001\n" + fvdb +
           "antialias|int64|1\n",
       0.05, 0.2, true},
  };
  for (const auto& one : cases) {
    const Model model = loaded(one.comments);
    EXPECT_EQ(model.near_plane, one.near_plane) << one.comments;
    EXPECT_EQ(model.kernel_px2, one.kernel_px2) << one.comments;
    EXPECT_EQ(model.antialiased, one.antialiased) << one.comments;
  }
  EXPECT_EQ(loaded("comment SplatRenderMode: other\n").antialiased_by, "");
  EXPECT_EQ(loaded("comment postshot.anti_aliasing=0\n").antialiased_by, "a comment of the ply");
}

TEST_F(TrainingRunTest, NearestReadableFileWins) {
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

TEST_F(TrainingRunTest, ModelOverridesTrainingRun) {
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
