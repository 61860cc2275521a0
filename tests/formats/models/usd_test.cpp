// OpenUSD's scenes, Spark's .rad and XGRIDS' .lcc are not read: their errors name them and the way out.

#include <gtest/gtest.h>

#include "support/load.h"
#include "support/zip.h"

namespace binosplat {
namespace {

TEST(Usd, ErrorSuggestsConversion) {
  const std::string text = "#usda 1.0\ndef Xform \"World\" {}\n", crate("PXR-USDC\0\x08", 10);
  const std::pair<const char*, std::string> scenes[] = {
      {"scene.usda", text},
      {"scene.usdc", crate},
      {"scene.usd", text},
      {"scene.usd", crate},
      {"scene.usdz", test::zipped({{"default.usda", text}, {"picture.png", "x"}})},
      {"scene.usdz", test::zipped({{"0/SCENE.USDC", crate}}, true)},
      {"scene.ply", crate}};
  for (const auto& [name, bytes] : scenes) {
    test::expect_no_models(name, {{bytes,
                                   {name, "looks like an OpenUSD scene", "export_ply.enabled=true",
                                    "threedgrut.export.scripts.transcode SCENE -o MODEL.ply"}}});
  }
  // Other archives, also cut ones, are not taken for OpenUSD.
  const std::string other = test::zipped({{"picture.png", "x"}, {"default.usda", text}});
  const auto refusal = [](const std::string& bytes) {
    try {
      test::load_model_of(bytes, "scene.usdz");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal(other).find("without a meta.json"), std::string::npos) << refusal(other);
  for (const std::size_t size : {4u, 29u, 30u, 36u})
    EXPECT_EQ(refusal(other.substr(0, size)).find("OpenUSD"), std::string::npos) << size;
}

TEST(Rad, ErrorSuggestsOriginal) {
  const std::string bytes = std::string("RAD0\x10\0\0\0{\"version\":1}", 21) + std::string(43, '\0');
  for (const char* name : {"city-lod.rad", "city-lod.splat"})
    test::expect_no_models(name, {{bytes, {name, "looks like a .rad model of Spark", "build-lod"}}});
}

TEST(Lcc, ErrorSuggestsConversion) {
  for (const char* name : {"scan.lcc", "META.LCC2"})
    test::expect_no_models(name, {{R"({"totalSplats": 9})", {name, "splat-transform converts .lcc"}}});
}

}  // namespace
}  // namespace binosplat
