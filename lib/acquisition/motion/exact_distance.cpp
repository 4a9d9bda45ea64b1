// See exact_distance.h. FCL (Pan, Chitta & Manocha, ICRA 2012): GJK between convex shapes (Gilbert, Johnson & Keerthi
// 1988), trees of boxes for triangles. FCL sees of a mesh its surface; whether something is inside of a closed one is
// asked by counting what a ray crosses. The direction of that ray is one that no edge of a drawn part has.
//
// FCL 0.7 is wrong where shapes are in line: 0.6576 m for two cylinders on one axis, 0.65 m apart. Between convex
// shapes its answer is therefore where the search for a proof begins (body.h); without a proof, what is certain counts.
#include "acquisition/motion/exact_distance.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>

#include "mesh/topology.h"
#include "mesh/triangle_tree.h"

namespace gonio::acquisition {
namespace {

using Geometry = std::unique_ptr<const fcl::CollisionGeometryd>;
using TriangleModel = fcl::BVHModel<fcl::OBBRSSd>;

fcl::Vector3d vector_of(Vec3 v) {
  return {v.x, v.y, v.z};
}

fcl::Transform3d transform_of(const PlacedBody& at) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) transform.linear()(i, j) = at.rotation(i, j);
  transform.translation() = vector_of(at.origin_m);
  return transform;
}

Geometry geometry_of(const Solid& solid) {
  const Vec3 s = solid.sides_m;
  switch (solid.shape) {
    case Solid::Shape::box: return std::make_unique<fcl::Boxd>(s.x, s.y, s.z);
    case Solid::Shape::ball: return std::make_unique<fcl::Sphered>(s.x);
    case Solid::Shape::cylinder: return std::make_unique<fcl::Cylinderd>(s.x, s.y);
    case Solid::Shape::mesh: break;
  }
  auto model = std::make_unique<TriangleModel>();
  model->beginModel(static_cast<int>(solid.triangles.size()), static_cast<int>(3 * solid.triangles.size()));
  for (const auto& [a, b, c] : solid.triangles)
    model->addTriangle(vector_of(solid.vertices_m[a]), vector_of(solid.vertices_m[b]), vector_of(solid.vertices_m[c]));
  model->endModel();
  return model;
}

}  // namespace

struct ExactDistances::Shapes {
  struct Shape {
    Geometry geometry;
    std::unique_ptr<const mesh::TriangleTree> inside{};  // of closed meshes
    Vec3 inner_m{};                                      // a point of the solid, its own coordinates
  };
  const std::vector<Body>& bodies;
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
  auto shapes = std::make_unique<Shapes>(Shapes{bodies, {}});
  for (const Body& body : bodies) {
    Shapes::Shape shape{geometry_of(*body.solid)};
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
  fcl::DistanceRequestd request;
  request.distance_tolerance = 1e-9;
  fcl::DistanceResultd result;
  const auto convex = [](const Body& body) { return body.solid->shape != Solid::Shape::mesh; };
  const Body &body_a = shapes_->bodies[a], &body_b = shapes_->bodies[b];
  request.enable_nearest_points = convex(body_a) && convex(body_b);
  const double found = fcl::distance(shapes_->shapes[a].geometry.get(), transform_of(at_a),
                                     shapes_->shapes[b].geometry.get(), transform_of(at_b), request, result);
  if (request.enable_nearest_points) {
    const fcl::Vector3d& on_b = result.nearest_points[1];
    Vec3 start{on_b.x(), on_b.y(), on_b.z()};
    if (!(found > 0) || !is_finite(start)) start = at_b.middle_m;
    const Bounded bounded = bounded_distance(body_a, at_a, body_b, at_b, start);
    return std::max(bounded.distance_m - (bounded.too_large_m > 1e-6 ? bounded.too_large_m : 0), 0.0);
  }
  if (!(found > 0) || shapes_->holds(a, at_a, b, at_b) || shapes_->holds(b, at_b, a, at_a)) return 0;
  return found;
}

}  // namespace gonio::acquisition
