// light.reflector: a card beside one lamp, in the pictures that the lamp is on in. Shadows about the place that the
// search starts from: relighting/lamp_shadows.h. The card's light by way of surfaces is left out.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "relighting/image_model.h"
#include "relighting/lamp_shadows.h"
#include "relighting/rough.h"
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_reflector();
}

namespace gonio::relighting::terms {
namespace {

constexpr double least_correlation = 0.1;  // of the rough residual with the card's light: below it nothing is asked

// A card as seen from a point: where, and max(0, c.(-l)) / r^2.
struct Card {
  Vec3 place_m, facing;  // facing: unit, to the lamp
  Card(Vec3 lamp_m, std::span<const double> amounts) {
    const Vec3 offset{amounts[1], amounts[2], amounts[3]};
    place_m = lamp_m + offset;
    facing = normalized(offset * -1.0);
  }
  Vec3 towards(Vec3 at_m) const { return normalized(place_m - at_m); }
  double falloff(Vec3 at_m) const {
    const Vec3 arm = place_m - at_m;
    const double square = dot(arm, arm);
    return std::max(0.0, -dot(facing, arm)) / (square * std::sqrt(square));
  }
};

struct CardShadows final : Prepared {
  std::vector<double> amounts;
  std::vector<std::vector<std::uint8_t>> nodes;  // [view][facet][node]
};

std::shared_ptr<const CardShadows> cast_cards(const Setting& s, std::size_t lamp, std::vector<double> amounts) {
  auto result = std::make_shared<CardShadows>();
  result->amounts = std::move(amounts);
  const Card card(s.layout.lights[lamp].position_m, result->amounts);
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    std::vector<std::vector<std::uint8_t>> nodes(cache.facets.size());
    parallel_for(
        0, cache.facets.size(),
        [&](std::size_t f) {
          const Patch& patch = cache.patches[cache.facets[f].first_patch];
          const double distance_m = norm(card.place_m - patch.position_m);
          const Vec3 from = patch.position_m + patch.normal * (1e-4 * distance_m + 1e-6);
          cast_shadows_about(
              card.towards(patch.position_m), patch.normal,
              [&](Vec3 d) { return !s.caster.blocked(from, d, distance_m); }, nodes[f]);
        },
        32);
    result->nodes.emplace_back();
    for (const auto& of_facet : nodes)
      result->nodes.back().insert(result->nodes.back().end(), of_facet.begin(), of_facet.end());
  }
  return result;
}

// Correlation of the rough residual with a card's light where the lamp itself arrives, about their means per image.
double card_correlation(const Setting& s, const RoughResidual& rough, std::size_t lamp, const Card& card) {
  struct Sums {
    double n = 0, r = 0, c = 0, rr = 0, rc = 0, cc = 0;
  };
  std::vector<Sums> sums(s.recordings.images.size());
  for (const RoughResidual::Sight& sight : rough.sights) {
    const Recording& image = s.recordings.images[sight.image];
    if (std::ranges::find(image.lights, lamp) == image.lights.end()) continue;
    const ViewCache& cache = s.model.cache(image.view);
    const Patch& patch = cache.patches[cache.facets[sight.facet].first_patch];
    const double light =
        std::max(0.0, dot(patch.normal, card.towards(patch.position_m))) * card.falloff(patch.position_m);
    const double residual = std::clamp(sight.relative, -1.0, 1.0) * sight.expected;
    Sums& at = sums[sight.image];
    at.n += 1, at.r += residual, at.c += light;
    at.rr += residual * residual, at.rc += residual * light, at.cc += light * light;
  }
  double rr = 0, rc = 0, cc = 0;
  for (const Sums& at : sums)
    if (at.n > 0) rr += at.rr - at.r * at.r / at.n, rc += at.rc - at.r * at.c / at.n, cc += at.cc - at.c * at.c / at.n;
  return rr > 0 && cc > 0 ? rc / std::sqrt(rr * cc) : 0;
}

std::vector<Use> candidates(const Setting& s) {
  const std::optional<Use> all =
      lamps_use(s, mechanism::light_reflector(), false,
                [](const Setting& here, std::size_t light) { return !here.layout.lights[light].directional; });
  if (!all) return {};
  const RoughResidual rough = rough_residual(s);
  std::vector<Use> uses;
  for (std::size_t t = 0; t < all->targets.size(); ++t) {
    const std::size_t lamp = all->targets[t];
    const Vec3 lamp_m = s.layout.lights[lamp].position_m;
    std::vector<double> best;
    double most = least_correlation;
    for (const double distance_m : {0.1, 0.25})
      for (int e = -2; e <= 2; ++e)
        for (int a = 0; a < (std::abs(e) == 2 ? 1 : 8); ++a) {
          const double elevation = 0.25 * pi * e, azimuth = 0.25 * pi * a;
          const std::vector<double> amounts{0, distance_m * std::cos(elevation) * std::cos(azimuth),
                                            distance_m * std::cos(elevation) * std::sin(azimuth),
                                            distance_m * std::sin(elevation)};
          const double here = card_correlation(s, rough, lamp, Card(lamp_m, amounts));
          if (here > most) most = here, best = amounts;
        }
    if (best.empty()) continue;
    Use use = target_use(*all->mechanism, {all->on[t]}, {lamp}, false);
    for (std::size_t k = 0; k < use.numbers.size(); ++k) {
      Number& n = use.numbers[k];
      n.groups = lit_by(s.recordings, lamp);
      if (k > 0) n.start = n.neutral = best[k], n.lower = best[k] - 0.4, n.upper = best[k] + 0.4;
    }
    use.family = use.mechanism->id;
    use.prepared = cast_cards(s, lamp, best);
    uses.push_back(std::move(use));
  }
  return uses;
}

void add(const Use& use, const Frame& frame, std::span<double> radiance) {
  const std::size_t lamp = use.targets[0];
  if (std::ranges::find(frame.image.lights, lamp) == frame.image.lights.end()) return;
  const std::span<const double> amounts = use.amounts(frame.state);
  const auto& table = static_cast<const CardShadows&>(*use.prepared);
  const Vec3 lamp_m = frame.model.layout().lights[lamp].position_m;
  const Card card(lamp_m, amounts), cast(lamp_m, table.amounts);
  const Rgb intensity = frame.state.lights[lamp].intensity * amounts[0];
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Pixel& pixel = frame.cache.pixels[frame.picked[i]];
    Rgb sum;
    for (std::size_t k = 0; k < pixel.facets; ++k) {
      const std::size_t f = pixel.first_facet + k;
      const Facet& facet = frame.cache.facets[f];
      const Vec3 at_m = frame.cache.patches[facet.first_patch].position_m;
      const double open =
          openness_or_last(&table.nodes[frame.image.view][f * shadow_nodes], cast.towards(at_m), card.towards(at_m));
      for (std::size_t p = facet.first_patch; open > 0 && p < facet.first_patch + facet.patches; ++p) {
        const Patch& patch = frame.cache.patches[p];
        const Vec3 to_card = card.towards(patch.position_m);
        const double cosine = dot(patch.normal, to_card);
        if (cosine > 0)
          sum += sent_back(frame.state.surfaces[facet.surface], facet, patch, to_card) *
                 (patch.weight * cosine * card.falloff(patch.position_m) * open);
      }
    }
    sum = sum * intensity * exposure_of(frame.state, frame.image, frame.number, pixel);
    for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] += sum[static_cast<int>(c)];
  }
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  if (use.prepared && !s.fitted) return use.prepared;
  std::vector<double> about;
  for (std::size_t k = 0; k < use.numbers.size(); ++k)
    about.push_back(s.fitted ? use.amounts(*s.fitted)[k] : use.numbers[k].start);
  return cast_cards(s, use.targets[0], std::move(about));
}

}  // namespace

const Term& light_reflector() {
  static const Term term{
      .mechanism = mechanism::light_reflector,
      .reach = Reach::add,
      .order = -11,
      .candidates = candidates,
      .prepare = prepare,
      .add = add,
  };
  return term;
}

}  // namespace gonio::relighting::terms
