#include "stream/level_sample.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/random.h"

namespace binosplat {

namespace {

// What parts lose together, over the sum of what each loses by itself: those that lie before and beside one
// another are wrong alike. 0.6 to 1.0 dB, in headset pictures of the city, from street and air, and of
// taebak.
const double together = std::pow(10.0, 0.08);
constexpr double fades = 0.9;      // what was found counts so much beside what is found next
constexpr double nothing = 1e-20;  // squared error of a picture
// A sample of some parts says at most so many times what is predicted of all, and at least one part of it:
// single parts are off by more.
constexpr double by_chance = 8.0;

}  // namespace

// By Efraimidis and Spirakis (2006): the largest of random numbers to the power of one over the weight. That
// is the root of what is lost: a sample's sum is mostly of those that lose much, and would be twice so with
// what is lost itself, while they lose 1.1 times what is predicted where others lose 0.6 (city, street).
std::vector<std::size_t> sample_of(const DetailChoice& choice, std::span<const std::size_t> levels,
                                   std::size_t most, unsigned seed) {
  Random random(seed);
  std::vector<std::pair<double, std::size_t>> keys;  // and parts
  for (std::size_t p = 0; p < levels.size(); ++p) {
    if (levels[p] == 0) continue;
    const double lost = choice.lost(0, p, levels[p]);
    keys.emplace_back(std::log(random.uniform(1e-12, 1.0)) / std::sqrt(std::max(lost, nothing)), p);
  }
  const std::size_t count = std::min(keys.size(), most);
  std::ranges::partial_sort(keys, keys.begin() + static_cast<std::ptrdiff_t>(count), std::greater<>());
  std::vector<std::size_t> parts;
  for (std::size_t k = 0; k < count; ++k) parts.push_back(keys[k].second);
  return parts;
}

void keep_what_fits(PartModels& others, const Model& model, const ModelParts& parts) {
  std::size_t taken = parts.gaussians() + parts.size() * ModelParts::block, kept = 0;  // half empty blocks
  for (; kept < others.parts.size(); ++kept) {
    taken += others.models[kept].count();
    if (taken > model.room) break;
  }
  others.parts.resize(kept);
  others.models.resize(kept);
}

PartModels exchange(const PartModels& others, Model& model, ModelParts& parts, const PartsTrial& trial) {
  PartModels before{others.parts, {}};
  std::vector<ModelParts::Replacement> replacements;
  for (std::size_t k = 0; k < others.parts.size(); ++k) {
    before.models.push_back(parts.part(model, others.parts[k]));
    replacements.push_back({others.parts[k], &others.models[k]});
  }
  parts.replace(model, replacements);
  trial.upload(parts.take_changes());
  return before;
}

SampleLoss loss_of(const DetailChoice& choice, double all, std::span<const std::size_t> levels,
                   std::span<const std::size_t> parts, double found) {
  SampleLoss loss{.found = found, .all = all, .parts = parts.size()};
  for (const std::size_t part : parts) loss.predicted += choice.lost(0, part, levels[part]);
  return loss;
}

void LevelsFound::note(const SampleLoss& loss) {
  if (!(loss.predicted > 0.0 && loss.all > 0.0)) return;
  const double left = 1.0 - std::min(loss.predicted / loss.all, 1.0), times = loss.found / loss.predicted;
  if (left < 0.01) {  // then nothing is up to chance
    parts_ = static_cast<double>(loss.parts);
    found_ = parts_ * times;
    return;
  }
  const double parts = static_cast<double>(loss.parts) / left;
  parts_ = fades * parts_ + parts;
  found_ = fades * found_ + parts * std::clamp(times * std::pow(together, left), 1.0 / by_chance, by_chance);
}

}  // namespace binosplat
