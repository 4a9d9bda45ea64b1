// See world.h: from a spec to a case.
#include "sealed/world.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "base/text.h"
#include "sealed/surviving.h"

namespace gonio::sealed {
namespace {

// Length of an effect that a chi-square test with k degrees of freedom at 1 % finds with a power of 80 %: Wilson &
// Hilferty's cube root for the quantile, and the normal law of the noncentral variable (Patnaik 1949).
double limit_of(double k) {
  const double quantile = k * std::pow(1 - 2 / (9 * k) + 2.326 * std::sqrt(2 / (9 * k)), 3);
  double noncentral = quantile - k;
  for (int step = 0; step < 30; ++step) noncentral = quantile - k + 0.842 * std::sqrt(2 * (k + 2 * noncentral));
  return std::sqrt(noncentral);
}
double freedom(const EffectKind& kind) {
  return kind.freedom > 0 ? kind.freedom : static_cast<double>(kind.parts);
}
constexpr double surely_apart = 5, surely_not = 3, surely_outside = 0.85;
constexpr double harmless_share = 0.002, harmless_widths = 0.1;  // of the signal; of the noise, where it is in pixels

const EffectKind& find(const std::vector<EffectKind>& kinds, const std::string& name) {
  for (const EffectKind& k : kinds)
    if (k.name == name) return k;
  throw std::runtime_error("no effect " + name);
}

Numbers drawn(const EffectKind& kind, Random& random) {
  Numbers size;
  for (std::size_t k = 0; k < kind.parts; ++k) {
    const double sign = kind.either_sign && random.uniform() < 0.5 ? -1 : 1;
    size.push_back(sign * kind.least * std::pow(kind.most / kind.least, random.uniform()));
  }
  return size;
}

Numbers minus(const Numbers& a, const Numbers& b) {
  Numbers d(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
  return d;
}

// One world that has been designed, with what the refit swallows.
struct Stage {
  const World& world;
  std::vector<EffectKind> kinds;
  Numbers base, clean, sigma;
  FreeParameters free;

  Stage(const World& w, const Sizes& around)
      : world(w),
        kinds(w.effects()),
        base(w.base()),
        clean(w.simulate(base, around)),
        sigma(w.sigma(clean)),
        free(w.base_columns(), sigma, w.strata(), w.own_columns()) {}
  Numbers surviving(const Sizes& sizes) const { return free.surviving(minus(world.simulate(base, sizes), clean)); }
};

// Sizes such that the effect is `multiple` detection limits long.
void scale_to(const Stage& s, double wanted, Numbers& size, const std::string& name) {
  for (int step = 0; step < 4; ++step) {
    const double now = length(s.surviving({{name, size}}));
    if (!(now > 0)) return;
    for (double& v : size) v *= std::clamp(wanted / now, 0.02, 50.0);
  }
}

// What `rival`, at its best size, leaves of `effect`. Rivals of one number are tried over their whole range, for those
// are seldom linear.
double left_by(const Stage& s, const EffectKind& rival, const Numbers& effect, const std::vector<Numbers>& beside) {
  std::vector<Numbers> others = beside;
  const double middle = std::sqrt(rival.least * rival.most);
  if (rival.parts > 1) {
    for (std::size_t k = 0; k < rival.parts; ++k) {
      Numbers size(rival.parts, 0.0);
      size[k] = middle;
      others.push_back(s.surviving({{rival.name, size}}));
    }
    return left_beside(effect, others);
  }
  double least = length(effect);
  for (int k = 0; k < 5; ++k) {
    others = beside;
    others.push_back(
        s.surviving({{rival.name, {0.5 * rival.least * std::pow(4 * rival.most / rival.least, k / 4.0)}}}));
    least = std::min(least, left_beside(effect, others));
  }
  return least;
}

// The least that any rival (or set of them, with all true effects but one) leaves.
double left_by_rivals(const Stage& s, const Sizes& sizes) {
  double least = 1e300;
  for (const auto& [name, size] : sizes) {
    std::vector<Numbers> beside;
    for (const auto& [other, its] : sizes)
      if (other != name) beside.push_back(s.surviving({{other, its}}));
    const Numbers own = s.surviving({{name, size}});
    least = std::min(least, left_beside(own, beside));
    for (const EffectKind& rival : s.kinds) {
      if (rival.id.empty() || sizes.contains(rival.name) || rival.id == find(s.kinds, name).id) continue;
      least = std::min(least, left_by(s, rival, own, beside));
    }
  }
  return least;
}

// Share of an effect's length that no single mechanism of the library imitates.
double outside_left(const Stage& s, const Sizes& sizes) {
  const Numbers effect = s.surviving(sizes);
  double least = length(effect);
  if (!s.world.asks_rivals() || !(least > 0)) return 1;
  for (const EffectKind& rival : s.kinds)
    if (!rival.id.empty()) least = std::min(least, left_by(s, rival, effect, {}));
  return least / length(effect);
}

double share_of(const Stage& s, const Numbers& surviving, const Numbers& observed) {
  const Numbers norm = s.world.norm(observed), reference = s.world.reference(s.clean, s.sigma);
  double sum = 0, noise = 0;
  for (std::size_t i = 0; i < norm.size(); ++i) {
    const double width = s.sigma[i] / reference[i];
    sum += surviving[i] * surviving[i] * width * width;
    noise += width * width;
  }
  if (s.world.relative()) return std::sqrt(sum / std::accumulate(norm.begin(), norm.end(), 0.0));
  return 1 - std::sqrt(noise / (noise + sum));
}

Sizes sizes_of(const Spec& spec, const Stage& s, Random& random) {
  Sizes sizes;
  for (const std::string& name : spec.effects) {
    Numbers size = drawn(find(s.kinds, name), random);
    const EffectKind& kind = find(s.kinds, name);
    if (spec.multiple > 0 && kind.scales) scale_to(s, spec.multiple * limit_of(freedom(kind)), size, name);
    sizes[name] = size;
  }
  return sizes;
}

// A constant that is slightly wrong: any effect of the library, so small that it harms nobody.
Sizes harmless(const Stage& s, Random& random) {
  std::vector<EffectKind> known;
  for (const EffectKind& k : s.kinds)
    if (!k.id.empty() && k.variant.empty() && k.scales) known.push_back(k);
  if (known.empty()) return {};
  for (int tries = 0; tries < 20; ++tries) {  // some effects have a least size
    const EffectKind& kind = known[random.below(static_cast<std::uint32_t>(known.size()))];
    Numbers size = drawn(kind, random);
    const double widths = harmless_widths * std::sqrt(static_cast<double>(s.sigma.size()));
    scale_to(s, widths, size, kind.name);
    if (s.world.relative()) {
      const double share = share_of(s, s.surviving({{kind.name, size}}), s.clean);
      scale_to(s, widths * std::min(4.0, harmless_share / share), size, kind.name);
    }
    if (length(s.surviving({{kind.name, size}})) < 4.5 * widths) return {{kind.name, size}};
  }
  return {};
}

// Share of the effect that counts least, beside the others.
double weakest_share(const Stage& s, const Sizes& sizes, const Numbers& observed) {
  double least = 1e300;
  for (const auto& [name, size] : sizes) {
    std::vector<Numbers> beside;
    for (const auto& [other, its] : sizes)
      if (other != name) beside.push_back(s.surviving({{other, its}}));
    Numbers own = s.surviving({{name, size}});
    const double left = beside.empty() ? 1 : left_beside(own, beside) / length(own);
    least = std::min(least, left * share_of(s, own, observed));
  }
  return least;
}

void fill_truth(const Spec& spec, const Stage& s, const Sizes& sizes, Truth& truth) {
  truth.kind = spec.kind;
  for (const auto& [name, size] : sizes) {
    const EffectKind& kind = find(s.kinds, name);
    if (!kind.id.empty() && spec.kind != Kind::distractor) {
      truth.mechanisms.push_back(kind.id);
      if (kind.values)
        for (const TrueValue& v : kind.values(size)) truth.values.push_back(v);
    }
    truth.limit = std::max(truth.limit, limit_of(freedom(kind)));
    truth.stages.insert(truth.stages.end(), kind.stages.begin(), kind.stages.end());
    truth.conditions.insert(truth.conditions.end(), kind.conditions.begin(), kind.conditions.end());
    truth.world += (truth.world.empty() ? "" : " + ") + name;
    for (const double v : size) truth.world += format(" %.4g", v);
  }
  if (spec.kind == Kind::outside) {  // what a known effect imitates for the most part is rightly called by its name
    truth.apart = outside_left(s, sizes) >= surely_outside ? Apart::yes : Apart::unclear;
    return;
  }
  const bool judged = spec.kind != Kind::null && spec.kind != Kind::distractor;
  if (!judged || !s.world.asks_rivals()) {
    truth.apart = spec.kind == Kind::alike ? Apart::no : Apart::yes;
    return;
  }
  const double left = left_by_rivals(s, sizes);
  truth.apart = left >= surely_apart ? Apart::yes : left <= surely_not ? Apart::no : Apart::unclear;
}

}  // namespace

std::string case_id(const Spec& spec) {
  std::uint64_t hash = split_mix(spec.seed);
  for (const char c : spec.domain + spec.variant) hash = split_mix(hash ^ static_cast<unsigned char>(c));
  static constexpr char digits[] = "0123456789abcdef";
  std::string id = "case-";
  for (int k = 0; k < 8; ++k) id += digits[(hash >> (4 * k)) & 15u];
  return id;
}

EffectKind& EffectKind::of_either_sign() {
  either_sign = true;
  return *this;
}
EffectKind& EffectKind::of_parts(std::size_t count, double numbers_of_a_test) {
  parts = count;
  freedom = numbers_of_a_test;
  return *this;
}
EffectKind& EffectKind::only_for(const std::string& design) {
  variant = design;
  return *this;
}
EffectKind& EffectKind::as_drawn() {
  scales = false;
  return *this;
}
EffectKind& EffectKind::means(const std::vector<std::string>& parameters, const Numbers& scale) {
  values = [=, mechanism = id](const Numbers& size) {
    std::vector<TrueValue> result;
    for (std::size_t k = 0; k < parameters.size(); ++k)
      result.push_back({mechanism, parameters[k], size[std::min(k, size.size() - 1)] * (scale.empty() ? 1 : scale[k])});
    return result;
  };
  return *this;
}
EffectKind& EffectKind::nearly(const std::string& parameter) {
  values = [=, mechanism = id](const Numbers& size) {
    return std::vector<TrueValue>{{mechanism, parameter, size[0], false}};
  };
  return *this;
}

std::vector<Numbers> World::base_columns() const {
  const Numbers at = base(), steps = base_steps();
  std::vector<Numbers> columns;
  for (std::size_t p = 0; p < at.size(); ++p) {
    Numbers up = at, down = at;
    up[p] += steps[p], down[p] -= steps[p];
    columns.push_back(minus(simulate(up, {}), simulate(down, {})));
  }
  return columns;
}

void World::locate(const Numbers& surviving, const Numbers& observed, Case& into) const {
  for (std::size_t i = 0; i < observed.size(); ++i) into.observed.push_back({observed[i], surviving[i]});
}

Case make_case(const Spec& spec) {
  const std::unique_ptr<World> world = make_world(spec.domain);
  if (world == nullptr) throw std::runtime_error("no world " + spec.domain);
  Random random(spec.seed, 0x7365616cu);
  world->design(random, spec.variant);
  const Stage s(*world, {});
  const bool distracted = spec.kind == Kind::distractor;
  const Sizes sizes = distracted ? harmless(s, random) : sizes_of(spec, s, random);
  Case made;
  made.id = case_id(spec);
  made.spec = spec;
  fill_truth(spec, s, sizes, made.truth);
  const Numbers simulated = sizes.empty() ? s.clean : world->simulate(s.base, sizes);
  const Numbers full = world->exposed(sizes, simulated);
  Numbers observed = world->noisy(full, random);
  Numbers stated = world->sigma(s.clean);
  const Numbers reference = world->reference(s.clean, s.sigma);
  double errors = 0;
  for (std::size_t i = 0; i < full.size(); ++i) errors += std::pow((observed[i] - full[i]) / reference[i], 2);
  if (distracted) {
    const double misstated = random.uniform(0.8, 1.25);
    for (double& v : stated) v *= misstated;
    for (std::size_t i = 0; i < observed.size(); ++i)  // dust
      if (random.uniform() < 1.0 / 400) observed[i] += 6 * s.sigma[i] * (random.uniform() < 0.5 ? -1 : 1);
  }
  const Numbers norm = world->norm(observed);
  made.truth.floor = std::sqrt(errors / std::accumulate(norm.begin(), norm.end(), 0.0));
  made.truth.floor_known = world->knows_floor();
  const Numbers surviving = s.free.surviving(minus(simulated, s.clean));
  made.truth.strength = length(surviving);
  made.truth.share = sizes.size() > 1 ? weakest_share(s, sizes, observed) : share_of(s, surviving, observed);
  world->locate(surviving, observed, made);
  world->write(observed, stated, made);
  return made;
}

}  // namespace gonio::sealed
