// The grid on the ground and the cameras, which the preview draws among the splats.

#include "preview/marks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "formats/pictures/image_file.h"
#include "measure/metrics.h"
#include "preview/session.h"
#include "render/faulty_shaders.h"
#include "support/gl.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat::preview {
namespace {

const glm::dvec3 world_up(0, -1, 0);

double difference(const Image& a, const Image& b) { return measure::largest_difference(a, b).max; }

/// Returns whether pixels are equal within about two steps of 8 bits: a wall transmits a ten-thousandth.
bool same_at(const Image& a, const Image& b, int x, int y) {
  bool same = true;
  for (int c = 0; c < 3; ++c) same = same && std::abs(a.at(x, y, c) - b.at(x, y, c)) < 2.5f / 255.0f;
  return same;
}

bool is_at(const Image& image, const glm::vec3& colour, int x, int y) {
  bool same = true;
  for (int c = 0; c < 3; ++c) same = same && std::abs(image.at(x, y, c) - colour[c]) < 1.5f / 255.0f;
  return same;
}

/// Adds a wall perpendicular to z, opaque in its middle.
void add_wall(Model& model, const glm::vec2& from, const glm::vec2& to, float z, const glm::vec3& colour) {
  for (float y = from.y; y <= to.y; y += 0.1f) {
    for (float x = from.x; x <= to.x; x += 0.1f)
      test::add(model, {x, y, z}, {0.1f, 0.1f, 0.01f}, 0.999f, colour);
  }
}

/// Returns a floor perpendicular to y, with the usual up direction of worlds.
Model floor_at(float y) {
  Model model;
  for (float z = -3.0f; z <= 3.0f; z += 0.15f) {
    for (float x = -3.0f; x <= 3.0f; x += 0.15f) test::add(model, {x, y, z}, {0.1f, 0.01f, 0.1f}, 0.9f);
  }
  return model;
}

TEST(Marks, GridLiesOnFloor) {
  const MarkPlaces places = places_of(find_mark_ground(floor_at(1.5f), world_up), {}, 1.0);
  EXPECT_NEAR(places.middle.y, 1.5, 0.08);
  EXPECT_LT(places.middle.y, 1.5) << "the floor's splats cover it";
  EXPECT_EQ(places.spacing, 1.0);
  const auto lines = grid_lines(places);
  ASSERT_GE(lines.size(), 8u);
  for (const Line& line : lines) {
    EXPECT_NEAR(line.from.y, places.middle.y, 1e-12);
    EXPECT_NEAR(line.to.y, places.middle.y, 1e-12);
  }
  EXPECT_EQ(places_of(find_mark_ground(floor_at(1.5f), world_up), {}, 2.0).spacing, 2.0)
      << "two units are the metre";
  EXPECT_EQ(places_of(find_mark_ground({}, world_up), {}, 1.0).spacing, 1.0) << "a model without Gaussians";
  // The model's 6 units are 6 mm or 6 km: its lines are a round number of metres apart instead of one.
  EXPECT_NEAR(places_of(find_mark_ground(floor_at(1.5f), world_up), {}, 1000.0).spacing, 0.5, 1e-9);
  EXPECT_NEAR(places_of(find_mark_ground(floor_at(1.5f), world_up), {}, 0.001).spacing, 0.5, 1e-9);
}

TEST(Marks, GridFallsBackBelowCameras) {
  Model wall;
  add_wall(wall, {-1, -1}, {1, 1}, 4.0f, glm::vec3(1));
  Camera camera = test::front_camera(64, 40, 55.0);
  camera.position.y = 0.5;
  EXPECT_NEAR(places_of(find_mark_ground(wall, world_up), std::array{camera}, 1.0).middle.y, 0.5 + 1.6, 1e-9);
  // If the distance is a hundred times the model, units are not metres.
  EXPECT_LT(places_of(find_mark_ground(wall, world_up), std::array{camera}, 100.0).middle.y, 3.0);
}

TEST(Marks, TrianglesCoverProjectedLine) {
  Camera eye = test::front_camera(64, 40, 55.0);
  eye.cx += 3.0;
  const Line line{{-0.5, 0.2, 2.0}, {1.0, 0.2, 4.0}, grid_colour};
  const auto corners = triangles(std::array{line}, eye, 0.1, 2.0);
  ASSERT_EQ(corners.size(), 6u);
  const auto px = [&](const MarkVertex& v) {
    return glm::dvec2((0.5 + 0.5 * v.place.x / v.place.w) * 64, (0.5 - 0.5 * v.place.y / v.place.w) * 40);
  };
  const glm::dvec2 from = 0.5 * (px(corners[0]) + px(corners[1])),
                   to = 0.5 * (px(corners[2]) + px(corners[5]));
  EXPECT_NEAR(from.x, 55.0 * -0.25 + 35.0, 1e-4);
  EXPECT_NEAR(from.y, 55.0 * 0.1 + 20.0, 1e-4);
  EXPECT_NEAR(to.x, 55.0 * 0.25 + 35.0, 1e-4);
  EXPECT_NEAR(glm::distance(px(corners[0]), px(corners[1])), 2.0, 1e-4);
  EXPECT_NEAR(0.5 + 0.5 * corners[0].place.z / corners[0].place.w, 1.0 - 0.1 / 2.0, 1e-6) << "its depth";
  // Lines that cross the near plane are clipped. Lines behind it are not drawn.
  const Line half{{0, 0.2, -5.0}, {0, 0.2, 5.0}, grid_colour},
      behind{{0, 0, -5.0}, {0, 0, 0.05}, grid_colour};
  for (const MarkVertex& v : triangles(std::array{half, behind}, eye, 0.1, 2.0))
    EXPECT_GE(v.place.w, 0.0999f);
  EXPECT_EQ(triangles(std::array{half, behind}, eye, 0.1, 2.0).size(), 6u);
}

TEST(Marks, HidesCameraAtHead) {
  const Camera front = test::front_camera(64, 40, 55.0);
  Camera far_away = front;
  far_away.position.x = 5.0;
  const std::array cameras = {front, far_away};
  const auto lines = camera_lines(cameras, 1, {0, 0, 0.1}, 0.3);
  ASSERT_FALSE(lines.empty());
  for (const Line& line : lines) {
    EXPECT_GT(line.from.x, 4.0);
    EXPECT_EQ(line.colour, camera_here_colour);
  }
  EXPECT_EQ(camera_lines(cameras, 1, {9, 9, 9}, 0.3).size(), 2 * lines.size());
}

/// A wall that hides the left half of each eye's view, and another wall behind all marks, with nothing
/// between them. The head looks along z.
struct MarkedSession : testing::Test {
  // Columns in px: the near wall covers those before `covered`, and nothing covers those from `open` on.
  static constexpr int width = 96, height = 60, covered = 24, open = 64;
  test::TempFolder folder;
  std::vector<Camera> cameras = [] {
    std::vector<Camera> list(3, test::front_camera(width, height, 0.8 * width));
    list[1].position = {0.7, 0.0, 2.5};
    list[2].position = {-1.2, 0.0, 2.5};  // behind the wall
    return list;
  }();
  std::unique_ptr<Session> session = make();

