#include "stereo/drawing.h"

#include <array>
#include <bit>
#include <utility>

#include "base/error.h"
#include "shared/limits.h"

namespace binosplat::stereo {

namespace {

std::uint32_t bits(float number) { return std::bit_cast<std::uint32_t>(number); }

}  // namespace

// Passes the eyes, or the views of their parts, to `to`, a member function of render::Frame.
void Drawing::forward_views(std::span<const shared::View> eyes, const render::FrameSettings& settings,
                            const render::DebugOptions& debug, const render::CallersTextures& textures,
                            decltype(&render::Frame::submit) to) {
  parts_.clear();
  if (!settings.foveation) return (frame_.*to)(eyes, settings, debug, textures);
  const std::size_t canvases = textures.canvases.size(), meshes = textures.mesh_depths.size();
  if (canvases != 0 && canvases != eyes.size())
    fail("{} canvases for {} eyes: expected one per eye", canvases, eyes.size());
  if (meshes != 0 && (canvases == 0 || meshes != eyes.size()))
    fail("foveation with mesh depths: expected one mesh depth and one canvas per eye");
  FoveatedViews drawn = foveated_views(eyes, settings);
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

Report Drawing::finish() {
  Report report = frame_.finish();
  if (is_foveated()) report.in_place = !to_.empty();
  return report;
}

void Drawing::compose(gl::Dispatcher& dispatcher) {
  for (std::size_t k = 0; k < eyes_.size(); ++k) compose_eye(dispatcher, k);
  dispatcher.wait_for_writes();
  // All barriers, because the caller may use the canvases in any way.
  if (!to_.empty()) dispatcher.context().gl().MemoryBarrier(GL_ALL_BARRIER_BITS);
}

void Drawing::compose_eye(gl::Dispatcher& dispatcher, std::size_t k) {
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

std::vector<Picture> Drawing::read_pictures() const {
  if (!is_foveated()) return frame_.read_pictures();
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
