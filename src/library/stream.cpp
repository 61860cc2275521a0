#include "library/stream.h"

#include <algorithm>

#include "base/error.h"
#include "gl/state.h"
#include "library/conversions.h"
#include "library/numbers.h"
#include "library/views.h"

namespace binosplat {

namespace {

StreamSettings settings_of(const StreamOptions& options) {
  if (!(options.quality >= render::min_quality && options.quality <= render::max_quality))
    fail("StreamOptions::quality {}: expected {} to {} dB", options.quality, render::min_quality,
         render::max_quality);
  StreamSettings settings{.finest_up_to = few_gaussians};
  settings.detail.db = options.quality;
  settings.detail.max_gaussians = options.max_gaussians.value_or(any_number);
  settings.reserve = std::min(options.reserve, settings.detail.max_gaussians);
  return settings;
}

template <typename Impl>
Stream& stream_in(const std::shared_ptr<Impl>& impl) {
  if (impl == nullptr) fail("this SplatStream was moved from: expected a valid one");
  return *impl->stream;
}

}  // namespace

SplatStream::SplatStream(const std::filesystem::path& path, const StreamOptions& options)
    : SplatStream(std::make_shared<Stream>(path, settings_of(options))) {}
SplatStream::SplatStream(std::shared_ptr<Stream> stream) : impl_(std::make_shared<Impl>(std::move(stream))) {}
SplatStream::~SplatStream() = default;
SplatStream::SplatStream(SplatStream&&) noexcept = default;
SplatStream& SplatStream::operator=(SplatStream&&) noexcept = default;

Placement SplatStream::placement(const glm::dvec3& origin, double units_per_metre) const {
  return library::placement_in(stream_in(impl_).model(), origin, units_per_metre);
}

bool SplatStream::begin_frame(std::span<const View> views, const Placement& placement,
                              const Settings& settings, double ms) {
  Stream& stream = stream_in(impl_);
  if (impl_->context == nullptr) fail("a stream without a renderer: make a Renderer of it first");
  impl_->context->check_current();
  if (impl_->is_drawn) fail("a frame of the stream is under way: call finish() before begin_frame()");
  if (!(ms >= 0.0)) fail("begin_frame of {} ms: expected zero or more", ms);
  library::check_numbers(views, placement);
  const render::FrameSettings of_frame = library::frame_settings(settings, views, impl_->precision);
  const gl::SavedState saved(*impl_->context);
  return stream.begin_frame(
      library::views_of(views, placement, stream.model().axes.origin, settings, stream.model()), of_frame,
      ms);
}

Bounds SplatStream::bounds() const { return core_bounds(stream_in(impl_).model()); }
bool SplatStream::settled() const { return stream_in(impl_).settled(); }
std::size_t SplatStream::count() const { return stream_in(impl_).gaussians(); }
std::optional<double> SplatStream::quality() const { return stream_in(impl_).reported_db(); }

}  // namespace binosplat
