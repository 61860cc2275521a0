#include "lab/bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/clock.h"
#include "base/statistics.h"
#include "lab/settings.h"
#include "lab/timed_rounds.h"
#include "measure/comparison.h"
#include "measure/depth_table.h"
#include "measure/foveated.h"
#include "reference/render.h"
#include "render/frame.h"
#include "stereo/disagreement.h"
#include "stereo/foveate.h"

namespace binosplat::lab {

namespace {

constexpr double reference_db = 60.0;  // against float64: the bar below which a driver draws wrongly
// A pair at its very threshold may fall either way, and calibrated tolerances lie at such thresholds, where
// the search ends; at most half of what the tolerance costs may come from that.
constexpr double share_db = 3.0;

// The clock has settled when the medians of two successive windows of frames agree.
constexpr std::size_t window = 10;
constexpr double agreement = 0.03;
constexpr double warm_up_ms = 3000.0;

const glm::vec3 black(0.0f);

/// Draws by settings, whole pictures or foveated ones.
class BenchDrawer {
 public:
  BenchDrawer(std::shared_ptr<render::GpuModel> model, const BenchSettings& settings)
      : foveated_(std::move(model)), settings_(settings) {}

  render::FrameReport draw(std::span<const shared::View> eyes) {
    return settings_.foveation ? foveated_.draw(eyes, *settings_.foveation, settings_)
                               : foveated_.frame().draw(eyes, settings_);
  }
  std::vector<Picture> read_pictures() {
    return settings_.foveation ? foveated_.read_pictures() : foveated_.frame().read_pictures();
  }
  stereo::FoveatedFrame& foveated() { return foveated_; }
  render::Frame& frame() { return foveated_.frame(); }

