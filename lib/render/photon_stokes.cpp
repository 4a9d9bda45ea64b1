#include "render/photon_stokes.h"

#include "render/polarized_carrier.h"

namespace gonio::render {

using optics::Mueller;
using optics::Stokes;

PhotonStokes::PhotonStokes(const light::Emitter& emitter, Vec3 direction) {
  depolarize(direction);
  const auto polarization = emitter.polarization(direction);
  if (!polarization) return;
  x_ = polarization->x;
  state_.fill(polarization->stokes);
}

Rgb PhotonStokes::scatter(const Vertex& vertex, Vec3 wi) {
  const Vec3 axis = vertex.frame.to_world(optics::scattering_axis(wi, vertex.wo));
  const Mueller turn = optics::frame_change(-vertex.frame.to_world(vertex.wo), x_, axis);
  const optics::MuellerRgb surface = vertex.model->mueller(vertex.values, vertex.wo, wi);
  x_ = axis;
  std::array<double, 3> factor{};
  for (std::size_t band = 0; band < 3; ++band) {
    Stokes& s = state_[band];
    s = optics::reversed(surface[band]) * (turn * s);
    factor[band] = s.s[0];
    s = factor[band] > 0 ? s * (1 / factor[band]) : Stokes{{1, 0, 0, 0}};
  }
  return {factor[0], factor[1], factor[2]};
}

void PhotonStokes::depolarize(Vec3 direction) {
  state_.fill({{1, 0, 0, 0}});
  x_ = Basis(direction).t;
}

std::array<Rgb, 3> PhotonStokes::seen(Vec3 direction, Vec3 camera_x) const {
  const Mueller turn = optics::frame_change(direction, x_, polarization_axis(camera_x, direction));
  const Stokes r = turn * state_[0], g = turn * state_[1], b = turn * state_[2];
  std::array<Rgb, 3> result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = {r.s[i + 1], g.s[i + 1], b.s[i + 1]};
  return result;
}

}  // namespace gonio::render
