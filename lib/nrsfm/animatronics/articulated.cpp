// An arm of four rigid links with three joints, in a sleeve of soft rubber. The sleeve is glued to the links and free
// about the joints, where it finds its own equilibrium. Rig: the motor of 60 mm that holds the first link, on a column.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "nrsfm/make/animatronic_support.h"

namespace gonio::nrsfm::animatronics {
namespace {

constexpr int links = 4, rings = 56, sectors = 14;
constexpr double link_m = 0.08, radius_m = 0.018, free_m = 0.026;  // free: of the sleeve to either side of a joint

struct Sleeve {
  Eigen::Matrix3Xd rest;
  Triangles triangles;
};

// A tube along x from 0, closed by a vertex in the middle of either end.
Sleeve sleeve() {
  Sleeve tube;
  tube.rest.resize(3, (rings + 1) * sectors + 2);
  const auto at = [](int ring, int sector) { return static_cast<std::uint32_t>(ring * sectors + sector % sectors); };
  for (int r = 0; r <= rings; ++r)
    for (int k = 0; k < sectors; ++k) {
      const double angle = 2 * pi * (k + 0.5 * (r % 2)) / sectors;
      tube.rest.col(at(r, k)) << links * link_m * r / rings, radius_m * std::cos(angle), radius_m * std::sin(angle);
    }
  const auto first = static_cast<std::uint32_t>((rings + 1) * sectors);
  tube.rest.col(first) << -0.4 * radius_m, 0, 0;
  tube.rest.col(first + 1) << links * link_m + 0.4 * radius_m, 0, 0;
  for (int k = 0; k < sectors; ++k) {
    for (int r = 0; r < rings; ++r) {
      const auto a = at(r, k), b = at(r, k + 1), c = at(r + 1, k), d = at(r + 1, k + 1);
      if (r % 2 == 0) {
        tube.triangles.push_back({a, b, c});
        tube.triangles.push_back({b, d, c});
      } else {
        tube.triangles.push_back({a, d, c});
        tube.triangles.push_back({a, b, d});
      }
    }
    tube.triangles.push_back({first, at(0, k + 1), at(0, k)});
    tube.triangles.push_back({first + 1, at(rings, k), at(rings, k + 1)});
  }
  return tube;
}

class Articulated : public Animatronic {
 public:
  const AnimatronicInfo& info() const override {
    static const AnimatronicInfo info{
        "articulated", "An arm of four rigid links with three joints, in a sleeve of soft rubber.",
        "hinges that swing out of step; sleeve: linear triangles and discrete shells (Grinspun et al. 2003)"};
    return info;
  }

  DeformingSurface make(const AnimatronicOptions& options) const override {
    Random random(options.seed, 5);
    struct Joint {
      double swing = 0, turns = 0, phase = 0;
      Eigen::Vector3d axis{0, 0, 1};
    };
    std::array<Joint, links - 1> joints;
    for (Joint& j : joints) {
      const double lean = random.uniform(-0.35, 0.35);
      j = {random.uniform(0.5, 0.65), random.uniform(0.8, 1.6), random.uniform(0, 2 * pi),
           Eigen::Vector3d(0, std::sin(lean), std::cos(lean))};
    }
    const Sleeve tube = sleeve();
    Shell shell(tube.rest, tube.triangles,
                {.young_pa = 3e5, .poisson = 0.4, .thickness_m = 3e-3, .density_kg_m3 = 1100});
    std::vector<int> link(static_cast<std::size_t>(tube.rest.cols()));
    for (Eigen::Index v = 0; v < tube.rest.cols(); ++v) {
      const double along = tube.rest(0, v) / link_m;
      link[static_cast<std::size_t>(v)] = std::clamp(static_cast<int>(along), 0, links - 1);
      const double joint = std::clamp(std::round(along), 1.0, links - 1.0);
      shell.fixed[static_cast<std::size_t>(v)] = std::abs(along - joint) * link_m > free_m;
    }
    const auto poses = [&](double s) {
      std::array<Eigen::Isometry3d, links> world_from_link;
      world_from_link[0] = Eigen::Isometry3d::Identity();
      for (std::size_t k = 0; k + 1 < links; ++k) {
        const Joint& j = joints[k];
        const Eigen::Vector3d centre((static_cast<double>(k) + 1) * link_m, 0, 0);
        const double angle = j.swing * std::sin(2 * pi * j.turns * s + j.phase);
        world_from_link[k + 1] = world_from_link[k] * Eigen::Translation3d(centre) * Eigen::AngleAxisd(angle, j.axis) *
                                 Eigen::Translation3d(-centre);
      }
      return world_from_link;
    };
    const auto place = [&](double s, Eigen::Matrix3Xd& x, bool all) {
      const auto world_from_link = poses(s);
      for (Eigen::Index v = 0; v < x.cols(); ++v) {
        const auto i = static_cast<std::size_t>(v);
        if (all || shell.fixed[i]) x.col(v) = world_from_link[static_cast<std::size_t>(link[i])] * tube.rest.col(v);
      }
    };
    // From the straight arm to the first pose in small steps.
    Eigen::Matrix3Xd start = tube.rest;
    const auto reach = joints;
    for (int k = 1; k <= 8; ++k) {
      for (std::size_t j = 0; j < joints.size(); ++j) joints[j].swing = reach[j].swing * k / 8;
      place(0, start, false);
      shell.settle(start);
    }
    return Play(shell, start, options)
        .run([&](double s, Eigen::Matrix3Xd& x) { place(s, x, false); },
             [](double) {
               return Rig{upright_box({-0.015, 0, 0}, {0.03, 0.03, 0.03}),
                          upright_box({-0.015, 0, -0.08}, {0.015, 0.015, 0.05})};
             });
  }
};

}  // namespace

const Animatronic& articulated() {
  static const Articulated articulated;
  return articulated;
}

}  // namespace gonio::nrsfm::animatronics
