#include "render/variants.h"

#include <bit>
#include <iterator>

#include "base/choices.h"

namespace binosplat::render {

namespace {

constexpr std::uint64_t flag = 2;  // number of values of a flag

// The files of shaders/measure/, by MEASURE_ of shared/limits.h.
constexpr const char* measure_files[] = {"none", "transmittance", "transposed", "changes", "visibility"};
static_assert(std::size(measure_files) == MEASURE_VISIBILITY + 1);

// Shaders know the settings by the numbers of shared/choices.h.
static_assert(static_cast<int>(Threshold::exact) == THRESHOLD_EXACT &&
              static_cast<int>(Threshold::adagscale) == THRESHOLD_ADAGSCALE &&
              static_cast<int>(Threshold::squared) == THRESHOLD_SQUARED);
static_assert(static_cast<int>(Transmittance::one) == TRANSMITTANCE_ONE &&
              static_cast<int>(Transmittance::depth) == TRANSMITTANCE_DEPTH &&
              static_cast<int>(Transmittance::last) == TRANSMITTANCE_LAST);
static_assert(static_cast<int>(Order::distance) == ORDER_DISTANCE);
static_assert(static_cast<int>(Projection::tangent) == PROJECTION_TANGENT);

gl::Number number(const char* name, auto value, std::uint64_t count, const char* word = nullptr) {
  return {name, static_cast<std::uint64_t>(value), count, word};
}

// The height of an invocation's column of pixels, and the number of splats whose alphas it computes at once.
struct BlendColumns {
  int height, ahead;
};

// These numbers were the fastest (README.md). In the approximate blend, blend_software.comp has blocks of
// `height` rows (docs/method.md 5.2). In the exact blend, longer columns would need more rounds of loops;
// llvmpipe allows 65,535 rounds of all loops together. blend.comp needs an `ahead` that divides BLEND_UNROLL.
BlendColumns columns_of(const BlendVariant& v) {
  if (v.debug_view) return {1, 1};
  if (v.program == BlendProgram::software) return {v.long_lists && v.approximate ? 4 : 8, 2};
  if (v.long_lists) return {1, 8};
  if (v.program == BlendProgram::general) return {2, 4};
  if (v.projection == Projection::tangent) return {2, 3};
  if (v.large_splats && v.many_splats) return {8, 2};  // a subgroup draws a whole tile
  return {v.large_splats ? 4 : 2, 4};
}

}  // namespace

gl::Number projection_number(Projection projection) {
  return number("PROJECTION", projection, std::size(projection_choices), name_of(projection));
}

gl::Number subgroups_number(const gl::Context& context) {
  return {"WITH_SUBGROUPS", context.limits().subgroups_of_32, flag};
}

gl::Number list_views_number(const FramePlan& plan) { return number("LIST_VIEWS", plan.list_views, 3); }

PairVariant::PairVariant(const FramePlan& plan)
    : tiles(plan.settings.tiles),
      threshold(*plan.settings.threshold),
      transmittance(*plan.settings.transmittance),
      probed(plan.probe.has_value()),
      regions(plan.draws_regions()),
      half(plan.settings.precision == PRECISION_HALF),
      offset_count(plan.offset_count),
      order(plan.perspective.order),
      projection(plan.perspective.projection),
      between_pixels(plan.between_pixels) {
  take(plan.models.front());
}

void PairVariant::take(const PlannedModel& model) {
  antialiased = model.antialiased;
  kernel_px2 = model.kernel_px2 == KERNEL_PX2 ? 0.0f : static_cast<float>(model.kernel_px2);
}

std::array<gl::Number, 18> PairVariant::numbers() const {
  return {number("TILES", tiles, std::size(tiles_choices), tiles_choices[tiles].name),
          number("THRESHOLD", threshold, std::size(threshold_choices), name_of(threshold)),
          number("TRANSMITTANCE", transmittance, std::size(transmittance_choices)),
          number("PROBED", probed, flag),
          number("REGIONS", regions, flag),
          number("ANTIALIASED", antialiased, flag),
          number("HALF", half, flag),
          {"OFFSETS", offset_count, 32},
          number("ORDER", order, std::size(order_choices)),
          projection_number(projection),
          number("BETWEEN", between_pixels, flag),
          number("MEASURES", measures, flag),
          number("EYES", eyes, 3),
          number("SH_DEGREE", sh_degree, 4),
          number("WITH_SUBGROUPS", subgroups, flag),
          number("LIST_VIEWS", list_views, 3),
          number("DISCS", discs, flag),
          {"KERNEL_PX2", std::bit_cast<std::uint32_t>(kernel_px2), std::uint64_t{1} << 32, nullptr, true}};
}

bool BlendVariant::is_legal() const {
  // Only the general program measures or makes debug views, because there all pixels of a tile walk through
  // its splats together. All programs measure visibility, because frames wait for it.
  const bool is_plain = draws() ? measure == MEASURE_NONE : measure == MEASURE_VISIBILITY;
  if (program != BlendProgram::general && !is_plain) return false;
  if (!draws() && (depth != DEPTH_NONE || canvases)) return false;
  const bool is_slow = program == BlendProgram::software || debug_view || discs ||
                       (program == BlendProgram::general && measure > MEASURE_TRANSMITTANCE);
  if (plain && is_slow) return false;
  if (measure > MEASURE_TRANSMITTANCE && (debug_view || approximate)) return false;
  // Visibility is measured only in exact pictures.
  if (depth == DEPTH_VISIBILITY && (canvases || mesh_depth || approximate || half || measure != MEASURE_NONE))
    return false;
  if (depth == DEPTH_MEDIAN_OF_TWO_ROWS && !canvases) return false;
  if (mesh_depth && (!draws() || measure != MEASURE_NONE)) return false;
  const bool may_be_larger = program == BlendProgram::subgroups && !long_lists && depth == DEPTH_NONE &&
                             !approximate && projection == Projection::affine;
  if (discs && (half || (depth != DEPTH_MEAN && depth != DEPTH_MEDIAN && !debug_view))) return false;
  if (many_splats && (half || mesh_depth || measure != MEASURE_NONE)) return false;
  return may_be_larger || (!large_splats && !many_splats);
}

std::string_view BlendVariant::shader() const {
  if (program == BlendProgram::subgroups) return "blend_subgroups.comp";
  return program == BlendProgram::software ? "blend_software.comp" : "blend.comp";
}

std::array<gl::Number, 14> BlendVariant::numbers() const {
  const BlendColumns columns = columns_of(*this);
  return {number("PLAIN", plain, flag),
          number("LISTS", long_lists, flag),
          number("COLUMN", columns.height, 9),
          number("AHEAD", columns.ahead, 9),
          number("HALF", half, flag),
          number("MEASURE", measure, std::size(measure_files), measure_files[measure]),
          number("DEBUG_VIEW", debug_view, flag),
          number("DEPTH", depth, DEPTH_MEDIAN_OF_TWO_ROWS + 1),
          number("APPROXIMATE", approximate, flag),
          number("CANVASES", canvases, flag),
          number("MESH_DEPTH", mesh_depth, flag),
          number("DISCS", discs, flag),
          number("ENDS_EARLY", many_splats, flag),
          projection_number(projection)};
}

std::vector<BlendVariant> blend_variants() {
  std::vector<BlendVariant> all(1), next;
  const auto vary = [&](auto member, const auto& values) {
    next.clear();
    for (const BlendVariant& v : all) {
      for (const auto value : values) {
        next.push_back(v);
        next.back().*member = value;
      }
    }
    all.swap(next);
  };
  const std::array either = {false, true};
  vary(&BlendVariant::program,
       std::array{BlendProgram::general, BlendProgram::software, BlendProgram::subgroups});
  vary(&BlendVariant::measure, std::array{MEASURE_NONE, MEASURE_TRANSMITTANCE, MEASURE_TRANSPOSED,
                                          MEASURE_CHANGES, MEASURE_VISIBILITY});
  vary(&BlendVariant::depth,
       std::array{DEPTH_NONE, DEPTH_MEAN, DEPTH_VISIBILITY, DEPTH_MEDIAN, DEPTH_MEDIAN_OF_TWO_ROWS});
  vary(&BlendVariant::projection, std::array{Projection::affine, Projection::tangent});
  for (const auto member :
       {&BlendVariant::plain, &BlendVariant::debug_view, &BlendVariant::canvases, &BlendVariant::long_lists,
        &BlendVariant::half, &BlendVariant::approximate, &BlendVariant::mesh_depth, &BlendVariant::discs,
        &BlendVariant::large_splats, &BlendVariant::many_splats}) {
    vary(member, either);
  }
  std::erase_if(all, [](const BlendVariant& v) { return !v.is_legal(); });
  return all;
}

}  // namespace binosplat::render
