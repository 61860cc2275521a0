#include "lab/suite.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lab/bench_settings.h"
#include "support/errors.h"

namespace binosplat::lab {
namespace {

std::vector<std::string> names_of(const Suite& suite) {
  std::vector<std::string> names;
  for (const BenchSettings& s : suite.settings) names.push_back(describe(s));
  return names;
}

TEST(Suite, ExpandAllCombinations) {
  const Suite suite = parse_suite("a.json", R"({"views": 3, "frames": 7, "repeats": 2, "eyes": [1, 2],
    "sizes": ["own", "64x48"], "settings": [
      {"tiles": ["aabb", "ellipse"], "precision": ["half", "full"]},
      {"threshold": ["adagscale", "squared"], "transmittance": ["one", "last"], "tolerance": [0.5, 2]},
      {"tiles": "ellipse"}]})");
  EXPECT_EQ(suite.views, 3);
  EXPECT_EQ(suite.frames, 7);
  EXPECT_EQ(suite.repeats, 2);
  EXPECT_EQ(suite.eyes, (std::vector{1, 2}));
  EXPECT_EQ(suite.sizes, (std::vector<std::string>{"own", "64x48"}));
  // 2 x 2 and 2 x 2 x 2 settings. The last block's only setting is also in the first block.
  EXPECT_EQ(names_of(suite), (std::vector<std::string>{
                                 "aabb, half", "aabb", "ellipse, half", "exact", "adagscale, one, 0.5",
                                 "adagscale, one, 2", "adagscale, last, 0.5", "adagscale, last, 2",
                                 "squared, 0.5", "squared, 2", "squared, last, 0.5", "squared, last, 2"}));
  EXPECT_EQ(row_of_settings(suite.settings.back()).dump(),
            R"({"tiles":"ellipse","threshold":"squared","transmittance":"last","tolerance":2.0})");
}

TEST(Suite, HalfPrecisionIsApproximate) {
  const Suite suite = parse_suite("a", R"({"settings": [{"precision": ["full", "half"]}]})");
  ASSERT_EQ(suite.settings.size(), 2);
  EXPECT_EQ(suite.sizes, (std::vector<std::string>{"own"})) << "where none is named";
  EXPECT_EQ(suite.eyes, (std::vector{1}));
  EXPECT_TRUE(is_exact(suite.settings[0]));
  EXPECT_FALSE(is_exact(suite.settings[1]));
  EXPECT_EQ(describe(suite.settings[1]), "ellipse, half");
  EXPECT_EQ(row_of_settings(suite.settings[1]).dump(),
            R"({"tiles":"ellipse","precision":"half","threshold":"exact"})");
}

TEST(Suite, InsetsMakeSettingsInexact) {
  const Suite suite = parse_suite("a", R"({"settings": [{}, {"inset": 20, "context": [0.25, 0.5]},
    {"inset": [10, 30], "threshold": "squared", "tolerance": 0.3}]})");
  EXPECT_EQ(names_of(suite),
            (std::vector<std::string>{"exact", "ellipse, inset 20, context 0.25",
                                      "ellipse, inset 20, context 0.5", "squared, inset 10, context 0.4, 0.3",
                                      "squared, inset 30, context 0.4, 0.3"}));
  EXPECT_TRUE(is_exact(suite.settings[0]));
  EXPECT_FALSE(is_exact(suite.settings[1]));
  EXPECT_EQ(row_of_settings(suite.settings[1]).dump(),
            R"({"tiles":"ellipse","threshold":"exact","inset":20.0,"context":0.25})");
}

TEST(Suite, AcceptQualitiesTargetsAndLevels) {
  const Suite suite = parse_suite("a", R"({"training": 3, "along": ["walk", "still"], "settings": [
    {"threshold": "squared", "transmittance": ["one", "depth"], "far": [100, null], "max_drop": 0.1,
     "found_on": ["test", "training"]},
    {"threshold": "adagscale", "quality": [37, 40]},
    {"detail": ["30dB", 2]}, {"order": "distance", "projection": "tangent"}]})");
  EXPECT_EQ(suite.training, 3);
  EXPECT_EQ(suite.along, (std::vector<std::string>{"walk", "still"}));
  EXPECT_EQ(names_of(suite),
            (std::vector<std::string>{
                "squared, 0.1 dB lost", "squared, found on training views, 0.1 dB lost",
                "squared, depth, far 100, 0.1 dB lost",
                "squared, depth, far 100, found on training views, 0.1 dB lost",
                "squared, depth, 0.1 dB lost", "squared, depth, found on training views, 0.1 dB lost",
                "adagscale, asked for 37 dB", "adagscale, asked for 40 dB", "ellipse, levels for 30dB",
                "ellipse, levels for 2px", "ellipse, by distance, tangent"}));
  EXPECT_EQ(row_of_settings(suite.settings[3]).dump(),
            R"({"tiles":"ellipse","threshold":"squared","transmittance":"depth","far":100.0,"max_drop":0.1,)"
            R"("found_on":"training"})");
  EXPECT_FALSE(is_exact(suite.settings[8]));
  EXPECT_TRUE(is_exact(suite.settings[10]));
}

