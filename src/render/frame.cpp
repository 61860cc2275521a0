#include "render/frame.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/thread_spans.h"
#include "render/stages.h"

namespace binosplat::render {

namespace {

constexpr int drawings_max = 8 + SORT_ROUNDS;
// An upload of levels counts as so much motion, as a share of a camera cut: the next frame has a probe.
constexpr double change_by_upload = 0.5;

void check(const CallersTextures& textures, std::size_t views, const FrameSettings& settings,
           const DebugOptions& debug) {
  const std::size_t canvases = textures.canvases.size(), meshes = textures.mesh_depths.size();
  if (canvases != 0 && (canvases != views || canvases > MAX_CANVASES))
    fail("{} canvases for {} views: expected one per view, for at most {} views", canvases, views,
         MAX_CANVASES);
  if (meshes == 0) return;
  if (meshes != views || meshes > MAX_CANVASES)
    fail("{} mesh depths for {} views: expected none, or one per view for at most {} views", meshes, views,
         MAX_CANVASES);
  if (measures(settings))
    fail("mesh depths with a measured transmittance: Gaussians behind a mesh are not measured");
  if (debug.stand_in) fail("mesh depths with a stand-in, which ignores meshes");
}

}  // namespace

Frame::Frame(std::shared_ptr<GpuModel> model)
    : model_(std::move(model)),
      drawn_{{model_, model_->uploads()}},
      dispatcher_(model_->context()),
      buffers_(model_->context()),
      counters_read_(model_->context(), "counters for the CPU", gl::Buffer::Use::read) {}

void Frame::place(std::vector<Instance> instances) {
  for (const auto& [model, place] : instances) {
    if (model->model().scaffold && (instances.size() > 1 || !place.is_plain())) {
      fail(
          "a Scaffold-GS model must be the only instance, without a transform: its networks compute "
          "Gaussians for an eye in the model's own world");
    }
  }
  std::vector<Drawn> drawn;
  places_.clear();
  while (!instances.empty()) {
    const std::shared_ptr<GpuModel> model = instances.front().model;
    const auto others = std::stable_partition(instances.begin(), instances.end(),
                                              [&](const Instance& one) { return one.model == model; });
    drawn.push_back({model, model->uploads(), static_cast<std::uint32_t>(others - instances.begin())});
    for (auto one = instances.begin(); one != others; ++one) places_.push_back(std::move(one->place));
    instances.erase(instances.begin(), others);
  }
  if (drawn.size() == 1 && places_.size() == 1 && places_.front().is_plain()) places_.clear();
  const auto same = [](const Drawn& a, const Drawn& b) {
    return a.model == b.model && a.instances == b.instances;
  };
  if (std::ranges::equal(drawn, drawn_, same)) return;  // the stored numbers of uploads stay valid
  unseen_change_ = std::numeric_limits<double>::infinity();
  drawn_ = std::move(drawn);
  model_buffers_.clear();  // frees the models that are gone
}

void Frame::store_submission(std::span<const shared::View> views, const FrameSettings& settings,
                             const DebugOptions& debug, const CallersTextures& textures) {
  check(textures, views.size(), settings, debug);
  submitted_ = {.views = {views.begin(), views.end()}, .settings = settings, .debug = debug};
  if (debug.stand_in) return;
  submitted_.canvases.assign(textures.canvases.begin(), textures.canvases.end());
  submitted_.mesh_depths.assign(textures.mesh_depths.begin(), textures.mesh_depths.end());
  submitted_.depth_rows = textures.depth_rows;
}

void Frame::prepare(std::span<const shared::View> views, const FrameSettings& settings,
                    const DebugOptions& debug, const CallersTextures& textures) {
  store_submission(views, settings, debug, textures);
  std::vector<std::optional<ToleranceControl::Choice>> choices(1);
  if (settings.quality) {
    choices = {{{.exact = ExactReason::unmeasured}}};
    for (const Threshold rule : {Threshold::squared, Threshold::adagscale}) {
      if (settings.threshold.value_or(rule) != rule) continue;
      choices.push_back({{.threshold = rule, .tolerance = 1.0f}});
      for (const ExactReason exact : {ExactReason::unmeasured, ExactReason::not_exact})
        choices.push_back({{exact, rule, 1.0f, Probe{.step = 4}}});
    }
  }
  for (const auto& choice : choices) {
    choice ? begin(*choice) : begin(PlanRequest{.textures = submitted_textures(true)});
    for (const bool measures_too : {false, true}) {
      if (measures_too && !measures(settings)) continue;
      measuring_ = {.measures = measures_too};
      capacity_.start(plan_, debug);
      reserve();
      dispatcher_.context().prepare([this] { record_stages(); });
    }
  }
  is_prepared_ = true;
  start_over();
}

void Frame::submit(std::span<const shared::View> views, const FrameSettings& settings,
                   const DebugOptions& debug, const CallersTextures& textures) {
  store_submission(views, settings, debug, textures);
  start_report();
  const bool follows = std::exchange(choice_, std::nullopt).has_value();
  begin(PlanRequest{.textures = submitted_textures(true)});
  if (settings.quality) {
    // The control has not seen the motion before a frame without a quality.
    const double motion = follows ? history_.motion_to(plan_) : std::numeric_limits<double>::infinity();
    choice_ = tolerance_control_.choose(plan_.views, settings,
                                        std::max(motion, std::exchange(unseen_change_, 0.0)));
    begin(*choice_);
  }
  start_drawing();
}

Report Frame::finish() {
  finish_drawing();
  if (choice_) {
    const ProbeResult probe = plan_.probe ? probe_result(plan_, counters_) : ProbeResult{};
    tolerance_control_.drew(
        static_cast<double>(report_.pairs) - (plan_.exact ? probe.pairs : probe.exact_pairs),
        plan_.gaussian_count);
    const bool settled = measuring_.uses_last || !measures(submitted_.settings);
    if (plan_.probe && settled) tolerance_control_.measured(probe);
    report_.exact = choice_->exact;
    report_.quality = tolerance_control_.quality();
  }
  report_.new_programs = dispatcher_.context().program_count() - programs_before_;
  return report_;
}

void Frame::start_report() {
  report_ = {};
  programs_before_ = dispatcher_.context().program_count();
}

Report Frame::draw_until(Stage last, std::span<const shared::View> views, const FrameSettings& settings,
                         const DebugOptions& debug, const std::optional<Probe>& probe, bool exact) {
  start_report();
  choice_.reset();
  submitted_ = {.views = {views.begin(), views.end()}, .settings = settings, .debug = debug, .last = last};
  begin(PlanRequest{.probe = probe, .exact = exact});
  start_drawing();
  return finish_drawing();
}

void Frame::begin(PlanRequest request) {
  const TimedSpan span("plan", &report_.plan_ms);
  const std::vector<shared::View>& views = submitted_.views;
  const FrameSettings& settings = submitted_.settings;
  const DebugOptions& debug = submitted_.debug;
  check(debug, settings);
  if (debug.stand_in && !is_plain()) fail("a stand-in draws only one model, without a transform");
  if (!model_buffers_.empty() && model_buffers_.front()->precision != settings.precision)
    model_buffers_.clear();  // before the next upload, because both precisions may not fit together
  bool is_other = model_buffers_.empty();
  std::uint32_t instance_count = 0;
  std::vector<std::shared_ptr<ModelBuffers>> held;
  for (Drawn& drawn : drawn_) {
    held.push_back(drawn.model->buffers_in(settings.precision));
    PlannedModel& model = request.models.emplace_back(planned(drawn.model->model(), drawn.model->size()));
    model.first_instance = instance_count;
    model.instances = drawn.instances;
    instance_count += drawn.instances;
    if (std::exchange(drawn.uploads, drawn.model->uploads()) == drawn.model->uploads()) continue;
    is_other = true;
    unseen_change_ = std::max(unseen_change_, change_by_upload);
  }
  if (drawn_.empty()) request.models.push_back({.instances = 0});
  model_buffers_ = std::move(held);
  request.instances = places_;
  const GpuModel& first = drawn_.empty() ? *model_ : *drawn_.front().model;
  plan_ = make_plan(views, settings, first.model(), first.size(), debug, request);
  plan_.list_parts = list_parts_;
  if (is_other) history_.follow(plan_);
}

CallersTextures Frame::submitted_textures(bool with_canvases) const {
  CallersTextures all{.depth_rows = submitted_.depth_rows, .mesh_depths = submitted_.mesh_depths};
  if (with_canvases) all.canvases = submitted_.canvases;
  return all;
}

void Frame::begin(const ToleranceControl::Choice& choice) {
  begin(PlanRequest{.probe = choice.probe,
                    .threshold = choice.threshold,
                    .tolerance = choice.tolerance,
                    .exact = choice.exact != ExactReason::not_exact,
                    .textures = submitted_textures(!choice.probe)});
}

void Frame::start_drawing() {
  measuring_ = history_.decide(plan_);
  capacity_.start(plan_, submitted_.debug);
  record();
}

const Report& Frame::finish_drawing() {
  for (;; ++report_.redraws) {
    if (report_.redraws == drawings_max)
      throw std::logic_error("a frame still overflowed after its buffers grew repeatedly");
    wait_and_read();
    const std::uint32_t parts = counters_.truncated_lists != 0 ? parts_of_lists() : 1;
    if (counters_.overflow == 0 && parts <= plan_.list_parts) break;
    if (counters_.overflow == 0)
      plan_.list_parts = list_parts_ = parts;
    else
      capacity_.grow(plan_, counters_);
    record();
  }
  if (counters_.truncated_lists != 0) {
    forget();  // the results of this frame are invalid
    throw_if_truncated(dispatcher_.context(), counters_);
  }
  if (submitted_.last == Stage::probe) {
    history_.store(plan_, measuring_, counters_);
    buffers_.swap_bounds(measuring_.measures);
  }
  report_.visible = counters_.visible;
  report_.pairs = counters_.tile_pairs;
  report_.order_groups = static_cast<std::uint32_t>(plan_.groups.size());
  report_.gpu_bytes = model_->context().allocated_bytes();
  for (const StageTime& stage : report_.stages) report_.gpu_ms += stage.ms;
  report_.threshold = plan_.exact ? Threshold::exact : *plan_.settings.threshold;
  report_.tolerance = plan_.exact ? 0.0f : plan_.tolerance;
  report_.used_last = measuring_.uses_last;
  report_.measured = measuring_.measures;
  report_.sampled_error = plan_.probe.has_value();
  report_.in_place = !plan_.canvases.empty();
  const double splats = static_cast<double>(report_.visible) * plan_.view_count();
  const auto pairs = static_cast<double>(report_.pairs);
  list_means_ = {pairs / std::max(1.0, splats), pairs / std::max(1u, plan_.tile_count())};
  return report_;
}

std::uint32_t Frame::parts_of_lists() const {
  if (plan_.settings.tiles == TILES_ALL) return 1;  // its lists are not continued
  std::uint32_t longest = LIST_PART + 1;
  for (const glm::uvec2& range : buffers_.lists.tile_ranges.read<glm::uvec2>(plan_.tile_count()))
    longest = std::max(longest, range.y - range.x);
  return (longest - 1) / LIST_PART + 1;
}

void Frame::wait_and_read() {
  {
    const TimedSpan span("wait for the GPU", &report_.wait_ms);
    dispatcher_.wait();
  }
  const TimedSpan span("read back", &report_.read_ms);
  const std::vector<StageSpan> spans = dispatcher_.read_spans();
  report_.stages = gl::sums_of(spans);
  report_.spans.insert(report_.spans.end(), spans.begin(), spans.end());
  counters_ = counters_read_.mapped<shared::Counters>(1).front();
}

void Frame::reserve() {
  if (!submitted_.debug.stand_in) share_lists(plan_, capacity_.slots, middle_depth(counters_));
  const TimedSpan span("upload", &report_.upload_ms);
  buffers_.reserve(plan_, model_buffers_, capacity_);
  buffers_.upload(plan_, measuring_.uses_last);
  for (const auto& model : model_buffers_) model->reserve(plan_);
  buffers_.counters.upload(std::vector{shared::Counters{}});
}

void Frame::record() {
  const DebugOptions& debug = submitted_.debug;
  reserve();
  stand_in_pictures_.clear();
  if (!std::exchange(is_prepared_, true)) {
    const TimedSpan span("prepare programs", &report_.submit_ms);
    dispatcher_.context().prepare([this] { record_stages(); });
  }
  if (debug.stand_in)
    stand_in_pictures_ = debug.stand_in->fill(model_->model(), plan_, *model_buffers_.front(), buffers_);
  const TimedSpan span("submit", &report_.submit_ms);
  dispatcher_.begin_frame();
  record_stages();
  counters_read_.reserve(sizeof(shared::Counters));
  counters_read_.copy(buffers_.counters, 0, sizeof(shared::Counters), 0);
  dispatcher_.end_frame();
}

void Frame::record_stages() {
  const DebugOptions& debug = submitted_.debug;
  const auto run = [&](Stage stage, const auto& dispatches) {
    if (stage > submitted_.last || (debug.stand_in && stage <= debug.stand_in->until)) return;
    dispatcher_.begin_stage(name_of(stage));
    dispatches();
  };
  if (plan_.offset_count > 0)
    run(Stage::decode, [&] { decode(dispatcher_, plan_, *model_buffers_.front(), buffers_); });
  for (std::uint32_t group = 0; group < plan_.groups.size(); ++group) {
    run(Stage::project,
        [&] { project(dispatcher_, plan_, group, measuring_.measures, model_buffers_, buffers_); });
  }
  run(Stage::bin, [&] { bin(dispatcher_, plan_, capacity_, buffers_); });
  run(Stage::sort, [&] { sort(dispatcher_, plan_, capacity_, buffers_); });
  run(Stage::blend, [&] {
    blend(dispatcher_, plan_, measuring_.measures, list_means_, buffers_);
    store_measured(dispatcher_, plan_, measuring_.measures, buffers_);
  });
  if (plan_.probe && stand_in_pictures_.empty())
    run(Stage::probe, [&] { probe(dispatcher_, plan_, buffers_); });
  if (debug.extra_stage && submitted_.last == Stage::probe) {
    dispatcher_.begin_stage(debug.extra_stage_name);
    debug.extra_stage(dispatcher_);
  }
}

}  // namespace binosplat::render
