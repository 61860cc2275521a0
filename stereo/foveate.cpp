#include "stereo/foveate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "shared/limits.h"

namespace binosplat::stereo {

namespace {

constexpr double inset_least = 1.0, inset_most = 120.0;  // degrees
constexpr double gaze_most = 80.0;
constexpr double scale_least = 0.05;

// A composed pixel depends on this many pixels of the context on each side.
constexpr std::uint32_t inset_reach = 2;

glm::dvec3 direction_of(const glm::dvec2& gaze) {
  return glm::normalize(glm::dvec3(std::tan(glm::radians(gaze.x)), -std::tan(glm::radians(gaze.y)), 1.0));
}

// The range of slopes along axis k, x/z or y/z, in the cone of half angle `half` (radians) around
// `direction`.
glm::dvec2 slopes_of(const glm::dvec3& direction, int k, double half) {
  const double middle = std::atan2(direction[k], direction.z);
  const double sine = std::sin(half) / std::hypot(direction[k], direction.z);
  const double side = sine < 1.0 ? std::asin(sine) : glm::radians(90.0);
  const double most = glm::radians(89.0);
  return {std::tan(std::max(middle - side, -most)), std::tan(std::min(middle + side, most))};
}

std::uint32_t bits(float number) { return std::bit_cast<std::uint32_t>(number); }

struct Span {
  std::uint32_t begin = 0, end = 0;
};

Span pixels_between(double begin, double end, std::uint32_t size) {
  const auto within = [&](double at) {
    return static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(size)));
  };
  return {within(std::floor(begin)), within(std::ceil(end))};
}

// Widens a span to multiples of BLEND_CELL, at which windows may begin and end.
Span to_cells(const Span& span, std::uint32_t size) {
  return {span.begin / BLEND_CELL * BLEND_CELL,
          std::min(size, (span.end + BLEND_CELL - 1) / BLEND_CELL * BLEND_CELL)};
}

}  // namespace

void check(const Foveation& f, std::string_view prefix) {
  // Each condition also fails for values that are not finite.
  if (!(f.inset_degrees >= inset_least && f.inset_degrees <= inset_most))
    fail("{}inset {}: expected {} to {} degrees", prefix, f.inset_degrees, inset_least, inset_most);
  if (!(f.context_scale >= scale_least && f.context_scale <= 1.0))
    fail("{}context {}: expected {} to 1, its width in px divided by the picture's", prefix, f.context_scale,
         scale_least);
  if (!(f.seam >= 0.0 && f.seam <= 1.0))
    fail("{}seam {}: expected a share of the inset's width, from 0 to 1", prefix, f.seam);
  for (const glm::dvec2& gaze : f.gaze) {
    if (!(std::abs(gaze.x) <= gaze_most && std::abs(gaze.y) <= gaze_most))
      fail("{}gaze {},{}: expected up to {} degrees to either side", prefix, gaze.x, gaze.y, gaze_most);
  }
}

