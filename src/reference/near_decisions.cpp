#include "reference/near_decisions.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "reference/blend_pixel.h"
#include "shared/limits.h"

namespace binosplat::reference {

namespace {

/// An entry that a pixel visited.
struct Visit {
  std::uint32_t gaussian;
  double alpha;
  PixelSum before;
  Verdict verdict;
};

double largest_channel(const glm::dvec3& colour) {
  return std::max({std::abs(colour.r), std::abs(colour.g), std::abs(colour.b)});
}

/// Replaces `best` by this decision if it is the better explanation: within the band the larger change,
/// otherwise the closer decision.
void consider(NearDecision& best, double distance, const glm::dvec3& change, std::uint32_t gaussian,
              double band) {
  const NearDecision candidate{distance, largest_channel(change), gaussian};
  const bool better = distance < band ? best.distance >= band || candidate.change > best.change
                                      : best.distance >= band && distance < best.distance;
  if (better) best = candidate;
}

/// The change of the pixel if this Gaussian's alpha fell on the other side of tau: alpha T (c - C_behind).
/// C_behind is the colour behind the Gaussian as if T were 1 (docs/method.md 5).
glm::dvec3 change_by_alpha(const Visit& visit, const glm::dvec3& colour, const glm::dvec3& final_colour) {
  const double t = visit.before.transmittance;
  const glm::dvec3 own = visit.alpha * t * colour;
  const glm::dvec3 rest = final_colour - visit.before.colour;
  return visit.verdict == Verdict::skipped ? own - visit.alpha * rest
                                           : own - visit.alpha * (rest - own) / (1 - visit.alpha);
}

/// The change of the pixel if two neighbours swapped. If the farther one stopped the pixel, the nearer one
/// would stop it after the swap.
glm::dvec3 change_by_swap(const Visit& nearer, const glm::dvec3& nearer_colour, const Visit& farther,
                          const glm::dvec3& farther_colour) {
  const double t = nearer.before.transmittance;
  if (farther.verdict == Verdict::stopped)
    return t * (nearer.alpha * nearer_colour - farther.alpha * farther_colour);
  return t * nearer.alpha * farther.alpha * (nearer_colour - farther_colour);
}

/// Considers the first visible splat behind the splat that stopped the pixel. If their depths are nearly
/// equal, rounding may swap the two; the pixel then blends the farther one before it stops.
void consider_behind(NearDecision& best, const std::vector<Splat>& splats,
                     std::span<const std::uint32_t> list, const Visit& last, int x, int y) {
  const double limit = splats[last.gaussian].depth;
  auto next = std::find(list.begin(), list.end(), last.gaussian);
  for (++next; next != list.end(); ++next) {
    const Splat& splat = splats[*next];
    const double alpha = alpha_at(splat, x, y);
    if (alpha < ALPHA_MIN) continue;
    consider(best, (splat.depth - limit) / splat.depth, alpha * last.before.transmittance * splat.colour,
             *next, depth_band);
    return;
  }
}

}  // namespace

PixelTrace trace(const std::vector<Splat>& splats, std::span<const std::uint32_t> list, int x, int y) {
  std::vector<Visit> visits;
  const glm::dvec3 final_colour =
      blend_pixel(splats, list, {x, y}, {},
                  [&](std::uint32_t i, double alpha, const PixelSum& before, Verdict verdict) {
                    visits.push_back({i, alpha, before, verdict});
                  })
          .colour;

  PixelTrace result;
  const Visit* nearer = nullptr;
  for (const Visit& visit : visits) {
    const Splat& splat = splats[visit.gaussian];
    ++result.walked;
    result.visible += visit.verdict == Verdict::blended;
    if (visit.verdict != Verdict::stopped) {
      consider(result.alpha, std::abs(visit.alpha / ALPHA_MIN - 1),
               change_by_alpha(visit, splat.colour, final_colour), visit.gaussian, alpha_band);
    }
    if (visit.verdict == Verdict::skipped) continue;
    const double t = visit.before.transmittance;
    const glm::dvec3 by_stop = visit.verdict == Verdict::stopped ? visit.alpha * t * splat.colour
                                                                 : final_colour - visit.before.colour;
    consider(result.stop, std::abs(t * (1 - visit.alpha) / TRANSMITTANCE_MIN - 1), by_stop, visit.gaussian,
             stop_band);
    if (nearer != nullptr) {
      const Splat& before = splats[nearer->gaussian];
      consider(result.depth, (splat.depth - before.depth) / splat.depth,
               change_by_swap(*nearer, before.colour, visit, splat.colour), visit.gaussian, depth_band);
    }
    nearer = &visit;
  }
  if (!visits.empty() && visits.back().verdict == Verdict::stopped) {
    consider_behind(result.depth, splats, list, visits.back(), x, y);
  }
  return result;
}

double PixelTrace::largest_change() const {
  double largest = 0.0;
  if (alpha.distance < alpha_band) largest = std::max(largest, alpha.change);
  if (stop.distance < stop_band) largest = std::max(largest, stop.change);
  if (depth.distance < depth_band) largest = std::max(largest, depth.change);
  return largest;
}

std::string PixelTrace::explain() const {
  struct Kind {
    const char* what;
    const NearDecision* near;
    double band;
  };
  const Kind kinds[] = {{"alpha misses tau", &alpha, alpha_band},
                        {"T (1 - alpha) misses the early stop", &stop, stop_band},
                        {"two neighbours' depths differ", &depth, depth_band}};
  std::string others;
  for (const auto& [what, near, band] : kinds) {
    if (std::isinf(near->distance)) continue;
    std::string text = fmt::format("{} by a relative {:.1e} (Gaussian {}): the pixel changes by {:.2f}/255",
                                   what, near->distance, near->gaussian, 255.0 * near->change);
    if (near->distance < band && near->change == largest_change()) return text;
    others += "; " + text;
  }
  return "no decision is close enough for fp32 to change it" + others;
}

}  // namespace binosplat::reference
