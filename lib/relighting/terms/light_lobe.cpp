// light.lobe: lamps at a finite distance that fade to the sides or have a cone, facing the scene's centre or beside it
// as in scene/edits/light_lobe.cpp. Forms (light/mechanisms/light_lobe.h): one for all lamps, where they are of one
// kind; each with its own axis; a cone with its axis for a single lamp; each its own.
#include "light/mechanisms/light_lobe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "light/turn.h"
#include "relighting/image_model.h"
#include "relighting/rough.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

using Lobe = std::array<double, mechanism::lobe_numbers>;

// What the rough residual says of lobes before any fit: squares left by the best brightness for every image and
// surface.
class LobeSearch {
 public:
  explicit LobeSearch(const Setting& s) : s_(s) {
    const RoughResidual rough = rough_residual(s);
    const std::size_t stride = 1 + rough.sights.size() / most_sights;
    for (std::size_t i = 0; i < rough.sights.size(); i += stride) look(rough.sights[i]);
  }

  // The best lobe of a lamp that fades about an axis near the centre, by a coarse grid; false where it leaves nearly as
  // much as none.
  bool best_fade(std::size_t lamp, Lobe& best) const {
    const double before = left({lamp}, {0, pi, 0.8, 0, 0});
    double least = before;
    for (const double exponent : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0})
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y) {
          const Lobe lobe{exponent, pi, 0.8, fade_tilt * x, fade_tilt * y};
          const double now = left({lamp}, lobe);
          if (now < least) least = now, best = lobe;
        }
    return least < worth * before;
  }

  // The best lobe of these lamps among a coarse grid of cones; false where it leaves nearly as much as none.
  bool best_cone(const std::vector<std::size_t>& lamps, bool aimed, Lobe& best) const {
    const double widest = widest_angle(lamps);
    if (!(widest > 0)) return false;
    const double before = left(lamps, {0, pi, 0.8, 0, 0});
    double least = before;
    for (const double outer : {0.4, 0.55, 0.7, 0.85, 1.0, 1.2, 1.5})
      for (const double inner : {0.1, 0.45, 0.75, 0.92})
        for (int x = aimed ? -2 : 0; x <= (aimed ? 2 : 0); ++x)
          for (int y = aimed ? -2 : 0; y <= (aimed ? 2 : 0); ++y) {
            const Lobe lobe{0, std::min(outer * widest, 1.5), inner, 0.3 * widest * x, 0.3 * widest * y};
            const double now = left(lamps, lobe);
            if (now < least) least = now, best = lobe;
          }
    if (!(least < worth * before)) return false;
    refine(lamps, aimed, widest, least, best);
    return true;
  }

 private:
  // Steps along the numbers of a cone, each half as long where none helps.
  void refine(const std::vector<std::size_t>& lamps, bool aimed, double widest, double least, Lobe& best) const {
    Lobe step{0, 0.15 * widest, 0.2, 0.15 * widest, 0.15 * widest};
    for (int halvings = 0; halvings < 5;) {
      bool better = false;
      for (std::size_t k = mechanism::lobe_outer; k < (aimed ? mechanism::lobe_numbers : mechanism::lobe_tilt_x); ++k)
        for (const double sign : {-1.0, 1.0}) {
          Lobe there = best;
          there[k] += sign * step[k];
          there[mechanism::lobe_outer] = std::clamp(there[mechanism::lobe_outer], 0.05, 1.5);
          there[mechanism::lobe_inner] = std::clamp(there[mechanism::lobe_inner], 0.02, 0.95);
          const double now = left(lamps, there);
          if (now < least) least = now, best = there, better = true;
        }
      if (better) continue;
      ++halvings;
      for (double& length : step) length *= 0.5;
    }
  }

  static constexpr std::size_t most_sights = 3000;
  static constexpr double worth = 0.95;
  static constexpr double fade_tilt = 0.15;  // rad
  struct Beam {                              // of one lamp at one sight
    std::size_t lamp;
    Vec3 away;  // from the lamp
    double share;
  };
  struct Look {
    std::size_t cell;  // image and surface
    double expected, ratio;
    std::vector<Beam> beams;
  };

  void look(const RoughResidual::Sight& sight) {
    const Recording& image = s_.recordings.images[sight.image];
    const ViewCache& cache = s_.model.cache(image.view);
    const Vec3 at_m = cache.patches[cache.facets[sight.facet].first_patch].position_m;
    Look now{sight.image * s_.layout.surfaces.size() + sight.surface,
             sight.expected,
             1 + std::clamp(sight.relative, -1.0, 1.0),
             {}};
    double sum = 0;
    for (const std::size_t l : image.lights) {
      const LightSource& light = s_.layout.lights[l];
      const double share = mean(s_.layout.start.lights[l].intensity) * s_.model.small_light(image.view, sight.facet, l);
      sum += share;
      now.beams.push_back({l, light.directional ? Vec3{} : normalized(at_m - light.position_m), share});
    }
    if (!(sum > 0)) return;
    for (Beam& b : now.beams) b.share /= sum;
    looks_.push_back(std::move(now));
  }

  Vec3 axis(std::size_t lamp, const Lobe& lobe) const {
    const Vec3 from = s_.layout.lights[lamp].position_m;
    return light::turned_with(normalized(s_.layout.centre_m - from), from, lobe[mechanism::lobe_tilt_x],
                              lobe[mechanism::lobe_tilt_y], s_.layout.centre_m);
  }

  // Within which nineteen in twenty sights lie.
  double widest_angle(const std::vector<std::size_t>& lamps) const {
    std::vector<double> angles;
    for (const Look& look : looks_)
      for (const Beam& b : look.beams)
        if (std::ranges::find(lamps, b.lamp) != lamps.end())
          angles.push_back(std::acos(std::clamp(dot(b.away, axis(b.lamp, {})), -1.0, 1.0)));
    if (angles.size() < 20) return 0;
    const auto at = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() * 19 / 20);
    std::nth_element(angles.begin(), at, angles.end());
    return *at;
  }

  double left(const std::vector<std::size_t>& lamps, const Lobe& lobe) const {
    std::vector<Vec3> axes(s_.layout.lights.size());
    std::vector<char> asked(s_.layout.lights.size(), 0);
    for (const std::size_t l : lamps) axes[l] = axis(l, lobe), asked[l] = 1;
    struct Fit {
      double yy = 0, yf = 0, ff = 0;
    };
    std::vector<Fit> cells(s_.recordings.images.size() * s_.layout.surfaces.size());
    for (const Look& look : looks_) {
      double f = 0;
      for (const Beam& b : look.beams)
        f += b.share * (asked[b.lamp] ? equation::light_lobe(dot(b.away, axes[b.lamp]), lobe) : 1);
      const double y = look.expected * look.ratio;
      f *= look.expected;
      Fit& cell = cells[look.cell];
      cell.yy += y * y, cell.yf += y * f, cell.ff += f * f;
    }
    double sum = 0;
    for (const Fit& cell : cells) sum += cell.yy - (cell.ff > 0 ? cell.yf * cell.yf / cell.ff : 0);
    return sum;
  }

  const Setting& s_;
  std::vector<Look> looks_;
};

