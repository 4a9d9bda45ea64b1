// Pairs of triangles whose boxes touch, told apart by exact predicates (CGAL's filtered kernel): two that share an edge
// intersect where they lie in one plane on the same side of it; two that share a corner where the far edge of one meets
// the other; others where they meet at all. Corners at the same place are shared, whatever their indices.
//
// Triangles without area are no surface and are left out: soundness() counts them.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("rounding-math")  // CGAL's interval arithmetic turns the processor's rounding
#endif
#define CGAL_NDEBUG 1  // do_intersect() asks exactly whether a triangle is one: those that are none are left out here
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <mutex>

#include "base/parallel.h"
#include "mesh/triangle_tree.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ExactPoint = Kernel::Point_3;
using ThreePlaces = std::array<Vec3, 3>;

ExactPoint exact(Vec3 p) {
  return {p.x, p.y, p.z};
}
Kernel::Triangle_3 exact(const ThreePlaces& t) {
  return {exact(t[0]), exact(t[1]), exact(t[2])};
}
bool without_area(const ThreePlaces& t) {
  return CGAL::collinear(exact(t[0]), exact(t[1]), exact(t[2]));
}

// `a` with its corner `first` in front, turned the way it was.
ThreePlaces turned(const ThreePlaces& a, std::size_t first) {
  return {a[first], a[(first + 1) % 3], a[(first + 2) % 3]};
}

bool folded_over_edge(Vec3 p, Vec3 q, Vec3 r, Vec3 s) {
  return CGAL::coplanar(exact(p), exact(q), exact(r), exact(s)) &&
         CGAL::coplanar_orientation(exact(p), exact(q), exact(r), exact(s)) == CGAL::POSITIVE;
}

bool meet(const ThreePlaces& a, const ThreePlaces& b) {
  std::array<std::size_t, 3> partner{3, 3, 3};  // of a's corners, in b
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (a[i] == b[j]) {
        partner[i] = j;
        ++shared;
      }
  if (shared == 3) return true;
  if (shared == 2) {
    const std::size_t alone = partner[0] == 3 ? 0 : partner[1] == 3 ? 1 : 2;
    const std::size_t i = (alone + 1) % 3, j = (alone + 2) % 3;
    return folded_over_edge(a[i], a[j], a[alone], b[3 - partner[i] - partner[j]]);
  }
  if (shared == 1) {
    const std::size_t i = partner[0] < 3 ? 0 : partner[1] < 3 ? 1 : 2;
    const ThreePlaces mine = turned(a, i), other = turned(b, partner[i]);
    return CGAL::do_intersect(exact(mine), Kernel::Segment_3(exact(other[1]), exact(other[2]))) ||
           CGAL::do_intersect(exact(other), Kernel::Segment_3(exact(mine[1]), exact(mine[2])));
  }
  return CGAL::do_intersect(exact(a), exact(b));
}

using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

ThreePlaces places_of(const io::TriangleMesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.positions_m[a], mesh.positions_m[b], mesh.positions_m[c]};
}

// Pairs, the smaller number first, whose boxes touch, that both have an area, and of which `wanted` says yes.
template <class Wanted>
TrianglePairs touching_pairs(const io::TriangleMesh& mesh, std::size_t at_most, const Wanted& wanted) {
  const TriangleTree tree(mesh.positions_m, mesh.triangles);
  std::vector<std::uint8_t> flat(mesh.triangles.size(), 0);
  parallel_for(
      0, flat.size(),
      [&](std::size_t t) {
        const ThreePlaces here = places_of(mesh, static_cast<std::uint32_t>(t));
        flat[t] = is_finite(here[0]) && is_finite(here[1]) && is_finite(here[2]) && without_area(here);
      },
      4096);
  // Stretches of leaves one after the other: who comes first does not depend on threads, and a mesh full of
  // intersections is not searched to its end.
  TrianglePairs all;
  constexpr std::size_t stretch = 1 << 16;
  for (std::size_t first = 0; first < tree.leaves() && all.size() < at_most; first += stretch) {
    const std::size_t last = std::min(first + stretch, tree.leaves());
    std::mutex lock;
    parallel_for(
        first, last,
        [&](std::size_t leaf) {
          tree.overlapping_pairs(leaf, [&](std::uint32_t one, std::uint32_t other) {
            if (flat[one] != 0 || flat[other] != 0 || !wanted(std::min(one, other), std::max(one, other))) return;
            const std::lock_guard hold(lock);
            all.push_back(std::minmax(one, other));
          });
        },
        256);
    std::sort(all.begin(), all.end());
  }
  if (all.size() > at_most) all.resize(at_most);
  return all;
}

}  // namespace

TrianglePairs self_intersections(const io::TriangleMesh& mesh, std::size_t at_most) {
  return touching_pairs(mesh, at_most, [&](std::uint32_t one, std::uint32_t other) {
    return meet(places_of(mesh, one), places_of(mesh, other));
  });
}

TrianglePairs intersections(const io::TriangleMesh& a, const io::TriangleMesh& b, std::size_t at_most) {
  io::TriangleMesh both;
  both.positions_m = a.positions_m;
  both.triangles = a.triangles;
  both.positions_m.insert(both.positions_m.end(), b.positions_m.begin(), b.positions_m.end());
  const auto corners = static_cast<std::uint32_t>(a.positions_m.size());
  const auto faces = static_cast<std::uint32_t>(a.triangles.size());
  for (const auto& [i, j, k] : b.triangles) both.triangles.push_back({i + corners, j + corners, k + corners});
  TrianglePairs met = touching_pairs(both, at_most, [&](std::uint32_t one, std::uint32_t other) {
    return one < faces && other >= faces &&
           CGAL::do_intersect(exact(places_of(both, one)), exact(places_of(both, other)));
  });
  for (auto& pair : met) pair.second -= faces;
  return met;
}

}  // namespace gonio::mesh
