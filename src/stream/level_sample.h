#pragma once
// What levels of detail truly lose, by a sample of parts: what is predicted is known of each part by itself,
// and in the mean of a scene, but not of what a view shows of it.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "scene/model.h"
#include "scene/model_parts.h"
#include "stream/detail.h"

namespace binosplat {

/// Parts of a sample that is tried out between frames of a head that rests: what they have time for.
inline constexpr std::size_t sample_of_rest = 24;

/// So many parts, or fewer, that are not at their finest level, each as likely as the root of what the first
/// view is predicted to lose by it is large; those that are predicted to lose nothing come last, since that
/// may be wrong, too. The same seed draws the same parts.
std::vector<std::size_t> sample_of(const DetailChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed);

/// What a sample of parts loses in a view: squared, meaned over pixels and channels.
struct SampleLoss {
  double predicted = 0.0, found = 0.0;
  double all = 0.0;       // that all parts are predicted to lose
  std::size_t parts = 0;  // of the sample
};

/// The Gaussians of some parts, each another one.
struct PartModels {
  std::vector<std::size_t> parts;
  std::vector<Model> models;
};

/// Leaves out what a model's `room` may be too small for.
void keep_what_fits(PartModels& others, const Model& model, const ModelParts& parts);

/// Puts others in the place of parts of a model, uploads that, and returns those that were there.
PartModels exchange(const PartModels& others, Model& model, ModelParts& parts, const PartsTrial& trial);

/// The loss of parts at `levels` that the first view of a choice, which loses `all`, was found to lose so
/// much by.
SampleLoss loss_of(const DetailChoice& choice, double all, std::span<const std::size_t> levels,
                   std::span<const std::size_t> parts, double found);

/// How many times what is predicted levels are found to lose: what was found first counts less and less, and
/// nothing once all that is lost was in a sample.
class LevelsFound {
 public:
  void note(const SampleLoss& loss);
  double factor() const { return found_ / parts_; }
  /// The same, but levels that seem to lose nothing are not made as coarse as that allows: a sample of other
  /// parts would find them wrong.
  double to_choose_by() const { return std::max(factor(), 1.0 / 8.0); }

 private:
  static constexpr double prior = 8.0;  // parts of which nothing is known but what is predicted

  double parts_ = prior, found_ = prior;  // and times what is predicted, with what was found before
};

}  // namespace binosplat
