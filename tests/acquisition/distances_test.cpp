// Distances between solids: closed forms, a bracket that owes nothing to FCL, and what a laboratory makes of them.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquisition/laboratories.h"
#include "acquisition/motion/exact_distance.h"
#include "acquisition/motion/line.h"
#include "acquisition/motion/way.h"
#include "acquisition/solid_geometry.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

using Shape = Solid::Shape;

Solid solid(Shape shape, Vec3 sides, Vec3 at = {}, Vec3 turn = {}) {
  Solid s;
  s.shape = shape;
  s.sides_m = sides;
  s.placed = {quaternion_of_rotation_vector(turn), at};
  return s;
}

Solid cube_mesh(double half, Vec3 at) {
  Solid s = solid(Shape::mesh, {}, at);
  for (int i = 0; i < 8; ++i)
    s.vertices_m.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half});
  for (const auto& q : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    for (const auto& t : {std::array{0, 1, 2}, {0, 2, 3}})
      s.triangles.push_back({std::uint32_t(q[t[0]]), std::uint32_t(q[t[1]]), std::uint32_t(q[t[2]])});
  return s;
}

struct Two {
  Laboratory laboratory;
  std::vector<Body> bodies;
  std::vector<PlacedBody> at;
  Two(const Solid& a, const Solid& b) {
    laboratory.obstacles = {a, b};
    bodies = bodies_of(laboratory);
    at = placed(laboratory, bodies, {});
  }
  double exactly() const { return ExactDistances(bodies).between(0, at[0], 1, at[1]); }
  double by_planes() const { return plane_gap(bodies[0], at[0], bodies[1], at[1]); }
  double by_balls() const { return ball_gap(bodies[0], at[0], bodies[1], at[1]); }
};

TEST(Distances, EqualClosedForms) {
  const Solid box = solid(Shape::box, {0.2, 0.4, 0.6});
  const Solid tube = solid(Shape::cylinder, {0.05, 0.5, 0});
  const Vec3 quarter_x{pi / 2, 0, 0}, quarter_y{0, pi / 2, 0};
  EXPECT_NEAR(Two(box, solid(Shape::box, {0.2, 0.2, 0.2}, {0.5, 0, 0})).exactly(), 0.3, 1e-8);
  EXPECT_NEAR(Two(box, solid(Shape::box, {0.2, 0.2, 0.2}, {0.5, 0.5, 0.8})).exactly(), std::hypot(0.3, 0.2, 0.4), 1e-8);
  EXPECT_NEAR(Two(box, solid(Shape::ball, {0.1, 0, 0}, {0.4, 0.5, 0.7})).exactly(), std::hypot(0.3, 0.3, 0.4) - 0.1,
              1e-8);
  EXPECT_NEAR(Two(solid(Shape::ball, {0.1, 0, 0}), solid(Shape::ball, {0.2, 0, 0}, {0, 3, 4})).exactly(), 4.7, 1e-8);
  EXPECT_NEAR(Two(tube, solid(Shape::cylinder, {0.03, 0.5, 0}, {0.3, 0.4, 0.1})).exactly(), 0.42,
              1e-7);                                                                                // side by side
  EXPECT_NEAR(Two(tube, solid(Shape::cylinder, {0.05, 0.2, 0}, {0, 0, 1})).exactly(), 0.65, 1e-7);  // in line
  EXPECT_NEAR(Two(tube, solid(Shape::cylinder, {0.03, 0.5, 0}, {0.3, 0, 0}, quarter_x)).exactly(), 0.22,
              1e-7);  // crossed
  EXPECT_NEAR(Two(tube, solid(Shape::cylinder, {0.03, 0.5, 0}, {0.5, 0, 0.1}, quarter_y)).exactly(), 0.2, 1e-7);
  EXPECT_NEAR(Two(tube, solid(Shape::ball, {0.01, 0, 0}, {0.35, 0, 0.65})).exactly(), 0.5 - 0.01,
              1e-7);  // from the rim
  EXPECT_EQ(Two(box, tube).exactly(), 0);
}