  std::unique_ptr<Session> make(bool listed = true) const {
    Model model;
    add_wall(model, {-2.0, -1.5}, {-0.2, 2.0}, 2.0f, {0.8f, 0.2f, 0.1f});
    add_wall(model, {-4.0, -3.0}, {4.0, 3.4}, 5.5f, {0.2f, 0.5f, 0.2f});
    auto made = std::make_unique<Session>(test::gl_context(), OpenedModel<Stream>{.whole = std::move(model)},
                                          Start{cameras, world_up, listed}, Choices{}, folder.path());
    made->resize({2 * width, height});
    return made;
  }

  Image picture() {
    session->change();
    session->draw();
    EXPECT_EQ(session->trouble(), "");
    return load_image(session->save_picture(false));
  }
  Image with(bool grid, bool of_cameras) {
    session->choices.grid = grid;
    session->choices.cameras = of_cameras;
    return picture();
  }

  /// Returns what is wrong with marks of a colour in both eyes, side by side. They must be visible in front
  /// of the far wall, hidden behind the near one, and change no other pixels.
  static std::string wrong(const Image& marked, const Image& plain, const glm::vec3& colour) {
    for (int eye = 0; eye < 2; ++eye) {
      int seen = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const bool same = same_at(marked, plain, eye * width + x, y);
          if (!same && x < covered) return fmt::format("eye {}: seen through a wall at {}, {}", eye, x, y);
          if (!same && x >= open && !is_at(marked, colour, eye * width + x, y))
            return fmt::format("eye {}: neither mark nor wall at {}, {}", eye, x, y);
          if (!same && x >= open) ++seen;
        }
      }
      if (seen < 15) return fmt::format("eye {}: {} px of the marks are seen", eye, seen);
    }
    return "";
  }
};

