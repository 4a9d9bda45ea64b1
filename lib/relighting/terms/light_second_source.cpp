// light.second-source: a distant light of unknown direction. Whether it reaches a facet is cast once for a grid of
// directions over the sphere and interpolated between them; cosines are exact. Matte light only: its highlights and its
// light by way of surfaces are left out. The search starts from the direction whose light the rough residual holds most
// of.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "relighting/image_model.h"
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

struct Openness final : Prepared {
  std::vector<std::vector<std::uint8_t>> open;  // [view][facet][elevation][azimuth]
};

std::shared_ptr<const Openness> cast(const Setting& s) {
  auto result = std::make_shared<Openness>();
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    result->open.emplace_back(cache.facets.size() * elevations * azimuths);
    parallel_for(
        0, cache.facets.size(),
        [&](std::size_t f) {
          const Patch& patch = cache.patches[cache.facets[f].first_patch];
          const Vec3 from =
              patch.position_m + patch.normal * (1e-4 * norm(patch.position_m - s.layout.centre_m) + 1e-6);
          for (std::size_t e = 0; e < elevations; ++e)
            for (std::size_t a = 0; a < azimuths; ++a) {
              const Vec3 d = direction(azimuth_of(a), elevation_of(e));
              result->open[v][(f * elevations + e) * azimuths + a] =
                  dot(d, patch.normal) > -0.2 && !s.caster.blocked(from, d);
            }
        },
        32);
  }
  return result;
}

double openness(const std::uint8_t* grid, double azimuth, double elevation) {
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

// Covariance of the residual with a direction's light over that light's spread, both about their means per image.
struct Sums {
  double n = 0, r = 0, s = 0, rs = 0, ss = 0;
};

std::vector<Use> candidates(const Setting& s) {
  if (switched_on(s.document, mechanism::light_second_source().id)) return {};
  const auto table = cast(s);
  const RoughResidual rough = rough_residual(s);
  double best = 0;
  Use use = scene_use(mechanism::light_second_source());
  for (std::size_t e = 1; e < elevations; ++e)
    for (std::size_t a = 0; a < (e + 1 == elevations ? 1 : azimuths); ++a) {
      const Vec3 d = direction(azimuth_of(a), elevation_of(e));
      std::vector<Sums> sums(s.recordings.images.size());
      for (const RoughResidual::Sight& sight : rough.sights) {
        const std::size_t v = s.recordings.images[sight.image].view;
        const ViewCache& cache = s.model.cache(v);
        const double light = std::max(0.0, dot(cache.patches[cache.facets[sight.facet].first_patch].normal, d)) *
                             table->open[v][(sight.facet * elevations + e) * azimuths + a];
        const double residual = std::clamp(sight.relative, -1.0, 1.0) * sight.expected;
        Sums& at = sums[sight.image];
        at.n += 1, at.r += residual, at.s += light, at.rs += residual * light, at.ss += light * light;
      }
      double covariance = 0, spread = 0;
      for (const Sums& at : sums)
        if (at.n > 0) covariance += at.rs - at.r * at.s / at.n, spread += at.ss - at.s * at.s / at.n;
      if (spread > 0 && covariance / std::sqrt(spread) > best) {
        best = covariance / std::sqrt(spread);
        use.numbers[1].start = azimuth_of(a);
        use.numbers[2].start = elevation_of(e);
      }
    }
  double level = 0;
  for (std::size_t l = 0; l < s.layout.lights.size(); ++l) {  // irradiance by a lamp in the scene's middle
    const Vec3 arm = s.layout.lights[l].position_m - s.layout.centre_m;
    level = std::max(level, mean(s.layout.start.lights[l].intensity) /
                                (s.layout.lights[l].directional ? 1 : std::max(1e-9, dot(arm, arm))));
  }
  use.numbers[0].start = 0.02 * level;
  use.numbers[0].upper = 10 * level;
  use.numbers[1].neutral = use.numbers[1].start;  // without light no direction counts
  use.numbers[2].neutral = use.numbers[2].start;
  use.numbers[2].lower = lowest;
  use.numbers[1].lower = use.numbers[1].start - 1.6;
  use.numbers[1].upper = use.numbers[1].start + 1.6;
  use.prepared = table;
  return {use};
}

void add(const Use& use, const Frame& frame, std::span<double> radiance) {
  const std::span<const double> amounts = use.amounts(frame.state);
  const auto& table = static_cast<const Openness&>(*use.prepared).open[frame.image.view];
  const Vec3 d = direction(amounts[1], amounts[2]);
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Pixel& pixel = frame.cache.pixels[frame.picked[i]];
    Rgb sum;
    for (std::size_t k = 0; k < pixel.facets; ++k) {
      const std::size_t f = pixel.first_facet + k;
      const Facet& facet = frame.cache.facets[f];
      const double cosine = dot(frame.cache.patches[facet.first_patch].normal, d);
      if (cosine <= 0) continue;
      const SurfaceState& surface = frame.state.surfaces[facet.surface];
      const double open = openness(&table[f * elevations * azimuths], amounts[1], amounts[2]);
      sum += surface.model->albedo(surface.values, {0, 0, 1}) * (facet.weight * cosine * open / pi);
    }
    sum *= exposure_of(frame.state, frame.image, frame.number, pixel) * amounts[0];
    for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] += sum[static_cast<int>(c)];
  }
}

}  // namespace

const Term& light_second_source() {
  static const Term term{
      .mechanism = mechanism::light_second_source,
      .reach = Reach::add,
      .order = -10,
      .candidates = candidates,
      .prepare = [](const Setting& s, const Use& use) -> std::shared_ptr<const Prepared> {
        return use.prepared && !s.fitted ? use.prepared : cast(s);
      },
      .add = add,
  };
  return term;
}

}  // namespace gonio::relighting::terms
