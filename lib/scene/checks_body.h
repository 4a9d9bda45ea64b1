// An object as a body in space, for scene/checks.cpp: closed or open, what is inside of it, what meets it.
#pragma once
#include <memory>
#include <string>

#include "mesh/topology.h"
#include "scene/scene.h"

namespace gonio::scene {

class Body {
 public:
  Body(const Instance& instance, const Surface& surface);
  const mesh::Mesh* mesh() const { return mesh_; }  // null for spheres and planes
  bool transmits() const { return transmits_; }
  bool needs_volume() const { return transmits_ || scatters_beneath_; }
  bool closed() const;
  const mesh::Topology& topology() const;  // of meshes; computed once
  bool contains(Vec3 point_m) const;       // false for open ones
  bool meets_ball(Vec3 centre_m, double radius_m) const;
  bool overlaps(const Body& other) const;  // is one of some points of this inside of the other?
  bool shows_in(const View& view) const;   // is one of its points inside of the picture?
  bool met_by(Vec3 origin_m, Vec3 direction) const;

 private:
  template <class Visit>
  bool any_point(std::size_t at_most, const Visit& visit) const;  // world frame; of the surface
  Vec3 inwards(Vec3 point_m) const;                               // to the object's frame

  const Instance& instance_;
  const mesh::Mesh* mesh_ = nullptr;
  bool transmits_ = false, scatters_beneath_ = false;
  mutable std::unique_ptr<mesh::Topology> topology_;
};

std::string open_words(const mesh::Topology& topology);  // "has 12 open edges around 2 holes"
const char* open_consequence();

}  // namespace gonio::scene
