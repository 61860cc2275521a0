#include "xr/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>

#include "base/error.h"
#include "base/log.h"

namespace binosplat::xr {

namespace {

// Beyond it all is equally far, m.
constexpr double far_metres = 1000.0;

// Depths have so many times fewer pixels along each side: a runtime moves pictures by them, for which no edge
// need be sharp, and GPUs of servers fill depths slowly (an H200 two whole ones in 2.3 ms).
constexpr int depth_step = 8;

struct ColourFormat {
  std::int64_t format;
  const char* name;
  bool linear;
};
// The best first. Trained colours are what sRGB's bytes are; all other formats mean light, of which 8 bits
// are too few.
constexpr ColourFormat colour_formats[] = {{GL_SRGB8_ALPHA8, "GL_SRGB8_ALPHA8", false},
                                           {GL_RGBA16F, "GL_RGBA16F", true},
                                           {GL_RGB10_A2, "GL_RGB10_A2", true},
                                           {GL_RGBA8, "GL_RGBA8", true}};
constexpr std::array<std::int64_t, 3> depth_formats = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24,
                                                       GL_DEPTH_COMPONENT16};

// The order in which views are drawn: an eye's side by side, so that they share their depth order.
std::size_t place_of(std::size_t view, std::size_t views) {
  return views == 4 ? (view % 2) * 2 + view / 2 : view;
}

// What an inset covers of the wide view it lies in is not drawn there, but for a margin that runtimes may mix
// both in. Both look the same way from the same place.
void take_hole(const XrView& wide, const XrView& inset, const glm::ivec2& size, render::ViewRegion& part) {
  if (std::memcmp(&wide.pose, &inset.pose, sizeof(XrPosef)) != 0) return;
  constexpr double margin = 0.1;  // of the inset's sides
  const double left = std::tan(wide.fov.angleLeft), right = std::tan(wide.fov.angleRight);
  const double up = std::tan(wide.fov.angleUp), down = std::tan(wide.fov.angleDown);
  glm::dvec2 begin((std::tan(inset.fov.angleLeft) - left) / (right - left),
                   (up - std::tan(inset.fov.angleUp)) / (up - down));
  glm::dvec2 end((std::tan(inset.fov.angleRight) - left) / (right - left),
                 (up - std::tan(inset.fov.angleDown)) / (up - down));
  const glm::dvec2 edge = margin * (end - begin);
  const auto pixels = [&](const glm::dvec2& share) {
    return glm::uvec2(glm::clamp(share, 0.0, 1.0) * glm::dvec2(size));
  };
  begin += edge;
  end -= edge;
  if (glm::all(glm::lessThan(begin, end))) part.hole_begin = pixels(begin), part.hole_end = pixels(end);
}

// How many times fewer pixels a degree a wide view has than its inset, squared; 1 where it has as many.
float low_pass_share(const XrView& wide, const glm::ivec2& wide_size, const XrView& inset,
                     const glm::ivec2& inset_size) {
  const auto per_slope = [](const XrFovf& fov, const glm::ivec2& size) {
    return size.x / (std::tan(fov.angleRight) - std::tan(fov.angleLeft));
  };
  const double share = per_slope(wide.fov, wide_size) / per_slope(inset.fov, inset_size);
  return static_cast<float>(std::min(1.0, share * share));
}

// Where each eye looks, as stereo::Foveation has it, a little within its picture.
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

}  // namespace

Eye eye_of(const XrPosef& pose, const XrFovf& fov) {
  const XrVector3f& p = pose.position;
  const XrQuaternionf& q = pose.orientation;
  return {{p.x, p.y, p.z},
          {q.x, q.y, q.z, q.w},
          {.left = fov.angleLeft, .right = fov.angleRight, .up = fov.angleUp, .down = fov.angleDown}};
}

Projection::Projection(const Session& session, gl::Context& context, const ProjectionSettings& settings)
    : session_(session),
      settings_(settings),
      presenter_(context),
      layer_{XR_TYPE_COMPOSITION_LAYER_PROJECTION} {
  sizes_ = sizes_now();
  eyes_.resize(sizes_.size());
  const std::vector<std::int64_t> offered = swapchain_formats(session);
  make_colours(offered);
  if (!foveates() && session.instance().has(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME))
    make_depths(offered);
}