TEST(Distances, ClosedMeshesAreAllThatTheyEnclose) {
  const Solid cube = cube_mesh(0.5, {1, 0, 0});
  EXPECT_NEAR(Two(cube, solid(Shape::ball, {0.1, 0, 0}, {0, 0, 0})).exactly(), 0.4, 1e-7);
  EXPECT_NEAR(Two(cube, cube_mesh(0.1, {1, 0, 1.5})).exactly(), 0.9, 1e-7);
  EXPECT_EQ(Two(cube, solid(Shape::ball, {0.1, 0, 0}, {1, 0.1, 0})).exactly(), 0);
  EXPECT_EQ(Two(solid(Shape::box, {0.1, 0.1, 0.1}, {1.2, 0, 0}), cube).exactly(), 0);
  EXPECT_EQ(Two(cube, cube_mesh(0.1, {1.1, 0.1, 0})).exactly(), 0);
  Solid open = cube;
  open.triangles.pop_back();
  EXPECT_NEAR(Two(open, solid(Shape::ball, {0.1, 0, 0}, {1, 0.1, 0})).exactly(), 0.3, 1e-7);
}

// Alternating projections (Cheney & Goldstein 1959) come down to the distance from above; across the plane between the
// two points, support functions bound it from below.
struct Bracket {
  double below = -std::numeric_limits<double>::infinity(), above = std::numeric_limits<double>::infinity();
};
Bracket bracket_of(const Solid& a, const Solid& b) {
  Bracket bracket;
  Vec3 p = b.placed.translation_m;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 on_a = a.placed * tests::nearest_in(a, inverse(a.placed) * p);
    p = b.placed * tests::nearest_in(b, inverse(b.placed) * on_a);
    const Vec3 across = p - on_a;
    bracket.above = std::min(bracket.above, norm(across));
    if (!(norm(across) > 1e-9)) return {0, 0};
    const Vec3 n = normalized(across);
    const double gap = dot(n, b.placed.translation_m - a.placed.translation_m) -
                       tests::support(a, inverse(a.placed).rotate(n)) - tests::support(b, inverse(b.placed).rotate(n));
    bracket.below = std::max(bracket.below, gap);
    if (bracket.above - bracket.below < 1e-9) break;
  }
  return bracket;
}

TEST(Distances, LieWhereProjectionsAndPlanesPutThem) {
  Random random(4);
  const auto any = [&](double scale) {
    return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * scale;
  };
  int apart = 0, narrow = 0;
  for (int i = 0; i < 300; ++i) {
    const auto one = [&](Vec3 at) {
      const Vec3 sides{random.uniform(0.02, 0.3), random.uniform(0.02, 0.5), random.uniform(0.02, 0.3)};
      return solid(static_cast<Shape>(random.below(3)), sides, at, any(3));
    };
    const Solid a = one({}), b = one(any(0.6));
    const Two two(a, b);
    const double exactly = two.exactly();
    const Bracket bracket = bracket_of(a, b);
    EXPECT_GE(exactly, bracket.below - 1e-7) << i;
    EXPECT_LE(exactly, bracket.above + 1e-7) << i;
    EXPECT_LE(two.by_balls(), exactly + 1e-9) << i;
    EXPECT_LE(two.by_planes(), exactly + 1e-9) << i;
    if (bracket.above <= 0) {
      EXPECT_LT(exactly, 1e-7) << i;
    }
    apart += exactly > 0;
    narrow += exactly > 0 && bracket.above - bracket.below < 1e-5;
  }
  EXPECT_GT(apart, 150);
  EXPECT_GT(narrow, 0.9 * apart);
}

// As parts stand in laboratories: turned by right angles, on one axis or face to face. (FCL alone fails here.)
TEST(Distances, HoldWherePartsAreInLine) {
  Random random(5);
  int apart = 0;
  for (int i = 0; i < 400; ++i) {
    const auto step = [&] { return 0.05 * static_cast<double>(random.below(5)); };
    const auto one = [&](Vec3 at) {
      const Vec3 turn = (pi / 2) * Vec3{double(random.below(2)), double(random.below(2)) * 0, 0};
      return solid(static_cast<Shape>(random.below(3)), {0.05 + step(), 0.05 + step(), 0.05 + step()}, at, turn);
    };
    const Vec3 axis = std::array{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}[random.below(3)];
    const Solid a = one({}), b = one(axis * 0.6 + Vec3{step(), step(), 0} * double(random.below(2)));
    const double exactly = Two(a, b).exactly();
    const Bracket bracket = bracket_of(a, b);
    EXPECT_LE(exactly, bracket.above + 1e-6) << i;
    EXPECT_GE(exactly, bracket.below - 1e-6) << i;
    apart += exactly > 0 && bracket.above - bracket.below < 1e-5;
  }
  EXPECT_GT(apart, 300);
}

