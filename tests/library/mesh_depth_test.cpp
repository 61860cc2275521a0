// Compares splats among meshes with the float64 reference. The caller has already drawn a table and a ball.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "library/renderer_fixture.h"
#include "measure/metrics.h"
#include "reference/render.h"
#include "stereo/eyes.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double floor_db = 60.0;

/// Returns a pixel's index in a picture, row by row.
std::size_t place(int x, int y) { return static_cast<std::size_t>(y) * size.x + x; }

/// How a texture stores depths.
struct Kept {
  GLenum format = GL_DEPTH_COMPONENT32F;
  MeshDepth coding = {};

  double number_of(double z) const {
    if (coding.coding == DepthCoding::axis) return std::isinf(z) ? 0.0 : z / coding.units_per_number;
    const double a = 1.0 / coding.near_plane, b = 1.0 / coding.far_plane;
    return std::isinf(z) ? (a > b ? 1.0 : 0.0) : std::clamp((1.0 / z - a) / (b - a), 0.0, 1.0);
  }
  double depth_of(double number) const {
    if (coding.coding == DepthCoding::axis) return number > 0.0 ? number * coding.units_per_number : inf;
    const double a = 1.0 / coding.near_plane, b = 1.0 / coding.far_plane;
    return number == (a > b ? 1.0 : 0.0) ? inf : 1.0 / (a + number * (b - a));
  }
};

MeshDepth planes(double near, double far) { return {.near_plane = near, .far_plane = far}; }

/// Returns the view z of the meshes in each pixel of a view, top row first, and infinity if there is no mesh.
/// The meshes are a table below the eyes and a ball on it.
std::vector<double> table_and_ball(const shared::View& view) {
  std::vector<double> depths;
  const auto up = [&](const glm::vec4& row) { return glm::dvec3(row); };
  const glm::dmat3 to_eye = glm::transpose(glm::dmat3(up(view.row_x), up(view.row_y), up(view.row_z)));
  const glm::dvec3 eye = glm::dvec3(view.anchor) + glm::dvec3(view.eye);
  const glm::dvec3 ball(0.2, 0.1, 3.0);
  for (std::uint32_t y = 0; y < view.height; ++y) {
    for (std::uint32_t x = 0; x < view.width; ++x) {
      const glm::dvec3 ray = glm::transpose(to_eye) * glm::dvec3((x + 0.5 - view.lens.z) / view.lens.x,
                                                                 (y + 0.5 - view.lens.w) / view.lens.y, 1.0);
      double z = inf;
      if (ray.y > 0.0) z = (0.8 - eye.y) / ray.y;  // y points down
      const glm::dvec3 to_ball = ball - eye;
      const double a = glm::dot(ray, ray), b = glm::dot(ray, to_ball), c = glm::dot(to_ball, to_ball) - 0.36;
      if (b * b > a * c) z = std::min(z, (b - std::sqrt(b * b - a * c)) / a);
      depths.push_back(z > 0.0 ? z : inf);
    }
  }
  return depths;
}

struct Meshes : Library {
  Model model = test::random_model(3, 400, 2);
  std::vector<shared::View> drawn = stereo::views_from_xr(quest_eyes(), placement, std::array{size, size});

  /// Creates a texture with these depths, in `layer` if that is not negative. `read` receives the depths that
  /// it stores.
  std::uint32_t depth_texture(const Kept& kept, const std::vector<double>& depths, std::vector<double>& read,
                              int layer = -1) {
    const bool has_stencil = kept.format == GL_DEPTH24_STENCIL8 || kept.format == GL_DEPTH32F_STENCIL8;
    const std::uint32_t id = caller.texture(kept.format, size.x, size.y, layer < 0 ? 0 : layer + 1);
    struct Stencilled {
      float depth;
      std::uint32_t stencil;
    };
    std::vector<float> plain;
    std::vector<Stencilled> stencilled;
    for (int y = size.y - 1; y >= 0; --y) {
      for (int x = 0; x < size.x; ++x) {
        plain.push_back(static_cast<float>(kept.number_of(depths[place(x, y)])));
        stencilled.push_back({plain.back(), 77u});
      }
    }
    const GLenum layout = kept.format == GL_R32F ? GL_RED
                          : has_stencil          ? GL_DEPTH_STENCIL
                                                 : GL_DEPTH_COMPONENT;
    const GLenum type = has_stencil ? GL_FLOAT_32_UNSIGNED_INT_24_8_REV : GL_FLOAT;
    const void* data = has_stencil ? static_cast<const void*>(stencilled.data()) : plain.data();
    if (layer < 0) {
      caller.TextureSubImage2D(id, 0, 0, 0, size.x, size.y, layout, type, data);
    } else {
      caller.TextureSubImage3D(id, 0, 0, 0, layer, size.x, size.y, 1, layout, type, data);
    }
    plain = caller.read<float>(id, size.x, size.y, std::max(layer, 0),
                               kept.format == GL_R32F ? GL_RED : GL_DEPTH_COMPONENT);
    read.clear();
    for (int y = size.y - 1; y >= 0; --y) {
      for (int x = 0; x < size.x; ++x) read.push_back(kept.depth_of(plain[place(x, y)]));
    }
    return id;
  }

