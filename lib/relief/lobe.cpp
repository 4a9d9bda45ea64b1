// See lobe.h.
#include "relief/lobe.h"

#include "base/error.h"
#include "relief/lobe_paths.h"

namespace gonio::relief {
namespace {

// A cone about a direction: its solid angle, and the projected one, of which a cone that touches the horizon has only
// what lies above (counted by a fixed lattice).
struct Cone {
  Basis about;
  double cosine, solid, projected;
  Cone(Vec3 axis, double half_angle)
      : about(axis),
        cosine(std::cos(half_angle)),
        solid(2 * pi * (1 - cosine)),
        projected(pi * std::sin(half_angle) * std::sin(half_angle) * axis.z) {
    if (half_angle <= std::asin(axis.z)) return;
    constexpr int lattice = 4096;
    double sum = 0;
    for (int k = 0; k < lattice; ++k) {
      const double v = k * 0.6180339887498949;
      sum += std::max(0.0, in_cone(about, cosine, (k + 0.5) / lattice, v - std::floor(v)).z);
    }
    projected = solid * sum / lattice;
  }
  bool point() const { return solid <= 0; }
  // w / |O| of a direction drawn uniformly: solid over projected, 1 / cos for a single direction.
  double per_projected() const { return point() ? 1 / about.n.z : solid / projected; }
  bool holds(Vec3 w) const { return !point() && dot(w, about.n) >= cosine; }
};

bool only_deltas(const Material& material) {
  Random random(1);
  for (int k = 0; k < 64; ++k) {
    const auto s = material.model->sample(material.values, normalized(Vec3{0.3, 0.2, 1}),
                                          {random.uniform(), random.uniform()}, random.uniform());
    if (s.pdf > 0 && s.wi.z > 0 && !s.delta) return false;
  }
  return true;
}

bool any_delta(const Material& material) {
  Random random(2);
  for (int k = 0; k < 256; ++k)
    if (material.model
            ->sample(material.values, normalized(Vec3{0.3, 0.2, 1}), {random.uniform(), random.uniform()},
                     random.uniform())
            .delta)
      return true;
  return false;
}

}  // namespace

void check_lobe(const Relief& relief, Vec3 w, const char* name) {
  if (!relief.periodic())
    throw Error(Exit::data, "lobe", "the relief ends at its edges", "tile it: mirrored or repeated");
  if (!(w.z > 0) || std::abs(norm(w) - 1) > 1e-6)
    throw Error(Exit::data, "lobe", std::string(name) + " is no unit vector above the horizon", "z > 0, length 1");
}

Estimate lobe(const Relief& relief, const Material& material, Vec3 wo, Vec3 wi, const Aperture& aperture,
              const Effort& effort) {
  check_lobe(relief, wo, "wo");
  check_lobe(relief, wi, "wi");
  const Cone eye(wo, aperture.about_wo_rad), light(wi, aperture.about_wi_rad);
  const bool smooth = only_deltas(material);
  if (light.point() && any_delta(material))
    throw Error(Exit::data, "lobe", "a smooth facet never sends light exactly along wi",
                "give the aperture about wi a half angle, or the facets a roughness");
  const std::int64_t per_batch = std::max<std::int64_t>(1, effort.paths / batches);
  std::array<Rgb, batches> means{};
  run_batches(effort, [&](std::size_t b, Random& random, const auto& place) {
    Rgb sum;
    for (std::int64_t k = 0; k < per_batch; ++k) {
      Vec3 from = wo;
      double weight = 1;
      if (!eye.point()) {
        from = in_cone(eye.about, eye.cosine, random.uniform(), random.uniform());
        if (from.z <= 0) continue;
        weight = from.z * eye.per_projected();
      }
      Rgb gathered;
      const auto next_event = [&](const Hit& hit, const Basis& frame, Vec3 here, Rgb throughput) {
        if (smooth) return;
        const Vec3 to = in_cone(light.about, light.cosine, random.uniform(), random.uniform());
        const Vec3 local = frame.to_local(to);
        if (to.z <= 0 || local.z <= 0) return;
        const Rgb f = material.model->evaluate(material.values, here, local);
        if (max_component(f) > 0 && relief.escapes(hit, to))
          gathered += throughput * f * (local.z * light.per_projected());
      };
      const Path path = traced(relief, material, from, place(k), random, effort.most_facets, next_event);
      if (path.escaped && path.delta && light.holds(path.leaves)) gathered += path.throughput / light.projected;
      sum += gathered * weight;
    }
    means[b] = sum / static_cast<double>(per_batch);
  });
  return estimate_of(means);
}

Vec3 direction_of(double theta_rad, double phi_rad) {
  return {std::sin(theta_rad) * std::cos(phi_rad), std::sin(theta_rad) * std::sin(phi_rad), std::cos(theta_rad)};
}

}  // namespace gonio::relief