State random_state(const Laboratory& laboratory, Random& random) {
  State state;
  for (const auto& [name, arm] : laboratory.arms)
    for (const robot::JointLimit& limit : arm.limits)
      state[name].push_back(random.uniform(std::max(-pi, limit.lower_rad), std::min(pi, limit.upper_rad)));
  return state;
}

TEST(Surroundings, ClearanceIsTheSmallestOfAllPairs) {
  for (const std::string& text : {tests::two_ur5_text(), tests::ur3_and_turntable_text()}) {
    const Laboratory laboratory = believed_laboratory(tests::laboratory_document(text));
    const Surroundings surroundings(laboratory);
    const std::vector<Body> bodies = bodies_of(laboratory);
    const ExactDistances exact(bodies);
    const auto left_out = [&](const std::string& a, const std::string& b) {
      return std::any_of(surroundings.left_out().begin(), surroundings.left_out().end(),
                         [&](const Clearance& c) { return c.first == a && c.second == b; });
    };
    const auto still = [](const Body& b) { return b.arm < 0 || b.solid->link == 0; };
    Random random(11);
    for (int k = 0; k < 25; ++k) {
      const State state = random_state(laboratory, random);
      const std::vector<PlacedBody> at = placed(laboratory, bodies, state);
      double of_all = 1e300, of_watched = 1e300;  // with and without those that may or may not be left out
      for (std::size_t a = 0; a < bodies.size(); ++a)
        for (std::size_t b = a + 1; b < bodies.size(); ++b) {
          const Solid &x = *bodies[a].solid, &y = *bodies[b].solid;
          if (still(bodies[a]) && still(bodies[b])) continue;
          const bool same = bodies[a].arm == bodies[b].arm;
          if (same && (x.link == y.link || (std::abs(x.link - y.link) == 1 && !x.carried && !y.carried))) continue;
          const double distance = exact.between(a, at[a], b, at[b]);
          of_all = std::min(of_all, distance);
          if (!left_out(x.name, y.name)) of_watched = std::min(of_watched, distance);
        }
      const Clearance clearance = surroundings.clearance(state);
      EXPECT_GE(clearance.distance_m, of_all);
      EXPECT_LE(clearance.distance_m, of_watched);
      for (const double margin : {0.0, 0.005, 0.02, 0.1, 0.5})
        EXPECT_EQ(surroundings.free(state, margin), clearance.distance_m > margin) << margin;
      EXPECT_EQ(surroundings.clearance(state, 0.05).distance_m, std::min(clearance.distance_m, 0.05));
    }
  }
}

TEST(Surroundings, NothingOnALineIsNearerThanWhatIsFound) {
  const Laboratory laboratory = believed_laboratory(tests::laboratory_document(tests::two_ur5_text()));
  const Surroundings surroundings(laboratory);
  Random random(12);
  const double inf = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 12; ++k) {
    const State from = random_state(laboratory, random), far = random_state(laboratory, random);
    const State to = between(laboratory, from, far, 0.2);
    const auto found = surroundings.nearest_between(from, to, inf, -1, 0.002);
    double sampled = inf;
    for (int i = 0; i <= 150; ++i)
      sampled = std::min(sampled, surroundings.clearance(between(laboratory, from, to, i / 150.0)).distance_m);
    EXPECT_GE(sampled, found.clearance.distance_m - 0.002);
    EXPECT_NEAR(surroundings.clearance(between(laboratory, from, to, found.at)).distance_m, found.clearance.distance_m,
                1e-9);
  }
}

}  // namespace
}  // namespace gonio::acquisition
