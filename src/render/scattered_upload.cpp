#include "render/scattered_upload.h"

#include <algorithm>
#include <bit>

#include "base/parallel_in_frame.h"
#include "shared/limits.h"

namespace binosplat::render {

ScatteredUpload::ScatteredUpload(gl::Context& context)
    : dispatcher_(context),
      places_(context, "places of uploads", gl::Buffer::Use::written),
      records_(context, "uploads", gl::Buffer::Use::written),
      read_(context) {}

void ScatteredUpload::upload(
    const gl::Buffer& buffer, std::span<const std::uint32_t> places, std::size_t words,
    const std::function<void(std::span<const std::uint32_t>, std::span<std::uint32_t>)>& fill) {
  const std::size_t all = static_cast<std::size_t>(buffer.bytes()) / (4 * words);
  while (!places.empty()) {
    const auto now = places.first(std::min(places.size(), records_at_once));
    const std::size_t word_count = now.size() * words;
    read_.wait();
    const std::size_t capacity =
        std::min(std::bit_ceil(all), records_at_once);  // final size: growing is slow
    std::ranges::copy(now, places_.writable<std::uint32_t>(capacity).begin());
    const auto records = records_.writable<std::uint32_t>(capacity * words);
    const auto fill_some = [&](std::size_t begin, std::size_t end) {
      fill(now.subspan(begin, end - begin), records.subspan(begin * words, (end - begin) * words));
    };
    parallel_in_frame(now.size(), std::max<std::size_t>(numbers_a_chunk / words, 1), fill_some);
    dispatcher_.begin_frame();
    dispatcher_.begin_stage("scatter");
    dispatcher_.run(dispatcher_.context().program("scattered_upload.comp"),
                    gl::DispatchSize::threads(word_count, THREADS),
                    {{"Places", places_}, {"Records", records_}, {"Scattered", buffer}},
                    {{"words", static_cast<std::uint32_t>(words)},
                     {"word_count", static_cast<std::uint32_t>(word_count)}});
    dispatcher_.end_frame();
    read_.set();
    places = places.subspan(now.size());
  }
  dispatcher_.context().gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace binosplat::render
