#include "xr/projection_layer.h"

#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "base/log.h"

namespace binosplat::xr {

namespace {

constexpr double far_metres = 1000.0;  // the far plane of depths

// Depth textures are smaller than pictures by this factor along each side. Runtimes use depths to reproject
// pictures, which needs no sharp edges. Server GPUs fill depths slowly (an H200 takes 2.3 ms for two textures
// of full size).
constexpr int depth_step = 8;

constexpr std::array<std::int64_t, 3> depth_formats = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24,
                                                       GL_DEPTH_COMPONENT16};

// The index of a view in a frame. The views of an eye are adjacent there, so that they are projected
// together.
std::size_t place_of(std::size_t view, std::size_t views) {
  return views == 4 ? (view % 2) * 2 + view / 2 : view;
}

// A picture in the plane at distance 1 in front of the eye: its upper left corner, and the vector from there
// to its lower right corner.
struct Frustum {
  explicit Frustum(const Fov& fov)
      : corner(std::tan(fov.left), std::tan(fov.up)),
        across(std::tan(fov.right) - corner.x, std::tan(fov.down) - corner.y) {}

  glm::dvec2 corner, across;
};

// Cuts a hole for the inset into the wide view, if both views have the same pose. The hole is smaller than
// the inset by a margin, in which runtimes may mix both views.
void add_inset(View& wide, const View& inset) {
  const Frustum of_wide(wide.eye.fov), of_inset(inset.eye.fov);
  const double share = wide.size.x / of_wide.across.x / (inset.size.x / of_inset.across.x);
  wide.region.low_pass_share = static_cast<float>(std::min(1.0, share * share));
  if (wide.eye.position != inset.eye.position || wide.eye.orientation != inset.eye.orientation) return;
  constexpr double margin = 0.1;  // share of the inset's width and height
  const auto pixels = [&](double at) {
    const glm::dvec2 point = of_inset.corner + at * of_inset.across;
    return glm::uvec2(glm::clamp((point - of_wide.corner) / of_wide.across, 0.0, 1.0) *
                      glm::dvec2(wide.size));
  };
  wide.region.hole_begin = pixels(margin);
  wide.region.hole_end = pixels(1.0 - margin);
}

}  // namespace

Eye eye_of(const XrPosef& pose, const XrFovf& fov) {
  const auto& [q, p] = pose;
  return {{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}};
}

std::vector<glm::dvec2> gaze_of(const XrPosef& gaze, std::span<const XrView> located) {
  constexpr double edge = 0.05;
  const auto rotation_of = [](const XrQuaternionf& q) { return glm::dquat(q.w, q.x, q.y, q.z); };
  const glm::dvec3 ahead = rotation_of(gaze.orientation) * glm::dvec3(0.0, 0.0, -1.0);
  std::vector<glm::dvec2> degrees;
  for (const XrView& view : located) {
    const glm::dvec3 v = glm::inverse(rotation_of(view.pose.orientation)) * ahead;
    const XrFovf& fov = view.fov;
    const auto within = [](double angle, double low, double high) {
      const double slack = edge * (high - low);
      return glm::degrees(std::clamp(angle, low + slack, high - slack));
    };
    degrees.emplace_back(within(std::atan2(v.x, -v.z), fov.angleLeft, fov.angleRight),
                         within(std::atan2(v.y, -v.z), fov.angleDown, fov.angleUp));
  }
  return degrees;
}

std::vector<glm::uvec2> visible_columns(const Mask& mask, const Fov& fov, const glm::ivec2& size) {
  if (mask.indices.size() < 3) return {};
  constexpr double tile = ViewRegion::tile, infinite = std::numeric_limits<double>::infinity();
  const Frustum picture(fov);
  const glm::ivec2 tiles = (size + ViewRegion::tile - 1) / ViewRegion::tile;
  // For each row of tiles, the minimum and maximum x of the triangles' edges within the row.
  std::vector<glm::dvec2> spans(static_cast<std::size_t>(tiles.y), {infinite, -infinite});
  const auto corner = [&](std::size_t k) {
    const XrVector2f& v = mask.vertices[mask.indices[k]];
    return (glm::dvec2(v.x, v.y) - picture.corner) / picture.across * glm::dvec2(size);
  };
  for (std::size_t i = 0; i < mask.indices.size(); ++i) {
    const glm::dvec2 a = corner(i), b = corner(i % 3 == 2 ? i - 2 : i + 1);
    for (std::size_t row = 0; row < spans.size(); ++row) {
      const double top = tile * static_cast<double>(row) - 1.0, bottom = top + tile + 2.0;
      if (std::max(a.y, b.y) < top || std::min(a.y, b.y) > bottom) continue;
      const auto x_at = [&](double y) { return a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x); };
      for (const glm::dvec2& end : {a, b}) {
        const bool within = end.y >= top && end.y <= bottom;
        const double x = within ? end.x : x_at(end.y < top ? top : bottom);
        spans[row] = {std::min(spans[row].x, x), std::max(spans[row].y, x)};
      }
    }
  }
  std::vector<glm::uvec2> columns;
  for (const glm::dvec2& span : spans) {
    const auto column = [&](double x) { return static_cast<unsigned>(std::clamp(x, 0.0, double(tiles.x))); };
    const glm::uvec2 seen(column(std::floor((span.x - 1.0) / tile)),
                          column(std::ceil((span.y + 1.0) / tile)));
    columns.push_back(seen.x < seen.y ? seen : glm::uvec2(0));
  }
  return columns;
}

