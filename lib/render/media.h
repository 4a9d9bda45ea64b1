// What fills space: objects that let light through, nested in each other. World frame, metres.
//
// Objects may overlap; the one of the highest priority fills the common part (Schmidt & Budge 2002, "Simple nested
// dielectrics in ray traced images"; equal priorities: the one named first in the manifest). A point knows the set of
// objects that it is in, and a surface is an interface where crossing it changes the one that fills. Surfaces where
// nothing changes - false interfaces inside of what has a higher priority, and those between equal indices of all
// bands - scatter nothing: paths and shadow rays pass them.
//
// A meeting with a back face of an object that the path has not entered (open meshes) is passed likewise.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/ray_caster.h"
#include "scene/scene.h"
#include "surface/medium.h"

namespace gonio::render {

// The objects that a point is in, by falling priority; at most twelve.
class Inside {
 public:
  bool empty() const { return count_ == 0; }
  std::uint32_t top() const { return entries_[0]; }  // number by priority; not of an empty one
  void enter(std::uint32_t rank);
  void leave(std::uint32_t rank);

 private:
  std::array<std::uint32_t, 12> entries_{};
  std::uint32_t count_ = 0;
};

// Attenuation exp(-sigma_t d); a distance of infinity through what attenuates is dark.
Rgb transmittance(const surface::Medium& medium, double distance_m);

struct Crossing {                         // of a surface, from the side of the path to the other
  const surface::Medium* here = nullptr;  // null: empty space
  const surface::Medium* beyond = nullptr;
  Inside inside_beyond;
  bool passes = false;  // no interface: the path goes straight on
  Rgb eta{1, 1, 1};     // index beyond over index here
};

class Media {
 public:
  Media(const scene::Scene& scene, const RayCaster& caster);
  bool any() const { return !media_.empty(); }
  bool holds(std::uint32_t instance) const { return any() && rank_[instance] != none; }
  // Null in empty space.
  const surface::Medium* at(const Inside& inside) const { return inside.empty() ? nullptr : &media_[inside.top()]; }
  Crossing crossing(const Inside& inside, const SurfacePoint& point) const;
  // The objects around a point in free space: those whose nearest surface in most of three directions is met from its
  // inside.
  Inside around(Vec3 position_m) const;

  // Share of light per band that arrives from `distance_m` away along `direction`; passes what Crossing::passes.
  // `from`: the surface that is left on the side of `inside`; without one, the ray starts at `origin_m`.
  Rgb clear(const SurfacePoint* from, Vec3 origin_m, const Inside& inside, Vec3 direction, double distance_m) const;

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  bool may_pass() const { return may_pass_; }
  Rgb walk(const SurfacePoint* from, Vec3 origin_m, Inside inside, Vec3 direction, double distance_m) const;

  const RayCaster& caster_;
  std::vector<std::uint32_t> rank_;       // of each instance; `none` where it bounds no medium
  std::vector<std::uint32_t> instances_;  // by rank
  std::vector<surface::Medium> media_;    // by rank
  bool may_pass_ = false;                 // there may be surfaces that are no interfaces
};

}  // namespace gonio::render
