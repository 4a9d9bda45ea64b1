// A sheet that is torn: the trouser tear test (ISO 6383-1). Two legs of a notched sheet are pulled apart, one up, one
// down, and the tear runs along the line of symmetry. The two banks of that line are held together by bonds; one breaks
// where its force exceeds the strength, and the shape after it is the equilibrium without it. A tear does not heal.
// Rig: a clamp 20 mm thick on a block, grips of 16 mm on rods, under a portal of 20 mm bars 250 mm tall.
#include <cmath>
#include <map>

#include "nrsfm/make/animatronic_support.h"

namespace gonio::nrsfm::animatronics {
namespace {

constexpr double length_m = 0.2, width_m = 0.14;
constexpr int cells = 28, notch = 4, clamped = 2;
constexpr double strength_n = 0.35;

struct Cut {
  Sheet sheet;
  std::vector<Bond> bonds;
};

// Vertices of the line y = 0 beyond the clamp get a second one for the half y > 0.
Cut cut_sheet() {
  Cut cut;
  cut.sheet = flat_sheet(length_m, width_m, cells);
  Eigen::Matrix3Xd& rest = cut.sheet.rest;
  const double cell = cut.sheet.cell_m;
  std::map<std::uint32_t, std::uint32_t> second;
  const Eigen::Index whole = rest.cols();
  for (Eigen::Index v = 0; v < whole; ++v) {
    if (std::abs(rest(1, v)) > 1e-9 || rest(0, v) < -length_m / 2 + (clamped + 0.1) * cell) continue;
    const auto a = static_cast<std::uint32_t>(v);
    second[a] = static_cast<std::uint32_t>(whole) + static_cast<std::uint32_t>(second.size());
    if (rest(0, v) < length_m / 2 - (notch - 0.1) * cell) cut.bonds.push_back({a, second[a], 2e4});
  }
  rest.conservativeResize(3, whole + static_cast<Eigen::Index>(second.size()));
  for (const auto& [a, b] : second) rest.col(b) = rest.col(a);
  for (auto& t : cut.sheet.triangles) {
    if (rest(1, t[0]) + rest(1, t[1]) + rest(1, t[2]) < 0) continue;
    for (std::uint32_t& v : t)
      if (const auto at = second.find(v); at != second.end()) v = at->second;
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
    const double reach = random.uniform(0.06, 0.07), uneven = random.uniform(0.75, 1);
    const double back = random.uniform(0.25, 0.35);
    Cut cut = cut_sheet();
    const Eigen::Matrix3Xd rest = cut.sheet.rest;
    Shell shell(rest, cut.sheet.triangles,
                {.young_pa = 1e7, .poisson = 0.35, .thickness_m = 4e-4, .density_kg_m3 = 900, .bending_n_m = 2e-4},
                cut.bonds);
    for (Eigen::Index v = 0; v < rest.cols(); ++v) {
      const bool clamp = rest(0, v) < length_m * (-0.5 + (clamped + 0.1) / cells);
      const bool grip = rest(0, v) > length_m * 0.499 && std::abs(rest(1, v)) > 0.12 * width_m;
      shell.fixed[static_cast<std::size_t>(v)] = clamp || grip;
    }
    const auto moved = [&](double s, bool upper) {  // how far a grip has come
      const double path = reach * eased(s), up = upper ? path : -uneven * path;
      return Eigen::Vector3d(-back * std::abs(up), 0.15 * up, up);
    };
    const auto lead = [&](double s, Eigen::Matrix3Xd& x) {
      for (Eigen::Index v = 0; v < rest.cols(); ++v) {
        if (!shell.fixed[static_cast<std::size_t>(v)]) continue;
        x.col(v) = rest.col(v);
        if (rest(0, v) > 0) x.col(v) += moved(s, rest(1, v) > 0);
      }
    };
    const auto rig = [&](double s) {
      constexpr double held_m = clamped * length_m / cells, wide_m = width_m / 2 + 0.008;
      Rig parts{upright_box({(held_m - length_m) / 2 - 0.002, 0, 0}, {held_m / 2 + 0.002, wide_m, 0.01}),
                upright_box({-length_m / 2 - 0.03, 0, -0.01}, {0.025, 0.05, 0.03})};
      for (const double y : {-1.0, 1.0}) {
        const Eigen::Vector3d grip = Eigen::Vector3d(length_m / 2 + 0.004, y * 0.28 * width_m, 0) + moved(s, y > 0);
        parts.push_back(upright_box(grip, {0.008, 0.2 * width_m, 0.008}));
        parts.push_back(upright_box(grip + Eigen::Vector3d(0.01, 0, y * 0.05), {0.006, 0.006, 0.058}));
        parts.push_back(upright_box({0.115, y * (wide_m + 0.02), 0.01}, {0.01, 0.01, 0.12}));
      }
      parts.push_back(upright_box({0.115, 0, 0.14}, {0.01, wide_m + 0.03, 0.01}));
      return parts;
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
    return Play(shell, rest, options).run(lead, rig, tear);
  }
};

}  // namespace

const Animatronic& tearing() {
  static const Tearing tearing;
  return tearing;
}

}  // namespace gonio::nrsfm::animatronics
