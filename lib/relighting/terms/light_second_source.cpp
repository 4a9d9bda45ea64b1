// light.second-source: a light of unknown direction, far away or at a distance that is sought. Whether it reaches a
// facet is cast once for a grid of directions over the sphere, and densely about the place that the search starts from,
// and interpolated; cosines and falloff are exact. Its light by way of surfaces is left out. The search starts from the
// place whose light the rough residual holds most of.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "light/mechanisms/light_inverse_square.h"
#include "relighting/image_model.h"
#include "relighting/lamp_shadows.h"
#include "relighting/rough.h"
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_second_source();
}

namespace gonio::relighting::terms {
namespace {

constexpr std::size_t azimuths = 24, elevations = 9;  // elevation -20 to 90 degrees: what stands on a table
constexpr double lowest = -0.35;
double elevation_of(std::size_t e) {
  return lowest + (pi / 2 - lowest) * static_cast<double>(e) / (elevations - 1);
}
double azimuth_of(std::size_t a) {
  return 2 * pi * static_cast<double>(a) / azimuths;
}
Vec3 direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

// Where the second lamp is as seen from a point, and its irradiance over that in the middle.
struct Second {
  Vec3 to_lamp;
  double falloff;
};
Second seen_from(std::span<const double> amounts, Vec3 centre_m, Vec3 at_m) {
  const Vec3 arm = equation::light_inverse_square_arm(amounts[3], direction(amounts[1], amounts[2]), at_m - centre_m);
  return {normalized(arm), equation::light_inverse_square(arm)};
}

Vec3 off_surface(const Setting& s, const Patch& patch) {
  return patch.position_m + patch.normal * (1e-4 * norm(patch.position_m - s.layout.centre_m) + 1e-6);
}

using Everywhere = std::vector<std::vector<std::uint8_t>>;  // [view][facet][elevation][azimuth]

struct Openness final : Prepared {
  std::shared_ptr<const Everywhere> everywhere;
  std::vector<std::vector<std::uint8_t>> about;  // [view][facet][node]: relighting/lamp_shadows.h
  std::vector<double> amounts;                   // about which
};

std::shared_ptr<const Everywhere> cast_everywhere(const Setting& s) {
  auto result = std::make_shared<Everywhere>();
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    result->emplace_back(cache.facets.size() * elevations * azimuths);
    parallel_for(
        0, cache.facets.size(),
        [&](std::size_t f) {
          const Patch& patch = cache.patches[cache.facets[f].first_patch];
          const Vec3 from = off_surface(s, patch);
          for (std::size_t e = 0; e < elevations; ++e)
            for (std::size_t a = 0; a < azimuths; ++a) {
              const Vec3 d = direction(azimuth_of(a), elevation_of(e));
              (*result)[v][(f * elevations + e) * azimuths + a] =
                  dot(d, patch.normal) > -0.2 && !s.caster.blocked(from, d);
            }
        },
        32);
  }
  return result;
}

std::shared_ptr<const Openness> cast_about(const Setting& s, std::shared_ptr<const Everywhere> everywhere,
                                           std::vector<double> amounts) {
  auto result = std::make_shared<Openness>();
  result->everywhere = std::move(everywhere);
  result->amounts = std::move(amounts);
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    std::vector<std::vector<std::uint8_t>> nodes(cache.facets.size());
    parallel_for(
        0, cache.facets.size(),
        [&](std::size_t f) {
          const Patch& patch = cache.patches[cache.facets[f].first_patch];
          const Vec3 from = off_surface(s, patch);
          const Vec3 towards = seen_from(result->amounts, s.layout.centre_m, patch.position_m).to_lamp;
          cast_shadows_about(
              towards, patch.normal, [&](Vec3 d) { return !s.caster.blocked(from, d); }, nodes[f]);
        },
        32);
    result->about.emplace_back();
    for (const auto& of_facet : nodes)
      result->about.back().insert(result->about.back().end(), of_facet.begin(), of_facet.end());
  }
  return result;
}

