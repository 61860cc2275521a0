// OpenUSD text files with Gaussians: values, transforms, and errors in other files.

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "formats/usd.h"
#include "scene/axes.h"
#include "support/load.h"
#include "support/models.h"
#include "support/ply_models.h"
#include "support/round_trip.h"
#include "support/usd.h"
#include "support/zip.h"

namespace binosplat {
namespace {

using test::load_usd_text;
using test::usd_file;
using test::usd_prim;

testing::AssertionResult refuses_usd(const std::string& text, std::vector<std::string> parts) {
  parts.emplace_back("bad.usda");
  return test::fails_saying([&] { test::load_model_of(text, "bad.usda"); }, parts);
}

Model some_model(int degree = 3, std::size_t count = 20) { return test::hard_model(degree, count); }

/// Returns a file with one small Gaussian at (1, 2, 3) in a prim within a prim. Their bodies begin with
/// `inner` and `outer`.
std::string placed(const std::string& outer, const std::string& inner = "") {
  Model one;
  test::add(one, {1, 2, 3}, glm::vec3(0.1f), 0.5f);
  return usd_file("def Xform \"World\"\n{\n" + outer + "\n" + usd_prim(one, inner) + "}\n");
}

testing::AssertionResult lies_at(const std::string& text, const glm::vec3& expected) {
  const glm::vec3 at = load_usd_text(text).position.at(0);
  if (glm::distance(at, expected) < 1e-5f) return testing::AssertionSuccess();
  return testing::AssertionFailure() << at.x << " " << at.y << " " << at.z;
}

TEST(Usd, ReadsWhatAPlyReads) {
  for (const int degree : {0, 1, 2, 3}) {
    const Model model = some_model(degree);
    const Model read = load_usd_text(usd_file(usd_prim(model)));
    EXPECT_TRUE(test::equal(read, model)) << degree;
    EXPECT_EQ(read.format, "OpenUSD");
    EXPECT_EQ(read.axes.letters, "RUB");
    EXPECT_EQ(read.perspective, Perspective{});
  }
  // Planted fault: quaternions are read as x y z w instead of w x y z.
  const Model model = some_model();
  Model turned = model;
  for (glm::vec4& q : turned.rotation) q = {q.y, q.z, q.w, q.x};
  EXPECT_FALSE(test::equal(load_usd_text(usd_file(usd_prim(turned))), model));
}

TEST(Usd, LooksAsTheSamePlyInTheFrameOfItsAxes) {
  const Model model = some_model(2);
  for (const std::string up : {"Y", "Z"}) {
    Model moved = model;
    bring_into_axes(moved, up == "Y" ? "RUB" : "RFU");
    Model read =
        load_usd_text(test::replaced(usd_file(usd_prim(moved)), "upAxis = \"Y\"", "upAxis = \"" + up + "\""));
    EXPECT_EQ(read.axes.letters, moved.axes.letters);
    bring_into_axes(read, "RDF");
    for (std::size_t i = 0; i < model.count(); ++i) EXPECT_EQ(read.position[i], model.position[i]);
    for (std::size_t k = 0; k < model.sh.size(); ++k) EXPECT_NEAR(read.sh[k], model.sh[k], 1e-5f);
  }
}

TEST(Usd, HalvesAndWhatIsNotThere) {
  std::string text = usd_prim(some_model(0, 2));
  for (const char* name : {"positions", "orientations", "scales", "opacities", "Coefficients"})
    text = test::replaced(text, std::string(name) + " =", std::string(name) + "h =");
  EXPECT_TRUE(test::equal(load_usd_text(usd_file(text)), some_model(0, 2)));
  const Model bare = load_usd_text(
      usd_file("def ParticleField3DGaussianSplat \"a\" { point3f[] positions = [(1, 2, 3),] }"));
  Model expected;
  test::add(expected, {1, 2, 3}, glm::vec3(1.0f), 1.0f, glm::vec3(0.5f));
  EXPECT_TRUE(test::equal(bare, expected));
}

TEST(Usd, SaysHowItIsSeen) {
  const auto seen = [](const std::string& more) {
    return load_usd_text(usd_file(usd_prim(some_model(0, 1), more))).perspective;
  };
  EXPECT_EQ(seen("uniform token sortingModeHint = \"cameraDistance\"\n"),
            (Perspective{.order = ORDER_DISTANCE}));
  EXPECT_EQ(seen("uniform token projectionModeHint = \"tangential\"\n"),
            (Perspective{.projection = PROJECTION_TANGENT}));
  testing::internal::CaptureStderr();
  EXPECT_EQ(seen("uniform token sortingModeHint = \"rayHitDistance\"\n"), Perspective{});
  EXPECT_NE(testing::internal::GetCapturedStderr().find("'rayHitDistance' is drawn as"), std::string::npos);
}

TEST(Usd, FlatGaussiansOf3dgrut) {
  const std::string text =
      "def ParticleField \"surfels\" (\n  prepend apiSchemas = [\"ParticleFieldPositionAttributeAPI\", "
      "\"ParticleFieldKernelGaussianSurfletAPI\"]\n)\n{\n" +
      test::usd_attributes(some_model(1)) + "}\n";
  Model expected = some_model(1);
  for (glm::vec3& scale : expected.scale) scale.z = 0.0f;
  const Model read = load_usd_text(usd_file(text));
  EXPECT_TRUE(test::equal(read, expected));
  EXPECT_EQ(read.format, "OpenUSD, flat Gaussians");
  EXPECT_TRUE(refuses_usd(usd_file(test::replaced(text, "GaussianSurfletAPI", "ConstantSurfletAPI")),
                          {"line 8", "'surfels' is a ParticleField with another kernel"}));
}

/// Returns the order in which a prim's transforms apply.
std::string order_of(const std::vector<std::string>& names) {
  return fmt::format("uniform token[] xformOpOrder = [\"{}\"]\n", fmt::join(names, "\", \""));
}

TEST(Usd, Transforms) {
  const std::string translate = "double3 xformOp:translate = (10, 0, 0)\n";
  const std::string scale = "float3 xformOp:scale = (2, 2, 2)\n";
  const std::string own = "float3 xformOp:translate = (1, 1, 1)\n";
  const std::string parent = scale + order_of({"xformOp:scale"});
  const struct {
    std::string outer, inner;
    glm::vec3 place;
  } cases[] = {
      {"", "", {1, 2, 3}},
      // The last transform of the order applies first.
      {translate + scale + order_of({"xformOp:translate", "xformOp:scale"}), "", {12, 4, 6}},
      {translate + scale + order_of({"xformOp:scale", "xformOp:translate"}), "", {22, 4, 6}},
      // A transform that the order omits does not apply.
      {translate, "", {1, 2, 3}},
      // 90 degrees around x, then around y.
      {"float3 xformOp:rotateXYZ = (90, 90, 0)\n" + order_of({"xformOp:rotateXYZ"}), "", {2, -3, -1}},
      {"float3 xformOp:rotateYXZ = (90, 90, 0)\n" + order_of({"xformOp:rotateYXZ"}), "", {3, 1, 2}},
      {"float xformOp:rotateZ:a = 90\n" + order_of({"xformOp:rotateZ:a"}), "", {-2, 1, 3}},
      {"quatf xformOp:orient = (0.70710678, 0, 0, 0.70710678)\n" + order_of({"xformOp:orient"}),
       "",
       {-2, 1, 3}},
      // Matrices are given by rows, with the translation in the last row.
      {"matrix4d xformOp:transform = ( (0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1) )\n" +
           order_of({"xformOp:transform"}),
       "",
       {3, 7, 10}},
      // Rotation around a pivot.
      {"float3 xformOp:translate:pivot = (1, 2, 0)\nfloat xformOp:rotateZ = 90\n" +
           order_of({"xformOp:translate:pivot", "xformOp:rotateZ", "!invert!xformOp:translate:pivot"}),
       "",
       {1, 2, 3}},
      // The prim's own transform with its parent's, and without its parent's.
      {parent, own + order_of({"xformOp:translate"}), {4, 6, 8}},
      {parent, own + order_of({"!resetXformStack!", "xformOp:translate"}), {2, 3, 4}},
  };
  for (const auto& [outer, inner, place] : cases) EXPECT_TRUE(lies_at(placed(outer, inner), place)) << outer;
}

TEST(Usd, PlacesKeepTheirDigits) {
  const glm::dvec3 far(455000.25, 5411000.5, 312.125);
  const Model model = some_model(0);
  const auto worst = [&](const std::string& place) {
    const Model read = load_usd_text(usd_file(usd_prim(model, place + order_of({"xformOp:translate"}))));
    double worst_of = 0.0;
    for (std::size_t i = 0; i < model.count(); ++i)
      worst_of = std::max(worst_of, glm::distance(read.axes.origin + glm::dvec3(read.position[i]),
                                                  far + glm::dvec3(model.position[i])));
    return worst_of;
  };
  EXPECT_LT(worst("double3 xformOp:translate = (455000.25, 5411000.5, 312.125)\n"), 1e-5);
  EXPECT_GT(worst("double3 xformOp:translate = (455000.25, 5411000.5, 312)\n"), 0.1) << "planted fault";
}

// OpenUSD holds a value until the next sample, and uses the first sample's value before it.
TEST(Usd, OneTimeSampleIsEveryTime) {
  const Model model = some_model(1, 2);
  const std::string text = usd_file(usd_prim(model)), other = usd_file(usd_prim(some_model(1, 1)));
  for (const std::string name : {"positions", "orientations", "scales", "opacities"}) {
    const auto value_in = [&](const std::string& file) {
      const std::size_t begin = file.find(name + " = ") + name.size() + 3;
      return file.substr(begin, file.find('\n', begin) - begin);
    };
    const std::string value = value_in(text);
    const auto with = [&](const std::string& samples) {
      return test::replaced(text, name + " = " + value, name + ".timeSamples = {" + samples + "}");
    };
    EXPECT_TRUE(test::equal(load_usd_text(with("1: " + value + ",")), model)) << name;
    EXPECT_TRUE(test::equal(load_usd_text(with("-1.5: " + value + ", 3: " + value)), model)) << name;
    EXPECT_TRUE(refuses_usd(with("1: " + value + ", 2: " + value_in(other)), {name + " changes with time"}))
        << "planted fault";
  }
  const std::string order = order_of({"xformOp:translate"});
  // Time samples override the default value, whatever their order in the file.
  EXPECT_TRUE(lies_at(placed("double3 xformOp:translate.timeSamples = { 1: (10, 0, 0), }\n"
                             "double3 xformOp:translate = (0, 7, 0)\n" +
                             order),
                      {11, 2, 3}));
  EXPECT_TRUE(
      refuses_usd(placed("double3 xformOp:translate.timeSamples = { 1: (10, 0, 0), 2: (0, 0, 0) }\n" + order),
                  {"moves with time"}));
  for (const char* when : {"1", "1: \"invisible\", 2"})
    EXPECT_TRUE(
        refuses_usd(placed(std::string("token visibility.timeSamples = { ") + when + ": \"invisible\" }"),
                    {"visible Gaussians"}));
}

TEST(Usd, GuidesAndProxiesAreNotDrawn) {
  const auto with = [](const std::string& purpose, std::size_t count) {
    const std::string line = purpose.empty() ? "" : "uniform token purpose = \"" + purpose + "\"\n";
    return "def Xform \"" + purpose + std::to_string(count) + "\"\n{\n" + line +
           usd_prim(some_model(0, count)) + "}\n";
  };
  const auto count = [](const std::string& prims) { return load_usd_text(usd_file(prims)).count(); };
  EXPECT_EQ(count(with("", 1) + with("guide", 2) + with("default", 4)), 5u);
  EXPECT_EQ(count(with("proxy", 2) + with("", 1)), 3u) << "alone it stands for nothing that is there";
  EXPECT_EQ(count(with("proxy", 2) + with("render", 4)), 4u);
  // A prim's own purpose overrides an inherited one.
  EXPECT_EQ(count("def Xform \"a\"\n{\nuniform token purpose = \"guide\"\n" + with("render", 3) +
                  with("", 1) + "}\n"),
            3u);
}

TEST(Usd, SaysItsUnit) {
  const test::TempFolder folder;
  const auto units = [&](const std::string& more) {
    test::write_text(folder / "a.usda",
                     test::replaced(usd_file(usd_prim(some_model(0, 1))), "metersPerUnit = 1\n", more));
    return usd_units_per_metre(folder / "a.usda");
  };
  EXPECT_EQ(units("metersPerUnit = 0.01\n"), 100.0);
  EXPECT_EQ(units("metersPerUnit = 1\n"), 1.0);
  EXPECT_EQ(units(""), std::nullopt);
  for (const char* bad : {"0", "-1", "nan", "1e-320"})
    EXPECT_THROW(units(std::string("metersPerUnit = ") + bad + "\n"), Error) << bad;
}

TEST(Usd, OpacitiesBeyondOne) {
  Model model = some_model(0, 200);
  model.opacity.assign(200, 1.0f);
  const Model whole = model;
  model.opacity[3] = std::nextafter(1.0f, 2.0f);
  EXPECT_TRUE(test::equal(load_usd_text(usd_file(usd_prim(model))), whole));
  model.opacity[3] = 1.5f;  // A single opacity above 1 counts as damage.
  EXPECT_EQ(load_usd_text(usd_file(usd_prim(model))).left_out, 1u);
  for (std::size_t i = 0; i < 200; ++i) model.opacity[i] = 0.1f * static_cast<float>(i) - 5.0f;
  EXPECT_TRUE(refuses_usd(usd_file(usd_prim(model)), {"opacities are from -5 to 14.9", "logits", "0 to 1"}));
}

TEST(Usd, OnlyWhatIsToBeSeen) {
  const Model one = some_model(0, 1), two = some_model(1, 2);
  const std::string hidden[] = {
      "def Xform \"a\" { token visibility = \"invisible\"\n" + usd_prim(one) + "}\n",
      "def Xform \"a\" ( active = false ) {\n" + usd_prim(one) + "}\n",
      "class \"a\" {\n" + usd_prim(one) + "}\n", "over \"a\" {\n" + usd_prim(one) + "}\n",
      test::replaced(usd_prim(one), "def ", "class ")};
  for (const std::string& text : hidden) {
    EXPECT_EQ(load_usd_text(usd_file(text + usd_prim(two))).count(), 2u) << text;
    EXPECT_TRUE(refuses_usd(usd_file(text), {"without visible Gaussians"}));
  }
  testing::internal::CaptureStderr();
  EXPECT_EQ(
      load_usd_text(usd_file("def PointInstancer \"a\" {\n" + usd_prim(one) + "}\n" + usd_prim(two))).count(),
      2u);
  EXPECT_NE(
      testing::internal::GetCapturedStderr().find("only its Gaussians are drawn, and no PointInstancer"),
      std::string::npos);
  // The Gaussians of all prims are drawn, even if their degrees differ.
  const Model both = load_usd_text(usd_file(usd_prim(one) + usd_prim(two)));
  EXPECT_EQ(both.count(), 3u);
  EXPECT_EQ(both.degree, 1);
}

TEST(Usd, OtherThingsInAFileAreSkipped) {
  const std::string text = usd_file(
      "# a comment { ( \"\ndef Mesh \"m\" (\n  kind = \"component\"\n  customData = {\n    string a = \"} ) "
      "\\\" \"\n"
      "  }\n)\n{\n  custom rel material:binding = </a/b{>\n  asset file = @./tex(ture.png@\n  token s = "
      "None\n"
      "  float x.timeSamples = { 0: 1, 1: 2, }\n  append rel other = [</a>, </b>]\n  string d = '''two\n"
      "lines ' of \"text\"'''; int i = 3\n  reorder nameChildren = [\"a\"]\n}\n" +
      usd_prim(some_model(0, 1)));
  EXPECT_EQ(load_usd_text(text).count(), 1u);
  EXPECT_EQ(load_usd_text(test::replaced(text, "\ndef Mesh", ";\r\n\tdef Mesh")).count(), 1u);
}

TEST(Usd, SaysWhatHasToBePutTogether) {
  const std::string world =
      "def Xform \"World\" (\n  prepend references = @gauss.usdc@</a> (offset = 1)\n) {}\n";
  EXPECT_TRUE(refuses_usd(usd_file(world), {"no Gaussians of its own, but references",
                                            "usdcat --flatten bad.usda -o bad.flat.usda"}));
  EXPECT_TRUE(refuses_usd(usd_file("", "subLayers = [@a.usd@]\n"), {"but subLayers"}));
  EXPECT_TRUE(refuses_usd(usd_file("def Xform \"a\" {\n variantSet \"v\" = {\n \"x\" {\n" +
                                   usd_prim(some_model(0, 1)) + "}\n}\n}\n"),
                          {"but variantSet"}));
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_usd_text(usd_file(world + usd_prim(some_model(0, 1)))).count(), 1u);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("the contents of its references are not drawn"),
            std::string::npos);
}