 private:
  stereo::FoveatedFrame foveated_;
  BenchSettings settings_;
};

bool is_finite(const Picture& picture) {
  return std::all_of(picture.colour.begin(), picture.colour.end(), [](const glm::vec4& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
  });
}

bool is_empty(const Picture& picture) {
  return std::ranges::all_of(picture.colour, [](const glm::vec4& v) { return v.w == 1.0f; });
}

bool same_inset(const Image& a, const Image& b, const stereo::FoveatedEye& parts) {
  for (unsigned y = parts.inset_begin.y; y < parts.inset_end.y; ++y) {
    for (unsigned x = parts.inset_begin.x; x < parts.inset_end.x; ++x) {
      for (int c = 0; c < a.channels; ++c) {
        if (a.at(int(x), int(y), c) != b.at(int(x), int(y), c)) return false;
      }
    }
  }
  return true;
}

/// Along the eye's axis, which meets the picture at its principal point; of a lens whose middle lies
/// elsewhere the angles beside it are a little off.
measure::Gaze gaze_of(const shared::View& eye) {
  return {eye.lens[2], eye.lens[3], glm::degrees(2.0 * std::atan(0.5 * eye.width / eye.lens[0]))};
}

/// Of pictures of one size, one number each by pixel.
SeenNumbers pooled(const std::vector<measure::FoveatedComparison>& found) {
  SeenNumbers seen{.visible = 0.0};
  const auto pictures = static_cast<double>(found.size());
  std::map<double, RingNumbers> rings;
  for (const measure::FoveatedComparison& picture : found) {
    seen.visible += picture.visible / pictures;
    for (const measure::Ring& ring : picture.rings) {
      RingNumbers& of_all =
          rings.try_emplace(ring.from, RingNumbers{.psnr_db = 0.0, .visible = 0.0}).first->second;
      of_all.from_degrees = ring.from;
      of_all.to_degrees = ring.to;
      of_all.share += ring.share / pictures;
      of_all.psnr_db += ring.share / pictures * std::pow(10.0, -0.1 * ring.psnr);  // squared errors, for now
      of_all.visible += ring.share / pictures * ring.visible;
    }
  }
  for (auto& [from, ring] : rings) {
    ring.psnr_db = -10.0 * std::log10(ring.psnr_db / ring.share);
    ring.visible /= ring.share;
    seen.rings.push_back(ring);
  }
  return seen;
}

double mean_signed(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.data.size(); ++k) sum += double(a.data[k]) - double(b.data[k]);
  return sum / static_cast<double>(a.data.size());
}

/// Draws until the GPU's clock has settled. Returns whether it did in time; a software renderer's always has.
bool warm_up(BenchDrawer& drawer, const BenchView& view, bool software) {
  const auto start = Clock::now();
  int drawn = 0;
  const auto goes_on = [&] {
    return drawn < render::settling_frames || (!software && ms_since(start) < warm_up_ms);
  };
  double last = 0.0;
  while (goes_on()) {
    std::vector<double> times;
    for (; times.size() < window && goes_on(); ++drawn) times.push_back(drawer.draw(view.eyes).total_ms);
    const double now = quantile(times, 0.5);
    if (times.size() == window && std::abs(now - last) <= agreement * now) return true;
    last = now;
  }
  return software;
}

double value(double number) { return number; }
double value(std::uint64_t number) { return static_cast<double>(number); }
double value(const std::optional<double>& number) { return number.value_or(NAN); }

/// Mean of a number over the views; not finite where one has none.
template <typename T>
double mean_of(const std::vector<ViewNumbers>& views, T ViewNumbers::*number) {
  double sum = 0.0;
  for (const ViewNumbers& view : views) sum += value(view.*number);
  return sum / static_cast<double>(views.size());
}

/// Mean over the pixels of all eyes.
double mean_of(const std::vector<Image>& images) {
  double sum = 0.0, pixels = 0.0;
  for (const Image& image : images) {
    for (const float value : image.data) sum += static_cast<double>(value);
    pixels += static_cast<double>(image.data.size());
  }
  return sum / pixels;
}

/// Adds what a frame, one of `frames`, had to do.
void add_work(const render::Frame& frame, const render::FrameReport& report, std::size_t frames,
              FrameWork& work) {
  const double weight = 1.0 / static_cast<double>(frames);
  const double views_of_group = static_cast<double>(frame.views().size()) / report.order_groups;
  work.in_view += weight * static_cast<double>(report.visible);
  work.splats += weight * static_cast<double>(report.visible) * views_of_group;
  work.pairs += weight * static_cast<double>(report.pairs);
  work.supertile_pairs += weight * static_cast<double>(report.supertile_pairs);
  for (const shared::View& view : frame.views()) {
    work.tiles += weight * view.tiles_x * view.tiles_y;
    work.pixels += weight * view.width * view.height;
  }
}

ExactNumbers summary_of_quality(const std::vector<ViewNumbers>& views) {
  const ViewNumbers& poorest =
      *std::min_element(views.begin(), views.end(), [](const ViewNumbers& a, const ViewNumbers& b) {
        return (std::isfinite(a.psnr_db) ? a.psnr_db : INFINITY) <
               (std::isfinite(b.psnr_db) ? b.psnr_db : INFINITY);
      });
  return {mean_of(views, &ViewNumbers::psnr_db),
          poorest.psnr_db,
          poorest.name,
          mean_of(views, &ViewNumbers::ssim),
          mean_of(views, &ViewNumbers::flip),
          mean_of(views, &ViewNumbers::signed_mean),
          mean_of(views, &ViewNumbers::disagreement_db)};
}

}  // namespace

Bench::Bench(gl::Context& context, const Model& model, std::vector<BenchView> views,
             const shared::View& small, const BenchEffort& effort)
    : model_(model),
      gpu_model_(std::make_shared<render::GpuModel>(context, model)),
      views_(std::move(views)),
      small_(small),
      effort_(effort) {}

const std::vector<Bench::Exact>& Bench::exact() {
  if (!exact_.empty()) return exact_;
  render::Frame frame(gpu_model_);
  for (const BenchView& view : views_) {
    frame.draw(view.eyes);
    Exact& one = exact_.emplace_back();
    one.pictures = frame.read_pictures();
    for (const Picture& picture : one.pictures) one.eyes.push_back(composite(picture, black));
    if (one.pictures.size() < 2) one.pictures.clear();
    if (view.photo) one.photo_psnr = measure::photo_psnr(one.eyes.front(), view.exposure, *view.photo);
  }
  return exact_;
}

const DepthTable& Bench::depth_table() {
  if (!depth_table_.bounds.empty()) return depth_table_;
  std::vector<shared::View> views;
  for (const BenchView& view : views_) views.push_back(view.eyes.front());
  render::Frame frame(gpu_model_);
  depth_table_ = measure::measure_depth_table(frame, views, {.far = effort_.far});
  return depth_table_;
}

double Bench::work_ms(const BenchSettings& settings, std::size_t points) {
  BenchDrawer drawer(gpu_model_, settings);
  double ms = 0.0;
  for (int n = 0; n < 2; ++n) {  // in the first one drivers compile their programs
    const auto start = Clock::now();
    drawer.draw(views_.front().eyes);
    ms = ms_since(start);
  }
  const int frames = effort_.repeats * (effort_.frames + render::settling_frames) + render::settling_frames;
  return ms * frames * static_cast<double>(views_.size() * points);
}