std::vector<glm::ivec2> Projection::sizes_now() const {
  std::vector<glm::ivec2> sizes;
  for (const XrViewConfigurationView& view : session_.instance().views()) {
    const auto scaled = [&](std::uint32_t recommended, std::uint32_t most) {
      const auto wanted = static_cast<int>(std::lround(recommended * settings_.scale));
      return std::clamp(wanted, 1, static_cast<int>(most));
    };
    sizes.emplace_back(scaled(view.recommendedImageRectWidth, view.maxImageRectWidth),
                       scaled(view.recommendedImageRectHeight, view.maxImageRectHeight));
  }
  return sizes;
}

void Projection::make_colours(std::span<const std::int64_t> offered) {
  const ColourFormat* found = nullptr;
  for (const ColourFormat& f : colour_formats) {
    if (found == nullptr && std::find(offered.begin(), offered.end(), f.format) != offered.end()) found = &f;
  }
  if (found == nullptr)
    throw Error(ExitCode::no_gl,
                fmt::format("{} offers no textures of sRGB, nor of 8, 10 or 16 bits a colour",
                            session_.instance().runtime()));
  if (found->format == GL_RGBA8)
    log_warning("{} offers no sRGB: 8 bits of light show bands where it is dark",
                session_.instance().runtime());
  format_ = found->format;
  linear_ = found->linear;
  // Written in place by compute shaders, of sRGB by a view of it; where that is not to be had, through a
  // copy.
  constexpr XrSwapchainUsageFlags drawn =
      XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT;
  constexpr XrSwapchainUsageFlags written =
      drawn | XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT | XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT;
  const auto make = [&](XrSwapchainUsageFlags usage) {
    for (std::size_t k = 0; k < eyes_.size(); ++k)
      eyes_[k].colours = std::make_unique<Swapchain>(session_, format_, sizes_[k], usage);
  };
  try {
    make(written);
  } catch (const Error&) {
    in_place_ = false;
    make(drawn);
  }
}

void Projection::make_depths(std::span<const std::int64_t> offered) {
  const auto format =
      std::find_first_of(depth_formats.begin(), depth_formats.end(), offered.begin(), offered.end());
  if (format == depth_formats.end()) return;
  for (std::size_t k = 0; k < eyes_.size(); ++k)
    eyes_[k].depths =
        std::make_unique<Swapchain>(session_, *format, (sizes_[k] + depth_step - 1) / depth_step,
                                    XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
}

void Projection::take_masks() {
  for (std::size_t k = 0; k < eyes_.size(); ++k)
    eyes_[k].visible = visible_of(session_, static_cast<std::uint32_t>(k));
}

// By the order in which they are drawn; none where all of every view is.
std::vector<render::ViewRegion> Projection::parts_of(const render::FrameSettings& settings,
                                                     std::span<const XrView> located,
                                                     std::span<const glm::ivec2> sizes) const {
  std::vector<render::ViewRegion> parts(located.size());
  for (std::size_t k = 0; k < located.size(); ++k) {
    const std::size_t at = place_of(k, located.size());
    parts[at].columns = visible_columns(eyes_[k].visible, located[k].fov, sizes[at], settings.tile_size);
    if (located.size() == 4 && k < 2) {
      const std::size_t inset = place_of(k + 2, located.size());
      take_hole(located[k], located[k + 2], sizes[at], parts[at]);
      // Insets are exact; a quality is one for all.
      if (settings.quality == 0.0f) parts[inset].tolerance_share = 0.0f;
      parts[at].low_pass_share = low_pass_share(located[k], sizes[at], located[k + 2], sizes[inset]);
    }
  }
  const auto is_whole = [](const render::ViewRegion& part) {
    return part.is_whole() && part.tolerance_share == 1.0f;
  };
  if (std::all_of(parts.begin(), parts.end(), is_whole)) parts.clear();
  return parts;
}

render::FrameReport Projection::draw(stereo::FoveatedFrame& frame, std::span<const XrView> located,
                                     const Placement& placement, render::FrameSettings settings,
                                     const Draw& draw) {
  const std::size_t count = eyes_.size();
  if (located.size() != count)
    throw Error(ExitCode::no_gl, fmt::format("{} located {} views of {}", session_.instance().runtime(),
                                             located.size(), count));
  const bool has_depths = eyes_[0].depths != nullptr;
  settings.depth = has_depths ? Depth::median : Depth::none;
  settings.background = settings_.background;
  std::vector<binosplat::Eye> drawn(count);
  std::vector<glm::ivec2> sizes(count);
  for (std::size_t k = 0; k < count; ++k) {
    drawn[place_of(k, count)] = eye_of(located[k].pose, located[k].fov);
    sizes[place_of(k, count)] =
        glm::max(glm::ivec2(1), glm::ivec2(glm::round(draw.scale * glm::dvec2(sizes_[k]))));
  }
  // Hands that enlarge the world do not push the near plane away.
  const double near_plane =
      settings_.near_plane * std::min(1.0, placement.units_per_metre / settings_.units_per_metre);
  const stereo::HeadViews head = stereo::views_from_xr(drawn, placement, sizes, near_plane);
  const double far_plane = std::max(far_metres * placement.units_per_metre, 2.0 * near_plane);
  std::vector<Target> targets(count);
  std::vector<DepthTarget> depths(has_depths ? count : 0);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = place_of(k, count);
    targets[at] = {.texture = eyes_[k].colours->acquire(), .linear = linear_, .in_place = in_place_};
    if (has_depths)
      depths[at] = {.texture = eyes_[k].depths->acquire(), .near_plane = near_plane, .far_plane = far_plane};
  }
  const stereo::Canvases canvases = presenter_.canvases(targets, settings_.background);
  render::FrameReport report;
  if (foveates()) {
    stereo::Foveation foveation = *settings_.foveation;
    if (draw.gaze) foveation.gaze = gaze_of(*draw.gaze, located);
    report = frame.draw(head.views, foveation, settings, {}, {.canvases = canvases.list});
  } else {
    settings.regions = parts_of(settings, located, sizes);
    report = frame.frame().draw(head.views, settings, {}, {.canvases = canvases.list, .depth_rows = 2});
  }
  const gl::Buffer& colours = foveates() ? frame.colours() : frame.frame().colours();
  const std::vector<shared::View>& views = foveates() ? frame.views() : frame.frame().views();
  for (std::size_t k = 0; k < count; ++k) {
    if (!report.on_canvases)
      presenter_.draw(colours, views, k, LAYOUT_SEPARATE, targets[k], settings_.background);
    if (has_depths) presenter_.draw_depth(frame.frame(), k, depths[k]);
  }
  const std::size_t shown = count == 4 ? place_of(2, count) : 0;  // of four views the inset
  if (draw.drawn_left) draw.drawn_left(targets[shown], sizes[shown]);
  submit(located, sizes, near_plane / placement.units_per_metre, far_plane / placement.units_per_metre);
  return report;
}

