#include "render/gpu_model.h"

#include <algorithm>
#include <span>

#include "render/halves.h"

namespace binosplat::render {

namespace {

shared::Gaussian gaussian_of(const Model& model, std::size_t i) {
  return {glm::vec4(model.position[i], model.opacity[i]), model.rotation[i], glm::vec4(model.scale[i], 0.0f)};
}

// Fills a buffer with `stride` numbers of each Gaussian of a page, which pack(Gaussian, room) makes; in
// pieces: switches of levels must not wait for memory that is touched once. The room is zero where it leaves
// it alone.
template <typename T, typename Pack>
void upload_in_pieces(const ModelBuffers::Page& page, std::size_t stride, gl::Buffer& buffer,
                      const Pack& pack_one) {
  constexpr std::size_t piece = 1 << 15;
  std::vector<T> packed(std::min<std::size_t>(piece, page.count) * stride);
  for (std::size_t at = 0; at < page.count; at += piece) {
    const std::size_t count = std::min<std::size_t>(piece, page.count - at);
    for (std::size_t k = 0; k < count; ++k)
      pack_one(page.first + at + k, std::span(packed).subspan(k * stride, stride));
    buffer.upload_part<T>(std::span(packed).first(count * stride), at * stride);
  }
}

void upload_halves(const Model& model, const ModelBuffers::Page& page) {
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const std::size_t words = static_cast<std::size_t>(harmonic_bytes(model.degree, PRECISION_HALF)) / 4;
  upload_in_pieces<Halves>(page, 1, *page.gaussians, [&](std::size_t i, std::span<Halves> room) {
    room[0] = pack(gaussian_of(model, i));
  });
  upload_in_pieces<std::uint32_t>(page, words, *page.harmonics,
                                  [&](std::size_t i, std::span<std::uint32_t> room) {
                                    pack(std::span(model.sh).subspan(i * floats, floats), room);
                                  });
}

void upload_floats(const Model& model, const ModelBuffers::Page& page) {
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const std::size_t stride =
      static_cast<std::size_t>(harmonic_bytes(model.degree, PRECISION_FULL)) / sizeof(float);
  upload_in_pieces<shared::Gaussian>(
      page, 1, *page.gaussians,
      [&](std::size_t i, std::span<shared::Gaussian> room) { room[0] = gaussian_of(model, i); });
  if (stride == floats) {
    page.harmonics->upload_part(std::span(model.sh).subspan(page.first * floats, page.count * floats), 0);
  } else {
    upload_in_pieces<float>(page, stride, *page.harmonics, [&](std::size_t i, std::span<float> room) {
      std::copy_n(&model.sh[i * floats], floats, room.begin());
    });
  }
}

}  // namespace

ModelBuffers::ModelBuffers(gl::Context& context, const Model& model, int in_precision,
                           std::uint32_t page_gaussians)
    : precision(in_precision), networks(context), page_gaussians_(page_gaussians) {
  upload(context, model);
}

void ModelBuffers::upload(gl::Context& context, const Model& model) {
  const std::int64_t each = std::max(gaussian_bytes(precision), harmonic_bytes(model.degree, precision));
  const std::int64_t reach = context.limits().storage_block_bytes / each;
  const std::size_t step = page_gaussians_ != 0 ? page_gaussians_ : static_cast<std::size_t>(reach);
  box.reset();
  if (model.scaffold) {
    pages.clear();
    upload_pages(context, *model.scaffold, page_gaussians_ != 0 ? step : step / MAX_VIEWS);
  } else {
    upload_pages(context, model, step);
    if (model.count() > 0) box = all_bounds(model);
  }
}

void ModelBuffers::upload_pages(gl::Context& context, const Model& model, std::size_t step) {
  pages.resize((model.count() + step - 1) / step);
  for (std::size_t k = 0; k < pages.size(); ++k) {
    Page& page = pages[k];
    page.first = static_cast<std::uint32_t>(k * step);
    page.count = static_cast<std::uint32_t>(std::min(step, model.count() - k * step));
    page.anchors.reset();
    if (!page.gaussians) page.gaussians = std::make_unique<gl::Buffer>(context, "Gaussians");
    if (!page.harmonics) page.harmonics = std::make_unique<gl::Buffer>(context, "SH coefficients");
    page.gaussians->reserve(page.count * gaussian_bytes(precision));
    page.harmonics->reserve(page.count * harmonic_bytes(model.degree, precision));
    if (precision == PRECISION_HALF) {
      upload_halves(model, page);
    } else {
      upload_floats(model, page);
    }
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

void ModelBuffers::reserve(const FrameShape& shape) {
  if (shape.offset_count == 0) return;
  for (Page& page : pages) {
    const std::int64_t gaussians = std::int64_t{shape.decoding_count()} * page.count;
    page.gaussians->reserve(gaussians * gaussian_bytes(precision));
    page.harmonics->reserve(gaussians * harmonic_bytes(0, precision));
  }
}

GpuModel::GpuModel(gl::Context& context, const Model& model, int precision, std::uint32_t page_gaussians)
    : context_(context), model_(model), page_gaussians_(page_gaussians) {
  in(precision);
}

std::shared_ptr<ModelBuffers> GpuModel::in(int precision) {
  std::weak_ptr<ModelBuffers>& wanted = all_.at(static_cast<std::size_t>(precision));
  if (const auto found = wanted.lock()) {
    latest_ = found;
  } else {
    latest_.reset();  // first, since both together may not fit
    latest_ = std::make_shared<ModelBuffers>(context_, model_, precision, page_gaussians_);
    wanted = latest_;
  }
  return latest_;
}

void GpuModel::reload() {
  ++uploads_;
  const auto other_is_held = [&] {
    return !all_.at(static_cast<std::size_t>(1 - latest_->precision)).expired();
  };
  if (latest_.use_count() == 1 && other_is_held()) latest_.reset();  // nobody draws it any more
  for (const auto& each : all_) {
    if (const auto held = each.lock()) held->upload(context_, model_);
  }
}

}  // namespace binosplat::render
