#include "primitives/scan.h"

#include <cstddef>

#include "shared/limits.h"
#include "shared/types.h"

namespace binosplat::primitives {

void Scan::reserve(std::int64_t count) {
  block_sums_.reserve((count / SCAN_BLOCK + 1) * 4);
  total_.reserve(4);
}

void Scan::run(gl::Dispatcher& dispatcher, const gl::Buffer& arguments, std::uint32_t which,
               const gl::Buffer& values) {
  gl::Context& context = dispatcher.context();
  const auto blocks = gl::DispatchSize::indirect(
      arguments, static_cast<std::int64_t>(which * sizeof(shared::DispatchArguments) +
                                           offsetof(shared::DispatchArguments, scan_x)));
  dispatcher.run(context.program("primitives/scan_reduce.comp"), blocks,
                 {{"Arguments", arguments}, {"Values", values}, {"BlockSums", block_sums_}},
                 {{"which", which}});
  dispatcher.run(
      context.program("primitives/scan_apply.comp"), blocks,
      {{"Arguments", arguments}, {"Values", values}, {"BlockSums", block_sums_}, {"Total", total_}},
      {{"which", which}});
}

}  // namespace binosplat::primitives
