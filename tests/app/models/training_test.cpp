// The table of trainers' keys: each row is walked with a model whose files have the row's key. The model is
// drawn as the options that the row stands for draw it, `info` names the file, and `convert` keeps or names
// the setting.

#include <cmath>
#include <map>

#include "app/options/table.h"
#include "app/scene.h"
#include "formats/training/trainer_keys.h"
#include "shared/layout.h"

namespace binosplat {
namespace {

using nlohmann::json;

/// Where a writer's keys stand: in a file beside the model, or in the model's own file ("ply", "SOG", "spz").
struct PlaceOfKeys {
  std::string file;
  std::string prefix;                     // of the keys
  std::map<std::string, json> mark = {};  // keys by which the file is recognised
};

const std::map<std::string, PlaceOfKeys> places = {
    {"ply", {"ply", ""}},
    {"Brush's ply", {"ply", "", {{"exported from", "brush"}}}},
    {"SOG", {"SOG", ""}},
    {"spz", {"spz", ""}},
    {"gsplat", {"cfg.json", "", {{"result_dir", "r"}}}},
    {"nerfstudio", {"config.yml", "pipeline.model.", {{"cull_alpha_thresh", 0.1}}}},
    {"StopThePop", {"config.json", "", {{"sort_settings.sort_mode", 0}}}},
    {"cfg_args", {"cfg_args", "", {{"sh_degree", 3}}}},
    {"EAGLES", {"cfg_args", "", {{"latent_dim", 3}}}},
    {"GOF", {"cfg_args", "", {{"use_decoupled_appearance", true}}}},
    {"Analytic-Splatting", {"cfg_args", "", {{"sample_more_highres", false}}}},
    {"LichtFeld Studio", {"training_config.json", "optimization.", {{"sh_degree", 3}}}},
    {"3DGRUT", {"parsed.yaml", "", {{"render.method", "3dgrt"}}}}};

/// A value that holds for the row, as its file has it.
json value_for(const TrainerKey& row) {
  const std::string value = row.value;
  if (value == "*") return row.meaning.kind == Meaning::near_plane ? 0.6 : 0.7;
  if (value == "!0" || value == "!2") return 4;
  if (value.starts_with('!')) return "another";
  return value == "true" ? json(true) : value == "false" ? json(false) : json(value);
}

/// How a model is drawn, in the words of `info --json`.
struct Drawn {
  double near_plane, kernel_px2;
  bool antialiased;
  std::string order;
  bool linear;
  bool operator==(const Drawn&) const = default;
};

struct TrainerKeys : SceneTest {
  /// Puts Gaussians before the first camera, which near planes cut or do not, and cameras in a large world.
  TrainerKeys() {
    save("cameras.json", {camera_json("front", 0.0), camera_json("far", 4.0)});
    const double nearest[] = {3e-5, 0.005, 0.05, 0.15, 0.4, 0.65};
    for (std::size_t i = 0; i < std::size(nearest); ++i) {
      ply.at(i, "x") = nearest[i] * (0.1 * static_cast<double>(i) - 0.2);
      ply.at(i, "y") = nearest[i] * (0.1 - 0.05 * static_cast<double>(i));
      ply.at(i, "z") = nearest[i];
      ply.at(i, "opacity") = -2.0;
      for (const char* scale : {"scale_0", "scale_1", "scale_2"})
        ply.at(i, scale) = std::log(0.02 * nearest[i]);
    }
    write_text(model, to_bytes(ply));
  }

  std::string path(const std::string& name) const { return folder / name; }

