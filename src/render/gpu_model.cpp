#include "render/gpu_model.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <numeric>
#include <span>

#include "base/parallel.h"
#include "base/parallel_in_frame.h"
#include "render/halves.h"

namespace binosplat::render {

namespace {

shared::Gaussian gaussian_of(const Model& model, std::size_t i) {
  return {glm::vec4(model.position[i], model.opacity[i]), model.rotation[i], glm::vec4(model.scale[i], 0.0f)};
}

using Range = ModelChunks::Range;

// The layout of Gaussians, or of their harmonics, on the GPU: `words` words for each Gaussian. For each of
// `places`, pack(first, places, records) writes the words of the model's Gaussian first + place. Unused words
// become zero.
struct Packing {
  std::size_t words;
  std::function<void(std::size_t first, std::span<const std::uint32_t> places,
                     std::span<std::uint32_t> records)>
      pack;
};

template <typename PackOne>
Packing packing_of(std::size_t words, const PackOne& pack_one) {
  return {words, [words, pack_one](std::size_t first, std::span<const std::uint32_t> places,
                                   std::span<std::uint32_t> records) {
            for (std::size_t k = 0; k < places.size(); ++k)
              pack_one(first + places[k], records.subspan(k * words, words));
          }};
}

Packing packing_of_gaussians(const Model& model, int precision) {
  const auto words = static_cast<std::size_t>(gaussian_bytes(precision)) / sizeof(std::uint32_t);
  if (precision == PRECISION_HALF) {
    return packing_of(words, [&model](std::size_t i, std::span<std::uint32_t> records) {
      std::ranges::copy(pack(gaussian_of(model, i)), records.begin());
    });
  }
  return packing_of(words, [&model](std::size_t i, std::span<std::uint32_t> records) {
    const shared::Gaussian gaussian = gaussian_of(model, i);
    std::memcpy(records.data(), &gaussian, sizeof(gaussian));
  });
}

Packing packing_of_harmonics(const Model& model, int precision) {
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const auto words =
      static_cast<std::size_t>(harmonic_bytes(model.degree, precision)) / sizeof(std::uint32_t);
  if (precision == PRECISION_HALF) {
    return packing_of(words, [&model, floats](std::size_t i, std::span<std::uint32_t> records) {
      pack(std::span(model.sh).subspan(i * floats, floats), records);
    });
  }
  return packing_of(words, [&model, floats](std::size_t i, std::span<std::uint32_t> records) {
    std::memcpy(records.data(), &model.sh[i * floats], floats * sizeof(float));
    std::ranges::fill(records.subspan(floats), 0u);
  });
}

// Uploads all of a page's Gaussians in pieces through one array, because memory is slow at first touch.
void upload_page(const Packing& packing, const ModelBuffers::Page& page, gl::Buffer& buffer) {
  constexpr std::size_t piece = 1 << 16;
  std::vector<std::uint32_t> packed(std::min<std::size_t>(piece, page.count) * packing.words);
  std::vector<std::uint32_t> places(std::min<std::size_t>(piece, page.count));
  std::iota(places.begin(), places.end(), 0u);
  for (std::size_t at = 0; at < page.count; at += piece) {
    const std::size_t count = std::min(piece, page.count - at);
    const auto pack_some = [&](std::size_t begin, std::size_t end) {
      packing.pack(page.first + at, std::span(places).subspan(begin, end - begin),
                   std::span(packed).subspan(begin * packing.words, (end - begin) * packing.words));
    };
    parallel_chunks(count, 1 << 12, pack_some);
    buffer.upload_part<std::uint32_t>(std::span(packed).first(count * packing.words), at * packing.words);
  }
}

void add_places(const ModelBuffers::Page& page, std::span<const Range> ranges,
                std::vector<std::uint32_t>& places) {
  for (const Range& range : ranges) {
    const std::size_t first = std::max<std::size_t>(range.first, page.first);
    const std::size_t end = std::min<std::size_t>(range.first + range.count, page.first + page.count);
    if (first >= end) continue;
    const std::size_t before = places.size();
    places.resize(before + end - first);
    std::iota(places.begin() + static_cast<std::ptrdiff_t>(before), places.end(),
              static_cast<std::uint32_t>(first - page.first));
  }
}

}  // namespace

ModelBuffers::ModelBuffers(gl::Context& context, const Model& model, int in_precision,
                           std::uint32_t page_gaussians)
    : precision(in_precision),
      networks(context),
      page_gaussians_(page_gaussians),
      to_gaussians_(context),
      to_harmonics_(context) {
  upload(context, model);
}

std::size_t ModelBuffers::page_step(gl::Context& context, const Model& model) const {
  if (page_gaussians_ != 0) return page_gaussians_;
  const std::int64_t each = std::max(gaussian_bytes(precision), harmonic_bytes(model.degree, precision));
  const auto reach = static_cast<std::size_t>(context.limits().storage_block_bytes / each);
  return model.scaffold ? reach / MAX_VIEWS : reach;
}

void ModelBuffers::upload(gl::Context& context, const Model& model) {
  if (model.scaffold) {
    pages.clear();
    upload_pages(context, *model.scaffold, page_step(context, model));
    return;
  }
  // Shader writes into these buffers (ScatteredUpload) must be complete. On a busy H200 (driver 580) uploads
  // overtook such writes in spite of a barrier, and a model kept parts of its old state.
  context.gl().Finish();
  set_pages(context, model);
  for (Page& page : pages) {
    page.gaussians->reserve(capacity_of(page, model) * gaussian_bytes(precision));
    page.harmonics->reserve(capacity_of(page, model) * harmonic_bytes(model.degree, precision));
  }
  for (Page& page : pages) {  // only now, because the memory may not suffice for all pages
    clear_from(page, page.count);
    upload_page(packing_of_gaussians(model, precision), page, *page.gaussians);
    upload_page(packing_of_harmonics(model, precision), page, *page.harmonics);
  }
}

void ModelBuffers::upload(gl::Context& context, const Model& model, const ModelChunks::Changes& changes) {
  set_pages(context, model);
  for (const Page& page : pages) {
    const std::int64_t each = gaussian_bytes(precision);
    const std::int64_t before = page.gaussians->bytes() / each;
    page.gaussians->grow(capacity_of(page, model) * each);
    page.harmonics->grow(capacity_of(page, model) * harmonic_bytes(model.degree, precision));
    clear_from(page, before);
    std::vector<std::uint32_t> places;
    add_places(page, changes.filled, places);
    const std::size_t filled = places.size();
    add_places(page, changes.emptied, places);
    // Emptied places become zero.
    const auto upload = [&](ScatteredUpload& scatter, const Packing& packing, gl::Buffer& buffer,
                            std::size_t count) {
      const auto fill = [&](std::span<const std::uint32_t> some, std::span<std::uint32_t> records) {
        const auto first = static_cast<std::size_t>(some.data() - places.data());
        const std::size_t packed = std::clamp(filled, first, first + some.size()) - first;
        packing.pack(page.first, some.first(packed), records);
        std::ranges::fill(records.subspan(packed * packing.words), 0u);
      };
      scatter.upload(buffer, std::span(places).first(count), packing.words, fill);
    };
    upload(to_gaussians_, packing_of_gaussians(model, precision), *page.gaussians, places.size());
    upload(to_harmonics_, packing_of_harmonics(model, precision), *page.harmonics, filled);
  }
}

std::int64_t ModelBuffers::capacity_of(const Page& page, const Model& model) const {
  const std::size_t capacity = std::max(model.count(), model.capacity) - page.first;
  return static_cast<std::int64_t>(std::min(page_step_, capacity));
}

// Writes zeros (opacity 0) from Gaussian `first` of the page to the buffer's end. It does this by uploads,
// because later uploads to the same place must not overtake the zeros.
void ModelBuffers::clear_from(const Page& page, std::int64_t first) const {
  constexpr std::int64_t piece = std::int64_t{1} << 22;  // bytes
  const std::int64_t begin = first * gaussian_bytes(precision), end = page.gaussians->bytes();
  const std::vector<std::byte> zeros(
      static_cast<std::size_t>(std::clamp(end - begin, std::int64_t{0}, piece)));
  for (std::int64_t at = begin; at < end; at += piece) {
    const std::int64_t bytes = std::min(piece, end - at);
    page.gaussians->upload_part(std::span(zeros).first(static_cast<std::size_t>(bytes)),
                                static_cast<std::size_t>(at));
  }
}

void ModelBuffers::set_pages(gl::Context& context, const Model& model) {
  const std::size_t step = page_step_ = page_step(context, model);
  pages.resize((model.count() + step - 1) / step);
  for (std::size_t k = 0; k < pages.size(); ++k) {
    Page& page = pages[k];
    page.first = static_cast<std::uint32_t>(k * step);
    page.count = static_cast<std::uint32_t>(std::min(step, model.count() - k * step));
    page.anchors.reset();
    if (!page.gaussians) page.gaussians = std::make_unique<gl::Buffer>(context, "Gaussians");
    if (!page.harmonics) page.harmonics = std::make_unique<gl::Buffer>(context, "SH coefficients");
  }
}

void ModelBuffers::upload_pages(gl::Context& context, const Scaffold& scaffold, std::size_t step) {
  const std::size_t k = scaffold.offset_count;
  const std::size_t anchors = std::max<std::size_t>(step / k, 1);
  for (std::size_t first = 0; first < scaffold.anchor_count(); first += anchors) {
    const std::size_t count = std::min(anchors, scaffold.anchor_count() - first);
    Page& page = pages.emplace_back();
    page.first = static_cast<std::uint32_t>(first * k);
    page.count = static_cast<std::uint32_t>(count * k);
    page.gaussians = std::make_unique<gl::Buffer>(context, "decoded Gaussians");
    page.harmonics = std::make_unique<gl::Buffer>(context, "decoded colours");
    page.anchors = std::make_unique<AnchorBuffers>(context, scaffold, first, count);
  }
  networks.upload(scaffold);
}

void ModelBuffers::reserve(const FramePlan& plan) {
  if (plan.offset_count == 0) return;
  for (Page& page : pages) {
    const std::int64_t gaussians = std::int64_t{plan.requested_views} * page.count;
    page.gaussians->reserve(gaussians * gaussian_bytes(precision));
    page.harmonics->reserve(gaussians * harmonic_bytes(0, precision));
  }
}

GpuModel::GpuModel(gl::Context& context, const Model& model, int precision, std::uint32_t page_gaussians)
    : context_(context), model_(model), page_gaussians_(page_gaussians) {
  buffers_in(precision);
}

std::shared_ptr<ModelBuffers> GpuModel::buffers_in(int precision) {
  std::weak_ptr<ModelBuffers>& wanted = by_precision_.at(static_cast<std::size_t>(precision));
  if (const auto found = wanted.lock()) {
    latest_ = found;
  } else {
    latest_.reset();  // before the upload, because both precisions may not fit together
    size_ = size_of(model_);
    latest_ = std::make_shared<ModelBuffers>(context_, model_, precision, page_gaussians_);
    wanted = latest_;
  }
  return latest_;
}

template <typename Upload>
void GpuModel::upload_all(const Upload& upload) {
  size_ = size_of(model_);
  const auto other_is_held = [&] {
    return !by_precision_.at(static_cast<std::size_t>(1 - latest_->precision)).expired();
  };
  if (latest_.use_count() == 1 && other_is_held()) latest_.reset();  // no frame draws it any more
  for (const auto& each : by_precision_) {
    if (const auto held = each.lock()) upload(*held);
  }
}

void GpuModel::reload() {
  ++uploads_;
  upload_all([&](ModelBuffers& buffers) { buffers.upload(context_, model_); });
}

void GpuModel::reload(const ModelChunks::Changes& changes) {
  if (changes.empty()) return;
  ++uploads_;
  upload_all([&](ModelBuffers& buffers) { buffers.upload(context_, model_, changes); });
}

}  // namespace binosplat::render
