// The layout of widgets, without a window: Dear ImGui computes it for a display of any size.

#include "preview/panel.h"

#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui/imgui_internal.h>

#include "preview/messages.h"
#include "support/gl.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat::preview {
namespace {

struct PanelTest : testing::Test {
  test::TempFolder folder;
  Session session{test::gl_context(),
                  {.whole = test::random_model(9, 400, 0, 0.6)},
                  {{[] {
                     Camera camera = test::front_camera(64, 40, 55.0);
                     camera.name = "a/rather/long/name/of/a/folder/of/photos/DSC07956.JPG";
                     return camera;
                   }()},
                   glm::dvec3(0, -1, 0)},
                  {.show = SHOW_DEPTH},
                  folder.path()};
  Panel panel;

  PanelTest() {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    session.resize({340, 400});
    session.draw();
    session.add_key();
    session.add_key();
  }
  ~PanelTest() override { ImGui::DestroyContext(); }

  /// Draws some frames at a size and scale of the display, with all sections open.
  void show(float width, float height, float scale, const std::vector<Message>& messages = {}) {
    ImGui::GetIO().DisplaySize = {width, height};
    set_scale(scale, 1.0f);
    unsigned char* pixels = nullptr;
    int across = 0, down = 0;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &across, &down);
    for (int frame = 0; frame < 4; ++frame) {
      ImGui::NewFrame();
      const float beside = width - panel.width(width);
      draw_legend(SHOW_DEPTH, *session.max_shown(), beside);
      panel.draw(session);
      preview::draw(messages, beside);
      ImGui::Render();
      ImGuiWindow* const window = ImGui::FindWindowByName("panel");
      if (window == nullptr) continue;
      for (const char* section : {"view", "eyes", "path", "open", "accuracy", "times", "keys"})
        window->StateStorage.SetInt(window->GetID(section), 1);
    }
  }

  /// Presses a key and releases it, in a small display.
  void press(ImGuiKey key) {
    ImGuiIO& io = ImGui::GetIO();
    for (const bool down : {true, false}) {
#if IMGUI_VERSION_NUM >= 18700
      io.AddKeyEvent(key, down);
#else
      io.KeyMap[key] = key;
      io.KeysDown[key] = down;
#endif
      show(640.0f, 400.0f, 1.0f);
    }
  }

  static ImRect place(const char* name) { return ImGui::FindWindowByName(name)->Rect(); }
};

TEST_F(PanelTest, LiesBesidePictureAndScrolls) {
  for (const auto& [width, height, scale] :
       {std::array{640.0f, 400.0f, 1.0f}, std::array{1280.0f, 720.0f, 1.0f},
        std::array{3840.0f, 2160.0f, 2.0f}, std::array{640.0f, 400.0f, 2.0f}}) {
    show(width, height, scale);
    const ImGuiWindow* const window = ImGui::FindWindowByName("panel");
    const ImRect at = window->Rect();
    EXPECT_EQ(at.Max.x, width);
    EXPECT_EQ(at.GetHeight(), height);
    EXPECT_EQ(at.Min.x, width - panel.width(width)) << "the picture does not begin where it ends";
    EXPECT_LE(at.GetWidth(), 0.5f * width);
    EXPECT_GE(at.GetWidth(), std::min(0.5f * width, 20.0f * 13.0f * scale)) << "it does not follow the scale";
    // The wheel reaches all that does not fit.
    EXPECT_GE(window->ScrollMax.y + window->InnerRect.GetHeight(), window->ContentSize.y) << width;
    EXPECT_EQ(window->ScrollMax.y > 0.0f, window->ContentSize.y > window->InnerRect.GetHeight()) << width;
    const float most = scale * 640.0f <= width ? window->InnerRect.GetWidth() : window->ContentSize.x;
    EXPECT_LE(window->ContentSize.x, most) << "cut off at the right at " << width;
  }
  panel.open = false;
  EXPECT_EQ(panel.width(640.0f), 0.0f);
}

TEST_F(PanelTest, KeyboardNavigationIsOptIn) {
  show(640.0f, 400.0f, 1.0f);
  ImGuiIO& io = ImGui::GetIO();
  panel.takes_keys = true;
  press(ImGuiKey_DownArrow);
  press(ImGuiKey_Space);
  EXPECT_TRUE(panel.open) << "a key presses something where nobody enabled keys";
  enable_keys();
  panel.takes_keys = true;
  // Since Dear ImGui 1.89, Tab also stops at widgets between the numbers.
  for (int k = 0; k < 20 && !io.WantTextInput; ++k) press(ImGuiKey_Tab);
  EXPECT_TRUE(io.WantTextInput) << "Tab goes to the next number, which is typed";
  press(ImGuiKey_Escape);
  EXPECT_FALSE(io.WantTextInput);
  press(ImGuiKey_UpArrow);
  EXPECT_TRUE(io.NavVisible);
  EXPECT_FALSE(io.WantCaptureKeyboard) << "W A S D would end";
  // The first widget hides the panel.
  for (int k = 0; k < 60; ++k) press(ImGuiKey_UpArrow);
  press(ImGuiKey_LeftArrow);
  press(ImGuiKey_Space);
  EXPECT_FALSE(panel.open);
}

TEST_F(PanelTest, TypedLengthGoesToRuler) {
  std::optional<double> length;
  panel.requests.set_ruler_length = [&](double metres) { length = metres; };
  ImGuiIO& io = ImGui::GetIO();
  session.ruler.emplace();
  show(640.0f, 400.0f, 1.0f);
  EXPECT_FALSE(io.WantTextInput) << "a length before there are two points";
  session.ruler = {glm::dvec3(0.0), glm::dvec3(0.0, 0.0, 3.0)};
  panel.takes_length = true;
  show(640.0f, 400.0f, 1.0f);
  ASSERT_TRUE(io.WantTextInput) << "the length is not typed at once";
  io.AddInputCharactersUTF8("1.5");
  show(640.0f, 400.0f, 1.0f);
  EXPECT_FALSE(length) << "before Enter";
  press(ImGuiKey_Enter);
  EXPECT_EQ(length, 1.5);
}

TEST_F(PanelTest, OverlayTextsFitWithoutOverlap) {
  const std::vector<Message> messages = {
      {"saved /home/somebody/with/a/rather/long/name/out/garden/preview_001.png", false, 1.0},
      {"garden.ply: vertex 17: the position is not finite; a model has a place for each Gaussian", true,
       1.0}};
  for (const bool open : {true, false}) {
    panel.open = open;
    show(640.0f, 400.0f, 1.0f, messages);
    const float beside = 640.0f - panel.width(640.0f);
    for (const char* name : {"messages", "legend"}) {
      const ImRect at = place(name);
      EXPECT_GE(at.Min.x, 0.0f) << name;
      EXPECT_LE(at.Max.x, beside) << name;
      EXPECT_LE(at.Max.y, 400.0f) << name;
    }
    EXPECT_FALSE(place("messages").Overlaps(place("legend")));
    // Both texts are complete: as tall as they are when wrapped, one below the other.
    const ImGuiWindow* const window = ImGui::FindWindowByName("messages");
    EXPECT_GE(window->InnerRect.GetHeight() + 1.0f, window->ContentSize.y);
    EXPECT_GT(window->ContentSize.y, 2.0f * 13.0f);
  }
}

}  // namespace
}  // namespace binosplat::preview
