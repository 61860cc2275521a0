// Compares decoding in Scaffold-GS with the trainer's arithmetic (expected.npz, decoded_0001.json), and with
// values that follow from weights set by hand.

#include "reference/decode.h"

#include <gtest/gtest.h>
#include <zip.h>

#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "formats/models/scaffold_file.h"
#include "reference/trained.h"
#include "support/fixtures.h"
#include "support/models.h"
#include "support/scaffold.h"

namespace binosplat::reference {
namespace {

namespace fs = std::filesystem;

// Reads NumPy's .npz archives, as far as the fixture needs it: arrays of float32 or bool.

/// Returns an array's elements in C order.
std::vector<float> parse_npy(const std::string& bytes) {
  if (bytes.size() < 10 || bytes.substr(1, 5) != "NUMPY") throw std::runtime_error("no .npy");
  const std::size_t header =
      static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  const bool bools = bytes.substr(10, header).find("'|b1'") != std::string::npos;
  const std::string data = bytes.substr(10 + header);
  if (bools) return {data.begin(), data.end()};
  if (bytes.substr(10, header).find("'<f4'") == std::string::npos)
    throw std::runtime_error("neither f4 nor b1");
  std::vector<float> values(data.size() / 4);
  std::memcpy(values.data(), data.data(), 4 * values.size());
  return values;
}

std::map<std::string, std::vector<float>> load_npz(const std::filesystem::path& path) {
  int error = 0;
  zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY, &error);
  if (archive == nullptr) throw std::runtime_error("cannot read " + path.string());
  std::map<std::string, std::vector<float>> arrays;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    zip_stat_t status;
    zip_stat_index(archive, static_cast<zip_uint64_t>(i), 0, &status);
    std::string bytes(status.size, '\0');
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
    zip_fread(file, bytes.data(), bytes.size());
    zip_fclose(file);
    const std::string name = status.name;
    arrays[name.substr(0, name.find(".npy"))] = parse_npy(bytes);
  }
  zip_discard(archive);
  return arrays;
}

shared::View view_from(const glm::dvec3& eye) {
  Camera camera = test::front_camera(64, 64, 64.0);
  camera.position = eye;
  return make_view(camera);
}

std::vector<Decoded> decode_all(const Scaffold& scaffold, const glm::dvec3& eye) {
  return decode(scaffold, view_from(eye), false);
}

/// The trainer's values for the fixture.
struct Expected {
  std::map<std::string, std::vector<float>> arrays;

  std::vector<std::size_t> ids() const {
    std::vector<std::size_t> ids;
    for (std::size_t i = 0; i < arrays.at("keep").size(); ++i) {
      if (arrays.at("keep")[i] != 0.0f) ids.push_back(i);
    }
    return ids;
  }
  template <typename Vector>
  double difference(const char* name, std::size_t i, const Vector& value) const {
    double most = 0.0;
    const int length = Vector::length();
    for (int c = 0; c < length; ++c)
      most = std::max(
          most,
          std::abs(value[c] -
                   arrays.at(name)[i * static_cast<std::size_t>(length) + static_cast<std::size_t>(c)]));
    return most;
  }
};

std::vector<std::size_t> ids_of(const std::vector<Decoded>& decoded) {
  std::vector<std::size_t> ids;
  for (const Decoded& d : decoded) ids.push_back(d.id);
  return ids;
}

/// Returns the largest difference from the trainer's values, or infinity if other Gaussians are kept.
double error_on(const Expected& expected, const Scaffold& scaffold) {
  const std::vector<float>& cam = expected.arrays.at("cam");
  const std::vector<Decoded> decoded = decode_all(scaffold, {cam[0], cam[1], cam[2]});
  if (ids_of(decoded) != expected.ids()) return INFINITY;
  double most = 0.0;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    const Gaussian& g = decoded[i].gaussian;
    most = std::max({most, expected.difference("xyz", i, g.position),
                     expected.difference("scale", i, g.scale), expected.difference("quat", i, g.rotation),
                     expected.difference("rgb", i, decoded[i].colour),
                     expected.difference("opacity", i, glm::dvec1(g.opacity))});
  }
  return most;
}