  /// Returns the earlier content of an eye's target: colours premultiplied by alpha, bottom row first.
  std::vector<float> behind(std::size_t eye) const {
    std::vector<float> pixels;
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const float alpha = x < size.x / 2 ? 1.0f : 0.25f;
        for (const float c :
             {0.9f * static_cast<float>(x) / size.x, 0.4f, 0.3f + 0.3f * static_cast<float>(eye)})
          pixels.push_back(alpha * c);
        pixels.push_back(alpha);
      }
    }
    return pixels;
  }
  void fill_targets() {
    for (std::size_t k = 0; k < 2; ++k)
      caller.TextureSubImage2D(textures[k], 0, 0, 0, size.x, size.y, GL_RGBA, GL_FLOAT, behind(k).data());
  }

  /// Returns the reference's picture over behind(), bottom row first: RGB and alpha.
  std::vector<float> reference_picture(std::size_t eye, const std::vector<double>& depths,
                                       const Settings& settings = {}) {
    reference::Settings of{.mesh_depths = {depths.begin(), depths.end()}};
    of.perspective =
        Perspective{settings.order.value_or(Order::depth), settings.projection.value_or(Projection::affine)};
    const Picture picture = reference::render(model, drawn[eye], of);
    std::vector<float> over = behind(eye);
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const glm::vec4 c = picture.colour[place(x, size.y - 1 - y)];
        float* to = &over[4 * place(x, y)];
        for (int k = 0; k < 3; ++k) to[k] = c[k] + c.a * to[k];
        to[3] = 1.0f - c.a * (1.0f - to[3]);
      }
    }
    return over;
  }

  static double psnr(const std::vector<float>& a, const std::vector<float>& b) {
    Image one(size.x, size.y, 4), other = one;
    one.data = a;
    other.data = b;
    return measure::psnr(one, other);
  }

  /// Draws both eyes with these depths. Returns the lower of the two PSNRs to the reference, whose depths
  /// `inject` may change.
  double psnr_against_reference(
      Renderer& renderer, std::vector<View> pair, const Settings& settings, const Kept& kept, int layer = -1,
      const std::function<void(std::vector<double>&)>& inject = [](auto&) {}) {
    std::array<std::vector<double>, 2> depths;
    for (std::size_t k = 0; k < 2; ++k) {
      pair[k].mesh_depth = kept.coding;
      pair[k].mesh_depth->texture = depth_texture(kept, table_and_ball(drawn[k]), depths[k], layer);
      pair[k].mesh_depth->layer = layer;
      inject(depths[k]);
    }
    fill_targets();
    renderer.draw(pair, placement, settings);
    double least = inf;
    for (std::size_t k = 0; k < 2; ++k)
      least = std::min(least, psnr(read(k), reference_picture(k, depths[k], settings)));
    return least;
  }
};

TEST_F(Meshes, HideSplatsBehind) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  const Kept kept{.coding = planes(0.1, inf)};
  EXPECT_GT(psnr_against_reference(renderer, views(), {}, kept), floor_db);
  const auto one_pixel_off = [](std::vector<double>& depths) {
    std::rotate(depths.begin(), depths.begin() + 1, depths.end());
  };
  EXPECT_LT(psnr_against_reference(renderer, views(), {}, kept, -1, one_pixel_off), floor_db);
}

