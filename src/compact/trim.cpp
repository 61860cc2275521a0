#include "compact/trim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>

#include "adagscale/tolerance_search.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/statistics.h"
#include "compact/weights.h"
#include "scene/reduce.h"

namespace binosplat::compact {

namespace {

constexpr int drawings = 3;                      // drawings of each view, for the reported time
constexpr int trial_rounds = 4;                  // rounds that fit the colours of a candidate
constexpr std::size_t gaussians_per_task = 256;  // Gaussians that a thread takes at a time
// Shares of the allowed loss that may be spent when these steps are done.
constexpr double after_bits = 0.25, after_harmonics = 0.5;

/// Measures the loss of a model in the validation views, and whether the bound allows it.
class TrimBound {
 public:
  TrimBound(gl::Context& context, const Model& original, const ViewSplit& views,
            const adagscale::CalibrationTarget& target)
      : target_(target) {
    const auto open = [&](const std::vector<adagscale::CalibrationView>& of) {
      return of.empty() ? nullptr
                        : std::make_unique<adagscale::Calibrator>(
                              std::make_shared<render::GpuModel>(context, original), of, views.near_plane,
                              target.kind);
    };
    validation_ = open(views.validation);
    validation_own_ = open(views.validation_own);
    test_ = open(views.test);
    test_own_ = open(views.test_own);
  }

  /// Returns the value that the bound limits: the mean over the validation views, at the worse size.
  double bounded_db(const Model& model) {
    const std::size_t views = validation_->views().size();
    Progress progress(fmt::format("measuring model {}, {} Gaussians of degree {}", ++measured_models_,
                                  model.count(), model.degree),
                      views + (validation_own_ ? validation_own_->views().size() : 0));
    const double db = validation_->cost(model, 1, [&](std::size_t done) { progress.update(done); }).mean_db;
    if (!validation_own_) return db;
    const auto tell = [&](std::size_t done) { progress.update(views + done); };
    return std::min(db, validation_own_->cost(model, 1, tell).mean_db);
  }

  /// Returns bounded_db() as a loss: smaller is better.
  double loss(const Model& model) { return -sign() * bounded_db(model); }

  /// Measures the model from which the steps start. If the bound is a drop, the steps share the difference
  /// between the allowed drop and this model's drop.
  void start_from(const Model& whole) { start_ = bounded_db(whole); }

  bool holds(double db, double share) const { return sign() * db >= sign() * bound(share); }

  /// Returns the largest amount whose cost `db(amount)` is within a share of the bound. The amount 0 must be
  /// within it.
  double largest_within(const std::function<double(double)>& db, double share,
                        adagscale::ToleranceSearch search) const {
    search.within = is_drop() ? 0.03 * (target_.db - start_) : 0.1;
    const auto value = [&](double amount) { return sign() * db(amount); };
    return adagscale::find_tolerance(value, sign() * bound(share), search).tolerance;
  }

  /// Measures a step's model in all views.
  void report(const Model& model, TrimStep& step) {
    step.validation = validation_->cost(model, drawings);
    if (validation_own_) step.validation_own = validation_own_->cost(model);
    if (test_) step.test = test_->cost(model);
    if (test_own_) step.test_own = test_own_->cost(model);
  }

 private:
  bool is_drop() const { return target_.kind == adagscale::CalibrationTarget::Kind::drop; }
  double sign() const { return is_drop() ? -1.0 : 1.0; }

  /// Returns the least PSNR, or the largest drop, for a share of the allowed loss.
  double bound(double share) const {
    return is_drop() ? start_ + share * (target_.db - start_) : target_.db - 10.0 * std::log10(share);
  }

