#include "render/scatter.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "shared/limits.h"

namespace binosplat::render {

Scatter::Scatter(gl::Context& context)
    : dispatcher_(context), places_(context, "places of uploads"), records_(context, "uploads") {}

void Scatter::upload(
    const gl::Buffer& buffer, std::span<const std::uint32_t> places, std::size_t words,
    const std::function<void(std::span<const std::uint32_t>, std::span<std::uint32_t>)>& fill) {
  std::vector<std::uint32_t> records;
  while (!places.empty()) {
    const auto now = places.first(std::min(places.size(), records_at_once));
    records.assign(now.size() * words, 0);
    const auto fill_some = [&](std::size_t begin, std::size_t end) {
      fill(now.subspan(begin, end - begin), std::span(records).subspan(begin * words, (end - begin) * words));
    };
    parallel_chunks(now.size(), std::max<std::size_t>(numbers_a_thread / words, 1), fill_some);
    places_.upload(now);
    records_.upload(records);
    dispatcher_.begin_frame();
    dispatcher_.begin_stage("scatter");
    dispatcher_.run(dispatcher_.context().program("scatter.comp"), gl::Work::threads(records.size(), THREADS),
                    {{"Places", places_}, {"Records", records_}, {"Scattered", buffer}},
                    {{"words", static_cast<std::uint32_t>(words)},
                     {"word_count", static_cast<std::uint32_t>(records.size())}});
    dispatcher_.end_frame();
    places = places.subspan(now.size());
  }
  dispatcher_.context().gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace binosplat::render