TEST_F(Meshes, AcceptEveryCodingAndFormat) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  const MeshDepth axis{.coding = DepthCoding::axis},
      half_units{.coding = DepthCoding::axis, .units_per_number = 0.5};
  for (const Kept& kept :
       {Kept{GL_DEPTH_COMPONENT24, planes(0.1, 50.0)}, Kept{GL_DEPTH24_STENCIL8, planes(0.2, 100.0)},
        Kept{GL_DEPTH32F_STENCIL8, planes(50.0, 0.1)}, Kept{GL_DEPTH_COMPONENT32F, planes(inf, 0.05)},
        Kept{GL_DEPTH_COMPONENT16, planes(0.3, 20.0)}, Kept{GL_R32F, axis}, Kept{GL_R32F, half_units}}) {
    EXPECT_GT(psnr_against_reference(renderer, views(), {}, kept), floor_db) << std::hex << kept.format;
  }
  EXPECT_GT(psnr_against_reference(renderer, views(), {}, {GL_DEPTH_COMPONENT32F, planes(0.1, inf)}, 2),
            floor_db);
}

TEST_F(Meshes, WorkInEveryProjectionAndOrder) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  for (const Order order : {Order::depth, Order::distance}) {
    for (const Projection projection : {Projection::affine, Projection::tangent}) {
      const Settings settings{.order = order, .projection = projection};
      EXPECT_GT(psnr_against_reference(renderer, views(), settings, {.coding = planes(0.1, inf)}), floor_db)
          << static_cast<int>(order) << static_cast<int>(projection);
    }
  }
}

TEST_F(Meshes, WorkWithEveryTarget) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  const Kept kept{.coding = planes(0.1, inf)};
  std::vector<View> copied = views();
  for (View& view : copied) view.target.in_place = false;
  EXPECT_GT(psnr_against_reference(renderer, copied, {}, kept), floor_db);
  std::vector<View> framed = views();
  for (std::size_t k = 0; k < 2; ++k) framed[k].target = {.framebuffer = caller.framebuffer(textures[k])};
  EXPECT_GT(psnr_against_reference(renderer, framed, {}, kept), floor_db);
  // With a quality, some frames measure their error and some do not.
  for (int n = 0; n < 3; ++n)
    EXPECT_GT(psnr_against_reference(renderer, views(), {.quality = 45.0f}, kept), 42.0);
}

TEST_F(Meshes, KeepBackgroundOfCaller) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  std::vector<double> read_back;
  const Kept kept{.coding = planes(0.1, inf)};
  const std::vector<double> wall(static_cast<std::size_t>(size.x * size.y), 0.15);
  std::vector<View> pair = views();
  for (View& view : pair) {
    view.mesh_depth = kept.coding;
    view.mesh_depth->texture = depth_texture(kept, wall, read_back);
  }
  fill_targets();
  renderer.draw(pair, placement);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(read(k), behind(k));
  // Without meshes, the usual picture appears over the earlier colours.
  const std::vector<double> nothing(wall.size(), inf);
  for (View& view : pair) view.mesh_depth->texture = depth_texture(kept, nothing, read_back);
  fill_targets();
  renderer.draw(pair, placement);
  EXPECT_NE(read(0), behind(0));
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(psnr(read(k), reference_picture(k, nothing)), floor_db);
}

TEST_F(Meshes, WriteNearerDepth) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  const Kept kept{.coding = planes(0.1, inf)};
  for (const bool in_place : {true, false}) {
    for (const Projection projection : {Projection::affine, Projection::tangent}) {
      std::array<std::vector<double>, 2> depths;
      std::vector<View> pair = views();
      for (std::size_t k = 0; k < 2; ++k) {
        pair[k].target.in_place = in_place;
        pair[k].mesh_depth = kept.coding;
        pair[k].mesh_depth->texture = depth_texture(kept, table_and_ball(drawn[k]), depths[k]);
        pair[k].depth = {.texture = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y), .near_plane = 0.1};
      }
      const Settings settings{.projection = projection};
      renderer.draw(pair, placement, settings);
      reference::Settings of{.perspective = Perspective{Order::depth, projection},
                             .mesh_depths = {depths[0].begin(), depths[0].end()}};
      const Picture picture = reference::render(model, drawn[0], of);
      const std::vector<float> written = read_depths(pair[0].depth->texture);
      int wrong = 0, of_meshes = 0;
      for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
          const auto at = place(x, y);
          const double cover = 1.0 - picture.colour[at].a;
          const bool is_mesh = !(cover > 0.5);
          const double z = is_mesh ? depths[0][at] : picture.z_sum[at] / cover;
          of_meshes += is_mesh && std::isfinite(z) ? 1 : 0;
          const double is = written[place(x, size.y - 1 - y)];
          wrong += std::abs(is - kept.number_of(z)) > 1e-4 ? 1 : 0;
        }
      }
      EXPECT_GT(of_meshes, 100);
      EXPECT_LE(wrong, 8) << in_place << static_cast<int>(projection) << ": pixels at a threshold";
    }
  }
}

