// The five animatronics: equilibrium in every frame, and the properties that give each kind its name.
// One process: All/Kind.*:Animatronics.*:Articulated.*:Bending.*:Deflation.*:Stretching.*:Tearing.*
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "nrsfm/make/animatronic_support.h"
#include "nrsfm/make/camera_paths.h"
#include "nrsfm/make/occlusion.h"

namespace gonio::nrsfm {
namespace {

// Each kind is simulated once for all tests.
const DeformingSurface& made(const std::string& id) {
  static std::map<std::string, DeformingSurface> all;
  const auto at = all.find(id);
  if (at != all.end()) return at->second;
  return all[id] = find_animatronic(id)->make({.frames = 21, .points = 80, .seed = 3});
}

Eigen::MatrixXd edge_lengths(const DeformingSurface& s) {
  Eigen::MatrixXd lengths(s.frames(), static_cast<Eigen::Index>(3 * s.triangles.size()));
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    const auto x = shape_of(s.vertices_m, f);
    for (std::size_t k = 0; k < s.triangles.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i)
        lengths(f, static_cast<Eigen::Index>(3 * k + i)) =
            (x.col(s.triangles[k][i]) - x.col(s.triangles[k][(i + 1) % 3])).norm();
  }
  return lengths;
}

// How often the closed surface winds about p (van Oosterom & Strackee 1983).
double winding(const DeformingSurface& s, Eigen::Index frame, const Eigen::Vector3d& p) {
  const auto x = shape_of(s.vertices_m, frame);
  double angle = 0;
  for (const auto& t : s.triangles) {
    const Eigen::Vector3d a = x.col(t[0]) - p, b = x.col(t[1]) - p, c = x.col(t[2]) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * M_PI);
}

// Just outside each triangle the winding number is 0, just inside 1: the surface does not run through itself.
void expect_no_self_penetration(const DeformingSurface& s, Eigen::Index frame) {
  const auto x = shape_of(s.vertices_m, frame);
  for (std::size_t k = 0; k < s.triangles.size(); k += 3) {
    const auto& t = s.triangles[k];
    const Eigen::Vector3d n = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0])).normalized();
    const Eigen::Vector3d centre = (x.col(t[0]) + x.col(t[1]) + x.col(t[2])) / 3;
    ASSERT_NEAR(winding(s, frame, centre + 1e-5 * n), 0, 1e-6) << "triangle " << k << ", frame " << frame;
    ASSERT_NEAR(winding(s, frame, centre - 1e-5 * n), 1, 1e-6) << "triangle " << k << ", frame " << frame;
  }
}

bool crosses(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const std::array<Eigen::Vector3d, 3>& t) {
  Eigen::Matrix3d m;
  m << t[1] - t[0], t[2] - t[0], from - to;
  const Eigen::Vector3d at = m.inverse() * (from - t[0]);  // two weights, the part of the way; not finite: parallel
  return at.minCoeff() > 1e-9 && at.x() + at.y() < 1 - 1e-9 && at.z() < 1 - 1e-9;
}

// Edges that run through triangles which they do not belong to. Vertices that coincide in the first frame are one.
int self_crossings(const DeformingSurface& s, Eigen::Index frame) {
  const auto x = shape_of(s.vertices_m, frame), x0 = shape_of(s.vertices_m, 0);
  std::map<std::array<long, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> same;
  for (Eigen::Index v = 0; v < x0.cols(); ++v) {
    const Eigen::Vector3d cell = (x0.col(v) / 1e-4).array().round();
    same.push_back(
        places.try_emplace({std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())}, v).first->second);
  }
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto& t : s.triangles) {
    boxes.emplace_back(Eigen::Vector3d(x.col(t[0])));
    boxes.back().extend(Eigen::Vector3d(x.col(t[1]))).extend(Eigen::Vector3d(x.col(t[2])));
  }
  int crossings = 0;
  for (const auto& e : s.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = e[i], b = e[(i + 1) % 3];
      if (a > b) continue;  // of two triangles with this edge one sees it in order
      Eigen::AlignedBox3d edge{Eigen::Vector3d(x.col(a))};
      edge.extend(Eigen::Vector3d(x.col(b)));
      for (std::size_t k = 0; k < s.triangles.size(); ++k) {
        if (!edge.intersects(boxes[k])) continue;
        const auto& t = s.triangles[k];
        if (std::ranges::any_of(t, [&](std::uint32_t v) { return same[v] == same[a] || same[v] == same[b]; })) continue;
        crossings += crosses(x.col(a), x.col(b), {x.col(t[0]), x.col(t[1]), x.col(t[2])});
      }
    }
  return crossings;
}

// Largest side of the box about all frames.
double extent(const DeformingSurface& s) {
  double most = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto coordinate = s.points_m(Eigen::seq(axis, Eigen::last, 3), Eigen::all);
    most = std::max(most, coordinate.maxCoeff() - coordinate.minCoeff());
  }
  return most;
}

