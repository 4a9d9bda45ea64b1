#include "sealed/traced_lens.h"

#include <algorithm>
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

Ray from_the_stop(const Singlet& l, double index, double t) {
  const double cosine = 1 / std::sqrt(1 + t * t);
  Ray ray{0, 0, cosine, t * cosine};
  ray = refracted(ray, l.stop_m, l.front_m, 1, index);
  return refracted(ray, l.stop_m + l.thickness_m, l.back_m, index, 1);
}

double height(const Singlet& l, double index, double t) {
  const Ray ray = from_the_stop(l, index, t);
  const double plane = l.stop_m + l.thickness_m + paraxial_focus(l);
  return ray.y + (plane - ray.z) * ray.up / ray.along;
}

constexpr double paraxial = 1e-4;

// Place on the axis where a ray that left the stop at tangent t within seems to come from, and its tangent outside.
struct Seeming {
  double place, tangent;
};
Seeming seeming(const Singlet& l, double t) {
  const Ray ray = from_the_stop(l, l.index, t);
  return {ray.z - ray.y * ray.along / ray.up, ray.up / ray.along};
}

}  // namespace

double image_height_ratio(const Singlet& lens, double t) {
  return t < paraxial ? 1 : height(lens, lens.index, t) / t * (paraxial / height(lens, lens.index, paraxial));
}

double colour_ratio(const Singlet& lens, double index, double t) {
  const double at = std::max(t, paraxial);
  return height(lens, index, at) / height(lens, lens.index, at);
}

double crown_glass(double um) {
  const double l2 = um * um;
  return std::sqrt(1 + 1.03961212 * l2 / (l2 - 0.00600069867) + 0.231792344 * l2 / (l2 - 0.0200179144) +
                   1.01046945 * l2 / (l2 - 103.560653));
}

double pupil_shift(const Singlet& lens, double t) {
  if (t < 10 * paraxial) return 0;
  double a = paraxial, b = t, f_a = seeming(lens, a).tangent - t;
  for (int step = 0; step < 30; ++step) {  // secant
    const double f_b = seeming(lens, b).tangent - t;
    if (std::abs(f_b) < 1e-13 || f_b == f_a) break;
    const double next = b - f_b * (b - a) / (f_b - f_a);
    a = b, f_a = f_b, b = next;
  }
  return seeming(lens, b).place - seeming(lens, paraxial).place;
}

}  // namespace gonio::sealed