TEST(Suite, PresetsAreWellFormed) {
  EXPECT_EQ(suite_presets(),
            (std::vector<std::string>{"foveate", "headset", "levels", "motion", "paper", "quick"}));
  for (const std::string& name : suite_presets()) EXPECT_GE(load_suite(name).settings.size(), 4) << name;
  EXPECT_EQ(load_suite("headset").eyes, std::vector{2});
  EXPECT_EQ(load_suite("motion").along, (std::vector<std::string>{"still", "calm", "walk", "fast"}));
  EXPECT_TRUE(load_suite("paper").contributions);
}

TEST(Suite, ErrorsNamePlace) {
  const struct {
    const char* text;
    const char* said;
  } cases[] = {
      {"{", "a.json is not valid JSON"},
      {R"({"frames": 1e999})", "a.json is not valid JSON"},
      {"[]", "a.json: expected an object"},
      {R"({"settings": []})", "expected a list 'settings'"},
      {R"({"settings": {}})", "expected a list 'settings'"},
      {R"({})", "expected a list 'settings'"},
      {R"({"settings": [{}], "frmaes": 3})", "unknown key 'frmaes'"},
      {R"({"settings": [{}, 5]})", "block 2 (counted from 1): expected an object"},
      {R"({"settings": [{"tiles": "box"}]})", "'tiles': 'box' is not one of aabb, ellipse"},
      {R"({"settings": [{"tiles": []}]})", "'tiles' is an empty list"},
      {R"({"settings": [{"threshold": 3}]})", "'threshold': '3' is not one of exact"},
      {R"({"settings": [{"threshold": "squared"}]})",
       "threshold needs one of: a tolerance above 0, a quality, max_drop, min_psnr"},
      {R"({"settings": [{"threshold": "exact", "tolerance": 1}]})",
       "tolerance has no effect with an exact threshold"},
      {R"({"settings": [{"transmittance": "last"}]})", "transmittance last has no effect on exact pictures"},
      {R"({"settings": [{"threshold": "squared", "tolerance": 1, "contrast": "final"}]})",
       "unknown key 'contrast'"},
      {R"({"settings": [{"threshold": "squared", "tolerance": 1, "transmittance": "both"}]})",
       "'transmittance': 'both' is not one of one, depth, last"},
      {R"({"settings": [{"threshold": "squared", "tolerance": -1}]})",
       "'tolerance' -1: expected a number of 0 or more"},
      {R"({"settings": [{"threshold": "squared", "tolerance": 1e99}]})", "'tolerance' 1e+99: expected"},
      {R"({"settings": [{"threshold": "squared", "tolerance": 1, "quality": 40}]})",
       "threshold needs one of"},
      {R"({"settings": [{"threshold": "squared", "quality": 1000}]})", "quality 1000: expected decibels"},
      {R"({"settings": [{"max_drop": 0.1}]})", "find a tolerance, but threshold exact has none"},
      {R"({"settings": [{"detail": "90dB"}]})", "'detail' 90dB: expected pixels"},
      {R"({"settings": [{"order": "size"}]})", "'order': 'size' is not one of depth, distance"},
      {R"({"settings": [{"threshold": "squared", "min_psnr": 40, "found_on": "photos"}]})",
       "'found_on': 'photos'"},
      {R"({"settings": [{}], "along": "crawl"})", "'along' \"crawl\": expected one of views, still"},
      {R"({"settings": [{}], "contributions": 1})", "'contributions' 1: expected true or false"},
      {R"({"settings": [{"context": 0.5}]})", "'context' has no effect without 'inset'"},
      {R"({"settings": [{"inset": "wide"}]})", "'inset' \"wide\": expected a number"},
      {R"({"settings": [{"inset": 0}]})", "inset 0: expected 1 to 120 degrees"},
      {R"({"settings": [{"inset": 20, "context": 2}]})", "context 2: expected 0.05 to 1"},
      {R"({"settings": [{}], "frames": 0})", "'frames' 0: expected a whole number from 1"},
      {R"({"settings": [{}], "frames": 1.5})", "'frames' 1.5: expected a whole number"},
      {R"({"settings": [{}], "eyes": 3})", "'eyes' 3: expected a whole number from 1 to 2"},
      {R"({"settings": [{}], "sizes": "big"})", "'sizes' \"big\": expected own, WxH"},
      {R"({"settings": [{}], "sizes": "0x5"})", "'sizes' \"0x5\""},
  };
  for (const auto& c : cases) EXPECT_ERROR(parse_suite("a.json", c.text), c.said) << c.text;
  EXPECT_ERROR(load_suite("fovate"), "fovate", "foveate, headset, levels, motion, paper, quick");
  // Lists with more combinations than fit into memory.
  const nlohmann::json block = {{"threshold", nlohmann::json(50, "squared")},
                                {"tolerance", nlohmann::json(500, 0.5)}};
  const std::string many = nlohmann::json{{"settings", {block}}}.dump();
  EXPECT_ERROR(parse_suite("a.json", many), "block 1", "more than 10000 combinations");
}

}  // namespace
}  // namespace binosplat::lab
