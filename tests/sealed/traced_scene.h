// A scene of spheres, a box and a table, traced by its equations: lamps with a size, light between surfaces by paths,
// coats by microfacets with the exact Fresnel reflectance, rough matte surfaces after Oren & Nayar's full model.
//
// World frame, metres; z up. Lamps have radiant intensity I (W/sr) per band; radiance in W/(m^2 sr).
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "sealed/matter.h"

namespace gonio::sealed {

struct Ball {
  Vec3 centre;
  double radius = 0.05;
  std::size_t matter = 0;
};
struct Stain {  // a spot of the table where less is sent back
  Vec3 centre;
  double radius = 0.04, depth = 0;
};
struct Lamp {
  Vec3 position;
  double radius = 0;
  Rgb intensity{1, 1, 1};
  Polarized light = {};
};
struct Wire {  // a thin cylinder that only casts shadows
  Vec3 from, to;
  double radius = 0;
};
struct Scene {
  std::vector<Ball> balls;
  Vec3 box_lower, box_upper;  // axes of the world; empty where equal
  std::size_t box_matter = 0;
  double table_half = 0.6;  // of its side
  std::size_t table_matter = 0;
  double table_lay = 0;  // direction of what is drawn out on the table, from x
  std::vector<Matter> matters;
  std::vector<Lamp> lamps;  // all that are on
  Rgb ambient;
  bool indirect = true;
  Stain stain;
  Wire wire;
};
struct Eye {  // x right, y down, z forward
  Vec3 position, right, down, forward;
  double focal_px = 200;
  int width = 96, height = 96;
  double pupil_m = 0, focus_m = 1;  // radius of a thin lens, distance that is sharp
};
Eye eye_at(Vec3 position, Vec3 target, double focal_px, int size);

struct Seen {  // of a pixel, for the free parameters' derivatives: share of the radiance that came off each matter
  Rgb radiance;
  std::vector<Rgb> of_matter;
};
// By `samples` ways through the pixel, at the same places whichever effects act. What is left of a pixel's mean by the
// places alone falls almost as 1/samples: 1 % of it with 64 of them, 0.3 % with 384.
Seen look(const Scene& scene, const Eye& eye, int x, int y, int samples, std::uint64_t seed);

}  // namespace gonio::sealed
