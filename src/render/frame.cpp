#include "render/frame.h"

#include <algorithm>
#include <utility>

#include "base/clock.h"
#include "base/error.h"
#include "primitives/arguments.h"
#include "render/stages.h"

namespace binosplat::render {

namespace {

constexpr int drawings_max = 8;

// Tiles along a side of a supertile, where that is left to the frame: 2 where a pair's value has room for the
// tiles.
int chosen_supertile_side(const FrameSettings& settings, const Workings& workings, std::uint64_t splats) {
  if (workings.supertile_side != 0) return workings.supertile_side;
  const bool has_room = splats <= std::uint64_t{1} << SUPERTILE_SPLAT_BITS;
  const bool usual = settings.tile_size == TILE_SIZE_DEFAULT && settings.tiles != TILES_ALL;
  return has_room && usual && !workings.stand_in ? 2 : 1;
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

Frame::Frame(std::shared_ptr<GpuModel> model)
    : model_(std::move(model)),
      uploads_(model_->uploads()),
      dispatcher_(model_->context()),
      buffers_(model_->context()) {}

FrameReport Frame::draw(std::span<const shared::View> views, const FrameSettings& settings,
                        const Workings& workings, std::span<const Canvas> canvases, int depth_rows) {
  const bool fit = canvases.size() == views.size() && canvases.size() <= MAX_CANVASES;
  if (!fit && !canvases.empty())
    fail("{} canvases for {} views: expected one each, at most {}", canvases.size(), views.size(),
         MAX_CANVASES);
  begin(views, settings, workings);
  if (settings.quality > 0.0f) return draw_with_quality(views, settings, workings, canvases, depth_rows);
  if (!workings.stand_in) take_canvases(canvases, depth_rows);
  return attempt(workings);
}

void Frame::take_canvases(std::span<const Canvas> canvases, int depth_rows) {
  if (!canvases.empty() && shape_.settings.depth == Depth::seen)
    fail("canvases take depths, and no sums of what is seen");
  shape_.canvases.assign(canvases.begin(), canvases.end());
  shape_.depth_rows = depth_rows;
}

FrameReport Frame::draw_until(Stage last, std::span<const shared::View> views, const FrameSettings& settings,
                              const Workings& workings, const std::optional<Probe>& probe) {
  begin(views, settings, workings, probe);
  return attempt(workings, last);
}

void Frame::begin(std::span<const shared::View> views, const FrameSettings& settings,
                  const Workings& workings, const std::optional<Probe>& probe) {
  check(workings, settings);
  const Model& model = model_->model();
  const ModelSize& size = model_->size();
  const std::int64_t slots =
      std::max({static_cast<std::int64_t>(size.room), capacity_.slots, workings.slots});
  const std::uint64_t splats =
      static_cast<std::uint64_t>(slots) * (views.size() + 1);  // a probe is a view, too
  shape_ = make_shape(views, settings, model, size, chosen_supertile_side(settings, workings, splats), probe);
  if (model_buffers_ && model_buffers_->precision != settings.precision) {
    model_buffers_.reset();  // first, since both together may not fit
    history_.forget_measured();
  }
  model_buffers_ = model_->in(settings.precision);
  if (std::exchange(uploads_, model_->uploads()) != model_->uploads())
    history_.follow_levels(shape_.gaussian_count);
}

FrameReport Frame::draw_with_quality(std::span<const shared::View> views, const FrameSettings& settings,
                                     const Workings& workings, std::span<const Canvas> canvases,
                                     int depth_rows) {
  FrameReport report;
  if (!history_.goes_on(shape_)) tolerance_control_.forget();
  if (tolerance_control_.knows(settings) && history_.probed_lately(shape_)) {
    shape_.settings.tolerance = tolerance_control_.tolerance();
    if (!workings.stand_in) take_canvases(canvases, depth_rows);
    report = attempt(workings);
  } else {
    do {
      const Probe probe = tolerance_control_.next_probe(views, settings);
      shape_ = make_shape(views, settings, model_->model(), model_->size(), shape_.supertile_side, probe);
      shape_.settings.tolerance = tolerance_control_.next_tolerance();
      add(attempt(workings), report);
      tolerance_control_.measured(probed(shape_, counters_),
                                  shape_.remembers || !measures(settings.transmittance));
    } while (!tolerance_control_.holds());
  }
  report.quality = tolerance_control_.quality();
  return report;
}

FrameReport Frame::attempt(const Workings& workings, Stage last) {
  history_.decide(shape_);
  shape_.tiles_a_splat = tiles_a_splat_;
  if (model_buffers_->box) limit_keys(shape_, *model_buffers_->box);
  capacity_.start(shape_, workings);
  const std::uint32_t blocks = (shape_.gaussian_count + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
  buffers_.block_arguments.upload(
      std::vector{primitives::make_arguments(blocks, dispatcher_.context().limits().groups)});
  FrameReport report;
  for (;; ++report.redrawn) {
    if (report.redrawn == drawings_max) throw std::logic_error("a frame overflowed again and again");
    shape_.slots = static_cast<std::uint32_t>(capacity_.slots);
    buffers_.upload(shape_);
    buffers_.reserve(shape_, *model_buffers_, capacity_.pairs, capacity_.tile_pairs);
    model_buffers_->reserve(shape_);
    run_stages(workings, last, report);
    if (counters_.overflow == 0) break;
    capacity_.grow(shape_, counters_);
  }
  if (counters_.loop_cut != 0) {
    forget();  // what this frame left behind is not to be gone by
    refuse_cut(dispatcher_.context(), counters_);
  }
  if (last == Stage::probe) {
    history_.keep(shape_, counters_);
    buffers_.keep_last(shape_);
  }
  fill(report);
  const double splats = static_cast<double>(report.visible) * shape_.view_count();
  tiles_a_splat_ = static_cast<double>(report.pairs) / std::max(1.0, splats);
  return report;
}

// The frame: its stages in order, without a read-back between them.
void Frame::run_stages(const Workings& workings, Stage last, FrameReport& report) {
  buffers_.counters.upload(std::vector{shared::Counters{}});
  pictures_stood_in_.clear();
  if (workings.stand_in)
    pictures_stood_in_ = workings.stand_in->fill(model_->model(), shape_, *model_buffers_, buffers_);
  const auto run = [&](Stage stage, const auto& record) {
    if (stage > last || (workings.stand_in && stage <= workings.stand_in->until)) return;
    dispatcher_.begin_stage(name_of(stage));
    record();
  };
  const auto start = Clock::now();
  dispatcher_.begin_frame();
  if (shape_.offset_count > 0)
    run(Stage::decode, [&] { decode(dispatcher_, shape_, *model_buffers_, buffers_); });
  for (std::uint32_t group = 0; group < shape_.groups.size(); ++group) {
    run(Stage::project, [&] { project(dispatcher_, shape_, group, *model_buffers_, buffers_); });
    run(Stage::order, [&] { order(dispatcher_, shape_, group, buffers_); });
    run(Stage::pairs, [&] { pairs(dispatcher_, shape_, group, buffers_); });
  }
  run(Stage::tile_sort, [&] { tile_sort(dispatcher_, shape_, buffers_); });
  run(Stage::ranges, [&] { ranges(dispatcher_, shape_, buffers_); });
  run(Stage::blend, [&] {
    find_long_lists(dispatcher_, shape_, buffers_);
    blend(dispatcher_, shape_, buffers_);
    remember(dispatcher_, shape_, buffers_);
  });
  if (shape_.probe && pictures_stood_in_.empty())
    run(Stage::probe, [&] { probe(dispatcher_, shape_, buffers_); });
  if (workings.then && last == Stage::probe) {
    dispatcher_.begin_stage(workings.then_called);
    workings.then(dispatcher_);
  }
  dispatcher_.end_frame();
  report.submit_ms = ms_since(start);
  report.stages = dispatcher_.wait_and_time();
  counters_ = buffers_.counters.read<shared::Counters>(1).front();
}

void Frame::fill(FrameReport& report) const {
  report.attempts = 1;
  report.visible = counters_.visible;
  report.pairs = shape_.supertile_side == 1 ? counters_.pairs : counters_.tile_pairs;
  report.supertile_pairs = counters_.pairs;
  report.order_groups = static_cast<std::uint32_t>(shape_.groups.size());
  report.order_passes = primitives::RadixSort::passes(shape_.groups.front().key_bits);
  report.tile_sort_passes = primitives::RadixSort::passes(shape_.supertile_bits());
  report.tile_size = shape_.settings.tile_size;
  report.supertile_side = shape_.supertile_side;
  report.gpu_bytes = model_->context().allocated_bytes();
  for (const gl::StageTime& stage : report.stages) report.total_ms += stage.ms;
  report.tolerance = shape_.settings.tolerance;
  report.remembered = shape_.remembers;
  report.recorded = shape_.records;
  report.on_canvases = !shape_.canvases.empty();
}

}  // namespace binosplat::render
