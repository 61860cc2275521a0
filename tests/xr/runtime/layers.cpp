// What is handed in at the end of a frame: is it of this frame, of the right eyes, and there?

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {
namespace {

std::string text_of(const XrExtent2Di& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

/// Bit for bit, NaN included.
template <typename T>
bool same(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

Json rectangle(const XrRect2Di& rect) {
  return {rect.offset.x, rect.offset.y, rect.extent.width, rect.extent.height};
}

/// A swapchain's rectangle that can be shown.
Swapchain& check_image(const XrSwapchainSubImage& image) {
  auto& swapchain = runtime().get<Swapchain>(image.swapchain);
  require(swapchain.released.has_value(), XR_ERROR_LAYER_INVALID,
          "no image of swapchain " + std::to_string(swapchain.id) + " was ever released");
  const XrRect2Di& rect = image.imageRect;
  const bool inside = rect.offset.x >= 0 && rect.offset.y >= 0 && rect.extent.width > 0 &&
                      rect.extent.height > 0 &&
                      rect.offset.x + std::int64_t{rect.extent.width} <= swapchain.info.width &&
                      rect.offset.y + std::int64_t{rect.extent.height} <= swapchain.info.height;
  require(inside, XR_ERROR_SWAPCHAIN_RECT_INVALID,
          "rectangle " + rectangle(rect).dump() + " of a swapchain of " +
              text_of({static_cast<int>(swapchain.info.width), static_cast<int>(swapchain.info.height)}));
  require(image.imageArrayIndex == 0, XR_ERROR_VALIDATION_FAILURE,
          "array index " + std::to_string(image.imageArrayIndex) + " of 1");
  return swapchain;
}

/// Of this frame, and as it was released.
void check_fresh(Swapchain& swapchain, const FrameRecord& frame) {
  Runtime& r = runtime();
  const std::string name = "swapchain " + std::to_string(swapchain.id);
  if (swapchain.released_frame != frame.number) {
    const std::string text =
        name + " shows an image that was released in frame " + std::to_string(swapchain.released_frame);
    if (frame.should_render) return r.fault(text);
    r.log({{"what", "stale"}, {"frame", frame.number}, {"text", text}});
    return;
  }
  if (swapchain.pixels.empty()) return;
  const Binding& gl = r.session()->binding;
  const Current current(gl);
  if (read_texture(gl, swapchain.textures[*swapchain.released], swapchain.info) != swapchain.pixels) {
    r.fault("the image of " + name + " was written to after its release");
  }
}

/// The rectangle's pixels, the top row first. The name of the file, or nothing.
Json write_pixels(const Swapchain& swapchain, const XrSwapchainSubImage& image, int frame, std::size_t view) {
  Runtime& r = runtime();
  if (!r.script.keeps_pixels(frame) || swapchain.pixels.empty()) return nullptr;
  char name[64];
  std::snprintf(name, sizeof(name), "frame%04d_view%zu.%s", frame, view, swapchain.depth ? "depth" : "rgba");
  std::ofstream out(r.script.folder / name, std::ios::binary);
  const XrRect2Di& rect = image.imageRect;
  for (int row = rect.extent.height - 1; row >= 0; --row) {
    const std::size_t at = (static_cast<std::size_t>(rect.offset.y + row) * swapchain.info.width +
                            static_cast<std::size_t>(rect.offset.x)) *
                           4;
    out.write(reinterpret_cast<const char*>(&swapchain.pixels[at]), 4 * rect.extent.width);
  }
  return name;
}

void check_numbers(const XrCompositionLayerDepthInfoKHR& depth) {
  const bool range = depth.minDepth >= 0 && depth.minDepth < depth.maxDepth && depth.maxDepth <= 1;
  require(range, XR_ERROR_VALIDATION_FAILURE,
          "depths from " + std::to_string(depth.minDepth) + " to " + std::to_string(depth.maxDepth) +
              " where 0 <= minDepth < maxDepth <= 1 is expected");
  const bool planes = depth.nearZ >= 0 && depth.farZ >= 0 && depth.nearZ != depth.farZ &&
                      !(std::isinf(depth.nearZ) && std::isinf(depth.farZ));
  require(planes, XR_ERROR_VALIDATION_FAILURE,
          "planes at " + std::to_string(depth.nearZ) + " and " + std::to_string(depth.farZ) +
              " where two different ones, not negative, are expected");
}

// But for a pixel, by which rounding makes smaller ones longer.
bool same_shape(const XrExtent2Di& depth, const XrExtent2Di& colours) {
  const std::int64_t across = std::int64_t{depth.width} * colours.height;
  const std::int64_t down = std::int64_t{depth.height} * colours.width;
  return std::abs(across - down) <= std::max(colours.width, colours.height);
}

Json check_depth(Session& session, FrameRecord& frame, const XrCompositionLayerProjectionView& view,
                 std::size_t index) {
  Runtime& r = runtime();
  const auto* depth =
      chained<XrCompositionLayerDepthInfoKHR>(view.next, XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR);
  if (depth == nullptr) return nullptr;
  if (r.instance()->extensions.count(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME) == 0) {
    r.fault("depth without XR_KHR_composition_layer_depth");
  }
  Swapchain& swapchain = check_image(depth->subImage);
  require(swapchain.depth, XR_ERROR_VALIDATION_FAILURE, "depth from a swapchain of colours");
  check_numbers(*depth);
  check_fresh(swapchain, frame);
  const XrExtent2Di &size = depth->subImage.imageRect.extent, &colours = view.subImage.imageRect.extent;
  if (!same_shape(size, colours)) {
    r.fault("view " + std::to_string(index) + " has depth of " + text_of(size) + " and colours of " +
            text_of(colours));
  }
  // One view's depth stays one view's depth, whichever had it first.
  bool others = false;
  for (const auto& [other, at] : session.depth_of_view) {
    if (other == index || at != swapchain.id) continue;
    others = true;
    r.fault("view " + std::to_string(index) + " has the depth of view " + std::to_string(other));
  }
  if (!others) session.depth_of_view[index] = swapchain.id;
  return {{"swapchain", swapchain.id},
          {"image", *swapchain.released},
          {"rect", rectangle(depth->subImage.imageRect)},
          {"min", depth->minDepth},
          {"max", depth->maxDepth},
          {"near", depth->nearZ},
          {"far", std::isinf(depth->farZ) ? Json("inf") : Json(depth->farZ)},
          {"file", write_pixels(swapchain, depth->subImage, frame.number, index)}};
}

void check_pose(const FrameRecord& frame, const Located* located,
                const XrCompositionLayerProjectionView& view, std::size_t index) {
  Runtime& r = runtime();
  const std::string name = "view " + std::to_string(index);
  const XrQuaternionf& q = view.pose.orientation;
  const float length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  require(std::abs(length - 1.0f) < 0.01f, XR_ERROR_POSE_INVALID,
          name + " has a quaternion of length " + std::to_string(length));
  if (located == nullptr) return;
  const XrView& expected = located->views.at(index);
  if (!same(view.pose, expected.pose)) {
    r.fault(name + " has another pose than was located for frame " + std::to_string(frame.number) + ": " +
            to_json(view.pose).dump() + " where " + to_json(expected.pose).dump() + " is expected");
  }
  if (!same(view.fov, expected.fov)) {
    r.fault(name + " has another fov than was located for frame " + std::to_string(frame.number) + ": " +
            to_json(view.fov).dump() + " where " + to_json(expected.fov).dump() + " is expected");
  }
}

const Located* located_in(const FrameRecord& frame, const Space& space) {
  const Located* found = nullptr;
  for (const Located& one : frame.located) {
    if (one.space == space.id) found = &one;
  }
  Runtime& r = runtime();
  if (found == nullptr) {
    r.fault("the layer's space " + std::to_string(space.id) + " is none that views were located in");
    return nullptr;
  }
  constexpr XrViewStateFlags both = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
  if ((found->flags & both) != both) r.fault("a layer of poses that are not valid");
  return found;
}

Json check_projection(Session& session, FrameRecord& frame, const XrCompositionLayerProjection& layer,
                      std::size_t first) {
  const auto& space = runtime().get<Space>(layer.space);
  const std::size_t expected = views_of(session.configuration).size();
  require(layer.viewCount == expected, XR_ERROR_VALIDATION_FAILURE,
          std::to_string(layer.viewCount) + " views where " + std::to_string(expected) + " are expected");
  require(layer.views != nullptr, XR_ERROR_VALIDATION_FAILURE, "a layer without views");
  const Located* located = located_in(frame, space);
  Json views = Json::array();
  for (std::size_t k = 0; k < expected; ++k) {
    const XrCompositionLayerProjectionView& view =
        checked(&layer.views[k], XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW);
    Swapchain& swapchain = check_image(view.subImage);
    require(!swapchain.depth, XR_ERROR_VALIDATION_FAILURE, "colours from a swapchain of depth");
    check_pose(frame, located, view, k);
    check_fresh(swapchain, frame);
    views.push_back({{"pose", to_json(view.pose)},
                     {"fov", to_json(view.fov)},
                     {"swapchain", swapchain.id},
                     {"image", *swapchain.released},
                     {"rect", rectangle(view.subImage.imageRect)},
                     {"colour", write_pixels(swapchain, view.subImage, frame.number, first + k)},
                     {"depth", check_depth(session, frame, view, first + k)}});
  }
  return {{"type", "projection"}, {"space", space.id}, {"flags", layer.layerFlags}, {"views", views}};
}

}  // namespace

void check_layers(Session& session, FrameRecord& frame, const XrFrameEndInfo& info, Json& line) {
  Json& layers = line["layers"] = Json::array();
  require(info.layerCount <= XR_MIN_COMPOSITION_LAYERS_SUPPORTED, XR_ERROR_LAYER_LIMIT_EXCEEDED,
          std::to_string(info.layerCount) + " layers");
  require(info.layerCount == 0 || info.layers != nullptr, XR_ERROR_VALIDATION_FAILURE, "no layers to count");
  std::size_t views = 0;
  for (std::uint32_t k = 0; k < info.layerCount; ++k) {
    const XrCompositionLayerBaseHeader* layer = info.layers[k];
    require(layer != nullptr, XR_ERROR_LAYER_INVALID, "layer " + std::to_string(k) + " is none");
    require(layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION, XR_ERROR_LAYER_INVALID,
            std::string("a layer of type ") + name_of(layer->type));
    const auto& projection = *reinterpret_cast<const XrCompositionLayerProjection*>(layer);
    layers.push_back(check_projection(session, frame, projection, views));
    views += projection.viewCount;
  }
}

}  // namespace binosplat::xr_test