TEST_F(MarkedSession, DisabledMarksLeaveNoTrace) {
  const Image before = with(false, false);
  const auto stages = session->frames().back().report.stages.size();
  EXPECT_GT(difference(with(true, true), before), 0.1);
  EXPECT_GT(session->frames().back().report.stages.size(), stages);
  EXPECT_EQ(difference(with(false, false), before), 0.0);
  EXPECT_EQ(session->frames().back().report.stages.size(), stages);
}

TEST_F(MarkedSession, SplatsAndGridOcclude) {
  const Image plain = with(false, false), marked = with(true, false);
  EXPECT_EQ(wrong(marked, plain, grid_colour), "");
  EXPECT_EQ(difference(with(true, false), marked), 0.0);
}

TEST_F(MarkedSession, SplatsAndCamerasOcclude) {
  const Image plain = with(false, false);
  EXPECT_EQ(wrong(with(false, true), plain, camera_colour), "");
  session->step_camera(1);
  session->go_to(cameras[0]);
  EXPECT_EQ(wrong(picture(), plain, camera_here_colour), "") << "it is not told which one R leads to";
  session = make(false);
  EXPECT_EQ(difference(with(false, true), plain), 0.0) << "cameras that were made up are drawn";
}

TEST_F(MarkedSession, SplatsAndRulerOcclude) {
  const Image plain = with(false, false);
  session->ruler = {{-3.0, 0.0, 5.5}, {3.0, 0.5, 5.5}};
  EXPECT_EQ(wrong(picture(), plain, ruler_colour), "");
  session->ruler.reset();
  EXPECT_EQ(difference(picture(), plain), 0.0);
}

TEST_F(MarkedSession, InjectedFaultIsDetected) {
  const Image plain = with(false, false);
  // Injected: the blend ignores the depths.
  const test::FaultyShaders faulty("blend_mesh.glsl", "z < NO_MESH ? z : NO_MESH",
                                   "z < NO_MESH ? NO_MESH : NO_MESH");
  EXPECT_NE(wrong(with(true, false), plain, grid_colour), "");
  EXPECT_NE(wrong(with(false, true), plain, camera_colour), "");
}

TEST_F(MarkedSession, EveryLayoutShowsMarks) {
  for (const int layout :
       {LAYOUT_SEPARATE, LAYOUT_CROSS_EYED, LAYOUT_HALF_HEIGHT, LAYOUT_ROWS, LAYOUT_GREY}) {
    session->choices.layout = layout;
    const Image plain = with(false, false);
    EXPECT_GT(difference(with(true, false), plain), 0.1) << layout;
  }
}

TEST_F(MarkedSession, DoubleClickTargetsGrid) {
  const Image plain = with(false, false), marked = with(true, false);
  const MarkPlaces places = session->mark_places();
  for (int y = height - 1; y >= 0; --y) {
    if (same_at(marked, plain, open + 8, y)) continue;
    session->focus({open + 8, y});
    EXPECT_NEAR(session->head.target().y, places.middle.y, 0.1) << "its depth is not that of the line";
    return;
  }
  FAIL() << "there is no line in this column";
}

TEST_F(MarkedSession, MeasurementsIgnoreMarks) {
  const Image plain = with(false, false), marked = with(true, true);
  EXPECT_FALSE(session->threshold_effect()) << "the exact picture is without marks";
  EXPECT_EQ(difference(load_image(session->save_picture(false)), marked), 0.0);
  session->choices.show = SHOW_SPLIT;
  session->choices.split = 0.5;
  EXPECT_EQ(difference(picture(), plain), 0.0);
  session->choices.show = SHOW_PICTURE;
  session->choices.settings = {
      {.tolerance = 1.0f, .threshold = Threshold::squared, .transmittance = Transmittance::last}};
  picture();
  choose_quality(session->choices.settings, 40.0f);
  picture();
}

}  // namespace
}  // namespace binosplat::preview
