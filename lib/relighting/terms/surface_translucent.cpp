// surface.translucent: light of the lamps that falls on the far side of a sheet, and what has come into a hollow body
// through its wall, is sent on to the eye.
//   L = translucent albedo / pi [B + translucent albedo (G1 + r G2 + r^2 G3)],  r = (1 - translucent) albedo
// B the irradiance of the far side straight from a lamp, G1, G2, G3 that by way of one, two, three more places of this
// surface seen from the same far side, the last of which is lit from outside; counted once for unit albedos by paths
// that leave the far side. What else such paths meet stays dark, and what falls through the sheet onto other bodies is
// left out: their shadows are too dark by its share of them. The surface's own albedo becomes r, as for light between
// surfaces; it is divided out of what is sent through.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "relighting/image_model.h"
#include "relighting/surface_rule.h"
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& surface_translucent();
}

namespace gonio::relighting::terms {
namespace {

constexpr int walks = 24, longest_walk = 3;
constexpr std::uint64_t walk_seed = 77;

struct FarSide {
  float straight = 0;
  std::array<float, longest_walk> by_way{};  // of one, two, three places
};
struct FarSides final : Prepared {
  std::vector<std::vector<FarSide>> of;  // [view][facet * lamps + lamp]
};

double falls_on(const render::RayCaster& caster, const render::SurfacePoint& at, const LightSource& light) {
  Vec3 towards = light.direction;
  double distance_m = render::far_away, falloff = 1;
  if (!light.directional) {
    const Vec3 arm = light.position_m - at.position_m;
    distance_m = norm(arm);
    towards = arm / distance_m;
    falloff = 1 / (distance_m * distance_m);
  }
  const double cosine = dot(at.normal, towards);
  return cosine > 0 && !caster.occluded(at, towards, distance_m) ? cosine * falloff : 0;
}

// What is met a little before the surface is the surface itself; a point for rays that leave to its far side.
std::optional<render::SurfacePoint> far_side(const Setting& s, const Patch& patch) {
  const double before_m = 1e-3 * norm(patch.position_m - s.layout.centre_m) + 1e-5;
  const auto met = s.caster.closest(patch.position_m + patch.wo * before_m, -patch.wo);
  if (!met || met->distance_m > 3 * before_m) return std::nullopt;
  return render::beyond(*met);
}

void look_through(const Setting& s, const Facet& facet, std::uint64_t number, const render::SurfacePoint& far,
                  std::span<FarSide> lamps) {
  for (std::size_t l = 0; l < lamps.size(); ++l)
    lamps[l].straight = static_cast<float>(falls_on(s.caster, far, s.layout.lights[l]));
  Random random(walk_seed, number);
  for (int k = 0; k < walks; ++k) {
    render::SurfacePoint at = far;
    for (int step = 0; step < longest_walk; ++step) {
      const double u = (step == 0 ? k + random.uniform() : walks * random.uniform()) / walks, across = std::sqrt(u),
                   phi = 2 * pi * random.uniform();
      const Vec3 wi = Basis(at.normal).to_world({across * std::cos(phi), across * std::sin(phi), std::sqrt(1 - u)});
      if (!(dot(wi, at.geometric_normal) > 0)) break;
      const auto next = s.caster.closest_from(at, wi);
      if (!next || next->surface != facet.surface) break;
      const render::SurfacePoint lit = render::beyond(*next);
      for (std::size_t l = 0; l < lamps.size(); ++l)
        lamps[l].by_way[static_cast<std::size_t>(step)] +=
            static_cast<float>(falls_on(s.caster, lit, s.layout.lights[l]) / walks);
      at = *next;
    }
  }
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  auto result = std::make_shared<FarSides>();
  const std::size_t lamps = s.layout.lights.size();
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    std::vector<FarSide> sides(cache.facets.size() * lamps);
    parallel_for(
        0, cache.facets.size(),
        [&](std::size_t f) {
          const Facet& facet = cache.facets[f];
          if (facet.surface != use.targets[0]) return;
          if (const auto far = far_side(s, cache.patches[facet.first_patch]))
            look_through(s, facet, v << 32 | f, *far, std::span(sides).subspan(f * lamps, lamps));
        },
        64);
    result->of.push_back(std::move(sides));
  }
  return result;
}

// Does any of some facets get light on its far side? That of a table does not.
bool is_lit_beyond(const Setting& s, std::size_t surface) {
  constexpr std::size_t looks = 40;
  std::vector<FarSide> lamps(s.layout.lights.size());
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    std::vector<std::size_t> mine;
    for (std::size_t f = 0; f < cache.facets.size(); ++f)
      if (cache.facets[f].surface == surface) mine.push_back(f);
    for (std::size_t i = 0; i < mine.size(); i += 1 + mine.size() / looks)
      if (const auto far = far_side(s, cache.patches[cache.facets[mine[i]].first_patch]))
        look_through(s, cache.facets[mine[i]], mine[i], *far, lamps);
  }
  return std::ranges::any_of(lamps, [](const FarSide& lamp) { return lamp.straight > 0 || lamp.by_way[0] > 0; });
}

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses;
  const mechanism::Mechanism& m = mechanism::surface_translucent();
  for (std::size_t k = 0; k < s.layout.surfaces.size(); ++k) {
    if (!has_parameter(*s.layout.start.surfaces[k].model, "albedo") ||
        switched_on(s.document, m.id, s.layout.surfaces[k]) || !is_lit_beyond(s, k))
      continue;
    uses.push_back(target_use(m, {s.layout.surfaces[k]}, {k}, false));
  }
  return uses;
}

void edit(const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
  SurfaceState& surface = state.surfaces[use.targets[0]];
  Rgb& albedo = surface.values.v[parameter_index(*surface.model, "albedo")];
  albedo = albedo * (1 - use.amounts(state)[0]);
}

void shade(const Use& use, const Frame& frame, Shading& shading) {
  const double through = use.amounts(frame.state)[0], kept = 1 - through;
  const SurfaceState& surface = frame.state.surfaces[use.targets[0]];
  const Rgb reflected = surface.values.rgb(parameter_index(*surface.model, "albedo"));
  const std::vector<FarSide>& sides = static_cast<const FarSides&>(*use.prepared).of[frame.image.view];
  const std::size_t lamps = frame.model.layout().lights.size();
  std::size_t slot = 0;
  for (const std::uint32_t p : frame.picked)
    for (std::size_t k = 0; k < frame.cache.pixels[p].facets; ++k, ++slot) {
      const std::size_t f = frame.cache.pixels[p].first_facet + k;
      const Facet& facet = frame.cache.facets[f];
      if (facet.surface != use.targets[0]) continue;
      const Rgb r = reflected * facet.tint;
      for (std::size_t j = 0; j < shading.lights; ++j) {
        const FarSide& far = sides[f * lamps + frame.image.lights[j]];
        const Rgb within = (r * (r * double{far.by_way[2]} + Rgb{1, 1, 1} * double{far.by_way[1]}) +
                            Rgb{1, 1, 1} * double{far.by_way[0]}) *
                           r * (through / kept);
        const Rgb falls = within + Rgb{1, 1, 1} * double{far.straight};
        shading.direct[slot * shading.lights + j].base += falls * (through / kept * facet.weight / pi);
      }
    }
}

}  // namespace

const Term& surface_translucent() {
  static const Term term{
      .mechanism = mechanism::surface_translucent,
      .reach = Reach::all,
      .order = 5,
      .candidates = candidates,
      .prepare = prepare,
      .edit = edit,
      .shade = shade,
  };
  return term;
}

}  // namespace gonio::relighting::terms
