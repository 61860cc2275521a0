#include "render/frame.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "primitives/amount.h"
#include "render/continuity.h"
#include "render/stages.h"
#include "render/twins.h"

namespace binosplat::render {

namespace {

constexpr int attempts_max = 8;
// Of the way to a cut: a picture that has changed by more is probed again.
constexpr double probe_share = 1.0 / 15.0;

// With lists chosen where that is left to the frame: of 2 x 2 tiles where subgroups blend, and where a pair's
// value has room for the tiles.
FrameSettings with_lists(FrameSettings settings, std::uint64_t splats, bool has_subgroups) {
  if (settings.list_tiles != 0) return settings;
  const bool has_room = splats <= std::uint64_t{1} << LIST_SPLAT_BITS;
  const bool usual = settings.tile_size == TILE_SIZE_DEFAULT && settings.tiles != TILES_ALL;
  const bool shares = has_subgroups && has_room && usual && !settings.reference_until;
  settings.list_tiles = shares ? 2 : 1;
  return settings;
}

// Another attempt at a frame: the last one is the frame, all took their time.
void add(FrameReport attempt, FrameReport& report) {
  attempt.attempts += report.attempts;
  attempt.redrawn += report.redrawn;
  attempt.submit_ms += report.submit_ms;
  attempt.total_ms += report.total_ms;
  for (const gl::StageTime& before : report.stages) {
    const auto same = std::find_if(attempt.stages.begin(), attempt.stages.end(),
                                   [&](const gl::StageTime& s) { return s.name == before.name; });
    if (same != attempt.stages.end()) same->ms += before.ms;
  }
  report = std::move(attempt);
}

}  // namespace

Frame::Frame(gl::Context& context, const Model& model, int precision, std::uint32_t page_gaussians)
    : dispatcher_(context),
      model_(model),
      model_buffers_(context, model, precision, page_gaussians),
      buffers_(context) {}

void Frame::reload() {
  model_buffers_.upload(dispatcher_.context(), model_, model_buffers_.precision());
  recorded_shape_ = {};
  last_shape_.gaussian_count = static_cast<std::uint32_t>(model_.count());
}

FrameReport Frame::draw(std::span<const shared::View> views, const FrameSettings& settings) {
  const std::int64_t slots =
      std::max({static_cast<std::int64_t>(model_.count()), slots_, settings.order_capacity});
  const std::uint64_t splats =
      static_cast<std::uint64_t>(slots) * (views.size() + 1);  // a probe is a view, too
  const FrameSettings chosen = with_lists(settings, splats, dispatcher_.context().limits().subgroups_of_32);
  shape_ = make_shape(views, chosen, model_);
  if (chosen.precision != model_buffers_.precision()) {
    model_buffers_.upload(dispatcher_.context(), model_, chosen.precision);
    recorded_shape_ = {};  // of Scaffold-GS what was kept is gone
  }
  if (chosen.quality == 0.0f) return attempt();
  if (!continues(last_shape_, shape_, last_median_depth_)) loss_control_.forget();
  FrameReport report;
  if (loss_control_.knows(chosen) && ++since_probed_ < chosen.probe_every &&
      continues(probed_shape_, shape_, last_median_depth_, probe_share)) {
    shape_.settings.loss = loss_control_.loss();
    report = attempt();
    report.quality = loss_control_.quality();
    return report;
  }
  do {
    const Probe probe = loss_control_.next_probe(views, chosen);
    shape_ = make_shape(views, chosen, model_, probe);
    shape_.settings.loss = loss_control_.next_loss();
    add(attempt(), report);
  } while (!loss_control_.holds());
  report.quality = loss_control_.quality();
  return report;
}

FrameReport Frame::attempt() {
  const FrameSettings& chosen = shape_.settings;
  decide_measuring();
  if (model_buffers_.box) limit_keys(shape_, *model_buffers_.box);
  slots_ = std::max<std::int64_t>(slots_, shape_.slots);
  if (chosen.order_capacity > 0) slots_ = chosen.order_capacity;
  pair_capacity_ =
      chosen.pair_capacity > 0 ? chosen.pair_capacity : std::max(pair_capacity_, starting_pairs(shape_));
  tile_pair_capacity_ =
      chosen.pair_capacity > 0 ? chosen.pair_capacity : std::max(tile_pair_capacity_, starting_pairs(shape_));

  buffers_.upload(shape_);
  const std::uint32_t groups_max = dispatcher_.context().limits().groups;
  const std::uint32_t blocks = (shape_.gaussian_count + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
  buffers_.block_amount.upload(std::vector{primitives::make_amount(blocks, groups_max)});

  FrameReport report;
  report.attempts = 1;
  shared::Counters counters{};
  for (;;) {
    shape_.slots = static_cast<std::uint32_t>(slots_);
    buffers_.reserve(shape_, pair_capacity_, tile_pair_capacity_);
    model_buffers_.reserve(shape_);
    counters = draw_once(report);
    if (counters.overflow == 0) break;
    if (++report.redrawn == attempts_max) throw std::logic_error("a frame overflowed again and again");
    grow(counters);
  }
  if (counters.loop_cut != 0) {
    forget();  // what this frame left behind is not to be gone by
    throw Error(
        ExitCode::out_of_memory,
        fmt::format(
            "{} ended a tile's list early: too many Gaussians in one tile for this driver. Use a smaller "
            "--tile or a smaller model.",
            dispatcher_.context().renderer()));
  }
  keep_measurements(counters, report);
  report.visible = counters.visible;
  report.pairs = chosen.list_tiles == 1 ? counters.pairs : counters.tile_pairs;
  report.listed_pairs = counters.pairs;
  report.order_groups = static_cast<std::uint32_t>(shape_.groups.size());
  report.order_passes = primitives::RadixSort::passes(shape_.groups.front().key_bits);
  report.tile_sort_passes = primitives::RadixSort::passes(shape_.list_bits());
  report.tile_size = chosen.tile_size;
  report.list_tiles = chosen.list_tiles;
  report.gpu_bytes = dispatcher_.context().allocated_bytes();
  for (const gl::StageTime& stage : report.stages) report.total_ms += stage.ms;
  return report;
}

shared::Counters Frame::draw_once(FrameReport& report) {
  const auto twin = [&](Stage stage) { return shape_.settings.reference_until >= stage; };
  buffers_.counters.upload(std::vector{shared::Counters{}});
  reference_pictures_.clear();
  if (shape_.settings.reference_until) {
    reference_pictures_ =
        fill_from_reference(model_, shape_, dispatcher_.context().limits().groups, model_buffers_, buffers_);
  }
  const auto start = Clock::now();
  dispatcher_.begin_frame();
  if (shape_.offset_count > 0 && !twin(Stage::decode)) {
    dispatcher_.begin_stage("decode");
    decode(dispatcher_, shape_, model_buffers_, buffers_);
  }
  for (std::uint32_t group = 0; group < shape_.groups.size(); ++group) {
    if (!twin(Stage::project)) {
      dispatcher_.begin_stage("project");
      project(dispatcher_, shape_, group, model_buffers_, buffers_);
    }
    if (!twin(Stage::order)) {
      dispatcher_.begin_stage("order");
      order(dispatcher_, shape_, group, buffers_);
    }
    if (!twin(Stage::pairs)) {
      dispatcher_.begin_stage("pairs");
      pairs(dispatcher_, shape_, group, buffers_);
    }
  }
  if (!twin(Stage::tile_sort)) {
    dispatcher_.begin_stage("tile_sort");
    tile_sort(dispatcher_, shape_, buffers_);
  }
  if (!twin(Stage::ranges)) {
    dispatcher_.begin_stage("ranges");
    ranges(dispatcher_, shape_, buffers_);
  }
  if (!twin(Stage::blend)) {
    dispatcher_.begin_stage("blend");
    blend(dispatcher_, shape_, buffers_);
    remember(dispatcher_, shape_, buffers_);
    if (shape_.probe) dispatcher_.begin_stage("probe");
    probe(dispatcher_, shape_, buffers_);
  }
  dispatcher_.end_frame();
  report.submit_ms = ms_since(start);
  report.stages = dispatcher_.wait_and_time();
  return buffers_.counters.read<shared::Counters>(1).front();
}

void Frame::decide_measuring() {
  const FrameSettings& s = shape_.settings;
  if (!measures(s.transmittance)) return;
  shape_.remembers = remembers(recorded_shape_, shape_, last_median_depth_);
  since_cut_ = shape_.remembers ? since_cut_ + 1 : 0;
  ++since_recorded_;
  shape_.records = since_cut_ < s.record_every || since_recorded_ >= s.record_every ||
                   shape_.offset_count > 0 ||
                   !continues(recorded_shape_, shape_, last_median_depth_, 1.0 / 3.0);
}

void Frame::keep_measurements(const shared::Counters& counters, FrameReport& report) {
  last_shape_ = shape_;
  if (shape_.records || shape_.probe)
    last_median_depth_ = counters.visible == 0 ? 0.0 : std::bit_cast<float>(counters.median_depth);
  if (shape_.records) {
    recorded_shape_ = shape_;
    since_recorded_ = 0;
    std::swap(buffers_.upper, buffers_.upper_next);
  } else if (!measures(shape_.settings.transmittance)) {
    recorded_shape_ = {};
  }
  model_buffers_.keep_last();
  report.recorded = shape_.records;
  report.loss = shape_.settings.loss;
  report.remembered = shape_.remembers;
  if (!shape_.probe) return;
  probed_shape_ = shape_;
  since_probed_ = 0;
  loss_control_.measured(probed(shape_, counters),
                         shape_.remembers || !measures(shape_.settings.transmittance));
}

void Frame::grow(const shared::Counters& counters) {
  const auto larger = [](std::uint32_t wanted) { return std::int64_t{wanted} + wanted / 8; };
  if (counters.pairs == COUNT_MAX) {
    throw Error(ExitCode::out_of_memory,
                "more than 2^32 Gaussian-tile pairs in one frame: use a smaller picture");
  }
  if ((counters.overflow & OVERFLOW_ORDER) != 0) {
    log_info("drawn again: {} Gaussians in view, room for {}", counters.order_wanted, slots_);
    slots_ = std::min<std::int64_t>(larger(counters.order_wanted), shape_.gaussian_count);
  }
  if ((counters.overflow & OVERFLOW_PAIRS) != 0) {
    log_info("drawn again: {} Gaussian-{} pairs, room for {}", counters.pairs,
             shape_.settings.list_tiles == 1 ? "tile" : "list", buffers_.pairs.capacity());
    pair_capacity_ = larger(counters.pairs);
  }
  if ((counters.overflow & OVERFLOW_TILE_PAIRS) != 0) {
    log_info("drawn again: {} Gaussian-tile pairs, room for {}", counters.tile_pairs, tile_pair_capacity_);
    tile_pair_capacity_ = larger(counters.tile_pairs);
  }
}

std::vector<Picture> Frame::read_pictures() {
  if (!reference_pictures_.empty()) return reference_pictures_;
  const auto pixels = static_cast<std::size_t>(shape_.pixel_count);
  const auto colours = buffers_.colours.read<glm::vec4>(pixels);
  const auto z_sums = buffers_.z_sums.read<float>(pixels);
  std::vector<Picture> pictures;
  for (const shared::View& view : std::span(shape_.views).first(shape_.asked)) {
    Picture& picture = pictures.emplace_back(static_cast<int>(view.width), static_cast<int>(view.height));
    std::copy_n(colours.begin() + view.pixel_offset, picture.colour.size(), picture.colour.begin());
    std::copy_n(z_sums.begin() + view.pixel_offset, picture.z_sum.size(), picture.z_sum.begin());
  }
  return pictures;
}

std::vector<Image> Frame::read_shown(int what) {
  if (!reference_pictures_.empty())
    fail("--show {}: the GPU does not walk the lists of --reference-until blend", show_choices[what].name);
  show(dispatcher_, shape_, buffers_, what);
  const auto shown = buffers_.shown.read<float>(static_cast<std::size_t>(shape_.pixel_count));
  std::vector<Image> images;
  for (const shared::View& view : std::span(shape_.views).first(shape_.asked)) {
    Image& image = images.emplace_back(static_cast<int>(view.width), static_cast<int>(view.height), 1);
    std::copy_n(shown.begin() + view.pixel_offset, image.data.size(), image.data.begin());
  }
  return images;
}

// What was measured in a view, a T a slot: take(Gaussian, T) of those drawn.
template <typename T, typename Take>
void Frame::read_drawn(std::uint32_t v, const Take& take) const {
  const DrawnBuffers& drawn = *buffers_.drawn[shape_.views.at(v).order_group];
  const auto count = drawn.amounts.read<shared::Amount>(1).front().count;
  const auto indices = drawn.indices.read<std::uint32_t>(count);
  const std::size_t views = shape_.view_count();
  const auto touched = buffers_.touched.read<std::uint32_t>(count * views);
  const auto measured = buffers_.measured.read<T>(count, std::size_t{v} * shape_.slots);
  for (std::size_t slot = 0; slot < count; ++slot) {
    if (touched[slot * views + v] != 0) take(indices[slot], measured[slot]);
  }
}

std::vector<MeasuredGaussian> Frame::read_measured(std::uint32_t v) const {
  if (!shape_.records) return {};
  const shared::View& view = shape_.views.at(v);
  std::vector<MeasuredGaussian> measured;
  read_drawn<float>(v, [&](std::uint32_t i, float most) {
    const glm::vec3 p = model_.position[i] - glm::vec3(view.anchor);
    measured.push_back({i, glm::dot(glm::vec3(view.row_z), p) + view.row_z.w, most});
  });
  return measured;
}

std::vector<WeighedGaussian> Frame::read_weights(std::uint32_t v) const {
  if (!shape_.settings.weigh) return {};
  std::vector<WeighedGaussian> weights;
  read_drawn<std::uint64_t>(v, [&](std::uint32_t i, std::uint64_t steps) {
    weights.push_back({i, static_cast<double>(steps) / WEIGHT_SCALE});
  });
  return weights;
}

}  // namespace binosplat::render
