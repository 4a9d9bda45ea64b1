// A sheet that is torn: the trouser tear test (ISO 6383-1). Two legs of a notched sheet are pulled apart, one up, one
// down, and the tear runs along the line of symmetry. The two banks of that line are held together by bonds; one breaks
// where its force exceeds the strength, and the shape after it is the equilibrium without it. A tear does not heal.
#include <cmath>

#include "nrsfm/animatronic_support.h"

namespace gonio::nrsfm::animatronics {
namespace {

constexpr double length_m = 0.2, width_m = 0.14;
constexpr int nx = 28, ny = 18, notch = 4, clamped = 2;  // cells
constexpr double strength_n = 0.35;

struct Cut {
  Sheet sheet;
  std::vector<Bond> bonds;
};

// Columns beyond the clamp get a second vertex on the line y = 0 for the half y > 0.
Cut cut_sheet() {
  Cut cut;
  cut.sheet = flat_sheet(length_m, width_m, nx, ny);
  Eigen::Matrix3Xd& rest = cut.sheet.rest;
  const Eigen::Index whole = rest.cols();
  const int line = ny / 2, first = clamped + 1;
  rest.conservativeResize(3, whole + nx - first + 1);
  const auto second = [&](int i) { return static_cast<std::uint32_t>(whole + i - first); };
  for (int i = first; i <= nx; ++i) {
    rest.col(second(i)) = rest.col(cut.sheet.at(i, line));
    if (i <= nx - notch) cut.bonds.push_back({cut.sheet.at(i, line), second(i), 2e4});
  }
  for (auto& t : cut.sheet.triangles) {
    if ((rest(1, t[0]) + rest(1, t[1]) + rest(1, t[2])) < 0) continue;
    for (std::uint32_t& v : t)
      for (int i = first; i <= nx; ++i)
        if (v == cut.sheet.at(i, line)) {
          v = second(i);
          break;
        }
  }
  return cut;
}

class Tearing : public Animatronic {
 public:
  const AnimatronicInfo& info() const override {
    static const AnimatronicInfo info{
        "tearing", "A notched sheet is torn: one leg is pulled up and back, the other down and back.",
        "trouser tear, ISO 6383-1; bonds of limited strength on linear triangles: Hillerborg, Modeer & Petersson 1976"};
    return info;
  }

  DeformingSurface make(const AnimatronicOptions& options) const override {
    Random random(options.seed, 3);
    const double reach = random.uniform(0.085, 0.1), uneven = random.uniform(0.75, 1);
    const double back = random.uniform(0.75, 0.85);
    Cut cut = cut_sheet();
    const Eigen::Matrix3Xd rest = cut.sheet.rest;
    Shell shell(rest, cut.sheet.triangles,
                {.young_pa = 1e7, .poisson = 0.35, .thickness_m = 4e-4, .density_kg_m3 = 900, .bending_n_m = 2e-4},
                cut.bonds);
    for (Eigen::Index v = 0; v < rest.cols(); ++v) {
      const bool clamp = rest(0, v) < length_m * (-0.5 + (clamped + 0.5) / nx);
      const bool grip = rest(0, v) > length_m * 0.499 && std::abs(rest(1, v)) > 0.12 * width_m;
      shell.fixed[static_cast<std::size_t>(v)] = clamp || grip;
    }
    const auto lead = [&](double s, Eigen::Matrix3Xd& x) {
      for (Eigen::Index v = 0; v < rest.cols(); ++v) {
        if (!shell.fixed[static_cast<std::size_t>(v)]) continue;
        x.col(v) = rest.col(v);
        if (rest(0, v) < 0) continue;
        const double path = reach * eased(s), up = rest(1, v) > 0 ? path : -uneven * path;
        x.col(v) += Eigen::Vector3d(-back * std::abs(up), 0.15 * up, up);
      }
    };
    const auto tear = [&](const Eigen::Matrix3Xd& x) {
      std::size_t worst = shell.bonds.size();
      double most = strength_n;
      for (std::size_t b = 0; b < shell.bonds.size(); ++b)
        if (!shell.bonds[b].broken && shell.bond_force(b, x) > most) worst = b, most = shell.bond_force(b, x);
      if (worst == shell.bonds.size()) return false;
      shell.bonds[worst].broken = true;
      return true;
    };
    return Play(shell, rest, options).run(lead, tear);
  }
};

}  // namespace

const Animatronic& tearing() {
  static const Tearing tearing;
  return tearing;
}

}  // namespace gonio::nrsfm::animatronics
