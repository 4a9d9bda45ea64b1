#include "surface/interface_trap.h"

#include <array>

#include "base/random.h"

namespace gonio::surface {
namespace {

constexpr int samples = 128, samples_per_azimuth = 64, steps = 96;

int samples_at(std::size_t azimuths) {
  return azimuths > 1 ? samples_per_azimuth : samples;
}

Rgb ratio(Rgb a, Rgb b) {
  const auto safe = [](double x, double y) { return y > 0 ? x / y : 0; };
  return {safe(a.x, b.x), safe(a.y, b.y), safe(a.z, b.z)};
}
double critical_cosine(double eta) {
  return std::sqrt(std::max(0.0, 1 - 1 / (eta * eta)));
}
double part(double x) {
  return x - std::floor(x);
}

Vec3 turned(Vec3 w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}
// Does the base reflect another way when both directions turn about the normal?
bool depends_on_azimuth(const Layer& base) {
  Random random(1);
  const auto direction = [&] {
    const double z = 0.1 + 0.9 * random.uniform(), r = std::sqrt(1 - z * z);
    return turned({r, 0, z}, 2 * pi * random.uniform());
  };
  for (int k = 0; k < 8; ++k) {
    const Vec3 wo = direction(), wi = normalized(Vec3{-wo.x, -wo.y, wo.z} + direction() * 0.5);
    const double angle = 2 * pi * random.uniform();
    const Rgb f = base.model->evaluate(base.values, wo, wi);
    const Rgb g = base.model->evaluate(base.values, turned(wo, angle), turned(wi, angle));
    if (max_component(f - g) > 1e-6 * max_component(f) || max_component(g - f) > 1e-6 * max_component(f)) return true;
  }
  return false;
}

struct Base {
  const Model* model = nullptr;
  const Prepared* prepared = nullptr;
  decltype(Values::v) values{};
  bool operator==(const Base&) const = default;
};
Base known(const Layer& base) {
  return {base.model, base.values.prepared, base.values.v};
}

struct Remembered {
  Base base;
  double eta = 0, alpha = 0;
  Rgb depth;
  InterfaceTrap trap;
};

}  // namespace

// What the base draws at every node: the same for every roughness and every absorption of the coat, remembered by each
// thread while the base and eta stay, so that a fit of a coat does not sample its base for every step.
struct InterfaceTrap::Drawn {
  struct One {
    double cosine;
    Rgb weight;
  };
  struct Node {
    std::vector<One> upwards;
    Rgb albedo;
  };
  Base base;
  double eta = 0;
  std::size_t azimuths = 1;
  std::vector<Node> nodes;
};

const InterfaceTrap::Drawn& InterfaceTrap::drawn_of(double eta, const Layer& base) {
  thread_local Drawn last;
  if (last.eta == eta && last.base == known(base)) return last;
  Drawn drawn{known(base), eta, depends_on_azimuth(base) ? turns : 1, {}};
  drawn.nodes.resize(drawn.azimuths * cosines);
  const int count = samples_at(drawn.azimuths);
  for (std::size_t k = 0; k < drawn.nodes.size(); ++k) {
    const double turn = drawn.azimuths > 1 ? static_cast<double>(k / cosines) / turns : 0.125;
    const Vec3 wo = node(eta, k % cosines, 2 * pi * turn);
    Drawn::Node& here = drawn.nodes[k];
    for (int i = 0; i < count; ++i) {  // the additive recurrence of Roberts 2018 (R3)
      const double n = i + 0.5;
      const Vec2 u{part(n * 0.8191725133961645), part(n * 0.6710436067037893)};
      const Sample s = base.model->sample(base.values, wo, u, part(n * 0.5497004779019703));
      if (s.pdf > 0 && !s.below && s.wi.z > 0) here.upwards.push_back({s.wi.z, s.weight});
    }
    if (!base.model->subsurface(base.values)) here.albedo = base.model->albedo(base.values, wo);
  }
  last = std::move(drawn);
  return last;
}

InterfaceTrap::InterfaceTrap(const CoatInterface& interface, Rgb depth, const Layer& base)
    : eta_(interface.eta()), critical_(critical_cosine(eta_)) {
  const Drawn& drawn = drawn_of(eta_, base);
  azimuths_ = drawn.azimuths;
  escapes_.resize(drawn.nodes.size());
  trapped_.resize(drawn.nodes.size());
  const bool scaled = !base.model->subsurface(base.values);
  for (std::size_t k = 0; k < drawn.nodes.size(); ++k) sum_node(k, drawn, scaled, interface, depth);
  Rgb escaping, staying, sent;
  for (std::size_t a = 0; a < azimuths_; ++a)
    for (int i = 0; i < steps; ++i) {  // 2 c dc = d(c^2)
      const double cosine = std::sqrt((i + 0.5) / steps), sine = std::sqrt(1 - cosine * cosine);
      const double azimuth = 2 * pi * static_cast<double>(a) / turns;
      const double each = 1.0 / (steps * static_cast<double>(azimuths_));
      const Vec3 w{sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
      escaping += escapes(w) * each;
      staying += trapped(w) * each;
      sent += trapped(w) * exp_of(depth * (-1 / cosine)) * (interface.passes_from_inside(cosine) * each);
    }
  leaves_ = ratio(escaping, Rgb{1, 1, 1} - staying);
  gain_ = ratio(leaves_, sent);
}

Vec3 InterfaceTrap::node(double eta, std::size_t cosine, double azimuth_rad) {
  double z = critical_cosine(eta) * (1 - 1e-9) * static_cast<double>(cosine) / (below - 1);
  if (cosine >= below) {
    const double root = static_cast<double>(cosine - below) / (above - 1), out2 = root * root * root * root;
    z = std::sqrt(1 - (1 - out2) / (eta * eta));
  }
  z = std::max(0.001, z);
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(azimuth_rad), r * std::sin(azimuth_rad), z};
}

void InterfaceTrap::sum_node(std::size_t at, const Drawn& all, bool scaled, const CoatInterface& interface, Rgb depth) {
  const int count = samples_at(azimuths_);
  Rgb drawn;
  for (const Drawn::One& s : all.nodes[at].upwards) {
    const Rgb survives = exp_of(depth * (-1 / s.cosine)), light = s.weight * survives / count;
    const double passes = interface.passes_from_inside(s.cosine);
    drawn += s.weight / count;
    escapes_[at] += light * passes;
    trapped_[at] += light * survives * (1 - passes);
  }
  if (!scaled) return;
  const Rgb noise = ratio(all.nodes[at].albedo, drawn);  // would be one with more samples
  escapes_[at] = escapes_[at] * noise;
  trapped_[at] = trapped_[at] * noise;
}

Rgb InterfaceTrap::at(const Nodes& values, Vec3 inside) const {
  const double z = std::clamp(inside.z, 0.0, 1.0), out2 = 1 - eta_ * eta_ * (1 - z * z);
  const bool steep = out2 >= 0;
  const double p = steep ? std::sqrt(std::sqrt(out2)) * (above - 1) : std::min(1.0, z / critical_) * (below - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(p), (steep ? above : below) - 2);
  const double share = p - static_cast<double>(low);
  const auto around = [&](std::size_t azimuth) {
    const Rgb* row = &values[azimuth * cosines + (steep ? below : 0) + low];
    return row[0] + (row[1] - row[0]) * share;
  };
  if (azimuths_ == 1) return around(0);
  const double turn = std::atan2(inside.y, inside.x) / (2 * pi), q = (turn - std::floor(turn)) * turns;
  const std::size_t first = std::min<std::size_t>(static_cast<std::size_t>(q), turns - 1);
  return around(first) + (around((first + 1) % turns) - around(first)) * (q - static_cast<double>(first));
}

const InterfaceTrap& trap_of(double eta, double alpha, Rgb depth, const Layer& base) {
  thread_local std::array<Remembered, 4> memory;
  thread_local std::size_t next = 0;
  for (const Remembered& m : memory)
    if (m.eta == eta && m.alpha == alpha && m.depth == depth && m.base == known(base)) return m.trap;
  Remembered& m = memory[next];
  next = (next + 1) % memory.size();
  m = {known(base), eta, alpha, depth, {{eta, alpha}, depth, base}};
  return m.trap;
}

}  // namespace gonio::surface