class Kind : public ::testing::TestWithParam<const char*> {};

TEST_P(Kind, ForcesBalanceAndPointsLieOnTheSurface) {
  const DeformingSurface& s = made(GetParam());
  EXPECT_GT(s.residual, 0);
  EXPECT_LE(s.residual, 1e-6);
  EXPECT_EQ(s.points_m.cols(), 80);
  EXPECT_TRUE(s.vertices_m.allFinite());
  const Shapes again = anchored(s);
  EXPECT_EQ((again - s.points_m).cwiseAbs().maxCoeff(), 0);
}

// A jump would be a step far longer than those before and after it. What buckles or tears moves on in small ones, up to
// a cell of the lattice: an allowance of a twentieth of the scene.
TEST_P(Kind, MovesWithoutJumps) {
  const DeformingSurface& s = made(GetParam());
  std::vector<double> steps;
  for (Eigen::Index f = 1; f < s.frames(); ++f)
    steps.push_back((shape_of(s.points_m, f) - shape_of(s.points_m, f - 1)).colwise().norm().maxCoeff());
  EXPECT_GT(*std::max_element(steps.begin(), steps.end()), 1e-3);
  for (std::size_t k = 1; k + 1 < steps.size(); ++k)
    EXPECT_LT(steps[k], 2 * std::max(steps[k - 1], steps[k + 1]) + 0.05 * extent(s)) << "after frame " << k;
}

TEST_P(Kind, NeverRunsThroughItself) {
  const DeformingSurface& s = made(GetParam());
  for (Eigen::Index f = 0; f < s.frames(); ++f) EXPECT_EQ(self_crossings(s, f), 0) << "frame " << f;
  DeformingSurface through = s;  // one vertex is pushed far away, through what lies between
  const Eigen::Index v = s.triangles[s.triangles.size() / 2][0], w = s.triangles[s.triangles.size() / 5][0];
  const Eigen::Vector3d from = s.vertices_m.block<3, 1>(0, v), to = s.vertices_m.block<3, 1>(0, w);
  through.vertices_m.block<3, 1>(0, v) = to + (to - from) / 2 + Eigen::Vector3d(2e-3, 1e-3, -5e-3);
  EXPECT_GT(self_crossings(through, 0), 0);
}

// The rig's parts hold the surface and stay out of what is seen of it; they move without jumps, too, and hide
// something.
TEST_P(Kind, RigHoldsAndHidesButDoesNotCutThrough) {
  const DeformingSurface& s = made(GetParam());
  ASSERT_EQ(s.rig.size(), 21u);
  ASSERT_GE(s.rig.front().size(), 1u);
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    const Rig& rig = s.rig[static_cast<std::size_t>(f)];
    ASSERT_EQ(rig.size(), s.rig.front().size());
    for (const RigBox& box : rig)
      for (Eigen::Index p = 0; p < s.points_m.cols(); ++p)
        EXPECT_FALSE(inside(box, shape_of(s.points_m, f).col(p), -1e-3)) << "frame " << f;
  }
  int held = 0;
  for (Eigen::Index v = 0; v < s.vertices_m.cols(); ++v)
    for (const RigBox& box : s.rig.front()) held += inside(box, shape_of(s.vertices_m, 0).col(v));
  EXPECT_GT(held, 10);
  const Motion with = motion_of(s), bare = [&s] {
    DeformingSurface alone = s;
    alone.rig.clear();
    return motion_of(alone);
  }();
  const Ball ball = ball_around(s.points_m);
  const auto cameras = camera_path("circle", s.frames(), {4.3 * ball.radius_m, ball.radius_m, ball.centre_m});
  const Visible behind = visible_points(with, cameras, Projection::perspective);
  const Visible open = visible_points(bare, cameras, Projection::perspective);
  EXPECT_FALSE((behind && !open).any());
  const bool below = std::string(GetParam()) == "deflation";  // the block that the cup is milled into
  EXPECT_LE(behind.count(), below ? open.count() : open.count() - 1);
}

