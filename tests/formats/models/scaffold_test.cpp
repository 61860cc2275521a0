// Scaffold-GS models: written models of every network kind load unchanged, and errors name unsuitable files.
// tests/reference/decode_test.cpp loads files of the trainer.

#include <gtest/gtest.h>

#include "formats/containers/torch_file.h"
#include "formats/models/model_file.h"
#include "formats/models/scaffold_file.h"
#include "support/broken.h"
#include "support/scaffold_files.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

bool same(const Network& a, const Network& b) {
  return a.inputs == b.inputs && a.hidden == b.hidden && a.outputs == b.outputs && a.first == b.first &&
         a.first_bias == b.first_bias && a.second == b.second && a.second_bias == b.second_bias &&
         a.distance == b.distance;
}

template <typename Vector>
double largest_in_vectors(const std::vector<Vector>& a, const std::vector<Vector>& b) {
  if (a.size() != b.size()) return INFINITY;
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, static_cast<double>(glm::length(a[i] - b[i])));
  return most;
}

testing::AssertionResult same(const Scaffold& a, const Scaffold& b) {
  if (a.offset_count != b.offset_count || a.feature_count != b.feature_count)
    return testing::AssertionFailure() << "K or F";
  if (a.position != b.position || a.offset != b.offset || a.feature != b.feature)
    return testing::AssertionFailure() << "positions, offsets or features";
  // The file stores logarithms of scales, and quaternions of any length, so these values are rounded.
  if (largest_in_vectors(a.offset_scale, b.offset_scale) > 1e-6)
    return testing::AssertionFailure() << "offset scales";
  if (largest_in_vectors(a.scale, b.scale) > 1e-6) return testing::AssertionFailure() << "scales";
  if (largest_in_vectors(a.rotation, b.rotation) > 1e-6) return testing::AssertionFailure() << "rotations";
  if (!same(a.opacity, b.opacity) || !same(a.covariance, b.covariance) || !same(a.colour, b.colour))
    return testing::AssertionFailure() << "networks";
  if (a.appearance_size != b.appearance_size || a.appearances != b.appearances)
    return testing::AssertionFailure() << "appearances";
  if (a.bank.has_value() != b.bank.has_value() || (a.bank && !same(*a.bank, *b.bank)))
    return testing::AssertionFailure() << "feature bank";
  return testing::AssertionSuccess();
}

TEST(ScaffoldFile, RoundTripsEveryKind) {
  const test::ScaffoldKind kinds[] = {
      {},
      {.distances = true},
      {.appearances = 3},
      {.distances = true, .appearances = 4},
      {.bank = true},
      {.anchors = 1, .offsets = 1, .features = 1, .hidden = 1},
      {.anchors = 7, .offsets = 31, .features = 8, .hidden = 20, .distances = true, .bank = true},
  };
  for (const test::ScaffoldKind& kind : kinds) {
    const test::TempFolder folder;
    const Scaffold written = test::random_scaffold(3, kind);
    test::write_scaffold(folder.path(), written);
    EXPECT_TRUE(same(*load_scaffold(OpenedFile(folder / "point_cloud.ply")), written)) << kind.offsets;
    Scaffold fault = written;
    fault.scale.swap(fault.offset_scale);
    EXPECT_FALSE(same(fault, written)) << kind.offsets;
  }
}

TEST(ScaffoldFile, FindsColumnsByName) {
  const test::TempFolder folder;
  const Scaffold written = test::random_scaffold(4);
  test::write_scaffold(folder.path(), written);
  test::PlyFile file = test::anchor_file(written);
  std::reverse(file.columns.begin(), file.columns.end());
  for (auto& row : file.rows) std::reverse(row.begin(), row.end());
  test::write_text(folder / "point_cloud.ply", to_bytes(file));
  test::write_zip(folder / "cov_mlp.pt", test::entries_of(written.covariance), true);
  EXPECT_TRUE(same(*load_scaffold(OpenedFile(folder / "point_cloud.ply")), written));
}

// files_of_model_test lists the files of such a folder.
TEST(ScaffoldFile, FolderIsModelOfAllGaussians) {
  const test::TempFolder folder;
  test::write_scaffold(folder.path(), test::random_scaffold(1, {.anchors = 8}));
  const Model model = load_model(folder.path());
  EXPECT_EQ(model.scaffold->anchor_count(), 8u);
  EXPECT_EQ(model.count(), 80u);
  EXPECT_EQ(model.position[23], model.scaffold->mean(23));
}

