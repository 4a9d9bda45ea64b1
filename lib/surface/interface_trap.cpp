#include "surface/interface_trap.h"

namespace gonio::surface {
namespace {

constexpr int samples = 96, steps = 96;

Rgb ratio(Rgb a, Rgb b) {
  const auto safe = [](double x, double y) { return y > 0 ? x / y : 0; };
  return {safe(a.x, b.x), safe(a.y, b.y), safe(a.z, b.z)};
}
double part(double x) {
  return x - std::floor(x);
}

struct Remembered {
  const Model* model = nullptr;
  const Prepared* prepared = nullptr;
  std::array<Rgb, 12> values;
  double eta = 0, alpha = 0;
  Rgb depth;
  InterfaceTrap trap;
};

}  // namespace

InterfaceTrap::InterfaceTrap(const CoatInterface& interface, Rgb depth, const Layer& base) {
  for (std::size_t k = 0; k < nodes; ++k) {
    const double z = std::max(1e-3, static_cast<double>(k) / (nodes - 1)), r = std::sqrt((1 - z * z) / 2);
    const Vec3 wo{r, r, z};
    for (int i = 0; i < samples; ++i) {  // the additive recurrence of Roberts 2018 (R3)
      const double n = i + 0.5;
      const Vec2 u{part(n * 0.8191725133961645), part(n * 0.6710436067037893)};
      const Sample s = base.model->sample(base.values, wo, u, part(n * 0.5497004779019703));
      if (!(s.pdf > 0) || s.below || !(s.wi.z > 0)) continue;
      const Rgb survives = exp_of(depth * (-1 / s.wi.z)), light = s.weight * survives / samples;
      const double passes = interface.passes_from_inside(s.wi.z);
      escapes_[k] += light * passes;
      trapped_[k] += light * survives * (1 - passes);
    }
    const Rgb all = escapes_[k] + trapped_[k];  // an estimate may exceed one by its noise
    if (const double most = max_component(all); most > 1) {
      escapes_[k] = escapes_[k] / most;
      trapped_[k] = trapped_[k] / most;
    }
  }
  Rgb escaping, staying, sent;
  for (int i = 0; i < steps; ++i) {  // 2 c dc = d(c^2)
    const double cosine = std::sqrt((i + 0.5) / steps);
    escaping += escapes(cosine) / steps;
    staying += trapped(cosine) / steps;
    sent += trapped(cosine) * exp_of(depth * (-1 / cosine)) * (interface.passes_from_inside(cosine) / steps);
  }
  leaves_ = ratio(escaping, Rgb{1, 1, 1} - staying);
  gain_ = ratio(leaves_, sent);
}

const InterfaceTrap& trap_of(double eta, double alpha, Rgb depth, const Layer& base) {
  thread_local std::array<Remembered, 4> memory;
  thread_local std::size_t next = 0;
  for (const Remembered& m : memory)
    if (m.model == base.model && m.eta == eta && m.alpha == alpha && m.depth == depth &&
        m.prepared == base.values.prepared && m.values == base.values.v)
      return m.trap;
  Remembered& m = memory[next];
  next = (next + 1) % memory.size();
  m = {base.model, base.values.prepared, base.values.v, eta, alpha, depth, {{eta, alpha}, depth, base}};
  return m.trap;
}

}  // namespace gonio::surface
