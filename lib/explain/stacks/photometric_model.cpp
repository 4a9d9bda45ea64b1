// See photometric_model.h.
#include "explain/stacks/photometric_model.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "light/mechanisms/light_ambient.h"
#include "light/mechanisms/light_inverse_square.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "optim/damped.h"
#include "optim/descent.h"
#include "render/mechanisms/sensor_black_offset.h"
#include "scene/mechanisms/optics_vignetting.h"
#include "surface/fresnel.h"
#include "surface/interface_albedo.h"
#include "surface/microfacet.h"
#include "surface/oren_nayar.h"
#include "surface/retro_lobe.h"
#include "surface/sheen.h"

namespace gonio::explain::stacks {
namespace {

constexpr double grazing = 1e-3, facing = 0.15, hidden_share = 0.5;

double gloss(double f0, double alpha, Vec3 wo, Vec3 wi) {
  const Vec3 h = surface::half_vector(wo, wi);
  return surface::fresnel_dielectric(surface::half_cosine(wo, wi), surface::eta_of_f0(f0)) *
         surface::Ggx(alpha).lobe(wo, wi, h);
}

// Least squares over the lamps in play that shine on the front.
Vec3 least_squares(const std::vector<PatchLight>& lights, const std::vector<double>& y, const std::vector<char>& out) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-9;
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < y.size(); ++k) {
    if (out[k]) continue;
    const Eigen::Vector3d l = linear::as_eigen(lights[k].towards) * lights[k].white;
    a += l * l.transpose();
    r += l * y[k];
  }
  const Eigen::Vector3d b = linear::solve_ldlt(a, r);
  return {b.x(), b.y(), b.z()};
}

}  // namespace

PatchLight seen_from(const PatchLight& light, Vec3 position, double nearness) {
  if (nearness == 0) return light;
  const Vec3 arm = equation::light_inverse_square_arm(nearness, light.towards, position);
  return {normalized(arm), light.white * equation::light_inverse_square(arm)};
}

double PatchModel::others(double colour, Vec3 wo, Vec3 wi) const {
  double sum = 0;
  if (metal > 0) sum += metal * colour * surface::Ggx(metal_alpha).lobe(wo, wi, surface::half_vector(wo, wi));
  if (sheen > 0) sum += sheen * surface::velvet(wo, wi, sheen_width);
  if (sheen_forward > 0) sum += sheen_forward * surface::forward_sheen(wo, wi);
  if (retro > 0) sum += retro * surface::RetroLobe(retro_alpha, retro_falloff).lobe(wo, wi);
  return sum;
}

double PatchModel::operator()(Vec3 b, double tint, const PatchLight& light, double radius) const {
  const double albedo = norm(b);
  if (!(albedo > 0)) return equation::sensor_black_offset(response(0), offset);
  const Vec3 n = b / albedo;
  const double ci = dot(n, light.towards), co = dot(n, eye);
  double u = 0;
  if (ci > 0) {
    u = light.white * tint * albedo * ci;
    const bool shared = rest() != 1;
    if ((sigma_rad > 0 || f0 > 0 || shared) && co > grazing) {
      const Basis basis(n);
      const Vec3 wo = basis.to_local(eye), wi = basis.to_local(light.towards);
      if (sigma_rad > 0) u *= surface::OrenNayar(sigma_rad).shape(wo, wi);
      if (f0 > 0) {
        const double passes = (1 - surface::dielectric_albedo(wo.z, alpha, f0)) *
                              (1 - surface::dielectric_albedo(wi.z, alpha, f0)) /
                              (1 - surface::dielectric_albedo_mean(alpha, f0));
        u = u * passes + light.white * pi * gloss(f0, alpha, wo, wi) * ci;
      }
      if (shared) u = u * rest() + light.white * pi * others(tint * albedo, wo, wi) * ci;
    }
  }
  if (ambient != 0) u += equation::light_ambient(ambient) * tint * albedo * light.white;
  const double v = response(u) * equation::optics_vignetting(falloff, radius * radius);
  return equation::sensor_black_offset(v, offset);
}

namespace {

// The numbers of one patch: its vector, then two of three tints where there are colours. Slopes are forward
// differences: a patch is one of thousands, and its end is judged by the fall alone.
struct PatchDescent final : optim::Descent {
  const PatchModel& model;
  const PatchReadings& readings;
  Eigen::VectorXd v, r, next, next_r, gradient;
  Eigen::MatrixXd h;