  adagscale::CalibrationTarget target_;
  int measured_models_ = 0;  // number of models measured so far
  double start_ = 0.0;       // drop of the model from which the steps start; negative if refit() improved it
  std::unique_ptr<adagscale::Calibrator> validation_,
      validation_own_;  // own: at the cameras' own size, or null
  std::unique_ptr<adagscale::Calibrator> test_, test_own_;
};

HarmonicsFit::Coefficients coefficients(const Model& model, std::size_t gaussian) {
  const auto count = static_cast<std::size_t>(sh_count(model.degree));
  HarmonicsFit::Coefficients now{};
  for (std::size_t k = 0; k < std::min(count, now.size()); ++k) {
    const float* c = &model.sh[3 * (gaussian * count + k)];
    now[k] = {c[0], c[1], c[2]};
  }
  return now;
}

/// Returns the model with these degrees, and with harmonics fitted to its colours in the training views.
Model nearest_of_degrees(const Model& whole, const Weights& weights,
                         const std::vector<std::uint8_t>& degrees) {
  Model model = with_degrees(whole, degrees);
  const auto count = static_cast<std::size_t>(sh_count(model.degree));
  parallel_for(
      degrees.size(),
      [&](std::size_t i) {
        if (degrees[i] >= whole.degree) return;
        const auto near = weights.colours[i].fitted(degrees[i], coefficients(whole, i));
        for (std::size_t k = 0; k < static_cast<std::size_t>(sh_count(degrees[i])); ++k) {
          for (int c = 0; c < 3; ++c)
            model.sh[3 * (i * count + k) + static_cast<std::size_t>(c)] = static_cast<float>(near[k][c]);
        }
      },
      gaussians_per_task);
  return model;
}

/// Returns how much each Gaussian's colours change at each degree below this one (HarmonicsFit::change).
std::vector<std::array<double, 3>> changes_below(int degree, const Model& whole, const Weights& weights) {
  std::vector<std::array<double, 3>> changes(whole.count());
  parallel_for(
      changes.size(),
      [&](std::size_t i) {
        for (int lower = 0; lower < degree; ++lower)
          changes[i][static_cast<std::size_t>(lower)] =
              weights.colours[i].change(lower, coefficients(whole, i));
      },
      gaussians_per_task);
  return changes;
}

class Trimmer {
 public:
  Trimmer(gl::Context& context, const Model& model, const ViewSplit& views, const TrimSettings& settings)
      : context_(context),
        views_(views),
        settings_(settings),
        original_(model),
        bound_(context, model, views, settings.target) {
    add_step("original", model, 0);
  }

  Trimmed run() {
    if (settings_.refit) {
      refitted_ = original_;
      found_.is_smaller = fit(*refitted_, {});
      bound_.start_from(*refitted_);
      add_step("colours fitted", *refitted_, 0);
    }
    const bool has_harmonics = whole().degree > 0;
    weights_ = weigh(context_, whole(), views_.training, views_.near_plane, has_harmonics);
    found_.unseen = weights_.unseen();
    model_ = whole();
    const std::string name = row_of(settings_.format).name;
    const bool packs = settings_.format == ModelFormat::spz;
    if (!holds(model_, 8, 1.0)) {
      found_.format_fits = false;
      add_written_step("as " + name);
    } else {
      if (packs && has_harmonics) lower_bits();
      add_written_step(packs && has_harmonics
                           ? fmt::format("as {}, {} bits a harmonic", name, found_.harmonic_bits)
                           : "as " + name);
      if (has_harmonics) lower_harmonics(packs);
      drop_gaussians();
    }
    found_.model = std::move(model_);
    return std::move(found_);
  }

 private:
  double cost(const Model& model, int bits) { return bound_.bounded_db(settings_.write(model, bits).model); }
  bool holds(const Model& model, int bits, double share) { return bound_.holds(cost(model, bits), share); }

  const Model& whole() const { return refitted_ ? *refitted_ : original_; }

  /// Fits colours; returns whether the model improved.
  bool fit(Model& model, const RefitSettings& settings) {
    const RefitTargets targets{original_, views_.training, *settings_.refit, views_.near_plane};
    Refitted found = refit(context_, model, targets, settings,
                           [this](const Model& fitting) { return bound_.loss(fitting); });
    model.sh = std::move(found.sh);
    return found.best_round > 0;
  }

  /// Returns the candidate with fitted colours, if refitting is requested and improves it.
  Model fitted(Model model) {
    if (settings_.refit) fit(model, {.rounds = trial_rounds, .keep_zeros = true});
    return model;
  }

  void lower_bits() {
    while (found_.harmonic_bits > 1 && holds(model_, found_.harmonic_bits - 1, after_bits))
      --found_.harmonic_bits;
    found_.is_smaller = found_.is_smaller || found_.harmonic_bits < 8;
  }

  Model lowered(const std::vector<std::uint8_t>& degrees) {
    return fitted(nearest_of_degrees(whole(), weights_, degrees));
  }

  void lower_harmonics(bool packs) {
    const std::size_t count = whole().count();
    for (int degree = 0; degree < whole().degree; ++degree) {
      Model lower = lowered(std::vector<std::uint8_t>(count, static_cast<std::uint8_t>(degree)));
      if (!holds(lower, found_.harmonic_bits, after_harmonics)) continue;
      model_ = std::move(lower);
      take(fmt::format("degree {} instead of {}", degree, whole().degree));
      break;
    }
    if (packs && model_.degree > 0 && holds(model_, found_.harmonic_bits, after_harmonics)) lower_degrees();
  }

