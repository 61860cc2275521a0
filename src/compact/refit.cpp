#include "compact/refit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "base/parallel.h"
#include "base/progress.h"
#include "render/linear_blend.h"
#include "scene/axes.h"
#include "scene/harmonics.h"

namespace binosplat::compact {

namespace {

constexpr std::size_t chunk = 4096;  // numbers or Gaussians that a thread takes at a time
constexpr int patience = 3;          // rounds without improvement until refit() ends

using Vector = std::vector<float>;

/// The dot product, summed in chunks of fixed size, so that the number of threads does not affect it.
double dot(const Vector& a, const Vector& b) {
  std::vector<double> parts((a.size() + chunk - 1) / chunk);
  parallel_for(parts.size(), [&](std::size_t part) {
    for (std::size_t k = part * chunk; k < std::min(a.size(), (part + 1) * chunk); ++k)
      parts[part] += static_cast<double>(a[k]) * static_cast<double>(b[k]);
  });
  double sum = 0.0;
  for (const double part : parts) sum += part;
  return sum;
}

void add_scaled(Vector& a, double factor, const Vector& b) {
  const auto f = static_cast<float>(factor);
  parallel_for(
      a.size(), [&](std::size_t k) { a[k] += f * b[k]; }, chunk);
}

/// Returns the gradient divided by (1 + damping) times the coefficient's weight, for all channels.
Vector preconditioned(const Vector& gradient, const Vector& weight, double damping) {
  Vector z(gradient.size());
  parallel_for(
      weight.size(),
      [&](std::size_t k) {
        const double of = static_cast<double>(weight[k]) * (1.0 + damping);
        for (std::size_t c = 3 * k; c < 3 * k + 3; ++c)
          z[c] = of > 0.0 ? static_cast<float>(static_cast<double>(gradient[c]) / of) : 0.0f;
      },
      chunk);
  return z;
}

float largest_of(std::span<const glm::vec3> colours) {
  float largest = 1e-12f;
  for (const glm::vec3& c : colours) {
    for (int channel = 0; channel < 3; ++channel) largest = std::max(largest, std::abs(c[channel]));
  }
  return largest;
}

class Refit {
 public:
  Refit(gl::Context& context, const Model& model, const RefitTargets& targets, const RefitSettings& settings,
        const ValidationLoss& validation_loss)
      : model_(model),
        targets_(targets),
        settings_(settings),
        validation_loss_(validation_loss),
        coefficients_(static_cast<std::size_t>(sh_count(model.degree))),
        blend_(context, model),
        context_(context),
        candidate_(model) {}

  Refitted run() {
    found_.sh = model_.sh;
    if (validation_loss_) found_.losses = {validation_loss_(model_)};
    const auto rounds = static_cast<std::uint64_t>(settings_.rounds);
    const std::uint64_t restarts =
        (rounds + static_cast<std::uint64_t>(settings_.rounds_linear) - 1) / settings_.rounds_linear;
    Progress progress("fitting the colours", targets_.cameras.size() * (rounds + restarts));
    progress_ = &progress;
    for (int round = 1; round <= settings_.rounds; ++round) {
      if ((round - 1) % settings_.rounds_linear == 0) linearise();
      if (!step()) break;
      if (validation_loss_) found_.losses.push_back(validation_loss_(candidate_));
      if (!validation_loss_ ||
          found_.losses.back() < found_.losses[static_cast<std::size_t>(found_.best_round)]) {
        found_.best_round = round;
        found_.sh = candidate_.sh;
      } else if (round - found_.best_round == patience) {
        break;
      }
    }
    return std::move(found_);
  }

 private:
  std::size_t at(std::size_t gaussian, std::size_t k) const { return 3 * (gaussian * coefficients_ + k); }

  glm::dvec3 sum_of(const Vector& sh, std::size_t gaussian, const std::array<double, 16>& basis) const {
    return sh_sum(std::span(sh).subspan(at(gaussian, 0), 3 * coefficients_), basis);
  }

