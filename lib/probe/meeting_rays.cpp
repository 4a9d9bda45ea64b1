// See bright_lights.h: rays of several highlights that meet in one lamp.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>

#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "optim/least_squares.h"
#include "probe/bright_lights.h"
#include "probe/mechanisms/probe_distance.h"
#include "stats/distributions.h"

namespace gonio::probe {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Ray {
  Vec3 point_m, direction;  // point from the balls' middle
  Vec3 across[2];
};

// Covariance of all rays' tangents: each has errors of its own, and rays from one ball share those of its place,
// however many views they were seen in. (Taken as independent, four views of one ball would halve an error that no view
// reduces.)
MatrixXd joint_covariance(const std::vector<const Highlight*>& seen, const std::vector<Ray>& rays) {
  const auto n = static_cast<Eigen::Index>(2 * rays.size());
  MatrixXd sum = MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const Highlight &a = *seen[i], &b = *seen[j];
      for (Eigen::Index k = 0; k < 2; ++k)
        for (Eigen::Index l = 0; l < 2; ++l) {
          const Vec3 s = rays[i].across[k], t = rays[j].across[l];
          double value = i != j ? 0 : dot(s, a.own_covariance * t) + (k == l ? 1e-18 : 0);
          for (std::size_t v = 0; a.ball == b.ball && v < a.shifts.size() && v < b.shifts.size(); ++v)
            value += dot(s, a.shifts[v].turn) * dot(t, b.shifts[v].turn);
          const auto row = 2 * static_cast<Eigen::Index>(i) + k, column = 2 * static_cast<Eigen::Index>(j) + l;
          sum(row, column) = sum(column, row) = value;
        }
    }
  return sum;
}

class Lamp final : public optim::Model {  // x: two tangents of the direction, inverse distance times `unit_m`
 public:
  Lamp(std::vector<Ray> rays, const MatrixXd& covariance, Vec3 towards, double unit_m)
      : rays_(std::move(rays)), white_(covariance), frame_(towards), unit_m_(unit_m) {}
  bool sound() const { return white_.info() == Eigen::Success; }
  Vec3 direction(const VectorXd& x) const { return normalized(frame_.n + frame_.t * x[0] + frame_.b * x[1]); }
  const Basis& frame() const { return frame_; }
  bool residuals(const VectorXd& x, VectorXd& r) const override {
    r.resize(static_cast<Eigen::Index>(2 * rays_.size()));
    const Vec3 u = direction(x);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const Vec3 way = equation::probe_distance(u, rays_[i].point_m, x[2] / unit_m_);
      if (!(dot(way, u) > 0)) return false;
      const Vec3 miss = normalized(way) - rays_[i].direction;
      for (std::size_t k = 0; k < 2; ++k) r[static_cast<Eigen::Index>(2 * i + k)] = dot(rays_[i].across[k], miss);
    }
    r = white_.solve_lower(r).eval();
    return true;
  }

 private:
  std::vector<Ray> rays_;
  linear::Llt white_;
  Basis frame_;
  double unit_m_;
};

// The lamp of these highlights, two or more.
std::optional<FoundLight> lamp_of(const std::vector<Highlight>& all, const std::vector<std::size_t>& seen,
                                  Vec3 middle_m, const LightWish& wish) {
  std::vector<Ray> rays;
  std::vector<const Highlight*> used;
  Vec3 towards{};
  double unit_m = 0;
  for (const std::size_t k : seen) {
    const Basis f(all[k].direction);
    rays.push_back({all[k].point_m - middle_m, all[k].direction, {f.t, f.b}});
    used.push_back(&all[k]);
    towards += all[k].direction;
    unit_m = std::max(unit_m, norm(rays.back().point_m));
  }
  if (!(norm(towards) > 0.1) || !(unit_m > 0)) return {};
  const MatrixXd covariance_of_rays = joint_covariance(used, rays);
  const Lamp lamp(std::move(rays), covariance_of_rays, normalized(towards), unit_m);
  if (!lamp.sound()) return {};
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
    // The distance's interval is not even. As far as the farther end of 95 % of the inverse distance.
    const double far = 1 / (1 - stats::normal_quantile(0.975) * sigma / inverse);
    by << linear::as_eigen(f.t * d), linear::as_eigen(f.b * d),
        linear::as_eigen(light.direction * (-d * d * far / unit_m));
    light.position_covariance_m2 = linear::mat3_of(Eigen::Matrix3d(by * covariance * by.transpose()));
  }
  return light;
}

// Irradiance at the middle, its scatter, size: from all that show the whole lamp.
void take_means(FoundLight& light, const std::vector<Highlight>& all) {
  std::vector<std::size_t> seen;
  std::ranges::copy_if(light.seen, std::back_inserter(seen), [&](std::size_t k) { return !all[k].cut; });
  if (seen.empty()) seen = light.seen;
  const auto n = static_cast<double>(seen.size());
  std::vector<Rgb> each;
  std::map<std::pair<std::size_t, std::size_t>, Rgb> shifted;  // by ball and direction of its error
  double half_angle = 0;
  for (const std::size_t k : seen) {
    const Highlight& h = all[k];
    double nearer = 1;  // irradiance at the middle over what the ball's own directions say
    if (light.position_m) {
      const double d = norm(*light.position_m - h.point_m);
      nearer = (d + h.focus_m.x) * (d + h.focus_m.y) / (light.distance_m * light.distance_m);
    }
    each.push_back(h.irradiance * nearer);
    light.irradiance += each.back() / n;
    light.irradiance_sigma += h.own_irradiance_variance * (nearer * nearer / (n * n));
    for (std::size_t v = 0; v < h.shifts.size(); ++v) shifted[{h.ball, v}] += h.shifts[v].more * (nearer / n);
    half_angle += h.half_angle_rad * std::sqrt(nearer) / n;
    light.clipped = light.clipped || h.clipped;
  }
  light.half_angle_rad = half_angle;
  if (!light.position_m) {  // as if it were infinitely far, which it may not be
    double focus_m = 0;
    for (const std::size_t k : seen) focus_m += (all[k].focus_m.x + all[k].focus_m.y) / n;
    const Rgb nearer = light.irradiance * (focus_m * std::hypot(light.nearness_per_m, light.nearness_sigma_per_m));
    light.irradiance_sigma += nearer * nearer;
  }
  for (const auto& [which, more] : shifted) light.irradiance_sigma += more * more;
  if (seen.size() > 1)
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
