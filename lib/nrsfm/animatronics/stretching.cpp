// A sheet of rubber that hangs between two bars, pulled taut and long while the bars turn against each other. It
// narrows as its Poisson's ratio says. Rig: bars 18 mm thick, a motor behind either, two guide rods of 20 mm beside the
// sheet.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "nrsfm/make/animatronic_support.h"

namespace gonio::nrsfm::animatronics {
namespace {

constexpr double length_m = 0.2, width_m = 0.13;
constexpr int cells = 24;

class Stretching : public Animatronic {
 public:
  const AnimatronicInfo& info() const override {
    static const AnimatronicInfo info{
        "stretching", "A sheet of rubber that hangs between two bars is pulled long while the bars turn.",
        "linear triangles, St. Venant-Kirchhoff in plane stress: Bonet & Wood, Nonlinear continuum mechanics, 2008"};
    return info;
  }

  DeformingSurface make(const AnimatronicOptions& options) const override {
    Random random(options.seed, 2);
    const double slack = random.uniform(0.90, 0.93), pull = random.uniform(1.32, 1.42);
    const double twist = random.uniform(0.25, 0.4) * (random.uniform() < 0.5 ? -1 : 1);
    const double skew = random.uniform(-0.15, 0.15);
    const Sheet sheet = flat_sheet(length_m, width_m, cells);
    Shell shell(sheet.rest, sheet.triangles,
                {.young_pa = 1e6, .poisson = 0.45, .thickness_m = 1e-3, .density_kg_m3 = 1100});
    for (Eigen::Index v = 0; v < sheet.rest.cols(); ++v)
      shell.fixed[static_cast<std::size_t>(v)] = std::abs(sheet.rest(0, v)) > 0.499 * length_m;
    const auto bar = [&](double s, int side) {  // its y axis along the end of the sheet
      const double half = length_m / 2 * (slack + (pull - slack) * eased(s));
      return Eigen::Translation3d(side * half, 0, 0) * Eigen::AngleAxisd(skew * eased(s), Eigen::Vector3d::UnitZ()) *
             Eigen::AngleAxisd(side * twist * std::sin(1.5 * pi * s) * eased(2 * s), Eigen::Vector3d::UnitX());
    };
    const auto rig = [&](double s) {
      Rig parts;
      for (const int side : {-1, 1}) {
        const Eigen::Isometry3d world_from_bar = bar(s, side);
        parts.push_back({{0.005, width_m / 2 + 0.005, 0.009}, world_from_bar});
        parts.push_back(
            upright_box(world_from_bar.translation() + Eigen::Vector3d(side * 0.05, 0, 0), {0.025, 0.04, 0.03}));
        parts.push_back(upright_box({0, side * (width_m / 2 + 0.025), 0}, {0.21, 0.01, 0.01}));
      }
      return parts;
    };
    const auto lead = [&](double s, Eigen::Matrix3Xd& x) {
      for (const int side : {-1, 1}) {
        const Eigen::Isometry3d world_from_bar = bar(s, side);
        for (Eigen::Index v = 0; v < x.cols(); ++v)
          if (side * sheet.rest(0, v) > 0.499 * length_m)
            x.col(v) = world_from_bar * Eigen::Vector3d(0, sheet.rest(1, v), 0);
      }
    };
    Eigen::Matrix3Xd start = sheet.rest;  // a parabola of about the sheet's length
    const double sag = std::sqrt(3.0 / 8 * (1 / slack - 1)) * slack * length_m;
    for (Eigen::Index v = 0; v < start.cols(); ++v) {
      const double u = 2 * start(0, v) / length_m;
      start(0, v) *= slack;
      start(2, v) = -sag * (1 - u * u);
    }
    return Play(shell, start, options).run(lead, rig);
  }
};

}  // namespace

const Animatronic& stretching() {
  static const Stretching stretching;
  return stretching;
}

}  // namespace gonio::nrsfm::animatronics
