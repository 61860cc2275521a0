#include "compact/level_errors.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "scene/reduce.h"

namespace binosplat::compact {

namespace {

constexpr int widths = 2;                  // number of pixel widths
constexpr double pixel_width_ratio = 8.0;  // ratio of successive pixel widths
// Ratio of the narrowest pixel's width to the spacing that the Gaussians would have in a square as wide as
// the box's diagonal. True spacings are smaller.
constexpr double narrowest = 0.625;
// px around each chunk, for the low-pass and for Gaussians that extend beyond the box.
constexpr int margin = 8;
constexpr int max_side = 1280;  // largest width and height of a picture, px
// Distance of the eye, in widths of the picture. So all Gaussians lie within about 5 degrees of the axis.
constexpr double eye_distance = 8.0;

/// Returns the box around all Gaussians, as spheres with a radius of twice their largest standard deviation.
Box box_of(const Model& model) {
  Box box;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const glm::vec3& s = model.scale[i];
    const double reach = 2.0 * std::max({s.x, s.y, s.z});
    box.include(glm::dvec3(model.position[i]) - reach, glm::dvec3(model.position[i]) + reach);
  }
  return box;
}

struct MeasuredChunk {
  std::span<const Model> levels;
  Box box;
  LevelErrors* errors;
  int square;  // px, side of the chunk's square in the narrowest pixels
};

/// The squares of a picture, row by row, each with one chunk.
struct Grid {
  std::uint32_t count, side, across;  // number of squares, side of a square in px, squares in a row
  std::uint32_t width() const { return across * side; }
  std::uint32_t height() const { return (count + across - 1) / across * side; }
  /// Returns the first pixel of square `i`.
  glm::uvec2 corner(std::size_t i) const {
    const auto k = static_cast<std::uint32_t>(i);
    return side * glm::uvec2(k % across, k / across);
  }
};

/// Draws models one after the other in the same buffers, because allocating buffers takes as long as drawing.
class LevelDrawer {
 public:
  explicit LevelDrawer(gl::Context& context)
      : context_(context),
        dispatcher_(context),
        finest_(context, "the finest level"),
        backgrounds_(context, "colours behind chunks"),
        sums_(context, "errors of chunks") {}

  /// The next model to draw; its memory is reused.
  Model& model() { return model_; }

  /// Draws the finest level, with which later calls of draw() compare. Returns its visible area in each
  /// square, px.
  std::vector<float> draw_finest(const shared::View& view, const Grid& grid) {
    draw(view, true);
    finest_.reserve(frame_->colours().bytes());
    backgrounds_.reserve(std::int64_t{grid.count} * 16);
    return sums_of(grid, true);
  }

  /// Draws another level. Returns each square's squared error against the finest level, over backgrounds_.
  std::vector<float> draw(const shared::View& view, const Grid& grid) {
    draw(view, false);
    return sums_of(grid, false);
  }

 private:
  void draw(const shared::View& view, bool visibility) {
    if (frame_) {
      frame_->model()->reload();
    } else {
      frame_.emplace(context_, model_);
    }
    frame_->draw({&view, 1}, {.has_depths = false}, {.visibility_as_depth = visibility});
  }

  std::vector<float> sums_of(const Grid& grid, bool finest) {
    sums_.reserve(std::int64_t{grid.count} * 4);
    dispatcher_.begin_frame();
    dispatcher_.begin_stage("level errors");
    const gl::Program& program = context_.program("level_errors.comp", gl::Number{"FINEST", finest, 2});
    dispatcher_.run(program, gl::DispatchSize::of_groups(grid.count),
                    {{"Colours", frame_->colours()},
                     {"Finest", finest_},
                     {"Backgrounds", backgrounds_},
                     {"Sums", sums_},
                     {"ZSums", frame_->z_sums()}},
                    {{"square_count", grid.count},
                     {"square_side", grid.side},
                     {"row_squares", grid.across},
                     {"row_pixels", grid.width()}});
    dispatcher_.end_frame();
    dispatcher_.wait_and_time();
    return sums_.read<float>(grid.count);
  }