  /// Calls body(n, Gaussian, basis, colour, counts) for each Gaussian that the view draws. `basis` is
  /// sh_basis() of its direction. `colour` is its unclamped colour at the last linearise(). `counts` is 1 for
  /// channels above 0, and 0 for channels that are clamped.
  template <typename Body>
  void for_drawn(const Camera& camera, const Body& body) const {
    const auto& drawn = blend_.drawn();
    const auto one = [&](std::size_t n) {
      const std::size_t i = drawn[n].index;
      const auto basis = sh_basis(glm::normalize(glm::dvec3(model_.position[i]) - camera.position));
      const glm::dvec3 colour = 0.5 + sum_of(candidate_at_start_, i, basis);
      body(n, i, basis, colour, glm::dvec3(glm::greaterThan(colour, glm::dvec3(0.0))));
    };
    parallel_for(drawn.size(), one, chunk);
  }

  /// For each target, sets blend_ to its view and calls body(camera in the world, camera in model axes).
  template <typename Body>
  void for_targets(const Body& body) {
    for (const Camera& in_world : targets_.cameras) {
      const Camera camera = into_axes(in_world, model_.axes);
      blend_.set_view(make_view(camera, targets_.near_plane));
      body(in_world, camera);
      progress_->update(++done_);
    }
  }

  std::vector<glm::vec3> wanted(const Camera& in_world, const Camera& camera) {
    std::vector<glm::vec3> pixels;
    pixels.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
    if (const auto photo = targets_.photo ? targets_.photo(in_world) : std::nullopt) {
      for (std::size_t k = 0; k < photo->data.size(); k += 3)
        pixels.emplace_back(photo->data[k], photo->data[k + 1], photo->data[k + 2]);
      return pixels;
    }
    const shared::View view = make_view(camera, targets_.near_plane);
    if (!wanted_) wanted_ = std::make_unique<render::Frame>(context_, targets_.original);
    wanted_->draw(std::span(&view, 1));
    const std::vector<Picture> drawn = wanted_->read_pictures();
    for (const glm::vec4& colour : drawn.front().colour) pixels.emplace_back(colour);
    return pixels;
  }

  /// Computes the gradient and each coefficient's weight at the present coefficients.
  void linearise() {
    candidate_at_start_ = candidate_.sh;
    gradient_.assign(candidate_.sh.size(), 0.0f);
    weight_.assign(model_.count() * coefficients_, 0.0f);
    for_targets([&](const Camera& in_world, const Camera& camera) {
      std::vector<glm::vec3> colours(blend_.drawn().size());
      for_drawn(camera, [&](std::size_t n, std::size_t, const auto&, const glm::dvec3& colour,
                            const glm::dvec3&) { colours[n] = glm::max(colour, 0.0); });
      blend_.set_colours(colours);
      std::vector<glm::vec3> missing = wanted(in_world, camera);
      std::vector<glm::vec4> picture = blend_.read_picture();
      for (std::size_t p = 0; p < missing.size(); ++p) missing[p] -= glm::vec3(picture[p]);
      const float largest = largest_of(missing);
      for (std::size_t p = 0; p < missing.size(); ++p) picture[p] = glm::vec4(missing[p], largest);
      blend_.set_picture(picture);
      const std::vector<glm::dvec4> sums = blend_.transposed(largest);
      for_drawn(camera, [&](std::size_t n, std::size_t i, const auto& basis, const glm::dvec3&,
                            const glm::dvec3& counts) {
        add_to(gradient_, i, basis, counts * glm::dvec3(sums[n]));
        const double weight = sums[n].w / static_cast<double>(largest);
        for (std::size_t k = 0; k < coefficients_; ++k) {
          if (!stays(i, k))
            weight_[i * coefficients_ + k] += static_cast<float>(weight * basis[k] * basis[k]);
        }
      });
    });
    direction_.assign(gradient_.size(), 0.0f);
    slope_ = 0.0;
  }