TEST(ScaffoldFile, SelectsAppearanceByRow) {
  Scaffold scaffold = test::random_scaffold(1, {.appearances = 3});
  choose_appearance(scaffold, 2);
  EXPECT_EQ(scaffold.appearance, 2u);
  EXPECT_ERROR(choose_appearance(scaffold, 3), "appearance 3", "0 to 2");
  Scaffold without = test::random_scaffold(1);
  EXPECT_ERROR(choose_appearance(without, 0), "without appearances");
}

TEST(ScaffoldFile, ReadsTrainerFiles) {
  REQUIRE_SCENE("scaffold", scenes);
  const auto fox = load_scaffold(OpenedFile(scenes / "fox" / "point_cloud.ply"));
  EXPECT_EQ(fox->anchor_count(), 18290u);
  EXPECT_EQ(fox->offset_count, 10u);
  EXPECT_EQ(fox->feature_count, 32u);
  EXPECT_EQ(fox->opacity.inputs, 35u);
  EXPECT_EQ(fox->appearance_size, 0u);
  EXPECT_FALSE(fox->opacity.distance || fox->covariance.distance || fox->colour.distance || fox->bank);
  EXPECT_EQ(fox->left_out, 0u);
}

/// A good model in a folder. Each test breaks one of its files.
struct BrokenScaffold : testing::Test {
  BrokenScaffold() { test::write_scaffold(folder.path(), good); }

  testing::AssertionResult refused(const std::vector<std::string>& said) const {
    return test::fails_saying([&] { load_model(folder.path()); }, said);
  }
  void expect_refused(const std::string& file, const std::vector<test::BrokenFile>& refusals) const {
    const std::string before = test::read_text(folder / file);
    test::expect_refusals(file, refusals, [&](const std::string& bytes) {
      test::write_text(folder / file, bytes);
      load_model(folder.path());
    });
    test::write_text(folder / file, before);
  }

  test::TempFolder folder;
  const Scaffold good = test::random_scaffold(5, {.appearances = 3});
};

TEST_F(BrokenScaffold, MissingFiles) {
  fs::remove(folder / "cov_mlp.pt");
  EXPECT_TRUE(refused({"cov_mlp.pt is missing"}));
  test::write_text(folder / "checkpoints.pth", "PK");
  EXPECT_TRUE(refused({"cov_mlp.pt is missing", "'split'"}));
  test::write_zip(folder / "cov_mlp.pt", test::entries_of(good.covariance));
  fs::remove(folder / "embedding_appearance.pt");
  EXPECT_TRUE(refused({"embedding_appearance.pt is missing", "color_mlp.pt has 5 inputs besides"}));
}

TEST_F(BrokenScaffold, WrongSizes) {
  const auto with = [](Network network, void (*change)(Network&)) {
    change(network);
    return test::zipped(test::entries_of(network));
  };
  const auto opacity = [&](void (*change)(Network&)) { return with(good.opacity, change); };
  const std::vector<test::BrokenFile> of_opacity = {
      {opacity([](Network& n) { n.first.pop_back(); }),
       {"1119 weights and 32 biases do not form a first layer"}},
      {opacity([](Network& n) { n.first.resize(32 * 37); }), {"37 inputs; expected 35", "or 36"}},
      {opacity([](Network& n) { n.first_bias.clear(); }), {"0 biases"}},
      {opacity([](Network& n) { n.second_bias.pop_back(); }), {"320 weights and 9 biases; expected 10 x 32"}},
      {opacity([](Network& n) { n.second[17] = NAN; }), {"value 17 of tensor 'net/data/2' is not finite"}}};
  expect_refused("opacity_mlp.pt", of_opacity);
  const std::string colour = with(good.colour, [](Network& n) { n.first.resize(32 * 34); });
  expect_refused("color_mlp.pt", {{colour, {"34 inputs; expected 35"}}});
  const std::string appearances = test::zipped(test::torch_entries({std::vector<float>(13)}));
  expect_refused("embedding_appearance.pt", {{appearances, {"13 values; expected rows of 5"}}});
  test::write_zip(folder / "feature_bank_mlp.pt", test::entries_of(good.opacity));
  EXPECT_TRUE(refused({"feature_bank_mlp.pt", "expected 3 x 32 and 3"}));
}

