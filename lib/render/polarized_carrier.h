// Carries polarized light; see carrier.h. Stokes vectors and their frames: optics/mueller.h.
//
// Per band a Mueller matrix takes the Stokes vector of light that travels against the ray, towards the camera, from the
// frame (x_, y, -direction) at the path's far end to the camera's frame. The camera's x axis is the picture's, made
// perpendicular to the ray; y = cross(d, x) then points up in the picture, whose own y axis points down:
//   s1 > 0  the field swings horizontally in the picture,  s1 < 0  vertically
//   s2 > 0  from the lower left to the upper right: angles grow counter-clockwise as one looks at the picture
//   s3 > 0  the field at the camera turns clockwise as the camera sees it
// The matrix over its unpolarized factor is the surface's: Model::mueller(). Where a path scatters in a medium or
// beneath a surface, polarization is lost. `|(s1, s2, s3)| <= s0` holds for every path and so for every mean.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "optics/mueller_algebra.h"
#include "render/carrier.h"

namespace gonio::render {

// The camera's x axis as light along `direction` has it, either way.
Vec3 polarization_axis(Vec3 camera_x, Vec3 direction);

class Polarized {
 public:
  using Value = std::array<Rgb, 4>;  // s0 ... s3

  static Polarized start(Vec3 camera_x, Vec3 direction);
  void scatter(const Vertex& vertex, Vec3 wi, Rgb weight);
  void depolarize(Vec3 direction, Rgb weight);
  void attenuate(Rgb share);
  void keep(int band);
  Rgb power() const { return {matrix_[0](0, 0), matrix_[1](0, 0), matrix_[2](0, 0)}; }
  Value met(Vec3 direction, Rgb radiance, const light::Emitter& emitter) const;
  static std::vector<std::string> planes() { return {"s1", "s2", "s3"}; }
  static void deposit(const Value& value, Rgb scale, std::span<Rgb> planes) {
    for (std::size_t i = 0; i < value.size(); ++i) planes[i] += value[i] * scale;
  }
  static Rgb radiance(const Value& value) { return value[0]; }

 private:
  Polarized(Vec3 x) : x_(x) {}

  optics::MuellerRgb matrix_{optics::identity_mueller(), optics::identity_mueller(), optics::identity_mueller()};
  Vec3 x_;  // unit, perpendicular to the ray
};

}  // namespace gonio::render
