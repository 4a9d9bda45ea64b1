// A sheet of drawing paper (200 g/m^2) between two clamps that come together, tilt and turn: it rises into an arch.
// Paper bends far more easily than it stretches, so that the sheet stays close to a developable one. The clamps stand
// where a circular arc would hold them without a force; then one leans and turns, and the paper is skewed. Rig: jaws
// 18 mm thick, each between two posts 100 mm tall, a motor behind either.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "nrsfm/make/animatronic_support.h"

namespace gonio::nrsfm::animatronics {
namespace {

constexpr double length_m = 0.21, width_m = 0.148;
constexpr double jaw_m = width_m / 2 + 0.006;  // half of its length
constexpr int cells = 28;

class Bending : public Animatronic {
 public:
  const AnimatronicInfo& info() const override {
    static const AnimatronicInfo info{
        "bending",
        "A sheet of paper between two clamps that come together and tilt rises into an arch, which one clamp skews.",
        "linear triangles, St. Venant-Kirchhoff; discrete shells: Grinspun, Hirani, Desbrun & Schroeder, SCA 2003"};
    return info;
  }

  DeformingSurface make(const AnimatronicOptions& options) const override {
    Random random(options.seed, 1);
    const double most = random.uniform(1.25, 1.4), least = random.uniform(0.35, 0.5);
    const double skew = random.uniform(0.12, 0.18) * (random.uniform() < 0.5 ? -1 : 1);
    const double lean = random.uniform(0.15, 0.25) * (random.uniform() < 0.5 ? -1 : 1);
    const double rounds = random.uniform(0.75, 0.85);
    const Sheet sheet = flat_sheet(length_m, width_m, cells);
    Shell shell(sheet.rest, sheet.triangles,
                {.young_pa = 2e9, .poisson = 1.0 / 3, .thickness_m = 2.5e-4, .density_kg_m3 = 800});
    const auto from_end = [&](Eigen::Index v) { return length_m / 2 - std::abs(sheet.rest(0, v)); };
    for (Eigen::Index v = 0; v < sheet.rest.cols(); ++v)
      shell.fixed[static_cast<std::size_t>(v)] = from_end(v) < 1.01 * sheet.cell_m;
    const auto half_angle = [&](double s) {
      return least + (most - least) * (0.5 - 0.5 * std::cos(2 * pi * rounds * eased(s)));
    };
    // Of the clamp at x < 0 (side -1) or x > 0: its x axis leads into the sheet from the end, its y axis along the end.
    const auto clamp = [&](double s, double side) {
      const double arc = half_angle(s), half = length_m / 2 * std::sin(arc) / arc, late = eased((s - 0.2) / 0.8);
      const double up = arc + side * lean * std::sin(2 * pi * late);
      Eigen::Isometry3d world_from_clamp(Eigen::Translation3d(side * half, 0, 0));
      if (side > 0)
        world_from_clamp.rotate(Eigen::AngleAxisd(skew * std::sin(2 * pi * late), Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(0.4 * skew * late, Eigen::Vector3d::UnitX()));
      Eigen::Matrix3d axes;
      axes.col(0) << -side * std::cos(up), 0, std::sin(up);
      axes.col(1) << 0, 1, 0;
      axes.col(2) = axes.col(0).cross(axes.col(1));
      return Eigen::Isometry3d(world_from_clamp * Eigen::Quaterniond(axes));
    };
    const auto lead = [&](double s, Eigen::Matrix3Xd& x) {
      const std::array<Eigen::Isometry3d, 2> clamps{clamp(s, -1), clamp(s, 1)};
      for (Eigen::Index v = 0; v < x.cols(); ++v) {
        if (!shell.fixed[static_cast<std::size_t>(v)]) continue;
        x.col(v) = clamps[sheet.rest(0, v) > 0] * Eigen::Vector3d(from_end(v), sheet.rest(1, v), 0);
      }
    };
    const auto rig = [&](double s) {
      Rig parts;
      for (const double side : {-1.0, 1.0}) {
        const Eigen::Isometry3d world_from_clamp = clamp(s, side);
        parts.push_back({{0.006, jaw_m, 0.009}, world_from_clamp * Eigen::Translation3d(0.001, 0, 0)});
        const double x = world_from_clamp.translation().x();
        for (const double y : {-1.0, 1.0})
          parts.push_back(upright_box({x, y * (jaw_m + 0.008), 0.01}, {0.01, 0.008, 0.05}));
        parts.push_back(upright_box({x + side * 0.045, 0, -0.005}, {0.025, 0.035, 0.035}));
      }
      return parts;
    };
    Eigen::Matrix3Xd start = sheet.rest;  // the circular arc whose ends the clamps hold
    const double arc = half_angle(0), radius = length_m / (2 * arc);
    for (Eigen::Index v = 0; v < start.cols(); ++v) {
      const double angle = sheet.rest(0, v) / radius;
      start(0, v) = radius * std::sin(angle), start(2, v) = radius * (std::cos(angle) - std::cos(arc));
    }
    return Play(shell, start, options).run(lead, rig);
  }
};

}  // namespace

const Animatronic& bending() {
  static const Bending bending;
  return bending;
}

}  // namespace gonio::nrsfm::animatronics