TEST(Usd, ErrorsNameTheLine) {
  const std::string good =
      usd_file("def ParticleField3DGaussianSplat \"a\"\n{\n  point3f[] positions = [(1, 2, 3)]\n}\n");
  ASSERT_EQ(load_usd_text(good).count(), 1u);
  const auto with = [&](const char* from, const std::string& to) { return test::replaced(good, from, to); };
  std::string deep = "#usda 1.0\n";
  for (int k = 0; k < 100000; ++k) deep += "def \"a\" {\n";
  const std::string shear = order_of({"xformOp:shear"}) + "}\n";
  const std::vector<test::BrokenFile> refusals = {
      {with("(1, 2, 3)", "(1, 2)"), {"line 10", "expected ',', found ')]'"}},
      {with("(1, 2, 3)", "(1, two, 3)"), {"line 10", "expected a number, found 'two, 3)]'"}},
      {with("(1, 2, 3)", "1, 2"), {"line 10", "expected '('"}},
      {with("(1, 2, 3)]", "(1, 2, 3)"), {"line 11", "expected ']', found '}'"}},
      {with("]\n}\n", ""), {"line 10", "this value does not end: the file is cut short"}},
      {with("}\n", ""), {"line 11", "a prim or an attribute, found the end of the file: it is cut short"}},
      {with("positions =", "= "), {"line 10", "the type and the name of an attribute"}},
      {with("def Part", "define Part"), {"line 8", "expected def, over or class"}},
      {with("\"a\"", "\"a"), {"line 8", "text in quotes does not end"}},
      {with("\"Y\"", "\"X\""), {"line 4", "upAxis 'X'"}},
      {with("}\n", "float[] opacities = []}\n"),
       {"line 11", "opacities has 0 values; expected 1, 1 for each of 1 positions"}},
      {with("}\n", "float3[] radiance:sphericalHarmonicsCoefficients = [(1, 1, 1)]}\n"),
       {"has 1 values; expected 16"}},
      {with("}\n", "uniform int radiance:sphericalHarmonicsDegree = 7}\n"),
       {"line 11", "harmonics of degree 7"}},
      {with("positions = [(1, 2, 3)]", "positions.timeSamples = { 1: [(1, 2, 3)], 2: [] }"),
       {"line 10", "positions changes with time"}},
      {with("positions =", "positions.timeSamples ="), {"line 10", "expected '{'"}},
      {with("}\n", shear), {"line 11", "'xformOp:shear' of 'a' is missing"}},
      {with("}\n", "float xformOp:shear = 1\n" + shear), {"line 11", "unknown transform xformOp:shear"}},
      {with("}\n", "float3 xformOp:scale = (1e300, 1, 1)\n" + order_of({"xformOp:scale"}) + "}\n"),
       {"line 8", "beyond the range of floats"}},
      {with("Field3DGaussianSplat", "s"), {"is an OpenUSD scene without visible Gaussians", "Particles"}},
      {deep, {"line 502", "nested more than 500 deep"}},
  };
  test::expect_no_models("bad.usda", refusals);
}

TEST(Usd, Archives) {
  const test::TempFolder folder;
  const std::string text = usd_file(usd_prim(some_model()));
  test::write_zip(folder / "a.usdz", {{"default.usda", text}, {"picture.png", "x"}});
  EXPECT_TRUE(test::equal(load_model(folder / "a.usdz"), some_model()));
  const auto packed = [](const char* name, const std::string& content) {
    return test::zipped({{name, content}});
  };
  const std::vector<test::BrokenFile> refusals = {
      {packed("a.usdc", "PXR-USDC and more"),
       {"a binary OpenUSD scene", "usdcat --flatten b.usdz -o b.flat.usda"}},
      {packed("a.usda", "#usda 1.0\ndef X"), {"b.usdz: its file a.usda, line 2"}},
      {packed("a.usda", "words"), {"a.usda", "looks like a text file"}},
      {packed("a.usda", usd_file("def \"a\" (references = @b.usdc@) {}")),
       {"usdcat --flatten b.usdz -o b.flat.usda"}},
  };
  test::expect_no_models("b.usdz", refusals);
  test::expect_no_models("bad.usd", {{"PXR-USDC and more", {"usdcat --flatten bad.usd -o bad.flat.usda"}}});
}

}  // namespace
}  // namespace binosplat