  gl::Context& context_;
  gl::Dispatcher dispatcher_;
  Model model_;
  std::optional<render::Frame> frame_;
  gl::Buffer finest_;       // vec4 by pixel
  gl::Buffer backgrounds_;  // vec4 by square: about the chunk's mean colour
  gl::Buffer sums_;         // float by square
};

/// Chunks side by side, each in its own square, seen along `direction`.
class ChunkSheet {
 public:
  ChunkSheet(std::span<const MeasuredChunk> chunks, std::size_t width, const glm::dvec3& direction)
      : chunks_(chunks), width_(width) {
    double widest = 0.0;
    for (const MeasuredChunk& chunk : chunks)
      widest = std::max(widest, glm::distance(chunk.box.low, chunk.box.high) / pixel(chunk));
    grid_ = {static_cast<std::uint32_t>(chunks.size()),
             static_cast<std::uint32_t>(std::ceil(widest)) + 2 * margin,
             static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(chunks.size()))))};
    camera_.width = static_cast<int>(grid_.width());
    camera_.height = static_cast<int>(grid_.height());
    camera_.fx = camera_.fy = eye_distance * std::max(camera_.width, camera_.height);
    camera_.cx = 0.5 * camera_.width;
    camera_.cy = 0.5 * camera_.height;
    const glm::dvec3 right = glm::normalize(glm::cross(direction, glm::dvec3(0.3, 1.0, 0.2)));
    camera_.rotation = glm::dmat3(right, glm::cross(direction, right), direction);
  }

  std::vector<float> draw_finest(LevelDrawer& drawer) const {
    fill(drawer.model(), 0);
    return drawer.draw_finest(make_view(camera_), grid_);
  }
  std::vector<float> draw(LevelDrawer& drawer, std::size_t level) const {
    fill(drawer.model(), level);
    return drawer.draw(make_view(camera_), grid_);
  }

 private:
  /// Copies one level of all chunks into `all`, each chunk into its square.
  void fill(Model& all, std::size_t level) const {
    if (all.count() == 0) all = without_gaussians(chunks_.front().levels[level]);
    std::vector<std::size_t> first{0};
    for (const MeasuredChunk& chunk : chunks_) first.push_back(first.back() + chunk.levels[level].count());
    all.resize(first.back());
    parallel_for(chunks_.size(), [&](std::size_t i) {
      const MeasuredChunk& chunk = chunks_[i];
      copy(chunk.levels[level], 0, chunk.levels[level].count(), all, first[i]);
      // At a depth of fx world units, a pixel covers one world unit.
      const glm::dvec2 centre =
          glm::dvec2(grid_.corner(i)) + 0.5 * grid_.side - glm::dvec2(camera_.cx, camera_.cy);
      const glm::dvec3 at(centre, camera_.fx);
      const glm::dvec3 to = camera_.rotation * at, middle = 0.5 * (chunk.box.low + chunk.box.high);
      for (std::size_t k = first[i]; k < first[i + 1]; ++k) {
        all.position[k] = glm::vec3((glm::dvec3(all.position[k]) - middle) / pixel(chunk) + to);
        all.scale[k] = glm::vec3(glm::dvec3(all.scale[k]) / pixel(chunk));
      }
    });
  }

  double pixel(const MeasuredChunk& chunk) const { return chunk.errors->pixels[width_]; }

  std::span<const MeasuredChunk> chunks_;
  std::size_t width_;
  Grid grid_{};
  Camera camera_;
};

/// Number of levels that are also drawn in the narrowest pixels, where coarser levels lose at most as much
/// per visible area as in wider pixels.
constexpr std::size_t fine_levels = 3;

/// In wide pixels a chunk's two sides look much alike, so only the first of two opposite directions is drawn.
bool is_drawn(std::size_t direction, std::size_t width) { return width == 0 || direction % 2 == 0; }

void fill_in(LevelErrors& errors) {
  for (std::size_t d = 0; d < detail_directions; ++d) {
    for (std::size_t width = 1; width < widths; ++width) {
      const std::size_t drawn = is_drawn(d, width) ? d : d - 1;
      errors.seen[d][width] = errors.seen[drawn][width];
      for (auto& of : errors.of_level) of[d][width] = of[drawn][width];
    }
    const double larger = errors.seen[d][1] > 0.0 ? errors.seen[d][0] / errors.seen[d][1] : 0.0;
    for (std::size_t level = fine_levels; level < errors.of_level.size(); ++level)
      errors.of_level[level][d][0] = larger * errors.of_level[level][d][1];
  }
}

void measure_chunks(LevelDrawer& drawer, std::span<const MeasuredChunk> chunks) {
  const std::size_t levels = chunks.front().levels.size();
  for (const MeasuredChunk& chunk : chunks) {
    chunk.errors->seen.assign(detail_directions, std::vector<double>(widths));
    chunk.errors->of_level.assign(levels, chunk.errors->seen);
  }
  for (std::size_t d = 0; d < detail_directions; ++d) {
    for (std::size_t width = 0; width < widths; ++width) {
      if (!is_drawn(d, width)) continue;
      const ChunkSheet sheet(chunks, width, detail_direction(d));
      const std::vector<float> seen = sheet.draw_finest(drawer);
      for (std::size_t i = 0; i < chunks.size(); ++i) chunks[i].errors->seen[d][width] = double{seen[i]};
      for (std::size_t level = 1; level < (width == 0 ? std::min(levels, fine_levels) : levels); ++level) {
        const std::vector<float> lost = sheet.draw(drawer, level);
        for (std::size_t i = 0; i < chunks.size(); ++i)
          chunks[i].errors->of_level[level][d][width] = double{lost[i]};
      }
    }
  }
  for (const MeasuredChunk& chunk : chunks) fill_in(*chunk.errors);
}

}  // namespace

std::vector<LevelErrors> level_errors(gl::Context& context,
                                      std::span<const std::vector<Model>> levels_of_chunks) {
  std::vector<LevelErrors> errors(levels_of_chunks.size());
  std::vector<MeasuredChunk> chunks;
  for (std::size_t i = 0; i < levels_of_chunks.size(); ++i) {
    const Model& finest = levels_of_chunks[i].front();
    const Box box = box_of(finest);
    const double diagonal = glm::distance(box.low, box.high);
    const double across = std::ceil(std::sqrt(static_cast<double>(finest.count())) / narrowest);
    for (int k = 0; k < widths; ++k)
      errors[i].pixels.push_back((diagonal > 0.0 ? diagonal / across : 1.0) * std::pow(pixel_width_ratio, k));
    chunks.push_back({levels_of_chunks[i], box, &errors[i], static_cast<int>(across) + 2 * margin});
  }
  LevelDrawer drawer(context);
  // All squares of a sheet are as large as the largest needs, so chunks of similar size share a sheet.
  std::stable_sort(chunks.begin(), chunks.end(),
                   [](const MeasuredChunk& a, const MeasuredChunk& b) { return a.square > b.square; });
  for (std::size_t first = 0, count = 0; first < chunks.size(); first += count) {
    const auto row = static_cast<std::size_t>(std::max(1, max_side / chunks[first].square));
    count = std::min(chunks.size() - first, row * row);
    measure_chunks(drawer, std::span(chunks).subspan(first, count));
  }
  return errors;
}

}  // namespace binosplat::compact