FoveatedEye foveate(const shared::View& eye, const Foveation& foveation, std::size_t nth) {
  check(foveation);
  if (foveation.gaze.size() > 1 && nth >= foveation.gaze.size())
    fail("{} gazes, but none for eye {}: give one gaze per eye, or one for all", foveation.gaze.size(), nth);
  const glm::dvec2 gaze =
      foveation.gaze.empty() ? glm::dvec2(0.0) : foveation.gaze[std::min(nth, foveation.gaze.size() - 1)];
  const glm::dvec3 direction = direction_of(gaze);
  const double half = glm::radians(foveation.inset_degrees) / 2.0;
  const glm::uvec2 size(eye.width, eye.height);
  FoveatedEye out;
  for (int k = 0; k < 2; ++k) {
    const double focal = eye.lens[k], middle = eye.lens[k + 2];
    const glm::dvec2 px = focal * slopes_of(direction, k, half) + middle;
    const Span inset = pixels_between(px.x, px.y, size[k]);
    if (inset.begin >= inset.end) {
      fail("gaze {},{}: the inset lies outside the picture of {} x {} px", gaze.x, gaze.y, size.x, size.y);
    }
    out.inset_begin[k] = inset.begin;
    out.inset_end[k] = inset.end;
    if (k == 0) out.seam = foveation.seam * (px.y - px.x);
  }
  out.context = eye;
  for (int k = 0; k < 2; ++k) {
    const Span seam = pixels_between(out.inset_begin[k] - out.seam, out.inset_end[k] + out.seam, size[k]);
    const Span cells = to_cells(seam, size[k]);
    out.window.corner[k] = cells.begin;
    out.window.size[k] = cells.end - cells.begin;
    // The context has the same frustum in an integer number of pixels.
    const auto pixels = static_cast<std::uint32_t>(std::lround(size[k] * foveation.context_scale));
    const double scale = static_cast<double>(std::max(pixels, 1u)) / size[k];
    (k == 0 ? out.context.width : out.context.height) = std::max(pixels, 1u);
    out.context.lens[k] = static_cast<float>(eye.lens[k] * scale);
    out.context.lens[k + 2] = static_cast<float>(eye.lens[k + 2] * scale);
    out.context_region.low_pass_share *= static_cast<float>(scale);
    // The hole is the part of the context that is never drawn. No pixel outside the inset depends on it.
    const auto begin = static_cast<std::uint32_t>(std::ceil(out.inset_begin[k] * scale)) + inset_reach;
    const auto end = static_cast<std::uint32_t>(std::floor(out.inset_end[k] * scale));
    const bool at_begin = out.inset_begin[k] == 0, at_end = out.inset_end[k] == size[k];
    out.context_region.hole_begin[k] = at_begin ? 0 : begin;
    out.context_region.hole_end[k] = at_end ? std::max(pixels, 1u) : end - std::min(end, inset_reach);
  }
  if (glm::any(glm::greaterThanEqual(out.context_region.hole_begin, out.context_region.hole_end)))
    out.context_region.hole_begin = out.context_region.hole_end = glm::uvec2(0);
  out.window.tolerance_share = 0.0f;
  return out;
}

FoveatedViews foveated_views(std::span<const shared::View> eyes, const Foveation& foveation,
                             const render::FrameSettings& settings) {
  if (eyes.empty() || eyes.size() > MAX_VIEWS / 2)
    fail("foveation of {} eyes: expected 1 to {}", eyes.size(), MAX_VIEWS / 2);
  if (!settings.regions.empty()) fail("foveation with view regions: expected whole views");
  if (settings.has_depths && settings.depth == DepthKind::median)
    fail("foveation with the median depth: expected the mean, because the seam mixes depths");
  FoveatedViews out{.settings = settings};
  for (std::size_t k = 0; k < eyes.size(); ++k) {
    const FoveatedEye& eye = out.eyes.emplace_back(foveate(eyes[k], foveation, k));
    out.views.insert(out.views.end(), {eye.context, eyes[k]});
    out.settings.regions.insert(out.settings.regions.end(), {eye.context_region, eye.window});
  }
  return out;
}

// Passes the views of the parts to `to`, a member function of render::Frame.
void FoveatedFrame::submit_or_prepare(std::span<const shared::View> eyes, const Foveation& foveation,
                                      const render::FrameSettings& settings,
                                      const render::DebugOptions& debug,
                                      const render::CallersTextures& textures,
                                      decltype(&render::Frame::submit) to) {
  const std::size_t canvases = textures.canvases.size(), meshes = textures.mesh_depths.size();
  if (canvases != 0 && canvases != eyes.size())
    fail("{} canvases for {} eyes: expected one per eye", canvases, eyes.size());
  if (meshes != 0 && (canvases == 0 || meshes != eyes.size()))
    fail("foveation with mesh depths: expected one mesh depth and one canvas per eye");
  FoveatedViews drawn = foveated_views(eyes, foveation, settings);
  eyes_.assign(eyes.begin(), eyes.end());
  std::int64_t pixels = 0;
  for (shared::View& eye : eyes_) {
    eye.pixel_offset = static_cast<std::uint32_t>(pixels);
    pixels += std::int64_t{eye.width} * eye.height;
  }
  to_.assign(textures.canvases.begin(), textures.canvases.end());
  has_mesh_depths_ = meshes != 0;
  background_ = settings.background.value_or(glm::vec3(0.0f));
  parts_ = std::move(drawn.eyes);
  drawn.settings.has_depths = to_.empty();
  drawn.settings.depth = DepthKind::mean;
  if (to_.empty()) {
    colours_.reserve(pixels * 16);
    z_sums_.reserve(pixels * 4);
  }
  std::vector<shared::Canvas> of_eyes;
  for (const render::Canvas& canvas : to_) of_eyes.push_back(render::on_gpu(canvas));
  if (!of_eyes.empty()) canvases_.upload(of_eyes);
  render::DebugOptions with_compose = debug;
  with_compose.extra_stage_name = "compose";
  with_compose.extra_stage = [this](gl::Dispatcher& dispatcher) { compose(dispatcher); };
  std::vector<render::MeshDepth> of_views;
  for (const render::MeshDepth& mesh : textures.mesh_depths) of_views.insert(of_views.end(), 2, mesh);
  (frame_.*to)(drawn.views, drawn.settings, with_compose, {.mesh_depths = of_views});
}

