#include "stream/sight.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/frame_crew.h"
#include "render/stages.h"

namespace binosplat {



namespace {

// px. In smaller pictures parts are sampled by so few pixels that those of which little is found by chance,
// which then stay coarse, cost 1.5 dB (taebak at 915 x 800 px).
constexpr std::uint32_t small_enough = 512;

/// The same view in a picture of fewer pixels.
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

/// px, which end between cells, as windows do (ViewPart); none where a band is narrower.
struct BandColumns {
  std::uint32_t left, right;
};

BandColumns columns_of_band(const Band& band, const shared::View& view) {
  constexpr std::uint32_t cell = BLEND_CELL;
  const std::uint32_t cells = (view.width + cell - 1) / cell;
  const auto column = [&](double share) {
    return std::min(static_cast<std::uint32_t>(std::lround(share * cells)) * cell, view.width);
  };
  return {column(band.begin), column(band.end)};
}

}  // namespace

Sight::Sight(std::shared_ptr<render::GpuModel> model)
    : frame_(model),
      dispatcher_(model->context()),
      sums_(model->context(), "how much is seen by splat"),
      owners_(model->context(), "parts by block"),
      of_parts_(model->context(), "how much is seen by part"),
      kept_(model->context()) {}

std::vector<std::vector<SeenPart>> Sight::look(std::span<const shared::View> views,
                                               const render::FrameSettings& settings, const ModelParts& parts,
                                               std::optional<int> shrink_most) {
  return look(views, settings, parts, shrink_most.value_or(shrink_usual()), {});
}

std::vector<SeenPart> Sight::look(const shared::View& view, Band band, const render::FrameSettings& settings,
                                  const ModelParts& parts) {
  const int usual = shrink_usual();
  const bool is_narrow = (band.end - band.begin) * usual * usual <= 1.0;
  return std::move(look({&view, 1}, settings, parts, is_narrow ? 1 : usual, band).front());
}

// A GPU draws the tiles of more pixels at once, and ends sooner: the lists of the few tiles in which most of
// a scene lies take the time, and smaller tiles have shorter ones. For the same reason a band is drawn at
// whole size that has no more pixels then than the whole picture has.
int Sight::shrink_usual() const { return frame_.model()->context().software() ? 4 : 2; }

std::vector<std::vector<SeenPart>> Sight::look(std::span<const shared::View> views,
                                               const render::FrameSettings& settings, const ModelParts& parts,
                                               int shrink_most, Band band) {
  render::FrameSettings exact = exact_in_precision(settings);
  std::vector<shared::View> small(views.begin(), views.end());
  std::vector<double> pixel_areas;  // of the views' pixels
  std::vector<std::vector<SeenPart>> seen(views.size(), std::vector<SeenPart>(parts.size()));
  for (shared::View& view : small) {
    const auto shrink = static_cast<int>(std::min(view.width, view.height) / small_enough);
    const glm::dvec2 size(view.width, view.height);
    view = shrunk(view, std::clamp(shrink, 1, shrink_most));
    pixel_areas.push_back(size.x / view.width * size.y / view.height);
    const BandColumns columns = columns_of_band(band, view);
    if (columns.left == columns.right) return seen;
    exact.parts.push_back({.low_pass_share = static_cast<float>(1.0 / pixel_areas.back())});
    if (!band.is_all()) {
      exact.parts.back().corner = {columns.left, 0};
      exact.parts.back().size = {columns.right - columns.left, view.height};
    }
  }
  frame_.draw_until(render::Stage::ranges, small, exact);
  const render::FrameShape& shape = frame_.shape();
  render::FrameBuffers& buffers = frame_.buffers();
  const std::int64_t of_views = static_cast<std::int64_t>(views.size());
  // Zeros again after each look, since clearing takes as long as all of the rest.
  const std::int64_t sum_bytes = std::int64_t{shape.slots} * of_views * 8;
  if (sums_.bytes() < sum_bytes) sums_.reserve_zeros(sum_bytes);
  of_parts_.reserve_zeros(static_cast<std::int64_t>(parts.size()) * of_views * 16);
  owners_.upload(parts.owners());
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("blend");
  render::find_long_lists(dispatcher_, shape, buffers);
  render::blend_seen(dispatcher_, shape, buffers, sums_);
  const auto model_buffers = frame_.model()->in(exact.precision);
  const gl::Program& program = dispatcher_.context().program(
      "parts_seen.comp", {{"OFFSETS", "0"}, {"HALF", exact.precision == PRECISION_HALF ? "1" : "0"}});
  for (std::size_t group = 0; group < shape.groups.size(); ++group) {
    for (const render::ModelBuffers::Page& page : model_buffers->pages) {
      const render::DrawnBuffers& drawn = *buffers.drawn[group];
      dispatcher_.run(program,
                      gl::Work::indirect(drawn.arguments, offsetof(shared::DispatchArguments, threads_x)),
                      {{"Frame", buffers.parameters},
                       {"Views", buffers.views},
                       {"Gaussians", *page.gaussians},
                       {"Arguments", drawn.arguments},
                       {"Indices", drawn.indices},
                       {"Sums", sums_},
                       {"Owners", owners_},
                       {"OfParts", of_parts_}},
                      {{"page_first", page.first},
                       {"page_count", page.count},
                       {"part_count", static_cast<std::uint32_t>(parts.size())},
                       {"block_size", static_cast<std::uint32_t>(ModelParts::block)},
                       {"view_begin", shape.groups[group].begin},
                       {"view_end", shape.groups[group].end}});
    }
  }
  dispatcher_.end_frame();
  dispatcher_.wait_and_time();
  render::refuse_cut(dispatcher_.context(), buffers.counters.read<shared::Counters>(1).front());
  const auto found = of_parts_.read<std::int64_t>(2 * parts.size() * views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto read = [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        const std::int64_t* const of = &found[2 * (v * parts.size() + p)];
        if (of[0] == 0) continue;
        const double area = static_cast<double>(of[0]);
        seen[v][p] = {area / SEEN_SCALE * pixel_areas[v],
                      std::exp2(static_cast<double>(of[1]) / area - 32.0)};
      }
    };
    frame_chunks(parts.size(), 1 << 12, read);
  }
  return seen;
}

void Sight::draw_whole(const shared::View& view, const render::FrameSettings& settings) {
  frame_.draw({&view, 1}, exact_in_precision(settings));
}

PartsTrial Sight::trial(const render::FrameSettings& settings) {
  return {.upload = [this](const ModelParts::Changes& changes) { frame_.model()->reload(changes); },
          .keep =
              [this, settings](const shared::View& view) {
                draw_whole(view, settings);
                kept_.clear();
                kept_.add(frame_.colours(), view.width * view.height);
              },
          .differs =
              [this, settings](const shared::View& view) {
                draw_whole(view, settings);
                return kept_.mean(frame_.colours());
              }};
}

}  // namespace binosplat
