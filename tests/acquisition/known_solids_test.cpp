// The solids of known arms against the makers' collision models: how far these stick out of the solids, and how far the
// solids reach beyond them.
#include "acquisition/laboratory/known_solids.h"

#include <gmock/gmock.h>

#include <limits>

#include "acquisition/robot_meshes.h"
#include "acquisition/solid_geometry.h"
#include "data.h"
#include "mesh/triangle_tree.h"

namespace gonio::acquisition {
namespace {

struct Fit {
  double overhang_m = 0, excess_m = 0;
};

// Of one link.
Fit fit_of(const std::vector<LinkSolid>& solids, const io::TriangleMesh& model, double spacing_m) {
  Fit fit;
  const auto depth = [&](Vec3 p, const LinkSolid* but) {
    double least = std::numeric_limits<double>::infinity();
    for (const LinkSolid& s : solids)
      if (&s != but) least = std::min(least, tests::signed_distance(s.solid, inverse(s.base_from_body) * p));
    return least;
  };
  for (const Vec3& p : tests::points_on(model, spacing_m)) fit.overhang_m = std::max(fit.overhang_m, depth(p, nullptr));
  const mesh::TriangleTree tree(model.positions_m, model.triangles);
  for (const LinkSolid& s : solids)
    for (const Vec3& local : tests::surface_points(s.solid, spacing_m)) {
      const Vec3 p = s.base_from_body * local;
      if (depth(p, &s) > -1e-9) fit.excess_m = std::max(fit.excess_m, tree.nearest(p).distance_m);
    }
  return fit;
}

TEST(KnownSolids, HoldTheMakersCollisionModels) {
  GONIO_NEEDS_DATA("robots/ur_description");
  for (const char* model : tests::arms_with_meshes) {
    const std::vector<io::TriangleMesh> meshes = tests::robot_meshes(model);
    ASSERT_EQ(meshes.size(), 7u) << model;
    Fit worst;
    std::string links;
    for (int link = 0; link <= 6; ++link) {
      std::vector<LinkSolid> solids = known_solids(model);
      std::erase_if(solids, [&](const LinkSolid& s) { return s.solid.link != link; });
      ASSERT_FALSE(solids.empty()) << model << " link " << link;
      const Fit fit = fit_of(solids, meshes[static_cast<std::size_t>(link)], 0.006);
      worst = {std::max(worst.overhang_m, fit.overhang_m), std::max(worst.excess_m, fit.excess_m)};
      links += " " + std::to_string(link) + ": " +
               std::to_string(std::lround(1e4 * fit.overhang_m) / 10.0).substr(0, 4) + "/" +
               std::to_string(std::lround(1e3 * fit.excess_m));
    }
    std::printf("%-18s overhang %.2f mm, excess %.1f mm; by link [mm]%s\n", model, 1e3 * worst.overhang_m,
                1e3 * worst.excess_m, links.c_str());
    EXPECT_LE(worst.overhang_m, 0.001) << model;
    EXPECT_LE(worst.excess_m, std::string(model).starts_with("ur") ? 0.05 : 0.2) << model;
  }
}

TEST(KnownSolids, NoneAreInventedForOtherArms) {
  EXPECT_TRUE(known_solids("ur3e").empty());
  EXPECT_TRUE(known_solids("dh").empty());
}

}  // namespace
}  // namespace gonio::acquisition
