// OpenUSD's scenes are not read: their error names them and the way out.

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

}  // namespace
}  // namespace binosplat