// What was drawn, with exactly the poses and angles that it was drawn from.
void Projection::submit(std::span<const XrView> located, std::span<const glm::ivec2> sizes, double nearest,
                        double farthest) {
  const std::size_t count = eyes_.size();
  const bool has_depths = eyes_[0].depths != nullptr;
  views_.assign(count, {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW});
  depth_infos_.assign(has_depths ? count : 0, {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR});
  for (std::size_t k = 0; k < count; ++k) {
    const glm::ivec2& size = sizes[place_of(k, count)];
    views_[k].pose = located[k].pose;
    views_[k].fov = located[k].fov;
    views_[k].subImage = eyes_[k].colours->part(size);
    eyes_[k].colours->release();
    if (!has_depths) continue;
    eyes_[k].depths->release();
    XrCompositionLayerDepthInfoKHR& info = depth_infos_[k];
    info.subImage = eyes_[k].depths->part(eyes_[k].depths->size());
    info.minDepth = 0.0f;
    info.maxDepth = 1.0f;
    info.nearZ = static_cast<float>(nearest);
    info.farZ = static_cast<float>(farthest);
    views_[k].next = &info;
  }
  layer_.space = session_.space();
  layer_.viewCount = static_cast<std::uint32_t>(count);
  layer_.views = views_.data();
}

const XrCompositionLayerBaseHeader* Projection::layer() const {
  return reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer_);
}

std::string Projection::description() const {
  std::string text;
  for (const glm::ivec2& size : sizes_)
    text += fmt::format("{}{} x {}", text.empty() ? "" : ", ", size.x, size.y);
  const auto* found = std::find_if(std::begin(colour_formats), std::end(colour_formats),
                                   [this](const ColourFormat& f) { return f.format == format_; });
  return fmt::format("{} px, {}{}", text, found->name, eyes_[0].depths ? ", with depths" : "");
}

}  // namespace binosplat::xr
