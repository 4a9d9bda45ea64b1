// A rubber ball in a cup, glued to it up to 30 degrees below its equator, loses its air: it shrinks while it is taut,
// then a dent falls in where it is worn flat. The gas inside obeys p V = c against the air outside; c falls.
// Rig: the block that the cup is milled into.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>

#include "nrsfm/make/animatronic_support.h"

namespace gonio::nrsfm::animatronics {
namespace {

constexpr double radius_m = 0.09, air_pa = 101325;

struct Ball {
  Eigen::Matrix3Xd rest;
  Triangles triangles;
};

// Icosahedron whose triangles are quartered `times` times, on the unit sphere.
Ball unit_ball(int times) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Eigen::Vector3d> v = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  Triangles t = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (auto& p : v) p.normalize();
  for (int k = 0; k < times; ++k) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(v.size()));
      if (added) v.push_back((v[a] + v[b]).normalized());
      return at->second;
    };
    Triangles finer;
    for (const auto& [a, b, c] : t) {
      const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& f : Triangles{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) finer.push_back(f);
    }
    t = finer;
  }
  Ball ball{Eigen::Matrix3Xd(3, v.size()), t};
  for (std::size_t i = 0; i < v.size(); ++i) ball.rest.col(static_cast<Eigen::Index>(i)) = v[i];
  return ball;
}

class Deflation : public Animatronic {
 public:
  const AnimatronicInfo& info() const override {
    static const AnimatronicInfo info{
        "deflation", "A rubber ball in a cup loses its air: it shrinks, then a dent falls in.",
        "linear triangles and discrete shells (Grinspun et al. 2003) around an ideal gas: p V = c"};
    return info;
  }

  DeformingSurface make(const AnimatronicOptions& options) const override {
    Random random(options.seed, 4);
    const Eigen::Vector3d top =
        Eigen::Vector3d(random.uniform(-0.25, 0.25), random.uniform(-0.25, 0.25), 1).normalized();
    const double swelling = random.uniform(1.005, 1.012), left = random.uniform(0.74, 0.78);
    Ball ball = unit_ball(3);
    const Eigen::Matrix3Xd unit = ball.rest;
    for (Eigen::Index v = 0; v < unit.cols(); ++v) {
      const double angle = std::acos(std::clamp(unit.col(v).dot(top), -1.0, 1.0));
      ball.rest.col(v) *= radius_m * (1 - 0.08 * std::exp(-angle * angle / (2 * 0.35 * 0.35)));  // worn flat
    }
    Shell shell(ball.rest, ball.triangles,
                {.young_pa = 8e5, .poisson = 0.45, .thickness_m = 1e-2, .density_kg_m3 = 1100});
    for (Eigen::Index v = 0; v < unit.cols(); ++v) shell.fixed[static_cast<std::size_t>(v)] = unit(2, v) < -0.5;
    const double rest_volume = shell.volume(ball.rest);
    const double tension = 8e5 * 1e-2 / (1 - 0.45) * (swelling - 1);
    const double full = (air_pa + 2 * tension / (radius_m * swelling)) * std::pow(swelling, 3) * rest_volume;
    shell.outside_pa = air_pa;
    const auto lead = [&](double s, Eigen::Matrix3Xd& x) {
      shell.gas_nm = full + (air_pa * left * rest_volume - full) * s;
      for (Eigen::Index v = 0; v < unit.cols(); ++v)
        if (shell.fixed[static_cast<std::size_t>(v)]) x.col(v) = ball.rest.col(v);
    };
    Eigen::Matrix3Xd start = ball.rest;
    start.array() *= swelling;
    start.row(2).array() += radius_m * (swelling - 1);
    return Play(shell, start, options).run(lead, [](double) {
      constexpr double rim_m = -0.5 * radius_m, floor_m = -radius_m - 0.01;
      return Rig{upright_box({0, 0, (rim_m + floor_m) / 2}, {0.095, 0.095, (rim_m - floor_m) / 2})};
    });
  }
};

}  // namespace

const Animatronic& deflation() {
  static const Deflation deflation;
  return deflation;
}

}  // namespace gonio::nrsfm::animatronics
