// See object.h.
#include "glass/object.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "mesh/inside.h"
#include "mesh/mesh.h"

namespace gonio::glass {
namespace {

// Attenuations of common tints, 1/m for a factor of one: bottle green, amber, cobalt, smoke.
constexpr Rgb tints[] = {{12, 3, 9}, {4, 14, 40}, {30, 20, 4}, {10, 10, 10}};

Rgb any_tint(Random& random) {
  if (random.uniform() < 0.5) return Rgb{0.6, 0.2, 0.5} * random.uniform(0.2, 2);  // clear: iron's green, faint
  const Rgb tint = tints[random.below(4)];  // one draw a statement: operands have no order
  return tint * random.uniform(0.3, 2);
}

// Balls of air in the glass, off its surface and off each other.
std::vector<Bubble> any_bubbles(const io::TriangleMesh& raw, double size_m, Random& random) {
  std::vector<Bubble> bubbles;
  if (random.uniform() > 0.25) return bubbles;
  const mesh::Mesh mesh = mesh::prepare(raw, mesh::Shading::flat, "body");
  const std::uint32_t wanted = 1 + random.below(8);
  for (int tries = 0; tries < 200 && bubbles.size() < wanted; ++tries) {
    const Vec3& a = raw.positions_m[random.below(static_cast<std::uint32_t>(raw.positions_m.size()))];
    const Vec3 at = a + Vec3{random.normal(), random.normal(), random.normal()} * (0.05 * size_m);
    const double room = mesh::distance_m(mesh, at);
    const double radius = std::min(0.6 * room, random.uniform(0.005, 0.02) * size_m);
    if (radius < 0.003 * size_m || mesh::winding_number(mesh, at) < 0.5) continue;
    const auto apart = [&](const Bubble& b) { return norm(b.centre_m - at) > 1.2 * (b.radius_m + radius); };
    if (std::ranges::all_of(bubbles, apart)) bubbles.push_back({at, radius});
  }
  return bubbles;
}

}  // namespace

MadeObject made_of_glass(CheckedBody checked, Random& random) {
  MadeObject made;
  const double size_m = random.uniform(0.07, 0.16);
  made.mesh = std::move(checked.body.mesh);
  for (Vec3& p : made.mesh.positions_m) {
    p = p * size_m;
    made.height_m = std::max(made.height_m, p.z), made.radius_m = std::max(made.radius_m, std::hypot(p.x, p.y));
  }
  made.flat = made.mesh.normals.empty();
  const auto kinds = static_cast<std::uint32_t>(glasses().size() - 1);  // the last is water
  made.glass = &glasses()[random.below(kinds)];
  made.sigma_a_per_m = any_tint(random);
  made.alpha = random.uniform() < 0.15 ? random.uniform(0.01, 0.08) : 0;
  made.bubbles = any_bubbles(made.mesh, size_m, random);
  const bool filled = random.uniform() < 0.35;
  made.liquid_per_m = random.uniform() < 0.5 ? Rgb{0.3, 0.05, 0.02} : any_tint(random);
  if (filled && checked.body.filling) {
    made.filling = std::move(*checked.body.filling);
    for (Vec3& p : made.filling.positions_m) p = p * size_m;
  }
  made.facts = {{"glass", made.glass->id},
                {"genus", format("%lld", static_cast<long long>(checked.genus))},
                {"components", format("%zu", checked.components)},
                {"triangles", format("%zu", made.mesh.triangles.size())},
                {"size_m", format("%.4f", size_m)},
                {"alpha", format("%.4f", made.alpha)},
                {"bubbles", format("%zu", made.bubbles.size())},
                {"filled", made.filling.triangles.empty() ? "no" : "yes"},
                {"wall_low_m", format("%.5f", checked.body.wall_low * size_m)},
                {"wall_high_m", format("%.5f", checked.body.wall_high * size_m)}};
  return made;
}

}  // namespace gonio::glass