Report FoveatedFrame::finish() {
  Report report = frame_.finish();
  report.in_place = !to_.empty();
  return report;
}

void FoveatedFrame::compose(gl::Dispatcher& dispatcher) {
  for (std::size_t k = 0; k < eyes_.size(); ++k) compose_eye(dispatcher, k);
  dispatcher.wait_for_writes();
  // All barriers, because the caller may use the canvases in any way.
  if (!to_.empty()) dispatcher.context().gl().MemoryBarrier(GL_ALL_BARRIER_BITS);
}

void FoveatedFrame::compose_eye(gl::Dispatcher& dispatcher, std::size_t k) {
  const shared::View &eye = eyes_[k], &context = frame_.views()[2 * k], &window = frame_.views()[2 * k + 1];
  const FoveatedEye& parts = parts_[k];
  gl::Context& gl = dispatcher.context();
  if (!to_.empty()) {
    const render::Canvas& to = to_[k];
    gl.gl().BindImageTexture(0, to.texture, to.level, GL_FALSE, to.layer, GL_WRITE_ONLY, to.format);
  }
  if (has_mesh_depths_) frame_.buffers().nearest.bind(0, to_[k].texture);
  const std::uint64_t groups = std::uint64_t{(eye.width + COMPOSE_COLUMNS - 1) / COMPOSE_COLUMNS} *
                               ((eye.height + COMPOSE_ROWS - 1) / COMPOSE_ROWS);
  const std::array variant = {gl::Number{"CANVASES", !to_.empty(), 2},
                              gl::Number{"MESH_DEPTH", has_mesh_depths_, 2}};
  dispatcher.start(gl.program("foveate.comp", variant), gl::DispatchSize::of_groups(groups),
                   {{"Colours", frame_.colours()},
                    {"ZSums", frame_.z_sums()},
                    {"Composed", colours_},
                    {"ComposedZ", z_sums_},
                    {"Canvases", canvases_}},
                   {{"nth", static_cast<std::uint32_t>(k)},
                    {"background_r", bits(background_.r)},
                    {"background_g", bits(background_.g)},
                    {"background_b", bits(background_.b)},
                    {"first", eye.pixel_offset},
                    {"width", eye.width},
                    {"height", eye.height},
                    {"step_x", bits(static_cast<float>(context.width) / static_cast<float>(eye.width))},
                    {"step_y", bits(static_cast<float>(context.height) / static_cast<float>(eye.height))},
                    {"context_first", context.pixel_offset},
                    {"context_width", context.width},
                    {"context_height", context.height},
                    {"window_first", window.pixel_offset},
                    {"window_left", window.left},
                    {"window_top", window.top},
                    {"window_width", window.width},
                    {"inset_left", parts.inset_begin.x},
                    {"inset_top", parts.inset_begin.y},
                    {"inset_right", parts.inset_end.x},
                    {"inset_bottom", parts.inset_end.y},
                    {"seam", bits(static_cast<float>(parts.seam))}});
}

std::vector<Picture> FoveatedFrame::read_pictures() const {
  if (!to_.empty()) fail("the pictures are on the caller's canvases: read them there");
  std::vector<Picture> pictures;
  for (const shared::View& eye : eyes_) {
    Picture& picture = pictures.emplace_back(static_cast<int>(eye.width), static_cast<int>(eye.height));
    picture.colour = colours_.read<glm::vec4>(picture.colour.size(), eye.pixel_offset);
    picture.z_sum = z_sums_.read<float>(picture.z_sum.size(), eye.pixel_offset);
  }
  return pictures;
}

}  // namespace binosplat::stereo