double coarse_openness(const std::uint8_t* grid, Vec3 towards) {
  const double elevation = std::asin(std::clamp(towards.z, -1.0, 1.0)), azimuth = std::atan2(towards.y, towards.x);
  const double e = std::clamp((elevation - lowest) / (pi / 2 - lowest), 0.0, 1.0) * (elevations - 1);
  double turns = azimuth / (2 * pi);
  turns -= std::floor(turns);
  const double a = turns * azimuths;
  const auto e0 = std::min(static_cast<std::size_t>(e), elevations - 2), a0 = static_cast<std::size_t>(a) % azimuths;
  const std::size_t a1 = (a0 + 1) % azimuths;
  const double te = e - static_cast<double>(e0), ta = a - std::floor(a);
  return (1 - te) * ((1 - ta) * grid[e0 * azimuths + a0] + ta * grid[e0 * azimuths + a1]) +
         te * ((1 - ta) * grid[(e0 + 1) * azimuths + a0] + ta * grid[(e0 + 1) * azimuths + a1]);
}

double openness(const Openness& table, std::size_t view, std::size_t facet, Vec3 given, Vec3 now) {
  if (const auto close = openness_within(&table.about[view][facet * shadow_nodes], given, now)) return *close;
  return coarse_openness(&(*table.everywhere)[view][facet * elevations * azimuths], now);
}

// Covariance of the residual with a lamp's light over that light's spread, both about their means per image.
class SecondSearch {
 public:
  SecondSearch(const Setting& s, const Everywhere& everywhere)
      : s_(s), everywhere_(everywhere), rough_(rough_residual(s)) {}

  double score(std::span<const double> amounts) const {
    std::vector<Sums> sums(s_.recordings.images.size());
    for (const RoughResidual::Sight& sight : rough_.sights) {
      const std::size_t v = s_.recordings.images[sight.image].view;
      const ViewCache& cache = s_.model.cache(v);
      const Patch& patch = cache.patches[cache.facets[sight.facet].first_patch];
      const Second second = seen_from(amounts, s_.layout.centre_m, patch.position_m);
      const double cosine = dot(patch.normal, second.to_lamp);
      const double light =
          cosine > 0 ? cosine * second.falloff *
                           coarse_openness(&everywhere_[v][sight.facet * elevations * azimuths], second.to_lamp)
                     : 0;
      const double residual = std::clamp(sight.relative, -1.0, 1.0) * sight.expected;
      Sums& at = sums[sight.image];
      at.n += 1, at.r += residual, at.s += light, at.rs += residual * light, at.ss += light * light;
    }
    double covariance = 0, spread = 0;
    for (const Sums& at : sums)
      if (at.n > 0) covariance += at.rs - at.r * at.s / at.n, spread += at.ss - at.s * at.s / at.n;
    return spread > 0 ? covariance / std::sqrt(spread) : 0;
  }

  // The best place among a grid of directions, at any of these distances.
  std::vector<double> best(std::span<const double> nearness_per_m) const {
    std::vector<double> best{0, 0, 0.8, nearness_per_m[0]};
    double most = 0;
    for (const double near : nearness_per_m)
      for (std::size_t e = 1; e < elevations; ++e)
        for (std::size_t a = 0; a < (e + 1 == elevations ? 1 : azimuths); ++a) {
          const std::vector<double> amounts{0, azimuth_of(a), elevation_of(e), near};
          const double here = score(amounts);
          if (here > most) most = here, best = amounts;
        }
    return best;
  }

 private:
  struct Sums {
    double n = 0, r = 0, s = 0, rs = 0, ss = 0;
  };
  const Setting& s_;
  const Everywhere& everywhere_;
  RoughResidual rough_;
};

// Of the lamps that the base model has: the largest irradiance in the middle, and how far they stand.
struct KnownLamps {
  double level = 0, distance_m = 0;
};
KnownLamps known_lamps(const Setting& s) {
  KnownLamps known;
  double near = 0;
  for (std::size_t l = 0; l < s.layout.lights.size(); ++l) {
    const LightSource& light = s.layout.lights[l];
    const Vec3 arm = light.position_m - s.layout.centre_m;
    const double square = light.directional ? 1 : std::max(1e-9, dot(arm, arm));
    known.level = std::max(known.level, mean(s.layout.start.lights[l].intensity) / square);
    if (!light.directional) known.distance_m += std::sqrt(square), near += 1;
  }
  if (near > 0) known.distance_m /= near;
  return known;
}

