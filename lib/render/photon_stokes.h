// Polarization of a photon on its way from a lamp. The flux is carried beside it, as the power of s0; here are Stokes
// vectors over s0, per band, in the frame (x, d cross x, d) of the direction of travel d (optics/mueller.h).
//
// At a surface the roles are those of light_tracer.h: `wo` points back to the lamp, and Model::mueller(wo, wi) is that
// of light the other way; reversed(), it is the photon's.
#pragma once
#include <array>

#include "light/light.h"
#include "optics/mueller_algebra.h"
#include "render/vertex.h"

namespace gonio::render {

class PhotonStokes {
 public:
  PhotonStokes(const light::Emitter& emitter, Vec3 direction);
  // Leaves along `wi`. By how much more or less than unpolarized light of the same flux, per band.
  Rgb scatter(const Vertex& vertex, Vec3 wi);
  void depolarize(Vec3 direction);
  // s1, s2 and s3 over s0 at a camera towards which it travels; the frame is that of polarized_carrier.h.
  std::array<Rgb, 3> seen(Vec3 direction, Vec3 camera_x) const;

 private:
  std::array<optics::Stokes, 3> state_;  // per band
  Vec3 x_;
};

}  // namespace gonio::render
