#include "stream/visibility.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/parallel_in_frame.h"
#include "render/stages.h"

namespace binosplat {

namespace {

// The shorter side of a shrunk view has at least this many px. In smaller pictures too few pixels sample a
// chunk. Chunks that are missed by chance stay coarse, which costs 1.5 dB (taebak at 915 x 800 px).
constexpr std::uint32_t min_shrunk_side = 512;
// A GPU draws a view faster at 1/2 than at 1/4 of its size. Most of the time goes to the few tiles that
// contain most of a scene. Tiles of a larger picture cover less of the scene, so their lists are shorter.
constexpr int shrink_on_gpu = 2, shrink_on_cpu = 4;

/// Returns the same view with fewer pixels.
shared::View shrunk(const shared::View& view, int by) {
  shared::View small = view;
  for (int k = 0; k < 2; ++k) {
    const std::uint32_t size = k == 0 ? view.width : view.height;
    const std::uint32_t pixels = std::max<std::uint32_t>(
        1, (size + static_cast<std::uint32_t>(by) / 2) / static_cast<std::uint32_t>(by));
    const float scale = static_cast<float>(pixels) / static_cast<float>(size);
    (k == 0 ? small.width : small.height) = pixels;
    small.lens[k] *= scale;
    small.lens[k + 2] *= scale;
  }
  return small;
}

render::FrameSettings exact_in_precision(const render::FrameSettings& settings) {
  render::FrameSettings exact = render::exact_of(settings);
  exact.precision = settings.precision;
  return exact;
}

}  // namespace

Visibility::Visibility(std::shared_ptr<render::GpuModel> model)
    : frame_(model),
      dispatcher_(model->context()),
      sums_(model->context(), "visibility by splat"),
      owners_(model->context(), "chunks by block"),
      of_chunks_(model->context(), "visibility by chunk"),
      kept_(model->context()) {}

std::vector<std::vector<ChunkVisibility>> Visibility::measure(std::span<const shared::View> views,
                                                              const render::FrameSettings& settings,
                                                              const ModelChunks& chunks,
                                                              std::optional<int> max_shrink) {
  const int most = max_shrink.value_or(frame_.model()->context().software() ? shrink_on_cpu : shrink_on_gpu);
  render::FrameSettings exact = exact_in_precision(settings);
  std::vector<shared::View> small(views.begin(), views.end());
  std::vector<double> pixel_areas;  // area of a pixel of each shrunk view, in pixels of the view
  for (shared::View& view : small) {
    const auto shrink = static_cast<int>(std::min(view.width, view.height) / min_shrunk_side);
    const glm::dvec2 size(view.width, view.height);
    view = shrunk(view, std::clamp(shrink, 1, most));
    pixel_areas.push_back(size.x / view.width * size.y / view.height);
    exact.regions.push_back({{.low_pass_share = static_cast<float>(1.0 / pixel_areas.back())}});
  }
  frame_.draw_until(render::Stage::sort, small, exact);
  const std::vector<std::int64_t> sums = sum_up(views.size(), exact.precision, chunks);
  std::vector<std::vector<ChunkVisibility>> seen(views.size(), std::vector<ChunkVisibility>(chunks.size()));
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto read = [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        const std::int64_t* const of = &sums[2 * (v * chunks.size() + c)];
        if (of[0] == 0) continue;
        const double area = static_cast<double>(of[0]);
        seen[v][c] = {area / VISIBILITY_SCALE * pixel_areas[v],
                      std::exp2(static_cast<double>(of[1]) / area - 32.0)};
      }
    };
    parallel_in_frame(chunks.size(), 1 << 12, read);
  }
  return seen;
}

// Sums visibility by chunk, for the views that the frame has drawn up to its stage `sort`.
std::vector<std::int64_t> Visibility::sum_up(std::size_t views, int precision, const ModelChunks& chunks) {
  const render::FramePlan& plan = frame_.plan();
  render::FrameBuffers& buffers = frame_.buffers();
  // The shader resets the sums to 0, since a separate clear would take as long as all other work.
  const std::int64_t sum_bytes = std::int64_t{buffers.slots} * static_cast<std::int64_t>(views) * 8;
  if (sums_.bytes() < sum_bytes) sums_.reserve_zeros(sum_bytes);
  of_chunks_.reserve_zeros(static_cast<std::int64_t>(chunks.size() * views * 16));
  owners_.upload(chunks.owners());
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("blend");
  render::blend_visibility(dispatcher_, plan, buffers, sums_);
  const auto model_buffers = frame_.model()->buffers_in(precision);
  const gl::Program& program = dispatcher_.context().program(
      "chunk_visibility.comp", gl::Number{"HALF", precision == PRECISION_HALF, 2});
  for (std::size_t group = 0; group < plan.groups.size(); ++group) {
    for (const render::ModelBuffers::Page& page : model_buffers->pages) {
      const render::DrawnBuffers& drawn = *buffers.drawn[group];
      dispatcher_.run(
          program,
          gl::DispatchSize::indirect(drawn.arguments, offsetof(shared::DispatchArguments, threads_x)),
          {{"Frame", buffers.parameters},
           {"Views", buffers.views},
           {"Gaussians", *page.gaussians},
           {"Arguments", drawn.arguments},
           {"Indices", drawn.indices},
           {"Sums", sums_},
           {"Owners", owners_},
           {"ChunkSums", of_chunks_}},
          {{"page_first", page.first},
           {"page_count", page.count},
           {"chunk_count", static_cast<std::uint32_t>(chunks.size())},
           {"block_size", static_cast<std::uint32_t>(ModelChunks::block)},
           {"view_begin", plan.groups[group].begin},
           {"view_end", plan.groups[group].end}});
    }
  }
  dispatcher_.end_frame();
  dispatcher_.wait_and_time();
  render::throw_if_truncated(dispatcher_.context(), buffers.counters.read<shared::Counters>(1).front());
  return of_chunks_.read<std::int64_t>(2 * chunks.size() * views);
}

void Visibility::keep_picture(const shared::View& view, const render::FrameSettings& settings) {
  frame_.draw({&view, 1}, exact_in_precision(settings));
  kept_.clear();
  kept_.add(frame_.colours(), view.width * view.height);
}

double Visibility::picture_error(const shared::View& view, const render::FrameSettings& settings) {
  frame_.draw({&view, 1}, exact_in_precision(settings));
  return kept_.mean(frame_.colours());
}

}  // namespace binosplat