TEST(Decode, MatchesTrainerOnFixture) {
  REQUIRE_FIXTURES(formats);
  const fs::path folder = formats.parent_path() / "scaffold" / "fixture";
  const Expected expected{load_npz(folder / "expected.npz")};
  ASSERT_EQ(expected.ids().size(), 336u);
  const auto scaffold = load_scaffold(OpenedFile(folder / "point_cloud.ply"));
  EXPECT_LT(error_on(expected, *scaffold), 1e-5);

  // Injected faults: a bias of the second layer, and the two scales swapped.
  Scaffold faulty = *scaffold;
  faulty.covariance.second_bias[3] += 1e-3f;
  EXPECT_GT(error_on(expected, faulty), 1e-5);
  faulty = *scaffold;
  faulty.scale.swap(faulty.offset_scale);
  EXPECT_GT(error_on(expected, faulty), 1e-5);
}

void expect_same(const nlohmann::json& truth, const Decoded& decoded) {
  const auto expect_near = [&](const char* name, const auto& value) {
    for (int c = 0; c < value.length(); ++c)
      EXPECT_NEAR(value[c], truth.at(name)[static_cast<std::size_t>(c)].get<double>(), 1e-4)
          << name << " of " << decoded.id;
  };
  expect_near("mean", decoded.gaussian.position);
  expect_near("scale", decoded.gaussian.scale);
  expect_near("quat_wxyz", decoded.gaussian.rotation);
  expect_near("rgb", decoded.colour);
  EXPECT_NEAR(decoded.gaussian.opacity, truth.at("alpha").get<double>(), 1e-4) << decoded.id;
}

TEST(Decode, MatchesTrainerOnRealModel) {
  REQUIRE_SCENE("scaffold", scenes);
  REQUIRE_SCENE("fox", fox_folder);
  const auto truth = nlohmann::json::parse(std::ifstream(scenes / "fox" / "decoded_0001.json"));
  const auto scaffold = load_scaffold(OpenedFile(scenes / "fox" / "point_cloud.ply"));
  const shared::View view = make_view(camera_named(fox_folder / "cameras.json", "0001"));
  const std::vector<Decoded> all = decode(*scaffold, view, false);
  const std::vector<Decoded> seen = decode(*scaffold, view);

  const double undecided = truth.at("alphas_within_1e-5_of_0");
  EXPECT_NEAR(double(all.size()), truth.at("kept").get<double>(), undecided);
  EXPECT_NEAR(double(seen.size()), truth.at("kept_after_voxel_cull").get<double>(), undecided);
  int anchors = 0;
  for (std::size_t n = 0; n < scaffold->anchor_count(); ++n)
    anchors += sees_anchor(*scaffold, n, view) ? 1 : 0;
  EXPECT_EQ(anchors, truth.at("anchors_after_voxel_cull").get<int>());

  std::map<std::size_t, const Decoded*> by_id;
  glm::dvec3 mean(0.0), colour(0.0), scale(0.0);
  glm::dvec4 rotation(0.0);
  double alpha = 0.0;
  for (const Decoded& d : all) {
    by_id[d.id] = &d;
    mean += d.gaussian.position;
    scale += d.gaussian.scale;
    rotation += glm::abs(d.gaussian.rotation);
    colour += d.colour;
    alpha += d.gaussian.opacity;
  }
  for (const nlohmann::json& one : truth.at("gaussians")) {
    ASSERT_TRUE(by_id.count(one.at("id")));
    expect_same(one, *by_id[one.at("id")]);
    EXPECT_EQ(sees_anchor(*scaffold, one.at("anchor"), view), one.at("anchor_passes_cull").get<bool>());
  }
  // One Gaussian more or less changes a sum by at most its own value. The rest is fp32 rounding over 127,027
  // Gaussians.
  const nlohmann::json& sums = truth.at("sums_over_kept");
  for (std::size_t c = 0; c < 3; ++c) {
    const int i = static_cast<int>(c);
    EXPECT_NEAR(mean[i], sums.at("mean")[c].get<double>(), 30.0);
    EXPECT_NEAR(scale[i], sums.at("scale")[c].get<double>(), 0.1);
    EXPECT_NEAR(colour[i], sums.at("rgb")[c].get<double>(), 3.0);
  }
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_NEAR(rotation[static_cast<int>(c)], sums.at("abs_quat_wxyz")[c].get<double>(), 3.0);
  EXPECT_NEAR(alpha, sums.at("alpha").get<double>(), 0.01);
}

