// Rows of sightings: text that reads back to the same numbers, walls that a line of sight crosses, and what the walls
// do to it against the formula of a plane-parallel plate and against Fermat's principle.
#include "reassembly/marker_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "io/csv.h"
#include "reassembly/mechanisms/marker_offset.h"
#include "reassembly/mechanisms/marker_refracted.h"
#include "volume/mechanisms/ct_scale.h"

namespace gonio::reassembly {
namespace {

MarkerRow some_row(Random& random) {
  const auto any = [&] { return Vec3{random.normal(), random.normal(), random.normal()}; };
  MarkerRow row{"left, 3", "pot", "pot \"knob\"", any(), 1e-5, normalized(any()), {1234.5678901, 77}, {0.1, 0.2}, {}};
  row.glass[0] = {3e-3, 0.02, normalized(any()), normalized(any())};
  return row;
}

TEST(MarkerRows, ReadBackAsTheyWereWritten) {
  Random random(1);
  const MarkerRow row = some_row(random);
  const io::Csv csv = io::parse_csv(marker_csv(std::vector<MarkerRow>{row, row}), "markers.csv");
  ASSERT_EQ(csv.header.size(), marker_columns().size());
  for (std::size_t c = 0; c < csv.header.size(); ++c) EXPECT_EQ(csv.header[c], marker_columns()[c].name);
  ASSERT_EQ(csv.rows.size(), 2u);
  const auto cell = [&](const std::string& name) {
    return csv.rows[1][static_cast<std::size_t>(std::ranges::find(csv.header, name) - csv.header.begin())];
  };
  EXPECT_EQ(cell("image"), row.image);
  EXPECT_EQ(cell("marker"), row.marker);
  EXPECT_EQ(io::csv_number(cell("z_m"), ""), row.centre_m.z);
  EXPECT_EQ(io::csv_number(cell("ny"), ""), row.normal.y);
  EXPECT_EQ(io::csv_number(cell("u_px"), ""), row.seen_px.x);
  EXPECT_EQ(io::csv_number(cell("v_sigma_px"), ""), row.sigma_px.y);
  EXPECT_EQ(io::csv_number(cell("glass_behind_m"), ""), row.glass[0].behind_m);
  EXPECT_EQ(io::csv_number(cell("glass_out_x"), ""), row.glass[0].out.x);
  EXPECT_EQ(io::csv_number(cell("glass2_path_m"), ""), 0);
}

TEST(MarkerRows, TheSectionNamesEveryColumnWithItsUnit) {
  const manifest::Table table = marker_table("markers");
  ASSERT_EQ(table.columns.size(), marker_columns().size());
  for (const auto& [name, unit] : table.columns) {
    const bool of_length = name.ends_with("_m"), of_pixels = name.ends_with("_px");
    if (!of_length && !of_pixels) continue;
    EXPECT_EQ(unit, of_length ? "m" : "px") << name;
  }
  EXPECT_THAT(table.observed, testing::ElementsAre("u_px", "v_px"));
  EXPECT_EQ(table.group, "marker");
}

// A box between -size / 2 and size / 2.
mesh::Mesh box(Vec3 size) {
  mesh::Mesh m;
  for (int i = 0; i < 8; ++i)
    m.positions_m.push_back(Vec3{i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5} * size);
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return m;
}

TEST(Walls, AreThoseThatTheLineGoesThroughTheFarthestFromTheMarkerFirst) {
  const mesh::Mesh pane = box({1, 1, 4e-3});
  const mesh::TriangleTree tree(pane.positions_m, pane.triangles);
  const auto at = [&](double z) { return PosedMesh{&pane, &tree, {{}, {0.013, 0.021, z}}}; };
  const std::vector<PosedMesh> panes{at(0.1), at(0.3)};
  const Vec3 camera{0.3, 0, 1}, marker{0, 0, 0};
  const double stretch = norm(camera - marker);  // per metre of height
  const auto walls = walls_between(camera, marker, 3e-3, panes);
  EXPECT_NEAR(walls[0].path_m, 4e-3 * stretch, 1e-9);
  EXPECT_NEAR(walls[0].behind_m, 0.298 * stretch, 1e-9);
  EXPECT_NEAR(walls[1].behind_m, 0.098 * stretch, 1e-9);
  EXPECT_NEAR(walls[0].in.z, 1, 1e-12);
  EXPECT_NEAR(walls[0].out.z, -1, 1e-12);
  // On the near side of a pane nothing stands between; on its far side the pane itself does; and a centre that lies
  // within the glass by less than the marker's radius belongs to a marker on the near side.
  const std::vector<PosedMesh> own{at(0)};
  EXPECT_EQ(walls_between(camera, {0, 0, 4e-3}, 3e-3, own)[0].path_m, 0);
  EXPECT_EQ(walls_between(camera, {0, 0, 1e-3}, 3e-3, own)[0].path_m, 0);
  const GlassWall through = walls_between(camera, {0, 0, -4e-3}, 3e-3, own)[0];
  EXPECT_NEAR(through.path_m, 4e-3 * norm(Vec3{0.3, 0, 1.004}) / 1.004, 1e-9);
  EXPECT_NEAR(through.behind_m, 2e-3 * norm(Vec3{0.3, 0, 1.004}) / 1.004, 1e-9);
  EXPECT_NEAR(outward_normal(pane, tree, {0.1, 0.1, 0.01}).z, 1, 1e-12);
}

// A ray comes out of a plate displaced by t sin(i - r) / cos(r) (Born & Wolf 1999, section 4.6), and the camera looks
// at another place by that.
TEST(Refracted, ThroughAPlateIsDisplacedByTheTextbooksFormula) {
  const double thickness = 4e-3, eta = 1.5, incidence = 0.7, within = std::asin(std::sin(incidence) / eta);
  const Vec3 marker{}, camera = Vec3{std::sin(incidence), 0, std::cos(incidence)} * 1000;  // so far that rays are equal
  const GlassWall wall{thickness / std::cos(incidence), 0.05, {0, 0, 1}, {0, 0, -1}};
  const Vec3 seems = equation::marker_refracted(camera, marker, camera, marker, std::vector{wall}, eta);
  EXPECT_NEAR(norm(seems), thickness * std::sin(incidence - within) / std::cos(within), 1e-7);
  EXPECT_LT(std::abs(dot(seems, normalized(camera))), 1e-6);
  EXPECT_EQ(equation::marker_refracted(camera, marker, camera, marker, std::vector{wall}, 1), marker);
  EXPECT_EQ(equation::marker_refracted(camera, marker, camera, marker, {}, eta), marker);
}

// Where a ray from `camera` to `marker` by way of two spheres about `centre` meets the first: the time of travel is
// stationary in both points. Descent along the spheres.
Vec3 first_point(Vec3 camera, Vec3 marker, Vec3 centre, Vec3 p, Vec3 q, double eta) {
  const double outer = norm(p - centre), inner = norm(q - centre);
  for (int round = 0; round < 6000; ++round) {
    const Vec3 before = normalized(p - camera), between = normalized(q - p) * eta, after = normalized(marker - q);
    p = centre + normalized(p - (before - between) * 4e-4 - centre) * outer;
    q = centre + normalized(q - (between - after) * 4e-4 - centre) * inner;
  }
  return p;
}

struct Shell {
  double outer_m, inner_m, behind_m;
  double within;  // of the effect
};
class Curved : public testing::TestWithParam<Shell> {};

TEST_P(Curved, GlassBendsSightAsTheShortestTimeDoes) {
  const Shell shell = GetParam();
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const Vec3 camera{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0.9}, centre{};
    const Vec3 aim{random.uniform(0.2, 0.4) * shell.outer_m, random.uniform(-0.3, 0.3) * shell.outer_m, 0};
    const Vec3 d = normalized(aim - camera), middle = camera - d * dot(camera, d);
    const auto chord = [&](double r) { return d * std::sqrt(r * r - dot(middle, middle)); };
    const Vec3 p = middle - chord(shell.outer_m);
    const Vec3 q = middle - chord(shell.inner_m);
    const Vec3 marker = q + d * shell.behind_m, out = -normalized(q);
    const GlassWall wall{norm(q - p), shell.behind_m, normalized(p), out};
    const double eta = 1.52;
    const Vec3 true_sight = normalized(first_point(camera, marker, centre, p, q, eta) - camera);
    const Vec3 seems = equation::marker_refracted(camera, marker, camera, marker, std::vector{wall}, eta);
    const double effect = norm(d - true_sight);
    EXPECT_GT(effect, 2e-6);
    EXPECT_LT(norm(normalized(seems - camera) - true_sight), shell.within * effect) << effect;
  }
}
INSTANTIATE_TEST_SUITE_P(Refracted, Curved,
                         testing::Values(Shell{0.06, 0.057, 0.04, 0.03}, Shell{0.15, 0.146, 0.1, 0.03},
                                         Shell{0.15, 0.146, 5e-3, 0.03}));

TEST(Offset, AndScaleAreTheSameOnABallAboutTheOrigin) {
  const Vec3 n = normalized(Vec3{0.3, -0.4, 0.8}), x = n * 0.05;
  const Vec3 glued = equation::marker_offset(x, n, 2e-4);
  EXPECT_NEAR(norm(glued - equation::ct_scale_undone(x, 0.05 / 0.0502 - 1, 0)), 0, 1e-15);
  EXPECT_EQ(equation::ct_scale_undone(x, 0, 0), x);
  // What the wall of a volume seems to be off by, first order (the domain volumes), is what is undone here.
  EXPECT_NEAR(dot(x - equation::ct_scale_undone(x, 1e-6, 2e-6), n), equation::ct_scale(0, 1e-6, 2e-6, x, n, 1), 1e-12);
}

}  // namespace
}  // namespace gonio::reassembly
