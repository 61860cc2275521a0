#include "lab/byte_pictures.h"

#include <numeric>

#include "shared/limits.h"

namespace binosplat::lab {

namespace {

std::uint32_t pixels_of(const shared::View& view) { return view.width * view.height; }

std::uint32_t groups_of(const shared::View& view) { return (pixels_of(view) + THREADS - 1) / THREADS; }

}  // namespace

BytePictures::BytePictures(gl::Context& context)
    : dispatcher_(context), sums_(context, "squared errors in 255ths") {}

std::int64_t BytePictures::bytes(std::span<const shared::View> views) {
  std::int64_t pixels = 0;
  for (const shared::View& view : views) pixels += pixels_of(view);
  return 4 * pixels;
}

void BytePictures::keep(const render::Frame& frame, std::span<const shared::View> views, gl::Buffer& kept) {
  kept.reserve(bytes(views));
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("byte pictures");
  std::uint32_t first = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    dispatcher_.run(dispatcher_.context().program("byte_pictures.comp"),
                    gl::DispatchSize::threads(pixels_of(views[v]), THREADS),
                    {{"Colours", frame.colours()}, {"Kept", kept}},
                    {{"first_pixel", frame.views().at(v).pixel_offset},
                     {"first_kept", first},
                     {"pixel_count", pixels_of(views[v])}});
    first += pixels_of(views[v]);
  }
  dispatcher_.end_frame();
  dispatcher_.wait_and_time();
}

std::vector<double> BytePictures::errors(const render::Frame& frame, std::span<const shared::View> views,
                                         const gl::Buffer& kept) {
  std::uint32_t groups = 0;
  for (const shared::View& view : views) groups += groups_of(view);
  sums_.reserve(std::int64_t{4} * groups);
  dispatcher_.begin_frame();
  dispatcher_.begin_stage("byte error");
  std::uint32_t first = 0, first_sum = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    // One dispatch per view, so that no workgroup has pixels of two views.
    dispatcher_.run(dispatcher_.context().program("byte_error.comp"),
                    gl::DispatchSize::threads(pixels_of(views[v]), THREADS),
                    {{"Colours", frame.colours()}, {"Kept", kept}, {"Sums", sums_}},
                    {{"first_pixel", frame.views().at(v).pixel_offset},
                     {"first_kept", first},
                     {"first_sum", first_sum},
                     {"pixel_count", pixels_of(views[v])}});
    first += pixels_of(views[v]);
    first_sum += groups_of(views[v]);
  }
  dispatcher_.end_frame();
  dispatcher_.wait_and_time();
  const auto sums = sums_.read<std::uint32_t>(groups);
  std::vector<double> errors;
  auto begin = sums.begin();
  for (const shared::View& view : views) {
    const auto end = begin + groups_of(view);
    const auto sum = static_cast<double>(std::accumulate(begin, end, std::uint64_t{0}));
    errors.push_back(sum / (255.0 * 255.0 * 3.0 * pixels_of(view)));
    begin = end;
  }
  return errors;
}

}  // namespace binosplat::lab