/// Returns a model of one anchor at (0, 0, 4) with constant networks: the opacity before tanh is 0.5, all
/// else 0.
Scaffold flat() {
  Scaffold s = test::random_scaffold(1, {.anchors = 1, .offsets = 2, .features = 8, .hidden = 1});
  s.position[0] = {0.0f, 0.0f, 4.0f};
  for (Network* network : {&s.opacity, &s.covariance, &s.colour}) {
    std::fill(network->first.begin(), network->first.end(), 0.0f);
    network->first_bias = {0.0f};
    std::fill(network->second.begin(), network->second.end(), 1.0f);
    std::fill(network->second_bias.begin(), network->second_bias.end(), 0.0f);
  }
  s.opacity.second_bias = {0.5f, 0.5f};
  return s;
}

double logit(double p) { return std::log(p / (1.0 - p)); }

TEST(Decode, DistanceIsOptionalInput) {
  Scaffold s = flat();
  s.opacity.inputs = 12;
  s.opacity.first.assign(12, 0.0f);
  s.opacity.first[11] = 0.1f;
  s.opacity.distance = true;
  EXPECT_NEAR(decode_all(s, {0, 0, 0})[1].gaussian.opacity, std::tanh(0.5 + 0.4), 1e-7);
  EXPECT_NEAR(decode_all(s, {0, 0, -6})[1].gaussian.opacity, std::tanh(0.5 + 1.0), 1e-7);
}

TEST(Decode, ColoursUseAppearanceRow) {
  Scaffold s = flat();
  s.appearance_size = 2;
  s.appearances = {0.0f, 1.0f, 0.0f, 3.0f};
  s.colour.inputs = 13;
  s.colour.first.assign(13, 0.0f);
  s.colour.first[12] = 1.0f;
  EXPECT_NEAR(logit(decode_all(s, {0, 0, 0})[0].colour.r), 1.0, 1e-6);
  s.appearance = 1;
  EXPECT_NEAR(logit(decode_all(s, {0, 0, 0})[0].colour.r), 3.0, 1e-6);
}

TEST(Decode, FeatureBankMixesThreeResolutions) {
  Scaffold s = flat();
  s.feature = {1, 2, 3, 4, 5, 6, 7, 8};
  s.bank = Network{4, 1, 3, {0, 0, 0, 0}, {0}, {0, 0, 0}, {0, 0, 0}, true};
  const auto input = [&](std::size_t i) {
    std::fill(s.colour.first.begin(), s.colour.first.end(), 0.0f);
    s.colour.first[i] = 1.0f;
    return logit(decode_all(s, {0, 0, 0})[0].colour.r);
  };
  const double resolutions[3][8] = {
      {1, 5, 1, 5, 1, 5, 1, 5}, {1, 3, 5, 7, 1, 3, 5, 7}, {1, 2, 3, 4, 5, 6, 7, 8}};
  for (std::size_t level = 0; level < 3; ++level) {
    s.bank->second_bias = {-50, -50, -50};
    s.bank->second_bias[level] = 50;
    for (std::size_t i = 0; i < 8; ++i)
      EXPECT_NEAR(input(i), resolutions[level][i], 1e-5) << level << " " << i;
  }
  s.bank->second_bias = {0, 0, 0};
  EXPECT_NEAR(input(5), (5.0 + 3.0 + 6.0) / 3.0, 1e-5);
}

TEST(Decode, SkipsNonPositiveAlphas) {
  Scaffold s = flat();
  s.opacity.second_bias = {0.0f, 1e-6f};
  ASSERT_EQ(ids_of(decode_all(s, {0, 0, 0})), (std::vector<std::size_t>{1}));
  s.opacity.second_bias = {-1.0f, -1e-6f};
  EXPECT_TRUE(decode_all(s, {0, 0, 0}).empty());
}

}  // namespace
}  // namespace binosplat::reference