// Other parameters of a texture than a fresh one's change what shaders read from it.
TEST_F(Meshes, IgnoreTextureParameters) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  const auto drawn_with = [&](GLenum parameter, GLint value, std::uint32_t depth = 0x80000000u) {
    std::uint32_t id = 0;
    caller.gl.CreateTextures(GL_TEXTURE_2D, 1, &id);
    caller.gl.TextureStorage2D(id, 3, GL_DEPTH24_STENCIL8, 2 * size.x, 2 * size.y);
    const std::vector<std::uint32_t> depths(static_cast<std::size_t>(size.x) * size.y, depth);
    caller.TextureSubImage2D(id, 1, 0, 0, size.x, size.y, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8,
                             depths.data());
    caller.TextureParameteri(id, parameter, value);
    std::vector<View> pair = views();
    for (View& view : pair)
      view.mesh_depth = MeshDepth{.texture = id, .level = 1, .near_plane = 1.0, .far_plane = inf};
    fill_targets();
    renderer.draw(pair, placement);
    return read(0);
  };
  const std::vector<float> usual = drawn_with(GL_TEXTURE_SWIZZLE_G, GL_ONE);
  EXPECT_EQ(drawn_with(GL_TEXTURE_SWIZZLE_R, GL_ONE), usual);
  EXPECT_EQ(drawn_with(GL_TEXTURE_BASE_LEVEL, 1), usual);
  EXPECT_EQ(drawn_with(GL_TEXTURE_MAX_LEVEL, 0), usual);
  EXPECT_EQ(drawn_with(GL_DEPTH_STENCIL_TEXTURE_MODE, GL_STENCIL_INDEX), usual);
  EXPECT_NE(drawn_with(GL_TEXTURE_SWIZZLE_G, GL_ONE, 0xffffff00u), usual) << "the mesh hides nothing";
}

TEST_F(Meshes, RejectUnreadableDepths) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  const auto refused = [&](const MeshDepth& mesh, const char* saying, const Settings& settings = {}) {
    std::vector<View> pair = views();
    for (View& view : pair) view.mesh_depth = mesh;
    return test::fails_saying([&] { renderer.draw(pair, placement, settings); }, {saying});
  };
  const std::uint32_t good = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y);
  MeshDepth sound = planes(0.1, inf);
  sound.texture = good;
  EXPECT_TRUE(refused({.texture = good}, "planes at 0 and 0"));
  EXPECT_TRUE(refused({.texture = 9999}, "9999"));
  EXPECT_TRUE(refused({.texture = caller.texture(GL_RGBA8, size.x, size.y)}, "format 0x8058"));
  EXPECT_TRUE(
      refused({.texture = caller.texture(GL_DEPTH_COMPONENT24, size.x - 1, size.y)}, "does not lie within"));
  EXPECT_TRUE(
      refused({.texture = good, .coding = DepthCoding::axis, .units_per_number = 0.0}, "units per number"));
  std::uint32_t mutable_texture = 0;
  caller.gl.GenTextures(1, &mutable_texture);
  caller.BindTexture(GL_TEXTURE_2D, mutable_texture);
  caller.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, size.x, size.y, 0, GL_RED, GL_FLOAT, nullptr);
  caller.TextureParameteri(mutable_texture, GL_TEXTURE_SWIZZLE_R, GL_ZERO);
  MeshDepth swizzled = sound;
  swizzled.texture = mutable_texture;
  EXPECT_TRUE(refused(swizzled, "glTextureStorage2D"));
  EXPECT_TRUE(refused(sound, "background", over_black));
  EXPECT_TRUE(refused(sound, "layout", {.layout = Layout::parallel}));
  EXPECT_TRUE(refused(sound, "measured", {.tolerance = 1.0f, .transmittance = Transmittance::last}));
  std::vector<View> pair = views();
  pair[0].mesh_depth = sound;
  EXPECT_ERROR(renderer.draw(pair, placement), "1 of 2 views");
  pair[1].mesh_depth = pair[0].mesh_depth;
  EXPECT_GT(renderer.draw(pair, placement).pairs, 0u) << "the good one is refused, too";
}

}  // namespace
}  // namespace binosplat