  /// Chooses a degree for each Gaussian, since the format packs zeros well.
  void lower_degrees() {
    const std::vector<std::array<double, 3>> changes = changes_below(model_.degree, whole(), weights_);
    std::vector<double> positive;
    for (const auto& of : changes) {
      if (of[0] > 0.0) positive.push_back(of[0]);
    }
    if (positive.empty()) return;
    // The lowest degree of each Gaussian at which its colours change by at most `change`.
    const auto degrees = [&](double change) {
      std::vector<std::uint8_t> of(changes.size());
      for (std::size_t i = 0; i < of.size(); ++i) {
        while (of[i] < model_.degree && changes[i][of[i]] > change) ++of[i];
      }
      return of;
    };
    const double start = std::clamp(quantile(std::move(positive), 0.5), 1e-9, 1e9);
    const auto db = [&](double change) {
      return cost(change > 0.0 ? lowered(degrees(change)) : model_, found_.harmonic_bits);
    };
    const double change = bound_.largest_within(db, after_harmonics, {.start = start});
    if (change == 0.0) return;
    const std::vector<std::uint8_t> of = degrees(change);
    const auto lower = std::count_if(of.begin(), of.end(), [&](int d) { return d < model_.degree; });
    model_ = lowered(of);
    take(fmt::format("lower degrees for {:.0f} %",
                     100.0 * static_cast<double>(lower) / static_cast<double>(of.size())));
  }

  void drop_gaussians() {
    const std::size_t count = model_.count();
    if (count < 2) return;
    const std::vector<double> changes = changes_without(context_, model_, views_.training, views_.near_plane);
    std::vector<std::uint32_t> by_worth(count);
    std::iota(by_worth.begin(), by_worth.end(), 0u);
    std::stable_sort(by_worth.begin(), by_worth.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(changes[a], weights_.weight[a]) < std::pair(changes[b], weights_.weight[b]);
    });
    const auto without = [&](double amount) {
      if (amount < 1.0) return model_;
      std::vector<std::uint8_t> kept(count, 1);
      for (std::size_t k = 0; k < static_cast<std::size_t>(amount); ++k) kept[by_worth[k]] = 0;
      return fitted(with_gaussians(model_, kept));
    };
    std::map<std::size_t, double> known;  // cost by amount, because the search may repeat a rounded amount
    const auto db = [&](double amount) {
      const auto [at, is_new] = known.try_emplace(static_cast<std::size_t>(amount));
      if (is_new) at->second = cost(without(amount), found_.harmonic_bits);
      return at->second;
    };
    const auto most = static_cast<double>(count - 1);
    const double start = std::clamp(static_cast<double>(found_.unseen), 1.0, most);
    const double dropped = bound_.largest_within(db, 1.0, {.start = start, .smallest = 1.0, .largest = most});
    if (dropped == 0.0) return;
    model_ = without(dropped);
    take("fewer Gaussians");
  }

  void take(const std::string& name) {
    found_.is_smaller = true;
    add_written_step(name);
  }

  void add_written_step(const std::string& name) {
    const WrittenModel written = settings_.write(model_, found_.harmonic_bits);
    add_step(name, written.model, written.bytes);
  }

  void add_step(const std::string& name, const Model& model, std::uintmax_t bytes) {
    TrimStep& step =
        found_.steps.emplace_back(TrimStep{name, model.count(), model.degree, bytes, {}, {}, {}, {}});
    bound_.report(model, step);
    log_info("{}: {} Gaussians, {:.3f} dB{}", name, step.gaussians, step.validation.mean_db,
             step.validation_own
                 ? fmt::format(", {:.3f} dB in the cameras' own size", step.validation_own->mean_db)
                 : "");
  }

  gl::Context& context_;
  const ViewSplit& views_;
  const TrimSettings& settings_;
  const Model& original_;
  TrimBound bound_;
  std::optional<Model> refitted_;  // the original with fitted colours, if requested
  Model model_;                    // as trimmed so far
  Weights weights_;
  Trimmed found_;
};

}  // namespace

Trimmed trim(gl::Context& context, const Model& model, const ViewSplit& views, const TrimSettings& settings) {
  return Trimmer(context, model, views, settings).run();
}

}  // namespace binosplat::compact