Use begun(const Setting& s, std::shared_ptr<const Everywhere> everywhere, const std::vector<double>& amounts,
          double level) {
  Use use = scene_use(mechanism::light_second_source());
  for (std::size_t k = 1; k < use.numbers.size(); ++k)
    use.numbers[k].start = use.numbers[k].neutral = amounts[k];  // without light no place counts
  use.numbers[0].start = 0.02 * level;
  use.numbers[0].upper = 10 * level;
  use.numbers[1].lower = amounts[1] - 1.6;
  use.numbers[1].upper = amounts[1] + 1.6;
  use.numbers[2].lower = lowest;
  if (amounts[3] == 0) use.numbers[3].free = false;
  use.numbers[3].upper = std::max(use.numbers[3].lower, 3 * amounts[3]);
  use.family = use.mechanism->id;
  use.prepared = cast_about(s, std::move(everywhere), amounts);
  return use;
}

// A lamp without end, and one that stands about as near as those that are known.
std::vector<Use> candidates(const Setting& s) {
  if (switched_on(s.document, mechanism::light_second_source().id)) return {};
  const auto everywhere = cast_everywhere(s);
  const SecondSearch search(s, *everywhere);
  const KnownLamps known = known_lamps(s);
  const double far[] = {0};
  std::vector<Use> uses{begun(s, everywhere, search.best(far), known.level)};
  if (known.distance_m > 0) {
    const double near[] = {0.7 / known.distance_m, 1.3 / known.distance_m};
    uses.push_back(begun(s, everywhere, search.best(near), known.level));
  }
  return uses;
}

void add(const Use& use, const Frame& frame, std::span<double> radiance) {
  const std::span<const double> amounts = use.amounts(frame.state);
  const auto& table = static_cast<const Openness&>(*use.prepared);
  const Vec3 centre_m = frame.model.layout().centre_m;
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Pixel& pixel = frame.cache.pixels[frame.picked[i]];
    Rgb sum;
    for (std::size_t k = 0; k < pixel.facets; ++k) {
      const std::size_t f = pixel.first_facet + k;
      const Facet& facet = frame.cache.facets[f];
      const SurfaceState& surface = frame.state.surfaces[facet.surface];
      const Vec3 at_m = frame.cache.patches[facet.first_patch].position_m;
      const Second middle = seen_from(amounts, centre_m, at_m);
      const double open =
          openness(table, frame.image.view, f, seen_from(table.amounts, centre_m, at_m).to_lamp, middle.to_lamp);
      for (std::size_t p = facet.first_patch; open > 0 && p < facet.first_patch + facet.patches; ++p) {
        const Patch& patch = frame.cache.patches[p];
        const Second second = seen_from(amounts, centre_m, patch.position_m);
        const double cosine = dot(patch.normal, second.to_lamp);
        if (cosine > 0)
          sum += sent_back(surface, facet, patch, second.to_lamp) * (patch.weight * cosine * second.falloff * open);
      }
    }
    sum *= exposure_of(frame.state, frame.image, frame.number, pixel) * amounts[0];
    for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] += sum[static_cast<int>(c)];
  }
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  if (use.prepared && !s.fitted) return use.prepared;
  std::vector<double> about;
  for (std::size_t k = 0; k < use.numbers.size(); ++k)
    about.push_back(s.fitted ? use.amounts(*s.fitted)[k] : use.numbers[k].start);
  return cast_about(s, cast_everywhere(s), std::move(about));
}

}  // namespace

const Term& light_second_source() {
  static const Term term{
      .mechanism = mechanism::light_second_source,
      .reach = Reach::add,
      .order = -10,
      .candidates = candidates,
      .prepare = prepare,
      .add = add,
  };
  return term;
}

}  // namespace gonio::relighting::terms