  /// Writes the model with these keys, and returns its file.
  std::string write(const PlaceOfKeys& place, const std::map<std::string, json>& more) {
    std::map<std::string, json> keys = place.mark;
    for (const auto& [key, value] : more) keys[key] = value;
    PlyFile file = ply;
    write_text(model, to_bytes(file));
    if (place.file == "ply") {
      for (const auto& [key, value] : keys) {
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        file.comments += "comment " + key + (key.find(' ') == std::string::npos ? ": " : " ") + text + "\n";
      }
    } else if (place.file == "cfg_args") {
      std::string text = "Namespace(";
      for (const auto& [key, value] : keys)
        text += key + "=" + (value == true ? "True" : value == false ? "False" : value.dump()) + ", ";
      write_text(path("cfg_args"), text + "eval=True)");
    } else if (place.file == "spz") {
      file.comments = keys.empty() ? "" : "comment antialiased 1\n";
      write_text(path("from.ply"), to_bytes(file));
      checked(run_program({"convert", path("from.ply"), "-o", path("model.spz")}));
      return path("model.spz");
    } else if (place.file == "SOG") {
      checked(run_program({"convert", model, "-o", path("model.sog")}));
      checked(
          {std::system(("cd " + folder.path().string() + " && python3 -m zipfile -e model.sog sog").c_str()),
           "", ""});
      fs::copy(path("cameras.json"), path("sog/cameras.json"), fs::copy_options::overwrite_existing);
      json meta = load_json(path("sog/meta.json"));
      for (const auto& [key, value] : keys) meta[key] = value;
      write_text(path("sog/meta.json"), meta.dump());
      return path("sog/meta.json");
    } else {
      json root;
      for (const auto& [key, value] : keys) {
        std::string pointer = "/" + place.prefix + key;
        std::ranges::replace(pointer, '.', '/');
        root[json::json_pointer(pointer)] = value;
      }
      write_text(path(place.file), root.dump());
    }
    write_text(model, to_bytes(file));
    return model;
  }

  json info(const std::string& file, std::string* said = nullptr) {
    const Outcome outcome = checked(run_program({"info", file, "--json", path("info.json")}));
    if (said != nullptr) *said = outcome.out + outcome.err;
    return load_json(path("info.json"));
  }

  static Drawn drawn_as(const json& info) {
    return {info["near_plane"], info["kernel_px2"], info["antialiased"], info["order"], info["linear"]};
  }

  Image picture(const std::string& file, const Words& options) {
    checked(run_program(joined({"render", file, "--cameras", path("cameras.json"), "--view", "front",
                                "--mono", "-o", path("p.png"), "--bits", "16"},
                               options)));
    return load_image(path("p.png"));
  }

