#include "sealed/traced_lens.h"

#include <cmath>

namespace gonio::sealed {
namespace {

struct Ray {  // in the meridional plane: height y and direction (along, up) at z
  double z = 0, y = 0, along = 1, up = 0;
};

// To the sphere of radius r whose vertex lies at z = vertex, and through it from index a to index b.
Ray refracted(Ray ray, double vertex, double r, double a, double b) {
  const double centre = vertex + r, dz = ray.z - centre;
  const double half = dz * ray.along + ray.y * ray.up, rest = dz * dz + ray.y * ray.y - r * r;
  const double root = std::sqrt(half * half - rest), way = r > 0 ? -half - root : -half + root;
  ray.z += way * ray.along, ray.y += way * ray.up;
  const double nz = (ray.z - centre) / r, ny = ray.y / r;  // points away from the light for r < 0, against it for r > 0
  const double towards = ray.along * nz + ray.up * ny, sign = towards < 0 ? -1 : 1;
  const double cos_in = std::abs(towards), ratio = a / b;
  const double cos_out = std::sqrt(1 - ratio * ratio * (1 - cos_in * cos_in));
  ray.along = ratio * ray.along + sign * (cos_out - ratio * cos_in) * nz;
  ray.up = ratio * ray.up + sign * (cos_out - ratio * cos_in) * ny;
  return ray;
}

double paraxial_focus(const Singlet& l) {  // from the second vertex (lensmaker's equation)
  const double power =
      (l.index - 1) * (1 / l.front_m - 1 / l.back_m + (l.index - 1) * l.thickness_m / (l.index * l.front_m * l.back_m));
  return (1 - (l.index - 1) * l.thickness_m / (l.index * l.front_m)) / power;
}

double height(const Singlet& l, double t) {
  const double cosine = 1 / std::sqrt(1 + t * t);
  Ray ray{0, 0, cosine, t * cosine};
  ray = refracted(ray, l.stop_m, l.front_m, 1, l.index);
  ray = refracted(ray, l.stop_m + l.thickness_m, l.back_m, l.index, 1);
  const double plane = l.stop_m + l.thickness_m + paraxial_focus(l);
  return ray.y + (plane - ray.z) * ray.up / ray.along;
}

}  // namespace

double image_height_ratio(const Singlet& lens, double t) {
  constexpr double paraxial = 1e-4;
  return t < paraxial ? 1 : height(lens, t) / t * (paraxial / height(lens, paraxial));
}

}  // namespace gonio::sealed