TEST_F(BrokenScaffold, BrokenArchives) {
  const auto with = [&](const auto& change, bool deflated = false) {
    test::ZipEntries entries = test::entries_of(good.colour);
    change(entries);
    return test::zipped(entries, deflated);
  };
  const std::string whole = with([](test::ZipEntries&) {});
  std::string flipped = whole;
  flipped[flipped.find("net/data/0") + 100] ^= 1;
  const std::string bomb = with([](auto& e) { e[2].second.assign(std::size_t{65} << 20, '\0'); }, true);
  EXPECT_LT(bomb.size(), 200000u);
  // This archive promises less than it contains.
  std::string liar = with([](auto& e) { e[2].second.assign(4480000, '\0'); }, true);
  const std::string truth = test::little(4480000u), promise = test::little(4480u);
  while (liar.find(truth) != std::string::npos) liar = test::replaced(liar, truth, promise);
  std::vector<test::BrokenFile> refusals = {
      {with([](auto& entries) { entries.pop_back(); }), {"no tensor 3; expected 4"}},
      {with([](auto& entries) { entries[2].second += "x"; }),
       {"'net/data/0' has 5121 bytes, not a number of float32"}},
      {with([](auto& entries) { entries.emplace_back("net/byteorder", "big"); }), {"byte order is 'big'"}},
      {"<html>not found</html>", {"expected a zip archive", "HTML"}},
      {test::zipped({{"hello", "you"}}), {"without data.pkl"}},
      {flipped, {"'net/data/0' is damaged", "CRC"}},
      {bomb, {"'net/data/0' promises 68157440 bytes; expected at most 67108864"}},
      {liar, {"'net/data/0'", "damaged"}},
  };
  for (const std::size_t bytes : {whole.size() - 1, whole.size() / 2, std::size_t{30}, std::size_t{4}})
    refusals.push_back(
        {whole.substr(0, bytes), {"zip archive is damaged or cut short", "fetch or export it again"}});
  for (const char* name : {"../data/0", "/etc/passwd", "a/../../b", "a\\b"})
    refusals.push_back(
        {with([&](auto& entries) { entries.emplace_back(name, "x"); }), {"leads out of the archive", name}});
  expect_refused("color_mlp.pt", refusals);
}

TEST_F(BrokenScaffold, AnchorFaultsAreNamed) {
  const auto with = [&](const auto& change) {
    test::PlyFile file = test::anchor_file(good);
    change(file);
    return to_bytes(file);
  };
  const auto renamed = [&](const char* from, const char* to) {
    return with([&](test::PlyFile& f) { f.columns[f.column(from)] = to; });
  };
  const auto without_two = [&](const char* a, const char* b) {
    return with([&](test::PlyFile& f) {
      f.columns[f.column("f_anchor_feat_31")] = a;
      f.columns[f.column("f_anchor_feat_30")] = b;
    });
  };
  const auto of_infinite = [](test::PlyFile& f) {
    for (std::size_t n = 0; n < f.rows.size(); ++n) f.at(n, "f_anchor_feat_0") = INFINITY;
  };
  const std::string bytes = to_bytes(test::anchor_file(good));
  expect_refused(
      "point_cloud.ply",
      {{bytes.substr(0, bytes.size() - 1), {"is cut short", "element 'vertex' needs 40 x 316 = "}},
       {with([](test::PlyFile& f) { f.format = "ascii"; }), {"Scaffold-GS", "binary_little_endian"}},
       {with([](test::PlyFile& f) { f.type = "double"; }),
        {"property 'x' of element 'vertex' is not of type float"}},
       {with([](test::PlyFile& f) { f.rows.clear(); }), {"holds no anchors"}},
       {renamed("f_offset_7", "other"), {"29 properties f_offset_*"}},
       {renamed("f_offset_7", "f_offset_30"), {"no property 'f_offset_7'"}},
       {renamed("scale_5", "other"), {"no property 'scale_5'"}},
       {without_two("a", "a"), {"'a' occurs twice"}},
       {with(of_infinite), {"all of its 40 anchors"}}});
  test::write_text(folder / "point_cloud.ply", without_two("a", "b"));
  EXPECT_TRUE(refused({"opacity_mlp.pt", "35 inputs; expected 33", "or 34"})) << "two features too few";
  test::write_text(folder / "point_cloud.ply", with([](test::PlyFile& f) {
                     f.at(3, "x") = NAN;
                     f.at(4, "scale_1") = 1000;
                   }));
  const auto kept = load_model(folder.path()).scaffold;
  EXPECT_EQ(kept->left_out, 2u);
  EXPECT_EQ(kept->position[3], good.position[5]);
  EXPECT_EQ(kept->feature[3 * 32 + 1], good.feature[5 * 32 + 1]);
}

}  // namespace
}  // namespace binosplat
