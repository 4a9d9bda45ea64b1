// A white tile that is no Lambertian one, as a laboratory's goniometer saw it: readings of a matte sample over it.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "data.h"
#include "geom/vector.h"
#include "scene/mechanisms/reference_tile.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

World readings() {
  World w;
  w.columns = {{"theta_i", "rad"}, {"phi_i", "rad"},      {"theta_o", "rad"},
               {"phi_o", "rad"},   {"wavelength_m", "m"}, {"f", "1/sr"}};
  w.sections = R"("surfaces": {"s": {"model": "diffuse", "albedo": {"value": 0.3, "free": true}}},)";
  w.rest = R"("model": "surface", "surface": "s", "observed": ["f"])";
  return w;
}

// The tile reflects 1.101 of a perfect one along its normal under light along it, and 0.869 under light at 70 degrees.
TEST(Tile, ARecordedOneIsNamedSeenAlongItsNormal) {
  constexpr const char* set = "explain/spectralon_panel";
  GONIO_NEEDS_DATA(set);
  World w = readings();
  std::ifstream in(gonio::tests::data(set) / "brf_grid.csv");
  std::string line;
  std::getline(in, line);
  double normal = 0, grazing = 0;
  while (std::getline(in, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream fields(line);
    double nm = 0, incidence = 0, view = 0, azimuth = 0, factor = 0;
    ASSERT_TRUE(fields >> nm >> incidence >> view >> azimuth >> factor) << line;
    if (view != 0) continue;
    if (nm == 550 && incidence == 0) normal = factor;
    if (nm == 550 && incidence == 70) grazing = factor;
    w.rows.push_back({incidence * pi / 180, 0, 0, azimuth * pi / 180, nm * 1e-9, 0.3 / pi / factor});
  }
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  ASSERT_EQ(named(problem, e), "reference.tile") << e.sentence;
  const Estimate* share = estimate_of(problem, e, "reference.tile.incidence");
  ASSERT_NE(share, nullptr) << e.sentence;
  // What was found, against the tile itself where it departs most. Its fall begins sooner than the square that stands
  // for it.
  const double found = equation::reference_tile(share->value, 0, std::cos(70 * pi / 180), 1);
  EXPECT_NEAR(found, normal / grazing, 0.03 * found);
  EXPECT_LT(e.held_out_after, 0.25 * e.held_out_before);
  const Explanation again = asked_again(w, problem, e);
  EXPECT_TRUE(again.named.empty()) << again.sentence;
  EXPECT_LT(again.held_out_before, 1.1 * e.held_out_after);
}

}  // namespace
}  // namespace gonio::explain::tables::tests