  PlyFile ply = small_model();
};

std::string number(double value) { return fmt::format("{}", value); }

Words options_of(const Drawn& drawn) {
  return {"--near",
          number(drawn.near_plane),
          "--eps2d",
          number(drawn.kernel_px2),
          drawn.antialiased ? "--antialias" : "--no-antialias",
          "--order",
          drawn.order};
}

TEST_F(TrainerKeys, EachKeyTakesEffect) {
  const std::string neutral = path("neutral.ply");
  write_text(neutral, to_bytes(ply));
  std::map<std::string, Image> of_options;
  const std::span<const TrainerKey> rows = trainer_keys();
  for (const TrainerKey& row : rows) {
    SCOPED_TRACE(fmt::format("{}: {} {}", row.writer, row.key, row.value));
    const auto of_row = places.find(row.writer);
    ASSERT_NE(of_row, places.end()) << "a new writer";
    const PlaceOfKeys& place = of_row->second;
    const std::string key = row.key;
    const std::map<std::string, json> keys =
        key.empty() ? std::map<std::string, json>{} : std::map{std::pair{key, value_for(row)}};
    Drawn expected = drawn_as(info(write(place, {})));
    // The first row of a kind counts: keys may have several rows.
    std::set<Meaning::Kind> decided;
    for (const TrainerKey& other : rows) {
      const bool same_file = other.writer == std::string(row.writer) || other.writer == place.file;
      if (!same_file || other.key != key || std::string(other.value) != row.value) continue;
      if (!decided.insert(other.meaning.kind).second) continue;
      const double given =
          std::isnan(other.meaning.number) ? keys.begin()->second.get<double>() : other.meaning.number;
      if (other.meaning.kind == Meaning::near_plane) expected.near_plane = std::max(given, 1e-6);
      if (other.meaning.kind == Meaning::low_pass) expected.kernel_px2 = std::max(given, 0.001);
      if (other.meaning.kind == Meaning::compensated) expected.antialiased = given == 1.0;
      if (other.meaning.kind == Meaning::by_distance) expected.order = "distance";
      if (other.meaning.kind == Meaning::linear) expected.linear = true;
    }
    const std::string file = write(place, keys);
    std::string said;
    const json found = info(file, &said);
    const std::string source = place.file == "ply"   ? "a comment of the ply"
                               : place.file == "spz" ? "its flag"
                               : place.file == "SOG" ? file
                                                     : path(place.file);
    if (row.meaning.sentence != nullptr) {
      EXPECT_TRUE(has(said, app::with_options(row.meaning.sentence)));
    } else if (row.meaning.kind != Meaning::background) {
      EXPECT_EQ(drawn_as(found), expected) << found.dump(1);
      const char* by = row.meaning.kind == Meaning::near_plane    ? "near_plane_by"
                       : row.meaning.kind == Meaning::low_pass    ? "kernel_px2_by"
                       : row.meaning.kind == Meaning::compensated ? "antialiased_by"
                       : row.meaning.kind == Meaning::linear      ? "linear_by"
                                                                  : "order_by";
      EXPECT_EQ(found[by], source) << said;
      const bool rounded = place.file == "spz" || place.file == "SOG";
      const Words options = options_of(expected);
      // No option makes colours linear: LinearLightIsConvertedAfterBlending has their pictures.
      Image& wanted = of_options[(rounded ? place.file : "") + testing::PrintToString(options)];
      if (wanted.data.empty()) wanted = picture(rounded ? write(place, {}) : neutral, options);
      if (rounded) write(place, keys);
      if (!expected.linear) {
        EXPECT_EQ(picture(file, {}).data, wanted.data);
      }
      for (const char* to : {"other/a.ply", "other/a.sog", "other/a.spz"}) {
        fs::create_directories(path("other"));
        fs::copy(path("cameras.json"), path("other/cameras.json"), fs::copy_options::overwrite_existing);
        const Outcome converted = checked(run_program({"convert", file, "-o", path(to)}));
        Drawn kept = drawn_as(info(path(to)));
        if (has(converted.err, "--near " + number(expected.near_plane)))
          kept.near_plane = expected.near_plane;
        if (has(converted.err, "--eps2d " + number(expected.kernel_px2)))
          kept.kernel_px2 = expected.kernel_px2;
        if (has(converted.err, "--order " + expected.order)) kept.order = expected.order;
        if (has(converted.err, "spz does not store that colours are linear light")) kept.linear = true;
        EXPECT_EQ(kept, expected) << to << converted.err;
      }
    }
    for (const auto& entry : fs::directory_iterator(folder.path()))
      if (entry.path().filename() != "cameras.json" && entry.path() != neutral) fs::remove_all(entry.path());
  }
}

// Without a file about the training, the near plane is that of gsplat if the cameras' world is as small as
// its.
TEST_F(TrainerKeys, NearPlaneDefaultsByWorldSize) {
  const auto near = [&](const Words& options) {
    checked(run_program(
        joined({"render", model, "--mono", "--json", path("r.json"), "-o", path("p.png")}, options)));
    return load_json(path("r.json"))["settings"]["near"].get<double>();
  };
  const std::string one = save("one.json", json::array({camera_json("here", 0.0)}));
  EXPECT_EQ(near({"--view", "front"}), 0.2);
  EXPECT_EQ(near({"--cameras", one}), 0.2) << "the cameras beside the model tell the size of the world";
  EXPECT_EQ(near({"--view", "front", "--near", "0.05"}), 0.05);
  save("cameras.json", {camera_json("front", 0.0), camera_json("side", -1.0)});
  EXPECT_EQ(near({"--view", "front"}), 0.01);
  EXPECT_EQ(near({"--cameras", one}), 0.01);
  EXPECT_EQ(near({"--view", "front", "--near", "0.05"}), 0.05);
  EXPECT_TRUE(has(run_program({"info", model}).out, "near plane     0.01 units, says its cameras"));
  EXPECT_TRUE(
      has(run_program({"info", model, "--near", "0.3"}).out, "near plane     0.3 units, says --near"));
  write_text(path("cfg_args"), "Namespace(sh_degree=3)");
  EXPECT_EQ(near({"--view", "front"}), 0.2) << "a trainer's file counts before the cameras";
  save_pose(1.0, 0.063);
  EXPECT_EQ(near({}), 0.1) << "a saved pose has its own";
}

TEST_F(TrainerKeys, TextsNameOptions) {
  save("training_config.json", {{"optimization",
                                 {{"sh_degree", 3},
                                  {"use_bilateral_grid", true},
                                  {"bg_mode", "solid_color"},
                                  {"bg_color", {0.5, 0.5, 0.25}}}}});
  const Outcome outcome = checked(run_program({"info", model, "--json", path("i.json")}));
  for (const std::string& text : {outcome.out, load_json(path("i.json")).dump()}) {
    EXPECT_TRUE(has(text, ": --background 0.5,0.5,0.25 draws it so"));
    EXPECT_TRUE(has(text, "`refit` fits them")) << "a command";
  }
  fs::remove(path("training_config.json"));
  write_text(path("cfg_args"), "Namespace(sh_degree=3, kernel_size=0.1)");
  checked(run_program({"convert", model, "-o", path("a.spz"), "--json", path("c.json")}));
  EXPECT_TRUE(has(load_json(path("c.json"))["losses"].dump(), "draw it with --eps2d 0.1"));
}

TEST_F(TrainerKeys, WarnsOnceOfNearPlaneCut) {
  for (std::size_t i = 0; i < ply.rows.size(); ++i) ply.at(i, "z") -= 3.0;
  write_text(model, to_bytes(ply));
  const auto said = [&](const Words& options) {
    return checked(render(joined({"--view", "all", "--mono"}, options))).err;
  };
  const std::string usual = said({}), given = said({"--near", "1.5"});
  EXPECT_FALSE(has(usual, "hides about")) << "a few at most";
  EXPECT_TRUE(has(given, "view front: the near plane of 1.5 units hides about "));
  EXPECT_EQ(given.find("hides about"), given.rfind("hides about"));
  EXPECT_FALSE(has(given, "warning: view front"));
  for (std::size_t i = 0; i < ply.rows.size(); ++i)
    for (const char* axis : {"x", "y", "z"}) ply.at(i, axis) *= 0.1;
  write_text(model, to_bytes(ply));
  EXPECT_TRUE(has(said({}), "warning: view front: the near plane of 0.2 units hides about "));
}

// Linear light is blended, over a background of linear light, and then converted to sRGB.
TEST_F(TrainerKeys, LinearLightIsConvertedAfterBlending) {
  const std::string linear = path("linear.ply");
  PlyFile file = ply;
  file.comments = "comment colorSpace: lin_rec709_display\n";
  write_text(linear, to_bytes(file));
  for (const float behind : {0.0f, 1.0f, 0.4f}) {
    const auto over = [](float v) { return Words{"--background", fmt::format("{0},{0},{0}", v)}; };
    Image light = picture(model, over(shared::layout_to_linear(behind)));
    for (float& value : light.data) value = shared::layout_to_display(value);
    const Image shown = picture(linear, over(behind));
    EXPECT_GT(measure::psnr(shown, light), 80.0) << behind;
    EXPECT_LT(measure::psnr(shown, picture(model, over(behind))), 30.0) << "injected: unconverted";
  }
}

}  // namespace
}  // namespace binosplat
