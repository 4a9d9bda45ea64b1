#include "acquisition/motion/exact_distance_module.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <memory>

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

class ByFcl : public SurfaceDistances {
 public:
  explicit ByFcl(const std::vector<Body>& bodies) {
    for (const Body& body : bodies) shapes_.push_back(geometry_of(*body.solid));
  }
  double between(std::size_t a, const PlacedBody& at_a, std::size_t b, const PlacedBody& at_b,
                 Vec3* nearest_on_b_m) const override {
    fcl::DistanceRequestd request;
    request.distance_tolerance = 1e-9;
    request.enable_nearest_points = nearest_on_b_m != nullptr;
    fcl::DistanceResultd result;
    const double found =
        fcl::distance(shapes_[a].get(), transform_of(at_a), shapes_[b].get(), transform_of(at_b), request, result);
    const fcl::Vector3d& on_b = result.nearest_points[1];
    if (nearest_on_b_m != nullptr) *nearest_on_b_m = {on_b.x(), on_b.y(), on_b.z()};
    return found;
  }

 private:
  std::vector<Geometry> shapes_;
};

}  // namespace
}  // namespace gonio::acquisition

const gonio::acquisition::SurfaceDistances* gonio_surface_distances(
    const std::vector<gonio::acquisition::Body>& bodies) {
  return new gonio::acquisition::ByFcl(bodies);
}
