// See exact_distance.h. FCL (Pan, Chitta & Manocha, ICRA 2012): GJK between convex shapes (Gilbert, Johnson & Keerthi
// 1988), trees of boxes for triangles. FCL sees of a mesh its surface; whether something is inside of a closed one is
// asked by counting what a ray crosses. The direction of that ray is one that no edge of a drawn part has.
//
// FCL 0.7 is wrong where shapes are in line: 0.6576 m for two cylinders on one axis, 0.65 m apart. Between convex
// shapes its answer is therefore where the search for a proof begins (body.h); without a proof, what is certain counts.
#include "acquisition/motion/exact_distance.h"

#include <algorithm>
#include <cmath>

#include "acquisition/motion/exact_distance_module.h"
#include "base/loaded_library.h"
#include "mesh/topology.h"
#include "mesh/triangle_tree.h"

namespace gonio::acquisition {

struct ExactDistances::Shapes {
  struct Shape {
    std::unique_ptr<const mesh::TriangleTree> inside{};  // of closed meshes
    Vec3 inner_m{};                                      // a point of the solid, its own coordinates
  };
  const std::vector<Body>& bodies;
  std::unique_ptr<const SurfaceDistances> surfaces;
  std::vector<Shape> shapes;

  // Is a point of `other` inside of the closed mesh `closed`? Only where no surfaces cross: then one point tells.
  bool holds(std::size_t closed, const PlacedBody& at, std::size_t other, const PlacedBody& other_at) const {
    const Shape& shape = shapes[closed];
    if (!shape.inside) return false;
    const Vec3 world = other_at.rotation * shapes[other].inner_m + other_at.origin_m;
    const Vec3 point = transposed(at.rotation) * (world - at.origin_m);
    const Body& body = bodies[closed];
    const Vec3 off = point - body.middle_m;
    if (std::fabs(off.x) > body.half_m.x || std::fabs(off.y) > body.half_m.y || std::fabs(off.z) > body.half_m.z)
      return false;
    const Vec3 direction = normalized(Vec3{0.6180339887, 0.3247179572, 0.7150961893});
    int crossed = 0;
    double t = 0;
    while (const auto hit = shape.inside->first_hit(point, direction, t)) {
      ++crossed;
      t = hit->t;
    }
    return crossed % 2 == 1;
  }
};

ExactDistances::ExactDistances(const std::vector<Body>& bodies) {
  static const auto surfaces_of =
      loaded_from_module<decltype(gonio_surface_distances)>("exact_distance", "gonio_surface_distances");
  auto shapes =
      std::make_unique<Shapes>(Shapes{bodies, std::unique_ptr<const SurfaceDistances>(surfaces_of(bodies)), {}});
  for (const Body& body : bodies) {
    Shapes::Shape shape;
    if (body.solid->shape == Solid::Shape::mesh) {
      shape.inner_m = body.solid->vertices_m[body.solid->triangles.front()[0]];
      mesh::Mesh mesh;
      mesh.positions_m = body.solid->vertices_m;
      mesh.triangles = body.solid->triangles;
      if (mesh::topology_of(mesh).closed())
        shape.inside = std::make_unique<mesh::TriangleTree>(body.solid->vertices_m, body.solid->triangles);
    }
    shapes->shapes.push_back(std::move(shape));
  }
  shapes_ = std::move(shapes);
}

ExactDistances::~ExactDistances() = default;

double ExactDistances::between(std::size_t a, const PlacedBody& at_a, std::size_t b, const PlacedBody& at_b) const {
  const auto convex = [](const Body& body) { return body.solid->shape != Solid::Shape::mesh; };
  const Body &body_a = shapes_->bodies[a], &body_b = shapes_->bodies[b];
  const bool both_convex = convex(body_a) && convex(body_b);
  Vec3 start;
  const double found = shapes_->surfaces->between(a, at_a, b, at_b, both_convex ? &start : nullptr);
  if (both_convex) {
    if (!(found > 0) || !is_finite(start)) start = at_b.middle_m;
    const Bounded bounded = bounded_distance(body_a, at_a, body_b, at_b, start);
    return std::max(bounded.distance_m - (bounded.too_large_m > 1e-6 ? bounded.too_large_m : 0), 0.0);
  }
  if (!(found > 0) || shapes_->holds(a, at_a, b, at_b) || shapes_->holds(b, at_b, a, at_a)) return 0;
  return found;
}

}  // namespace gonio::acquisition