void free_alone(Use& use, std::span<const mechanism::LobeNumber> form) {
  for (std::size_t i = 0; i < use.numbers.size(); ++i) {
    Number& n = use.numbers[i];
    n.free = std::ranges::find(form, i % mechanism::lobe_numbers) != form.end();
    if (!n.free) n.start = n.neutral;
  }
}

void begin(Use& use, std::size_t set, const Lobe& lobe) {
  for (std::size_t k = 0; k < mechanism::lobe_numbers; ++k) {
    Number& n = use.numbers[set * mechanism::lobe_numbers + k];
    if (n.free) n.start = std::clamp(lobe[k], n.lower, n.upper);
  }
}

Use of_lamp(const Use& all, std::size_t t, const Recordings& recordings) {
  Use use = target_use(*all.mechanism, {all.on[t]}, {all.targets[t]}, false);
  for (Number& n : use.numbers) n.groups = lit_by(recordings, all.targets[t]);
  return use;
}

// A ball shines all round: where there are points beside them, balls are not asked.
bool may_fade(const Setting& s, std::size_t light) {
  const auto small = [&](std::size_t l) {
    return !s.layout.lights[l].directional && !(s.layout.start.lights[l].radius_m > 0);
  };
  bool any_small = false;
  for (std::size_t l = 0; l < s.layout.lights.size(); ++l) any_small = any_small || small(l);
  return any_small ? small(light) : !s.layout.lights[light].directional;
}

std::vector<Use> candidates(const Setting& s) {
  const std::optional<Use> all = lamps_use(s, mechanism::light_lobe(), true, may_fade);
  if (!all) return {};
  std::vector<Use> uses{*all};
  free_alone(uses.back(), mechanism::fading_lobe);
  const LobeSearch search(s);
  Lobe lobe{};
  if (search.best_cone(all->targets, false, lobe)) {
    uses.push_back(*all);
    free_alone(uses.back(), mechanism::shaded_lobe);
    begin(uses.back(), 0, lobe);
  }
  Use each = target_use(*all->mechanism, all->on, all->targets, false);
  for (std::size_t i = 0; i < each.numbers.size(); ++i)
    each.numbers[i].groups = lit_by(s.recordings, all->targets[i / mechanism::lobe_numbers]);
  Use fading = each;
  free_alone(fading, mechanism::aimed_fade);
  std::size_t faded = 0;
  for (std::size_t t = 0; t < all->targets.size(); ++t) {
    if (!search.best_fade(all->targets[t], lobe)) continue;
    ++faded;
    begin(fading, t, lobe);
  }
  if (faded > 0) uses.push_back(std::move(fading));
  free_alone(each, mechanism::aimed_lobe);
  std::size_t coned = 0;
  for (std::size_t t = 0; t < all->targets.size(); ++t) {
    Use one = of_lamp(*all, t, s.recordings);
    free_alone(one, mechanism::aimed_lobe);
    if (!search.best_cone({all->targets[t]}, true, lobe)) continue;
    ++coned;
    begin(one, 0, lobe);
    begin(each, t, lobe);
    uses.push_back(std::move(one));
  }
  if (coned > 1 && coned == all->targets.size()) uses.push_back(std::move(each));
  for (Use& use : uses) use.family = all->mechanism->id;
  return uses;
}

}  // namespace

const Term& light_lobe() {
  static const Term term{
      .mechanism = mechanism::light_lobe,
      .reach = Reach::all,
      .candidates = candidates,
      .edit =
          [](const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
            for (std::size_t t = 0; t < use.targets.size(); ++t) {
              const std::span<const double> amounts = use.amounts(state, t);
              state.lights[use.targets[t]].lobe.assign(amounts.begin(), amounts.end());
            }
          },
  };
  return term;
}

}  // namespace gonio::relighting::terms
