#include "render/polarized_carrier.h"

namespace gonio::render {

using optics::Mueller;
using optics::Stokes;

Vec3 polarization_axis(Vec3 camera_x, Vec3 direction) {
  const Vec3 across = camera_x - direction * dot(camera_x, direction);
  const double length = norm(across);
  return length > 1e-9 ? across / length : Basis(direction).t;
}

Polarized Polarized::start(Vec3 camera_x, Vec3 direction) {
  return Polarized(polarization_axis(camera_x, direction));
}

void Polarized::scatter(const Vertex& vertex, Vec3 wi, Rgb weight) {
  const Vec3 axis = vertex.frame.to_world(optics::scattering_axis(wi, vertex.wo));
  const Mueller turn = optics::frame_change(vertex.frame.to_world(vertex.wo), axis, x_);
  const optics::MuellerRgb surface = vertex.model->mueller(vertex.values, vertex.wo, wi);
  for (int band = 0; band < 3; ++band) {
    Mueller& matrix = matrix_[static_cast<std::size_t>(band)];
    matrix = weight[band] == 0 ? Mueller{} : matrix * (turn * (surface[static_cast<std::size_t>(band)] * weight[band]));
  }
  x_ = axis;
}

void Polarized::depolarize(Vec3 direction, Rgb weight) {
  for (int band = 0; band < 3; ++band) {
    Mueller& matrix = matrix_[static_cast<std::size_t>(band)];
    matrix = matrix * Mueller::depolarizer() * weight[band];
  }
  x_ = Basis(direction).t;
}

void Polarized::attenuate(Rgb share) {
  for (int band = 0; band < 3; ++band) {
    Mueller& matrix = matrix_[static_cast<std::size_t>(band)];
    matrix = matrix * share[band];
  }
}

void Polarized::keep(int band) {
  attenuate({band == 0 ? 3.0 : 0, band == 1 ? 3.0 : 0, band == 2 ? 3.0 : 0});
}

Polarized::Value Polarized::met(Vec3 direction, Rgb radiance, const light::Emitter& emitter) const {
  const auto polarization = emitter.polarization(-direction);
  Stokes sent{{1, 0, 0, 0}};
  if (polarization) sent = optics::frame_change(-direction, polarization->x, x_) * polarization->stokes;
  Value value;
  const auto received = [&](std::size_t band, double l) { return matrix_[band] * sent * l; };
  const Stokes r = received(0, radiance.x), g = received(1, radiance.y), b = received(2, radiance.z);
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = {r.s[i], g.s[i], b.s[i]};
  return value;
}

}  // namespace gonio::render
