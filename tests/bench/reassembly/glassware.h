// The four pieces of glass of scripts/experiments/reassembly.mk: a bowl, a teapot, and their lids, with markers glued
// on.
#pragma once
#include <string>
#include <vector>

#include "ct/scanner.h"
#include "geom/rigid.h"

namespace gonio::reassembly_experiment {

// As it stands: foot on z = 0, axis of the vessel on z; lids on their vessels.
struct Glassware {
  std::string name;
  std::string surface;    // of the glass
  double eta = 1.5;       // its index,
  Vec3 absorption_per_m;  // and what it takes from red, green and blue
  ct::ShapePtr glass;
  std::vector<ct::Ball> markers;
  Vec3 middle;                      // of the tomograph's field of view, m
  double across_m = 0, high_m = 0;  // its size
};
const std::vector<Glassware>& glassware();
const Glassware& piece_named(const std::string& name);  // std::invalid_argument where there is none

constexpr double foot_inner_m = 0.020, foot_outer_m = 0.027;  // of both vessels

// How the piece lies in the tomograph: neither upright nor in the middle of a voxel.
struct Scanned {
  ct::Phantom phantom;
  ct::Scanner scanner;
};
Rigid<frame::Object, frame::Light> tomograph_from_standing(const Glassware& piece, std::size_t voxels);
Scanned scanned(const Glassware& piece, std::size_t voxels, double photons, std::uint64_t seed);

}  // namespace gonio::reassembly_experiment