  PatchDescent(const PatchModel& of, const PatchReadings& read, const Patch& start)
      : model(of), readings(read), v(read.channels == 1 ? 3 : 5) {
    v.head(3) = linear::as_eigen(start.b);
    if (read.channels > 1) v[3] = start.tint[0], v[4] = start.tint[1];
    r = residuals(v);
  }
  static Patch patch_of(const Eigen::VectorXd& v) {
    Patch p{{v[0], v[1], v[2]}, {1, 1, 1}};
    if (v.size() > 3) p.tint = {v[3], v[4], 3 - v[3] - v[4]};
    return p;
  }
  Eigen::VectorXd residuals(const Eigen::VectorXd& of) const {
    const Patch p = patch_of(of);
    const std::size_t channels = readings.channels;
    Eigen::VectorXd result(static_cast<Eigen::Index>(readings.y.size()));
    for (std::size_t i = 0; i < readings.y.size(); ++i) {
      const double w = readings.weight[i];
      const double f = w > 0 ? model(p.b, p.tint[i % channels], readings.lights[i / channels], readings.radius) : 0;
      result[static_cast<Eigen::Index>(i)] = w > 0 ? (readings.y[i] - f) * w : 0;
    }
    return result;
  }
  void linearise() override {
    Eigen::MatrixXd j(r.size(), v.size());
    for (Eigen::Index c = 0; c < v.size(); ++c) {
      Eigen::VectorXd moved = v;
      const double step = c < 3 ? 1e-5 * std::max(v.head(3).norm(), 1e-6) : 1e-5;
      moved[c] += step;
      j.col(c) = (r - residuals(moved)) / step;
    }
    h = j.transpose() * j;
    gradient = j.transpose() * r;
  }
  optim::Proposal propose(double damping) override {
    const auto step = optim::damped_step(h, gradient, damping);
    next = v + step.change;
    return {step.promised};
  }
  double evaluate() override {
    next_r = residuals(next);
    return next_r.squaredNorm();
  }
  void accept() override {
    v.swap(next);
    r.swap(next_r);
  }
};

}  // namespace

Patch fitted_patch(const PatchModel& model, const PatchReadings& readings, const Patch& start) {
  PatchDescent patch(model, readings, start);
  optim::Limits limits;
  limits.most_trials = 15;
  limits.least_damping = 1e-9;
  limits.most_damping = 1e5;
  limits.small_fall = limits.rounding = {1e-6, 0};
  optim::descend(patch, patch.r.squaredNorm(), limits);
  return PatchDescent::patch_of(patch.v);
}

Patch matte_patch(const PatchReadings& readings, std::vector<char>& hidden) {
  const std::vector<PatchLight>& lights = readings.lights;
  const std::size_t channels = readings.channels;
  std::vector<double> y(lights.size());
  for (std::size_t i = 0; i < readings.y.size(); ++i) y[i / channels] += readings.y[i] / static_cast<double>(channels);
  // To begin with, the brighter half of the readings, without the two brightest that may be gloss.
  std::vector<std::size_t> order(y.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return y[a] / lights[a].white > y[b] / lights[b].white; });
  hidden.assign(y.size(), 1);
  const std::size_t first = y.size() >= 8 ? 2 : 0;
  for (std::size_t k = first; k < std::max<std::size_t>(first + 4, (y.size() + first + 1) / 2 + 1); ++k)
    if (k < order.size()) hidden[order[k]] = 0;
  Patch patch;
  patch.b = least_squares(lights, y, hidden);
  std::vector<char> dark(hidden);
  for (int i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < y.size(); ++k) {
      const double cosine = dot(patch.b, lights[k].towards) / std::max(norm(patch.b), 1e-12);
      const double promised = dot(patch.b, lights[k].towards) * lights[k].white;
      hidden[k] = cosine > facing && y[k] < hidden_share * promised;
      dark[k] = hidden[k] || cosine <= 0;  // turned away: dark whatever the albedo
    }
    if (std::count(dark.begin(), dark.end(), 0) < 3) break;
    patch.b = least_squares(lights, y, dark);
  }
  if (channels == 1) return patch;
  double all = 0;
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < readings.y.size(); ++i)
    if (!dark[i / channels]) sum[i % channels] += readings.y[i], all += readings.y[i];
  if (all > 0)
    for (std::size_t c = 0; c < 3; ++c) patch.tint[c] = 3 * sum[c] / all;
  return patch;
}

}  // namespace gonio::explain::stacks