// What a threshold by measurements draws has no reference; that the frame's other stages are right is seen
// with all others.
std::string Bench::verify(const BenchSettings& settings) {
  render::Frame frame(gpu_model_);
  if (settings.transmittance == TRANSMITTANCE_ONE) {
    frame.draw(std::span(&small_, 1), settings);
    const Image drawn = composite(frame.read_pictures().front(), black);
    const auto judge = [&](const reference::Settings& by) {
      return composite(reference::render(model_, small_, by), black);
    };
    const Image judged = judge({settings.tiles, settings.tile_size, settings.th, settings.tolerance, {}});
    const double db = measure::psnr(drawn, judged);
    double needed = reference_db;
    if (!(db >= needed) && !render::is_exact(settings.th))
      needed = std::min(needed, measure::psnr(judged, judge({})) + share_db);
    if (!(db >= needed))
      return fmt::format("{} x {} px differ from the float64 reference: {:.1f} dB, expected {:.1f} or more",
                         small_.width, small_.height, db, needed);
  }
  const BenchView& view = views_.front();
  BenchDrawer drawer(gpu_model_, settings);
  drawer.draw(view.eyes);
  const std::vector<Picture> pictures = drawer.read_pictures();
  for (const Picture& picture : pictures) {
    if (!is_finite(picture)) return view.name + ": a pixel is not a finite number";
    if (is_empty(picture)) return view.name + ": the picture is empty";
  }
  BenchSettings of_inset = settings;
  of_inset.foveation.reset();
  of_inset.th = TH_TAU;
  for (std::size_t eye = 0; settings.foveation && is_exact(of_inset) && eye < pictures.size(); ++eye) {
    const stereo::FoveatedEye& parts = drawer.foveated().parts()[eye];
    if (!same_inset(composite(pictures[eye], black), exact().front().eyes[eye], parts))
      return view.name + ": the inset is not the exact picture's";
  }
  if (settings.transmittance != TRANSMITTANCE_ONE) return "";
  drawer.draw(view.eyes);
  return same_bits(drawer.read_pictures(), pictures) ? "" : view.name + ": two frames differ";
}

ViewNumbers Bench::compare(const BenchView& view, const Exact& exact,
                           const std::vector<Picture>& drawn) const {
  ViewNumbers v{view.name, 0.0, 0.0, 0.0, 0.0};
  const auto eyes = static_cast<double>(drawn.size());
  for (std::size_t eye = 0; eye < drawn.size(); ++eye) {
    const Image image = composite(drawn[eye], black);
    v.psnr_db += measure::psnr(image, exact.eyes[eye]) / eyes;
    v.ssim += measure::ssim(image, exact.eyes[eye]) / eyes;
    v.flip += measure::flip(image, exact.eyes[eye], effort_.ppd) / eyes;
    v.signed_mean += mean_signed(image, exact.eyes[eye]) / eyes;
  }
  if (!exact.pictures.empty()) {
    const std::array<shared::View, 2> eyes_of_view = {view.eyes[0], view.eyes[1]};
    v.disagreement_db = stereo::disagreement(eyes_of_view, exact.pictures, drawn).db;
  }
  if (view.photo) {
    const Image image = exposed(composite(drawn.front(), black), view.exposure);
    v.photo_psnr_db = measure::psnr(quantised(image), quantised(*view.photo));
    v.drop_db = *exact.photo_psnr - *v.photo_psnr_db;
    v.photo_ssim = measure::ssim(quantised(image), quantised(*view.photo));
    v.photo_flip = measure::flip(image, *view.photo, effort_.ppd);
  }
  return v;
}

