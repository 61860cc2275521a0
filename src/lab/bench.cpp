#include "lab/bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "adagscale/contributions.h"
#include "adagscale/depth_table.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/statistics.h"
#include "lab/bench_drawer.h"
#include "lab/times.h"
#include "measure/comparison.h"
#include "measure/foveated.h"
#include "reference/render.h"
#include "render/frame.h"
#include "scene/axes.h"
#include "stereo/disagreement.h"

namespace binosplat::lab {

namespace {

// The least PSNR against the float64 reference. If it is lower, the driver draws wrongly.
constexpr double reference_db = 60.0;
// fp32 and float64 may differ in which pairs close to a threshold they drop, and searched tolerances often
// end there. Such pairs may cause at most half (3 dB) of the squared error that the tolerance causes.
constexpr double share_db = 3.0;

const glm::vec3 black(0.0f);

// Few, because the float64 analysis of contributions takes seconds per view.
constexpr std::size_t contribution_views = 3;
constexpr float paper_far = 100.0f;  // world units: end of AdaGScale's table by depth

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

/// The gaze along the eye's axis. If the principal point is off the middle, angles are slightly wrong.
measure::Gaze gaze_of(const shared::View& eye) {
  return {eye.lens[2], eye.lens[3], glm::degrees(2.0 * std::atan(0.5 * eye.width / eye.lens[0]))};
}

/// Returns the % of pixels with a visible difference, mean over pictures of one size. Appends a detail for
/// each ring around the gaze, with means over the ring's pixels in all pictures.
double pooled(const std::vector<measure::FoveatedComparison>& found, std::vector<Row>& details) {
  struct OfRing {
    double to = 0.0, share = 0.0, squared_error = 0.0, visible = 0.0;
  };
  std::map<double, OfRing> rings;
  double visible = 0.0;
  const auto pictures = static_cast<double>(found.size());
  for (const measure::FoveatedComparison& picture : found) {
    visible += picture.visible / pictures;
    for (const measure::Ring& ring : picture.rings) {
      OfRing& of_all = rings[ring.from];
      of_all.to = ring.to;
      of_all.share += ring.share / pictures;
      of_all.squared_error += ring.share / pictures * std::pow(10.0, -0.1 * ring.psnr);
      of_all.visible += ring.share / pictures * ring.visible;
    }
  }
  for (const auto& [from, ring] : rings) {
    details.push_back(object("kind", "ring", "from", from, "to", ring.to, "area", 100.0 * ring.share,
                             "psnr_db", capped(-10.0 * std::log10(ring.squared_error / ring.share)), "seen",
                             100.0 * ring.visible / ring.share));
  }
  return 100.0 * visible;
}

double mean_signed(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.data.size(); ++k) sum += double(a.data[k]) - double(b.data[k]);
  return sum / static_cast<double>(a.data.size());
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

/// Stores the means of all numbers of the views.
void put_means(const std::vector<Row>& views, Row& row) {
  for (const std::string& name : columns_of(views)) put(row, name, mean_number(views, name));
  const auto psnr = [](const Row& view) {
    const double db = number(view, "psnr_db");
    return std::isnan(db) ? INFINITY : db;
  };
  const Row& worst = *std::ranges::min_element(views, {}, psnr);
  if (!worst.contains("psnr_db")) return;
  put(row, "worst_psnr_db", number(worst, "psnr_db"), "worst_view", text(worst, "view"));
  const auto photos = std::ranges::count_if(views, [](const Row& v) { return v.contains("photo_psnr_db"); });
  if (photos > 0) put(row, "photo_views", photos);
}

}  // namespace

const std::vector<shared::View>& BenchCase::first() const {
  return views.empty() ? stretches.front().frames.front() : views.front().eyes;
}

Bench::Bench(gl::Context& context, std::function<const Model&()> load, BenchCase what,
             const BenchEffort& effort)
    : context_(context), clock_(context), load_(std::move(load)), what_(std::move(what)), effort_(effort) {}

Bench::~Bench() = default;

const std::shared_ptr<render::GpuModel>& Bench::gpu_model() {
  if (!gpu_model_) gpu_model_ = std::make_shared<render::GpuModel>(context_, load_());
  return gpu_model_;
}

bool Bench::has_finest(Row& row) {
  if (no_finest_.empty()) {
    try {
      gpu_model();
    } catch (const Error& error) {
      if (!what_.follow || error.code() != ExitCode::out_of_memory) throw;
      no_finest_ = error.what();
    } catch (const std::bad_alloc&) {
      if (!what_.follow) throw;
      no_finest_ = "out of memory";
    }
  }
  if (!no_finest_.empty()) put(row, "no_exact", "the finest levels cannot be drawn: " + no_finest_);
  return no_finest_.empty();
}

BenchDrawer Bench::drawer(const BenchSettings& settings) {
  if (settings.detail) return {what_.follow(*settings.detail), settings};
  return {{gpu_model(), {}}, settings};
}

const std::vector<Bench::Exact>& Bench::exact(const BenchSettings& settings) {
  std::vector<Exact>& all = exact_[order_and_projection(settings)];
  if (!all.empty()) return all;
  render::Frame frame(gpu_model());
  for (const BenchView& view : what_.views) {
    Exact& one = all.emplace_back();
    one.pairs = static_cast<double>(frame.draw(view.eyes, render::exact_of(settings)).pairs);
    one.pictures = frame.read_pictures();
    for (const Picture& picture : one.pictures) one.eyes.push_back(composite(picture, black));
    if (one.pictures.size() < 2) one.pictures.clear();
    if (view.photo) one.photo_psnr = measure::photo_psnr(one.eyes.front(), view.exposure, *view.photo);
  }
  return all;
}

const DepthTable& Bench::depth_table(const std::optional<float>& far, const OrderAndProjection& perspective) {
  DepthTable& table = tables_[{far, perspective}];
  if (!table.bounds.empty()) return table;
  std::vector<shared::View> all, views;
  for (const adagscale::CalibrationView& view : what_.training)
    all.push_back(make_view(into_axes(view.camera, load_().axes), what_.near_plane));
  if (all.empty()) {
    for (const BenchView& view : what_.views) all.push_back(view.eyes.front());
    for (const Stretch& stretch : what_.stretches) {
      for (const auto* of : {&stretch.frames.front(), &stretch.frames.back()})
        all.insert(all.end(), of->begin(), of->end());
    }
  }
  for (const std::size_t k : spread_evenly(all.size(), adagscale::default_views)) views.push_back(all[k]);
  render::Frame frame(gpu_model());
  const render::FrameSettings of_frame{{.order = perspective.first, .projection = perspective.second}};
  return table = adagscale::measure_depth_table(frame, views, {.far = far, .frame = of_frame});
}

adagscale::Calibrator& Bench::calibrator(bool training, bool drop, const BenchSettings& settings) {
  std::unique_ptr<adagscale::Calibrator>& found =
      calibrators_[{training, drop, order_and_projection(settings)}];
  using Kind = adagscale::CalibrationTarget::Kind;
  if (!found)
    found = std::make_unique<adagscale::Calibrator>(
        gpu_model(), training ? what_.training : what_.tested, what_.near_plane,
        drop ? Kind::drop : Kind::quality,
        render::FrameSettings{{.order = settings.order, .projection = settings.projection}});
  return *found;
}

void Bench::find_tolerance(BenchSettings& settings, Row& row) {
  const render::FrameSettings& whole = settings;
  const adagscale::CalibrationEntry found =
      calibrator(settings.found_on_training, settings.max_drop.has_value(), settings)
          .find(whole, settings.max_drop ? *settings.max_drop : *settings.min_psnr);
  settings.tolerance = static_cast<float>(found.tolerance);
  put(row, "found_tolerance", found.tolerance, "found_db", found.reached_db);
}

double Bench::work_ms(const BenchSettings& settings, std::size_t points) {
  Row ignored;
  if (!settings.detail && !has_finest(ignored)) return 0.0;
  BenchSettings first = settings;
  if (first.transmittance == Transmittance::depth) first.transmittance = Transmittance::one;
  BenchDrawer drawer = this->drawer(first);
  double ms = 0.0;
  for (int n = 0; n < 2; ++n) {  // the first frame does not count: drivers compile programs in it
    const auto start = Clock::now();
    drawer.draw(what_.first());
    ms = ms_since(start);
  }
  double frames = 0.0;
  for (const Stretch& stretch : what_.stretches)
    frames += static_cast<double>(stretch.frames.size()) * (effort_.repeats + 1);
  if (what_.stretches.empty())
    frames = static_cast<double>(what_.views.size()) *
             (effort_.repeats * (effort_.frames + render::settling_frames) + render::settling_frames);
  return ms * frames * static_cast<double>(points);
}

// Compares a small picture with the float64 reference. Skips it for settings that use measurements, levels
// of detail, or another order or projection, because other points verify their stages, and for inexact
// settings with own shaders. Then checks the first view: pixels are finite, an exact inset equals the exact
// picture, and frames repeat bit for bit.
std::string Bench::verify(const BenchSettings& settings) {
  const bool by_reference = render::chosen_transmittance(settings) == Transmittance::one &&
                            !settings.quality && !settings.detail && !settings.order &&
                            !settings.projection && (is_exact(settings) || !effort_.own_shaders);
  if (by_reference) {
    render::Frame frame(gpu_model());
    frame.draw(std::span(&what_.small, 1), settings);
    const Image drawn = composite(frame.read_pictures().front(), black);
    const auto reference_picture = [&](const reference::Settings& by) {
      return composite(reference::render(load_(), what_.small, by), black);
    };
    const Threshold threshold = render::chosen_threshold(settings);
    const Image expected =
        reference_picture({settings.tiles, threshold, settings.tolerance.value_or(0.0f), {}});
    const double db = measure::psnr(drawn, expected);
    double needed = reference_db;
    if (!(db >= needed) && !render::is_exact(threshold))
      needed = std::min(needed, measure::psnr(expected, reference_picture({})) + share_db);
    if (!(db >= needed))
      return fmt::format("{} x {} px differ from the float64 reference: {:.1f} dB, expected {:.1f} or more",
                         what_.small.width, what_.small.height, db, needed);
  }
  if (what_.views.empty()) return "";
  const BenchView& view = what_.views.front();
  BenchDrawer drawer = this->drawer(settings);
  drawer.load_levels(view.eyes);
  drawer.draw(view.eyes);
  const std::vector<Picture> pictures = drawer.read_pictures();
  for (const Picture& picture : pictures) {
    if (!is_finite(picture)) return view.name + ": a pixel is not a finite number";
    if (is_empty(picture)) return view.name + ": the picture is empty";
  }
  BenchSettings of_inset = settings;
  of_inset.foveation.reset();
  of_inset.threshold = Threshold::exact;
  for (std::size_t eye = 0; settings.foveation && is_exact(of_inset) && eye < pictures.size(); ++eye) {
    const stereo::FoveatedEye& parts = drawer.parts()[eye];
    if (!same_inset(composite(pictures[eye], black), exact(settings).front().eyes[eye], parts))
      return view.name + ": the inset differs from the exact picture";
  }
  if (render::chosen_transmittance(settings) != Transmittance::one || settings.quality) return "";
  drawer.draw(view.eyes);
  return same_bits(drawer.read_pictures(), pictures) ? "" : view.name + ": two frames differ";
}

Row Bench::compare(const BenchView& view, const Exact& exact, const std::vector<Picture>& drawn) const {
  std::vector<double> psnr;
  double ssim = 0.0, flip = 0.0, signed_error = 0.0;
  const auto eyes = static_cast<double>(drawn.size());
  for (std::size_t eye = 0; eye < drawn.size(); ++eye) {
    const Image image = composite(drawn[eye], black);
    psnr.push_back(measure::psnr(image, exact.eyes[eye]));
    ssim += measure::ssim(image, exact.eyes[eye]) / eyes;
    flip += measure::flip(image, exact.eyes[eye], effort_.ppd) / eyes;
    signed_error += mean_signed(image, exact.eyes[eye]) / eyes;
  }
  Row row = object("psnr_db", pooled_db(psnr), "ssim", ssim, "flip", flip, "signed_error", signed_error);
  if (!exact.pictures.empty()) {
    const std::array<shared::View, 2> both = {view.eyes[0], view.eyes[1]};
    const stereo::Disagreement found = stereo::disagreement(both, exact.pictures, drawn);
    put(row, "disagreement_db", capped(found.db));
    std::vector<double> errors;
    std::ranges::copy_if(found.disparity.data, std::back_inserter(errors),
                         [](float px) { return px >= 0.0f; });
    if (!errors.empty())
      put(row, "disparity_median_px", quantile(errors, 0.5), "disparity_p99_px", quantile(errors, 0.99));
  }
  if (view.photo) {
    const Image image = exposed(composite(drawn.front(), black), view.exposure);
    const double db = measure::psnr(quantised(image), quantised(*view.photo));
    const auto finite = [](double number) { return std::isfinite(number) ? number : NAN; };  // unless equal
    put(row, "photo_psnr_db", finite(db), "drop_db", finite(*exact.photo_psnr - db), "photo_ssim",
        measure::ssim(quantised(image), quantised(*view.photo)), "photo_flip",
        measure::flip(image, *view.photo, effort_.ppd));
  }
  return row;
}

void Bench::time_views(BenchDrawer& drawer, Row& row) {
  const bool software = context_.software(), follows = drawer.follows();
  bool full_clock = true;
  Report last;
  std::vector<double> repeats, all_ms, submit_ms;  // repeats: means over the views
  std::vector<CpuUse> cpu_repeats;
  std::vector<Typical> turns;
  for (int repeat = 0; repeat < effort_.repeats; ++repeat) {
    std::vector<Typical> of_views;
    CpuUse cpu;
    double drawn = 0.0;
    for (const BenchView& view : what_.views) {
      drawer.load_levels(view.eyes);
      // A GPU's clock drops while pictures are compared or levels are read.
      if (repeat == 0 && &view == &what_.views.front())
        gl::raise_clock(context_, 1000.0, [&] { drawer.draw(view.eyes); });
      if (follows) gl::raise_clock(context_, 300.0, [&] { drawer.draw(view.eyes); });
      for (int n = 0; n < render::settling_frames; ++n) drawer.draw(view.eyes);
      Reports frames;
      CpuUse used;
      const auto time_frames = [&] {
        frames.clear();
        const CpuUse before = CpuUse::now(context_);
        for (int n = 0; n < effort_.frames; ++n) frames.push_back(last = drawer.draw(view.eyes));
        used = CpuUse::now(context_).since(before);
      };
      full_clock = clock_.measure(time_frames) && full_clock;
      cpu += used;
      drawn += static_cast<double>(frames.size());
      of_views.push_back(typical_of(frames));
      for (const Report& report : frames) {
        all_ms.push_back(report.gpu_ms);
        submit_ms.push_back(report.submit_ms);
      }
    }
    repeats.push_back(mean_of(of_views).frame_ms);
    if (software) cpu_repeats.push_back({cpu.used / drawn, cpu.waited / drawn});
    turns.insert(turns.end(), of_views.begin(), of_views.end());
  }
  put_clock(full_clock, row);
  put(row, "gpu_bytes", last.gpu_bytes, "submit_ms", quantile(submit_ms, 0.5));
  put_times(repeats, all_ms, row);
  put_cpu_times(cpu_repeats, row);
  put_stages(mean_of(turns).stages, row);
}

void Bench::measure_views(const BenchSettings& settings, BenchDrawer& drawer, Point& point) {
  std::vector<Row> views;
  std::vector<measure::FoveatedComparison> seen;
  const bool finest = has_finest(point.row);
  for (std::size_t v = 0; v < what_.views.size(); ++v) {
    const BenchView& view = what_.views[v];
    const LoadedLevels levels = drawer.load_levels(view.eyes);
    Report report;
    // So that measurements of earlier frames, whose number depends on time, do not count.
    drawer.frame().start_over();
    for (int n = 0; n < render::settling_frames; ++n) report = drawer.draw(view.eyes);
    const std::vector<Picture> drawn = drawer.read_pictures();
    Row& row = views.emplace_back(object("kind", "view", "view", view.name));
    if (finest) {
      const Exact& exact = this->exact(settings)[v];
      row.update(compare(view, exact, drawn));
      put(row, "pairs_removed", 100.0 * (1.0 - static_cast<double>(report.pairs) / exact.pairs));
      for (std::size_t eye = 0; effort_.seen && eye < drawn.size(); ++eye)
        seen.push_back(measure::compare_foveated(composite(drawn[eye], black), exact.eyes[eye],
                                                 gaze_of(view.eyes[eye])));
    }
    put(row, "pairs", report.pairs, "visible", report.visible, "gaussians", levels.gaussians, "reported_db",
        levels.predicted_db);
    if (settings.quality) put(row, "reported_db", capped(report.quality));
    if (v == 0) point.picture = for_page(composite(drawn.front(), black));
    if (settings.foveation) continue;  // pixels of inset and context are not comparable
    put(row, "alphas", mean_of(drawer.frame().read_debug_view(SHOW_ALPHAS)), "alphas_visible",
        mean_of(drawer.frame().read_debug_view(SHOW_VISIBLE)));
  }
  put_means(views, point.row);
  point.details = std::move(views);
  if (!seen.empty()) put(point.row, "seen", pooled(seen, point.details));
}

// Measures only PSNR and drops, from sums on the GPU. Reads back only the first picture.
void Bench::measure_by_sums(const BenchSettings& settings, BenchDrawer& drawer, Point& point) {
  const adagscale::Calibrator::Cost cost = calibrator(false, false, settings).cost(settings);
  std::vector<Row> views;
  for (std::size_t v = 0; v < what_.views.size(); ++v)
    views.push_back(object("kind", "view", "view", what_.views[v].name, "psnr_db", cost.view_db[v]));
  if (what_.tested.front().photo) {
    adagscale::Calibrator& photos = calibrator(false, true, settings);
    const adagscale::Calibrator::Cost lost = photos.cost(settings);
    for (std::size_t v = 0; v < views.size(); ++v) put(views[v], "drop_db", lost.view_db[v]);
    put(point.row, "photo_psnr_db", photos.exact_photo_db() - lost.mean_db, "photo_views", views.size());
  }
  put_means(views, point.row);
  put(point.row, "pairs", cost.pairs, "pairs_removed", 100.0 * cost.pairs_removed, "gaussians",
      load_().count());
  point.details = std::move(views);
  for (int n = 0; n < render::settling_frames; ++n) drawer.draw(what_.views.front().eyes);
  point.picture = for_page(composite(drawer.read_pictures().front(), black));
}

Point Bench::measure(BenchSettings settings) {
  Point point{object("device", device_text(context_))};
  if (!settings.detail && !has_finest(point.row)) return point;
  if (settings.transmittance == Transmittance::depth)
    settings.depth_table = depth_table(settings.far, order_and_projection(settings));
  if (settings.finds_tolerance()) find_tolerance(settings, point.row);
  if (const std::string problem = verify(settings); !problem.empty()) {
    put(point.row, "problem", problem);
    return point;
  }
  if (!what_.stretches.empty()) settings.has_depths = false;
  BenchDrawer drawer = this->drawer(settings);
  if (!what_.stretches.empty()) {
    measure_frames(settings, drawer, point);
  } else {
    time_views(drawer, point.row);
    if (effort_.perception || what_.tested.empty() || settings.foveation || settings.detail)
      measure_views(settings, drawer, point);
    else
      measure_by_sums(settings, drawer, point);
  }
  return point;
}

Point Bench::contributions() {
  std::vector<adagscale::CalibrationView> some;
  for (const std::size_t v : spread_evenly(what_.tested.size(), contribution_views))
    some.push_back(what_.tested[v]);
  return {object("device", device_text(context_)),
          adagscale::contributions(load_(), some, what_.near_plane, depth_table(paper_far, {}),
                                   depth_table({}, {}))};
}

}  // namespace binosplat::lab
