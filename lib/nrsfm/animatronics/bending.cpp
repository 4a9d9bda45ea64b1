// A sheet of paper between two clamps that come together, tilt and turn: it rises into an arch. Paper bends a thousand
// times more easily than it stretches, so that the sheet stays close to a developable one.
#include <Eigen/Geometry>
#include <cmath>

#include "nrsfm/animatronic_support.h"

namespace gonio::nrsfm::animatronics {
namespace {

constexpr double length_m = 0.21, width_m = 0.148;
constexpr int nx = 28, ny = 18;

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
    const double closing = random.uniform(0.34, 0.42), tilt = random.uniform(0.75, 0.95);
    const double skew = random.uniform(0.10, 0.16) * (random.uniform() < 0.5 ? -1 : 1);
    const double rounds = random.uniform(0.75, 0.85);
    const Sheet sheet = flat_sheet(length_m, width_m, nx, ny);
    Shell shell(sheet.rest, sheet.triangles,
                {.young_pa = 2e9, .poisson = 0.3, .thickness_m = 1e-4, .density_kg_m3 = 800});
    for (const int i : {0, 1, nx - 1, nx})
      for (int j = 0; j <= ny; ++j) shell.fixed[sheet.at(i, j)] = 1;
    const auto lead = [&](double s, Eigen::Matrix3Xd& x) {
      const double fold = 0.5 - 0.5 * std::cos(2 * pi * rounds * eased(s)), late = eased((s - 0.25) / 0.75);
      const double up = 0.06 + tilt * fold, half = length_m / 2 * (1 - 0.002 - closing * fold);
      const Eigen::Matrix3d turn = (Eigen::AngleAxisd(skew * std::sin(2 * pi * late), Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.4 * skew * late, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
      const double cell = length_m / nx;
      for (int j = 0; j <= ny; ++j) {
        const double y = sheet.rest(1, sheet.at(0, j));
        for (const int i : {0, 1}) {
          const Eigen::Vector3d along(i * cell * std::cos(up), y, i * cell * std::sin(up));
          x.col(sheet.at(i, j)) = Eigen::Vector3d(-half, 0, 0) + along;
          x.col(sheet.at(nx - i, j)) =
              Eigen::Vector3d(half, 0, 0) + turn * Eigen::Vector3d(-along.x(), along.y(), along.z());
        }
      }
    };
    Eigen::Matrix3Xd start = sheet.rest;
    for (Eigen::Index v = 0; v < start.cols(); ++v)
      start(2, v) = 0.06 * length_m / pi * std::cos(pi * start(0, v) / length_m);
    return Play(shell, start, options).run(lead);
  }
};

}  // namespace

const Animatronic& bending() {
  static const Bending bending;
  return bending;
}

}  // namespace gonio::nrsfm::animatronics