  /// Returns whether a coefficient is 0 in all channels and must stay so.
  bool stays(std::size_t gaussian, std::size_t k) const {
    const float* c = &candidate_at_start_[at(gaussian, k)];
    return settings_.keep_zeros && k > 0 && c[0] == 0.0f && c[1] == 0.0f && c[2] == 0.0f;
  }

  void add_to(Vector& sh, std::size_t gaussian, const std::array<double, 16>& basis,
              const glm::dvec3& colour) const {
    for (std::size_t k = 0; k < coefficients_; ++k) {
      float* c = &sh[at(gaussian, k)];
      for (int channel = 0; channel < 3; ++channel)
        c[channel] += static_cast<float>(basis[k] * colour[channel]);
    }
  }

  /// Makes a round of conjugate gradients. Returns false if nothing is left to gain.
  bool step() {
    const Vector z = preconditioned(gradient_, weight_, settings_.damping);
    const double slope = dot(gradient_, z);
    if (!(slope > 0.0)) return false;
    const auto before = static_cast<float>(slope_ > 0.0 ? slope / slope_ : 0.0);
    parallel_for(
        z.size(), [&](std::size_t k) { direction_[k] = z[k] + before * direction_[k]; }, chunk);
    slope_ = slope;
    const Vector curved = curvature();
    const double bend = dot(direction_, curved);
    if (!(bend > 0.0)) return false;
    add_scaled(candidate_.sh, slope / bend, direction_);
    add_scaled(gradient_, -slope / bend, curved);
    return true;
  }

  /// Returns (A^T A + damping) times the direction. A is the matrix from coefficients to pixels.
  Vector curvature() {
    Vector curved(direction_.size());
    const auto damping = static_cast<float>(settings_.damping);
    parallel_for(
        weight_.size(),
        [&](std::size_t k) {
          for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) curved[c] = damping * weight_[k] * direction_[c];
        },
        chunk);
    for_targets([&](const Camera&, const Camera& camera) {
      std::vector<glm::vec3> colours(blend_.drawn().size());
      for_drawn(camera,
                [&](std::size_t n, std::size_t i, const auto& basis, const glm::dvec3&,
                    const glm::dvec3& counts) { colours[n] = counts * sum_of(direction_, i, basis); });
      blend_.set_colours(colours);
      // No pixel exceeds the largest colour, since its weights add up to at most 1. Its T is at most 1, too.
      const std::vector<glm::dvec4> sums = blend_.transposed(std::max(1.0f, largest_of(colours)));
      for_drawn(camera,
                [&](std::size_t n, std::size_t i, const auto& basis, const glm::dvec3&,
                    const glm::dvec3& counts) { add_to(curved, i, basis, counts * glm::dvec3(sums[n])); });
    });
    return curved;
  }

  const Model& model_;
  const RefitTargets& targets_;
  const RefitSettings& settings_;
  const ValidationLoss& validation_loss_;
  const std::size_t coefficients_;  // number per Gaussian and channel
  render::LinearBlend blend_;
  gl::Context& context_;
  std::unique_ptr<render::Frame> wanted_;  // draws the original
  Model candidate_;
  Vector candidate_at_start_;  // harmonics at the last linearisation
  Vector gradient_;            // negative gradient of half the squared error
  Vector direction_;
  double slope_ = 0.0;
  Vector weight_;  // by Gaussian and coefficient
  Progress* progress_ = nullptr;
  std::uint64_t done_ = 0;
  Refitted found_;
};

}  // namespace

Refitted refit(gl::Context& context, const Model& model, const RefitTargets& targets,
               const RefitSettings& settings, const ValidationLoss& validation_loss) {
  return Refit(context, model, targets, settings, validation_loss).run();
}

}  // namespace binosplat::compact
