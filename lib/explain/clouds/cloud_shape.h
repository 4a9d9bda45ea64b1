// A plane, ball or mesh that a cloud's points lie on, and where it stands. Private to clouds/.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "mesh/triangle_tree.h"

namespace gonio::explain {

class ShapeMesh {  // object frame
 public:
  ShapeMesh(std::vector<Vec3> positions_m, std::vector<std::array<std::uint32_t, 3>> triangles)
      : positions_m_(std::move(positions_m)), triangles_(std::move(triangles)), tree_(positions_m_, triangles_) {}
  ShapeMesh(const ShapeMesh&) = delete;  // the tree refers to both
  ShapeMesh& operator=(const ShapeMesh&) = delete;
  const std::vector<Vec3>& positions_m() const { return positions_m_; }
  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  const mesh::TriangleTree& tree() const { return tree_; }

 private:
  std::vector<Vec3> positions_m_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  mesh::TriangleTree tree_;
};

class CloudShape {
 public:
  // Fitted to the points; `place` is where the cloud stands, for messages. Error(data) where they are too few.
  static CloudShape plane(std::span<const Vec3> points_m, const std::string& place);
  static CloudShape ball(std::span<const Vec3> points_m, double radius_m, const std::string& place);
  // Begins where it is told; the fit's base model moves it.
  static CloudShape of_mesh(std::shared_ptr<const ShapeMesh> mesh, const Rigid<frame::Rig, frame::Object>& pose);

  // A small part of a surface, flat, that stands as told; moved, it turns about `pivot_m` first.
  static CloudShape patch(Vec3 at_m, Vec3 normal, Vec3 pivot_m);

  // Numbers that say where it stands, all zero where it was fitted, and their names with units and usual sizes.
  struct Freedom {
    const char *name, *unit;
    double size;
  };
  std::span<const Freedom> freedoms() const;

  bool may_light_itself() const { return kind_ == Kind::mesh; }
  struct Met {
    double distance_m = 0;
    Vec3 normal;  // unit, against the ray
  };
  // Where a ray (unit direction) first meets it, moved by `change`.
  std::optional<Met> met(Vec3 origin, Vec3 direction, std::span<const double> change) const;
  // Signed distance of a point from it where it was fitted (mesh: unsigned).
  double off(Vec3 point) const;

 private:
  enum class Kind { plane, ball, mesh, patch } kind_ = Kind::plane;
  Vec3 middle_, normal_, along_, across_;  // plane: normal towards the camera; ball, mesh: middle; patch: pivot
  Vec3 at_;                                // patch
  double radius_m_ = 0;
  std::shared_ptr<const ShapeMesh> mesh_;
  Rigid<frame::Rig, frame::Object> pose_;
};

}  // namespace gonio::explain