INSTANTIATE_TEST_SUITE_P(All, Kind, ::testing::Values("articulated", "bending", "deflation", "stretching", "tearing"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Animatronics, AreFiveAndFoundByName) {
  EXPECT_EQ(all_animatronics().size(), 5u);
  EXPECT_EQ(find_animatronic("melting"), nullptr);
}

TEST(Bending, PaperKeepsItsLengths) {
  const DeformingSurface& s = made("bending");
  const Eigen::MatrixXd lengths = edge_lengths(s);
  double worst = 0;
  for (Eigen::Index f = 1; f < s.frames(); ++f)
    worst = std::max(worst, (lengths.row(f).array() / lengths.row(0).array() - 1).abs().maxCoeff());
  EXPECT_LT(worst, 5e-3);
  std::vector<double> heights;
  for (Eigen::Index f = 0; f < s.frames(); ++f) heights.push_back(shape_of(s.vertices_m, f).row(2).maxCoeff());
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  EXPECT_GT(*low, 0.01);  // an arch in every frame
  EXPECT_GT(*high, 0.05);
}

TEST(Deflation, BallLosesVolumeAndStaysOutOfItself) {
  const DeformingSurface& s = made("deflation");
  const Shell shell(shape_of(s.vertices_m, 0), s.triangles, {});
  std::vector<double> volumes;
  for (Eigen::Index f = 0; f < s.frames(); ++f) volumes.push_back(shell.volume(shape_of(s.vertices_m, f)));
  for (std::size_t f = 1; f < volumes.size(); ++f) EXPECT_LT(volumes[f], volumes[f - 1]);
  EXPECT_LT(volumes.back(), 0.85 * volumes.front());
  for (const Eigen::Index f : {10, 20}) expect_no_self_penetration(s, f);
}

TEST(Articulated, LinksStayRigidAndTheSleeveOutOfItself) {
  const DeformingSurface& s = made("articulated");
  const Eigen::MatrixXd lengths = edge_lengths(s);
  int rigid = 0;
  for (Eigen::Index e = 0; e < lengths.cols(); ++e)
    if (lengths.col(e).maxCoeff() - lengths.col(e).minCoeff() < 1e-9) ++rigid;
  EXPECT_GT(rigid, lengths.cols() / 4);  // of the links
  EXPECT_LT(rigid, lengths.cols() * 3 / 4);
  for (const Eigen::Index f : {0, 10, 20}) expect_no_self_penetration(s, f);
}

TEST(Stretching, SheetGrowsLongerAndNarrower) {
  const DeformingSurface& s = made("stretching");
  // Lengths of the rows of the sheet at rest: 0.2 m long, vertices in rows of y.
  const Sheet sheet = flat_sheet(0.2, 0.13, 24);
  ASSERT_EQ(sheet.rest.cols(), s.vertices_m.cols());
  const auto along = [&](Eigen::Index f, auto&& chosen, Eigen::Index axis) {
    std::map<double, Eigen::Index> path;
    for (Eigen::Index v = 0; v < sheet.rest.cols(); ++v)
      if (chosen(sheet.rest.col(v))) path[sheet.rest(axis, v)] = v;
    double sum = 0;
    for (auto at = path.begin(); std::next(at) != path.end(); ++at)
      sum += (shape_of(s.vertices_m, f).col(std::next(at)->second) - shape_of(s.vertices_m, f).col(at->second)).norm();
    return sum;
  };
  const auto length = [&](Eigen::Index f) {
    return along(
        f, [](const Eigen::Vector3d& r) { return std::abs(r.y()) < 1e-9; }, 0);
  };
  const auto width = [&](Eigen::Index f) {  // the rows that have a vertex on x = 0
    return along(
        f, [](const Eigen::Vector3d& r) { return std::abs(r.x()) < 1e-9; }, 1);
  };
  // Free of forces across, Green's strains are in the ratio -nu; the bars hold their ends wide.
  const double stretch = length(20) / length(0), narrowed = width(20) / width(0);
  EXPECT_GT(stretch, 1.25);
  EXPECT_LT(narrowed, 0.95);
  EXPECT_GT(narrowed, std::sqrt(1 - 0.45 * (stretch * stretch - 1)));
}

// Vertices that coincide at rest and part for good; the tear runs on from the notch, vertex by vertex.
TEST(Tearing, TearRunsOnAndDoesNotHeal) {
  const DeformingSurface& s = made("tearing");
  const auto first = shape_of(s.vertices_m, 0);
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;
  for (Eigen::Index a = 0; a < first.cols(); ++a)
    for (Eigen::Index b = a + 1; b < first.cols(); ++b)
      if ((first.col(a) - first.col(b)).norm() < 1e-4) pairs.emplace_back(a, b);
  ASSERT_GT(pairs.size(), 20u);
  const auto parted = [&](Eigen::Index f) {
    std::size_t count = 0;
    for (const auto& [a, b] : pairs)
      if ((s.vertices_m.block<3, 1>(3 * f, a) - s.vertices_m.block<3, 1>(3 * f, b)).norm() > 5e-4) ++count;
    return count;
  };
  std::size_t before = 0;
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    EXPECT_GE(parted(f), before);
    before = parted(f);
  }
  EXPECT_GE(before, 12u);
  EXPECT_LT(before, pairs.size());  // not torn in two
}

TEST(Animatronics, SameSeedSameBytes) {
  const AnimatronicOptions options{.frames = 6, .points = 40, .seed = 3}, other{.frames = 6, .points = 40, .seed = 4};
  const Animatronic& stretching = *find_animatronic("stretching");
  const DeformingSurface a = stretching.make(options), b = stretching.make(options), c = stretching.make(other);
  EXPECT_EQ((a.points_m - b.points_m).cwiseAbs().maxCoeff(), 0);
  EXPECT_GT((a.vertices_m - c.vertices_m).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace gonio::nrsfm