void Bench::time(const BenchSettings& settings, BenchNumbers& point) {
  BenchDrawer drawer(gpu_model_, settings);
  std::vector<Timed> all;
  bool settled = true;
  render::FrameReport last;
  for (const BenchView& view : views_) {
    const auto begin = [&](int repeat) {
      if (repeat == 0) settled = warm_up(drawer, view, gpu_model_->context().software()) && settled;
      for (int n = 0; repeat > 0 && n < render::settling_frames; ++n) drawer.draw(view.eyes);
    };
    all.push_back({effort_.frames, begin, [&](int) { return last = drawer.draw(view.eyes); }});
  }
  const auto rounds = timed_rounds(gpu_model_->context(), effort_.repeats, all, [] {});
  std::vector<double> repeats, frame_ms, submit_ms;  // repeats: means over the views
  std::vector<Typical> turns;
  for (std::size_t repeat = 0; repeat < rounds.front().size(); ++repeat) {
    std::vector<Typical> of_views;
    for (const auto& of_view : rounds) {
      of_views.push_back(typical_of(of_view[repeat]));
      for (const render::FrameReport& report : of_view[repeat]) {
        frame_ms.push_back(report.total_ms);
        submit_ms.push_back(report.cpu.submit);
      }
    }
    repeats.push_back(mean_of(of_views).frame_ms);
    turns.insert(turns.end(), of_views.begin(), of_views.end());
  }
  const auto [least, most] = std::minmax_element(repeats.begin(), repeats.end());
  point.frame_ms = mean(repeats);
  point.p99_ms = quantile(frame_ms, 0.99);
  point.repeats_ms = repeats;
  if (effort_.repeats > 1) point.noise_ms = (*most - *least) / 2;
  point.settled = settled;
  point.frames = frame_ms.size();
  point.gpu_bytes = last.gpu_bytes;
  point.submit_ms = quantile(submit_ms, 0.5);
  point.stages = mean_of(turns).stages;
}

void Bench::judge(const BenchSettings& settings, BenchNumbers& point) {
  BenchDrawer drawer(gpu_model_, settings);
  std::vector<ViewNumbers> photographed;
  std::vector<measure::FoveatedComparison> seen;
  FrameWork work{.precision = settings.precision};
  for (std::size_t v = 0; v < views_.size(); ++v) {
    render::FrameReport report;
    for (int n = 0; n < render::settling_frames; ++n) report = drawer.draw(views_[v].eyes);
    const std::vector<Picture> drawn = drawer.read_pictures();
    ViewNumbers& view = point.views.emplace_back(compare(views_[v], exact()[v], drawn));
    for (std::size_t eye = 0; effort_.seen && eye < drawn.size(); ++eye) {
      seen.push_back(measure::compare_foveated(composite(drawn[eye], black), exact()[v].eyes[eye],
                                               gaze_of(views_[v].eyes[eye])));
    }
    view.pairs = report.pairs;
    view.visible = report.visible;
    if (v == 0) point.picture = for_page(composite(drawn.front(), black));
    if (!settings.foveation) {  // whose pixels are of two pictures
      add_work(drawer.frame(), report, views_.size(), work);
      view.alphas = mean_of(drawer.frame().read_debug_view(SHOW_ALPHAS));
      view.alphas_visible = mean_of(drawer.frame().read_debug_view(SHOW_VISIBLE));
    }
    if (views_[v].photo) photographed.push_back(view);
  }
  point.pairs = mean_of(point.views, &ViewNumbers::pairs);
  point.visible = mean_of(point.views, &ViewNumbers::visible);
  point.alphas = mean_of(point.views, &ViewNumbers::alphas);
  point.alphas_visible = mean_of(point.views, &ViewNumbers::alphas_visible);
  if (!seen.empty()) point.seen = pooled(seen);
  if (effort_.peaks && !settings.foveation) {
    work.gaussians = static_cast<double>(model_.count());
    work.degree = model_.degree;
    work.alphas = point.alphas * work.pixels;
    work.stages = point.stages;
    point.profile = profile(work, *effort_.peaks);
  }
  point.exact = summary_of_quality(point.views);
  if (!photographed.empty()) {
    point.photos = {photographed.size(), mean_of(photographed, &ViewNumbers::photo_psnr_db),
                    mean_of(photographed, &ViewNumbers::drop_db),
                    mean_of(photographed, &ViewNumbers::photo_ssim),
                    mean_of(photographed, &ViewNumbers::photo_flip)};
  }
}

BenchNumbers Bench::measure(BenchSettings settings) {
  if (settings.transmittance == TRANSMITTANCE_DEPTH) settings.depth_table = depth_table();
  BenchNumbers point{.device = device_text(gpu_model_->context()), .problem = verify(settings)};
  if (!point.problem.empty()) return point;
  time(settings, point);
  judge(settings, point);
  return point;
}

std::vector<std::size_t> spread_evenly(std::size_t all, std::size_t count) {
  std::vector<std::size_t> chosen;
  count = std::min(all, count);
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(count == 1 ? 0 : (i * (all - 1) + (count - 1) / 2) / (count - 1));
  return chosen;
}

}  // namespace binosplat::lab
