// See bright_lights.h: rays of several highlights that meet in one lamp.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/geom_matrices.h"
#include "optim/least_squares.h"
#include "probe/bright_lights.h"
#include "probe/mechanisms/probe_distance.h"

namespace gonio::probe {
namespace {

using Eigen::VectorXd;

struct WhiteRay {
  Vec3 point_m, direction;  // point from the balls' middle
  Vec3 rows[2];             // whitened tangents: residual k is dot(rows[k], predicted - direction)
};

// Rows that make the tangential covariance a unit matrix.
WhiteRay white_ray(const Highlight& h, Vec3 middle_m) {
  const Basis f(h.direction);
  const auto by = [&](Vec3 a, Vec3 b) { return dot(a, h.covariance * b); };
  const double tt = by(f.t, f.t), tb = by(f.t, f.b), bb = by(f.b, f.b);
  const double l11 = std::sqrt(std::max(tt, 1e-18)), l21 = tb / l11, l22 = std::sqrt(std::max(bb - l21 * l21, 1e-18));
  return {h.point_m - middle_m, h.direction, {f.t / l11, (f.b - f.t * (l21 / l11)) / l22}};
}

class Lamp final : public optim::Model {  // x: two tangents of the direction, inverse distance times `unit_m`
 public:
  Lamp(std::vector<WhiteRay> rays, Vec3 towards, double unit_m)
      : rays_(std::move(rays)), frame_(towards), unit_m_(unit_m) {}
  Vec3 direction(const VectorXd& x) const { return normalized(frame_.n + frame_.t * x[0] + frame_.b * x[1]); }
  const Basis& frame() const { return frame_; }
  bool residuals(const VectorXd& x, VectorXd& r) const override {
    r.resize(static_cast<Eigen::Index>(2 * rays_.size()));
    const Vec3 u = direction(x);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const Vec3 way = equation::probe_distance(u, rays_[i].point_m, x[2] / unit_m_);
      if (!(dot(way, u) > 0)) return false;
      const Vec3 miss = normalized(way) - rays_[i].direction;
      for (std::size_t k = 0; k < 2; ++k) r[static_cast<Eigen::Index>(2 * i + k)] = dot(rays_[i].rows[k], miss);
    }
    return true;
  }

 private:
  std::vector<WhiteRay> rays_;
  Basis frame_;
  double unit_m_;
};

// The lamp of these highlights, two or more.
std::optional<FoundLight> lamp_of(const std::vector<Highlight>& all, const std::vector<std::size_t>& seen,
                                  Vec3 middle_m, const LightWish& wish) {
  std::vector<WhiteRay> rays;
  Vec3 towards{};
  double unit_m = 0;
  for (const std::size_t k : seen) {
    rays.push_back(white_ray(all[k], middle_m));
    towards += all[k].direction;
    unit_m = std::max(unit_m, norm(rays.back().point_m));
  }
  if (!(norm(towards) > 0.1) || !(unit_m > 0)) return {};
  const Lamp lamp(std::move(rays), normalized(towards), unit_m);
  const optim::Fit fit = optim::fit(lamp, VectorXd::Zero(3));
  if (!fit.determined) return {};
  FoundLight light;
  light.seen = seen;
  light.direction = lamp.direction(fit.x);
  light.chi_square = fit.cost;
  light.degrees = static_cast<int>(2 * seen.size()) - 3;
  const Eigen::Matrix3d covariance = fit.covariance;
  Eigen::Matrix3d by;  // d (direction) / d x, and the inverse distance's own column
  const Basis& f = lamp.frame();
  by << linear::as_eigen(f.t), linear::as_eigen(f.b), Eigen::Vector3d::Zero();
  light.direction_covariance = linear::mat3_of(Eigen::Matrix3d(by * covariance * by.transpose()));
  light.distance_m = HUGE_VAL;
  const double inverse = fit.x[2] / unit_m, sigma = std::sqrt(covariance(2, 2)) / unit_m;
  light.nearness_per_m = inverse, light.nearness_sigma_per_m = sigma;
  if (inverse > wish.least_z * sigma) {
    const double d = 1 / inverse;
    light.distance_m = d;
    light.position_m = middle_m + light.direction * d;
    by << linear::as_eigen(f.t * d), linear::as_eigen(f.b * d), linear::as_eigen(light.direction * (-d * d / unit_m));
    light.position_covariance_m2 = linear::mat3_of(Eigen::Matrix3d(by * covariance * by.transpose()));
  }
  return light;
}

// Irradiance at the middle, its scatter, size: from all that show the lamp.
void take_means(FoundLight& light, const std::vector<Highlight>& all) {
  const auto n = static_cast<double>(light.seen.size());
  std::vector<Rgb> each;
  double half_angle = 0;
  for (const std::size_t k : light.seen) {
    const Highlight& h = all[k];
    double nearer = 1;  // irradiance at the middle over what the ball's own directions say
    if (light.position_m) {
      const double d = norm(*light.position_m - h.point_m);
      nearer = (d + h.focus_m.x) * (d + h.focus_m.y) / (light.distance_m * light.distance_m);
    }
    each.push_back(h.irradiance * nearer);
    light.irradiance += each.back() / n;
    light.irradiance_sigma += h.irradiance_sigma * h.irradiance_sigma / (n * n);
    half_angle += h.half_angle_rad * std::sqrt(nearer) / n;
    light.clipped = light.clipped || h.clipped;
  }
  light.half_angle_rad = half_angle;
  if (light.seen.size() > 1)
    for (const Rgb& e : each) {
      const Rgb off = e - light.irradiance;
      light.irradiance_sigma += off * off / (n * (n - 1));
    }
  const Rgb v = light.irradiance_sigma;
  light.irradiance_sigma = {std::sqrt(v.x), std::sqrt(v.y), std::sqrt(v.z)};
}

bool alike(const Highlight& a, const Highlight& b) {
  constexpr double factor = 3;
  const double ratio = mean(a.irradiance) / mean(b.irradiance);
  return ratio < factor && ratio > 1 / factor;
}

}  // namespace

std::vector<FoundLight> lights_of(const std::vector<Highlight>& all, Vec3 middle_m, const LightWish& wish) {
  constexpr double gate = 25;  // chi-square of one more ray
  std::vector<bool> taken(all.size());
  std::vector<std::size_t> order(all.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t k) { return mean(all[k].irradiance); });
  std::size_t views = 0;
  for (const Highlight& h : all) views = std::max(views, h.view + 1);
  std::vector<FoundLight> lights;
  for (const std::size_t first : order) {
    if (taken[first]) continue;
    FoundLight light;
    light.seen = {first};
    light.direction = all[first].direction, light.direction_covariance = all[first].covariance;
    light.distance_m = HUGE_VAL;
    for (std::size_t v = 0; v < views; ++v) {
      if (v == all[first].view) continue;
      std::optional<FoundLight> best;
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (taken[k] || all[k].view != v || !alike(all[k], all[first])) continue;
        std::vector<std::size_t> with = light.seen;
        with.push_back(k);
        const auto tried = lamp_of(all, with, middle_m, wish);
        if (tried && tried->chi_square < light.chi_square + gate && (!best || tried->chi_square < best->chi_square))
          best = tried;
      }
      if (best) light = *best;
    }
    for (const std::size_t k : light.seen) taken[k] = true;
    take_means(light, all);
    lights.push_back(std::move(light));
  }
  std::ranges::stable_sort(lights, std::greater{}, [](const FoundLight& l) { return mean(l.irradiance); });
  return lights;
}

}  // namespace gonio::probe