Swapchain::Swapchain(const Session& session, std::int64_t format, const glm::ivec2& wanted,
                     XrSwapchainUsageFlags usage, XrSwapchainUsageFlags more)
    : size(wanted) {
  XrSwapchainCreateInfo info{XR_TYPE_SWAPCHAIN_CREATE_INFO};
  info.usageFlags = usage | more;
  info.format = format;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  info.width = static_cast<std::uint32_t>(size.x);
  info.height = static_cast<std::uint32_t>(size.y);
  XrSwapchain made = XR_NULL_HANDLE;
  XrResult result = XR_CALL(CreateSwapchain, session.handle(), &info, &made);
  if (XR_FAILED(result) && more != 0) {
    has_more = false;
    info.usageFlags = usage;
    result = XR_CALL(CreateSwapchain, session.handle(), &info, &made);
  }
  if (result == XR_ERROR_RUNTIME_FAILURE && !session.instance().takes_egl()) {
    refuse(
        "{} creates no textures ({}), as is reported of SteamVR on Linux (SteamVR-for-Linux issue 782): "
        "update it, or use Monado",
        session.instance().runtime, name_of(result));
  }
  check(result, "xrCreateSwapchain");
  handle = Owned<XrSwapchain>(made, {"xrDestroySwapchain"});
  const XrSwapchainImageOpenGLKHR empty{XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR};
  for (const auto& image : all_of(empty, [&](auto capacity, auto*count, auto*all) {
         XR(EnumerateSwapchainImages, handle.get(), capacity, count,
            reinterpret_cast<XrSwapchainImageBaseHeader*>(all));
       }))
    textures.push_back(image.image);
}

std::uint32_t Swapchain::acquire() const {
  std::uint32_t index = 0;
  XR(AcquireSwapchainImage, handle.get(), nullptr, &index);
  const XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};
  XR(WaitSwapchainImage, handle.get(), &wait);
  return textures.at(index);
}

