// The points of bench as JSON, with the keys in the order of its files, and as CSV.

#include <algorithm>
#include <utility>

#include "lab/bench_results.h"
#include "lab/csv.h"
#include "lab/fields.h"

namespace binosplat::lab {

using nlohmann::ordered_json;

static void fields(const auto& io, Some<StageFloor> auto& f) {
  io("stage", f.stage, "ms", f.ms, "bytes", f.bytes, "operations", f.operations, "floor_ms", f.floor_ms,
     "share", f.share);
}

static void fields(const auto& io, Some<ViewNumbers> auto& v) {
  io("name", v.name, "psnr_db", v.psnr_db, "ssim", v.ssim, "flip", v.flip, "signed", v.signed_mean,
     "disagreement_db", v.disagreement_db, "photo_psnr_db", v.photo_psnr_db, "drop_db", v.drop_db,
     "photo_ssim", v.photo_ssim, "photo_flip", v.photo_flip, "pairs", v.pairs, "visible", v.visible, "alphas",
     v.alphas, "alphas_visible", v.alphas_visible);
}

static void fields(const auto& io, Some<ExactNumbers> auto& e) {
  io("psnr_db", e.psnr_db, "worst_psnr_db", e.worst_psnr_db, "worst_view", e.worst_view, "ssim", e.ssim,
     "flip", e.flip, "signed", e.signed_mean, "disagreement_db", e.disagreement_db);
}

static void fields(const auto& io, Some<RingNumbers> auto& r) {
  io("from_degrees", r.from_degrees, "to_degrees", r.to_degrees, "share", r.share, "psnr_db", r.psnr_db,
     "visible", r.visible);
}

static void fields(const auto& io, Some<SeenNumbers> auto& s) { io("visible", s.visible, "rings", s.rings); }

static void fields(const auto& io, Some<PhotoNumbers> auto& p) {
  io("views", p.views, "psnr_db", p.psnr_db, "drop_db", p.drop_db, "ssim", p.ssim, "flip", p.flip);
}

namespace {

void numbers_fields(const auto& io, Some<BenchNumbers> auto& n) {
  io("frame_ms", n.frame_ms, "p99_ms", n.p99_ms, "noise_ms", n.noise_ms, "repeats_ms", n.repeats_ms,
     "settled", n.settled, "frames", n.frames, "gpu_bytes", n.gpu_bytes, "submit_ms", n.submit_ms,
     "stages_ms", n.stages, "pairs", n.pairs, "visible", n.visible, "alphas", n.alphas, "alphas_visible",
     n.alphas_visible, "profile", n.profile, "exact", n.exact, "seen", n.seen, "photos", n.photos, "views",
     n.views);
}

void names(const auto& io, Some<BenchPoint> auto& p) {
  io("scene", p.scene, "eyes", p.eyes, "size", p.size, "name", p.name, "family", p.family, "settings",
     p.settings);
}

}  // namespace

void to_json(ordered_json& json, const BenchNumbers& n) {
  if (n.device.empty()) return;
  json["device"] = n.device;
  if (n.measured()) {
    numbers_fields(FieldWriter{json}, n);
  } else {
    json["problem"] = n.problem;
  }
}

void from_json(const ordered_json& json, BenchNumbers& n) {
  FieldReader{json}("device", n.device, "problem", n.problem);
  numbers_fields(FieldReader{json}, n);
}

void to_json(ordered_json& json, const BenchPoint& point) {
  names(FieldWriter{json}, point);
  to_json(json, static_cast<const BenchNumbers&>(point));
}

void from_json(const ordered_json& json, BenchPoint& point) {
  names(FieldReader{json}, point);
  from_json(json, static_cast<BenchNumbers&>(point));
}

namespace {

double stage_ms(const BenchPoint& p, const char* name) {
  const auto found = std::find_if(p.stages.begin(), p.stages.end(),
                                  [&](const gl::StageTime& stage) { return stage.name == name; });
  return found == p.stages.end() ? NAN : found->ms;
}

constexpr const char* csv_columns =
    "scene,eyes,size,name,settings_tiles,settings_tile,settings_precision,settings_th,"
    "settings_transmittance,settings_tolerance,settings_inset,settings_context,device,frame_ms,p99_ms,noise_"
    "ms,settled,submit_ms,pairs,"
    "visible,"
    "gpu_bytes,alphas,alphas_visible,exact_psnr_db,exact_worst_psnr_db,exact_ssim,exact_flip,exact_signed,"
    "exact_disagreement_db,seen_visible,photos_psnr_db,photos_drop_db,photos_ssim,photos_flip,stages_ms_"
    "project,"
    "stages_ms_bin,stages_ms_sort,stages_ms_blend,stages_ms_compose,"
    "problem,pareto\n";

std::string csv_line(const BenchPoint& p, bool pareto) {
  const NamedSettings& s = p.settings;
  const ExactNumbers& exact = p.exact;
  const PhotoNumbers photos = p.photos.value_or(PhotoNumbers{});
  const auto measured = [&](const Cell& cell) { return p.measured() ? cell : Cell(); };
  std::string line;
  for (const Cell& cell :
       row(p.scene, p.eyes, p.size, p.name, s.tiles, s.tile, s.precision, s.th, s.transmittance, s.tolerance,
           s.inset, s.context, p.device, p.frame_ms, p.p99_ms, p.noise_ms, measured(p.settled), p.submit_ms,
           p.pairs, p.visible, measured(p.gpu_bytes), p.alphas, p.alphas_visible, exact.psnr_db,
           exact.worst_psnr_db, exact.ssim, exact.flip, exact.signed_mean, exact.disagreement_db,
           p.seen.value_or(SeenNumbers{}).visible, photos.psnr_db, photos.drop_db, photos.ssim, photos.flip,
           stage_ms(p, "project"), stage_ms(p, "bin"), stage_ms(p, "sort"), stage_ms(p, "blend"),
           stage_ms(p, "compose"), p.problem))
    line += csv_field(cell) + ",";
  return line + (pareto ? "true\n" : "false\n");
}

}  // namespace

std::string csv(const std::vector<BenchPoint>& points) {
  std::string text = csv_columns;
  const std::vector<bool> front = pareto_front(points);
  for (std::size_t i = 0; i < front.size(); ++i) text += csv_line(points[i], front[i]);
  return text;
}

}  // namespace binosplat::lab