ProjectionLayer::ProjectionLayer(const Session& session, double scale, bool composed)
    : session_(session), composed_(composed) {
  const Instance& instance = session.instance();
  const auto formats = all_of<std::int64_t>({}, [&](auto capacity, auto* count, auto* all) {
    XR(EnumerateSwapchainFormats, session.handle(), capacity, count, all);
  });
  if (std::ranges::find(formats, GL_SRGB8_ALPHA8) == formats.end())
    refuse("{} offers no textures of GL_SRGB8_ALPHA8, which the models' colours need", instance.runtime);
  const auto* const depth_format = std::ranges::find_first_of(depth_formats, formats);
  const bool has_depths = !composed && depth_format != depth_formats.end() &&
                          instance.has(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME);
  const auto views = all_of(XrViewConfigurationView{XR_TYPE_VIEW_CONFIGURATION_VIEW},
                            [&](auto capacity, auto* count, auto* all) {
                              XR(EnumerateViewConfigurationViews, instance.handle.get(), instance.system,
                                 instance.views, capacity, count, all);
                            });
  for (const XrViewConfigurationView& view : views) {
    const auto side = [&](std::uint32_t recommended, std::uint32_t most) {
      return std::clamp(static_cast<int>(std::lround(recommended * scale)), 1, static_cast<int>(most));
    };
    const glm::ivec2 size(side(view.recommendedImageRectWidth, view.maxImageRectWidth),
                          side(view.recommendedImageRectHeight, view.maxImageRectHeight));
    // Compute shaders write in place, through a view of the sRGB texture. If the runtime forbids views of
    // textures or shader writes, the renderer copies its own picture.
    ViewTextures of{
        Swapchain(session, GL_SRGB8_ALPHA8, size,
                  XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT,
                  XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT | XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT)};
    if (has_depths)
      of.depths.emplace(session, *depth_format, (size + depth_step - 1) / depth_step,
                        XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
    view_textures_.push_back(std::move(of));
  }
  take_masks();
}

void ProjectionLayer::take_masks() {
  const Instance& instance = session_.instance();
  if (composed_ || !instance.has(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME)) return;
  const auto get = instance.function<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR");
  for (std::size_t k = 0; k < view_textures_.size(); ++k) {
    XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
    const auto ask = [&] {
      check(get(session_.handle(), instance.views, static_cast<std::uint32_t>(k),
                XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR, &mask),
            "xrGetVisibilityMaskKHR");
    };
    ask();
    auto& [vertices, indices] = view_textures_[k].mask;
    vertices.resize(mask.vertexCountOutput);
    indices.resize(mask.indexCountOutput);
    mask.vertexCapacityInput = mask.vertexCountOutput;
    mask.indexCapacityInput = mask.indexCountOutput;
    mask.vertices = vertices.data();
    mask.indices = indices.data();
    if (!indices.empty()) ask();
    // An invalid mask hides nothing.
    const auto is_none = [&](std::uint32_t index) { return index >= view_textures_[k].mask.vertices.size(); };
    if (indices.size() % 3 != 0 || std::any_of(indices.begin(), indices.end(), is_none)) indices.clear();
  }
}

std::vector<View> ProjectionLayer::begin(std::span<const XrView> located, const Placement& placement,
                                         double scale, const Settings& settings) {
  const std::size_t count = view_textures_.size();
  if (located.size() != count)
    refuse("{} located {} views of {}", session_.instance().runtime, located.size(), count);
  std::vector<View> views(count);
  for (std::size_t k = 0; k < count; ++k) {
    const ViewTextures& of = view_textures_[k];
    View& view = views[place_of(k, count)];
    view.eye = eye_of(located[k].pose, located[k].fov);
    view.size = glm::max(glm::ivec2(1), glm::ivec2(glm::round(scale * glm::dvec2(of.colours.size))));
    view.target = {.texture = of.colours.acquire(), .linear_alpha = true, .in_place = of.colours.has_more};
    view.region.columns = visible_columns(of.mask, view.eye.fov, view.size);
    if (!of.depths) continue;
    view.depth = {.texture = of.depths->acquire(),
                  .near_plane = *settings.near_plane,
                  .far_plane = std::max(far_metres * placement.units_per_metre, 2.0 * *settings.near_plane)};
  }
  for (std::size_t k = 0; count == 4 && k < 4; k += 2) {
    add_inset(views[k], views[k + 1]);
    if (!settings.quality) views[k + 1].region.tolerance_share = 0.0f;
  }
  return views;
}

void ProjectionLayer::end(XrTime display, std::span<const XrView> located, std::span<const View> drawn,
                          const Placement& placement) const {
  const std::size_t count = view_textures_.size();
  std::vector<XrCompositionLayerProjectionView> views(count, {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW});
  std::vector<XrCompositionLayerDepthInfoKHR> depths(count);
  const auto part = [](const Swapchain& of, const glm::ivec2& size) {
    return XrSwapchainSubImage{of.handle.get(), {{0, 0}, {size.x, size.y}}, 0};
  };
  for (std::size_t k = 0; k < count; ++k) {
    const ViewTextures& of = view_textures_[k];
    const View& view = drawn[place_of(k, count)];
    views[k].pose = located[k].pose;
    views[k].fov = located[k].fov;
    views[k].subImage = part(of.colours, view.size);
    of.colours.release();
    if (!of.depths) continue;
    of.depths->release();
    depths[k] = {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR, nullptr, part(*of.depths, of.depths->size), 0.0f,
                 1.0f};
    depths[k].nearZ = static_cast<float>(view.depth->near_plane / placement.units_per_metre);
    depths[k].farZ = static_cast<float>(view.depth->far_plane / placement.units_per_metre);
    views[k].next = &depths[k];
  }
  XrCompositionLayerProjection layer{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
  // Over the room. Colours are premultiplied by alpha.
  if (session_.instance().blend_mode != XR_ENVIRONMENT_BLEND_MODE_OPAQUE)
    layer.layerFlags = XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT;
  layer.space = session_.space();
  layer.viewCount = static_cast<std::uint32_t>(count);
  layer.views = views.data();
  session_.end_frame(display, &layer);
}

std::string ProjectionLayer::description() const {
  std::string text;
  for (const ViewTextures& view : view_textures_)
    text += fmt::format("{}{} x {}", text.empty() ? "" : ", ", view.colours.size.x, view.colours.size.y);
  return fmt::format("{} px, GL_SRGB8_ALPHA8{}", text, view_textures_[0].depths ? ", with depths" : "");
}

}  // namespace binosplat::xr
