// A lid on its pot: floating, sinking and at rest, where the truth is known.
#include "reassembly/lids.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "mesh/verdict.h"
#include "reassembly/sheets.h"

namespace gonio::reassembly {
namespace {

using testing::HasSubstr;
constexpr Vec3 down{0, 0, -1};
constexpr double pot_height = 0.12, pot_radius = 0.06, wall = 0.006;

io::TriangleMesh turned_round(const std::vector<Vec2>& profile, std::uint32_t around) {
  const auto rows = static_cast<std::uint32_t>(profile.size() - 1);
  return sheets::turned(rows, around,
                        [&](double s) { return profile[static_cast<std::size_t>(std::lround(s * rows))]; });
}
io::TriangleMesh pot(std::uint32_t around = 48) {
  const double in = pot_radius - wall;
  return turned_round({{0, 0}, {pot_radius, 0}, {pot_radius, pot_height}, {in, pot_height}, {in, 0.01}, {0, 0.01}},
                      around);
}
// Its underside at z = 0 lies on the rim; the plug has a millimetre of play.
io::TriangleMesh lid(std::uint32_t around = 40) {
  const double in = pot_radius - wall - 0.001;
  return turned_round({{0, -0.01}, {in, -0.01}, {in, 0}, {pot_radius, 0}, {pot_radius, 0.005}, {0.01, 0.02}, {0, 0.03}},
                      around);
}

StandingPiece piece(const std::string& name, const io::TriangleMesh& mesh, Vec3 at, double turn_sd, double shift_sd) {
  StandingPiece p{name, &mesh, {{}, at}, {}, at};
  for (std::size_t k = 0; k < 6; ++k) p.covariance[7 * k] = k < 3 ? turn_sd * turn_sd : shift_sd * shift_sd;
  return p;
}
io::TriangleMesh placed(const StandingPiece& p, const Rigid<frame::World, frame::Object>& pose) {
  io::TriangleMesh mesh = *p.mesh;
  for (Vec3& q : mesh.positions_m) q = pose * q;
  return mesh;
}

TEST(Lids, FloatOrSinkOrTouchWithinTheirUncertainty) {
  const io::TriangleMesh a = pot(), b = lid();
  const StandingPiece below = piece("pot", a, {}, 0, 0.00003);
  for (const double gap : {0.001, 0.0001, -0.001}) {
    const Seat seat = seat_of(piece("lid", b, {0, 0, pot_height + gap}, 0, 0.00004), below, down);
    EXPECT_NEAR(seat.gap_m, gap, 1e-9);
    EXPECT_NEAR(seat.sigma_m, 0.00005, 1e-6);
    EXPECT_EQ(seat.standing, gap > 0.0005 ? Standing::floats : gap < 0 ? Standing::sinks : Standing::touches);
  }
  EXPECT_EQ(seat_of(piece("lid", b, {0, 0, 0.3}, 0, 0.001), below, down).standing, Standing::apart);
  // A tilt acts at the lever of the rim: one side sinks by r sin(tilt).
  StandingPiece tilted = piece("lid", b, {0, 0, pot_height}, 0.001, 0);
  tilted.world_from_object.rotation = quaternion_of_rotation_vector({0.01, 0, 0});
  const Seat seat = seat_of(tilted, below, down);
  EXPECT_NEAR(seat.gap_m, -pot_radius * 0.01, 2e-5);
  EXPECT_NEAR(seat.sigma_m, std::hypot(pot_radius * 0.001, 0.00003), 3e-6);
}

// Poses drawn from their covariance: after settling the lid stands level on the rim, wherever it was drawn, shifts
// across stay within what was drawn, and as many are refused as three degrees of freedom have beyond 3 sigma: 2.9 %.
TEST(Lids, ComeToRestOnTheRim) {
  const io::TriangleMesh a = pot(24), b = lid(20);
  const StandingPiece below = piece("pot", a, {}, 0, 0);
  constexpr double turn_sd = 0.003, shift_sd = 0.0002;
  int refused = 0;
  constexpr int draws = 40;
  for (int i = 0; i < draws; ++i) {
    Random random(22, static_cast<std::uint64_t>(i));
    const auto three = [&](double sd) {
      return Vec3{sd * random.normal(), sd * random.normal(), sd * random.normal()};
    };
    StandingPiece above = piece("lid", b, {0, 0, pot_height}, turn_sd, shift_sd);
    above.world_from_object.rotation = quaternion_of_rotation_vector(three(turn_sd));
    above.world_from_object.translation_m += three(shift_sd);
    const Settled s = settle(above, below, down, {}, "test");
    if (!s.refused.empty()) {
      EXPECT_THAT(s.refused, HasSubstr("standard deviations of its pose (limit 3)"));
      EXPECT_EQ(s.world_from_object, above.world_from_object);
      ++refused;
      continue;
    }
    EXPECT_EQ(mesh::intersections(placed(above, s.world_from_object), placed(below, below.world_from_object)).size(),
              0u);
    EXPECT_NEAR(s.world_from_object.translation_m.z, pot_height, 4e-6) << i;
    const Vec3 up = s.world_from_object.rotate({0, 0, 1});
    EXPECT_LT(std::hypot(up.x, up.y), 1e-4) << i;
    EXPECT_EQ(s.feet_m.size(), 3u);
    EXPECT_LE(s.sigmas, 3);
  }
  EXPECT_LE(refused, 7) << "of 40 at 2.9 %: more than that once in 10^5";
}

// A slab on three pins of unequal height lies in the plane of their tips: what geometry says without any programme.
TEST(Lids, ASlabLiesInThePlaneOfThreeTips) {
  const std::array<Vec3, 3> tips{Vec3{0.03, 0, 0.0501}, Vec3{-0.02, 0.025, 0.0494}, Vec3{-0.02, -0.025, 0.0502}};
  io::TriangleMesh pins;
  for (const Vec3& tip : tips) {
    io::TriangleMesh pin = turned_round({{0, 0}, {0.002, 0}, {0.0005, 0.9 * tip.z}, {0, tip.z}}, 7);
    pins = mesh::shapes::together(pins, mesh::shapes::moved(pin, {tip.x, tip.y, 0}));
  }
  io::TriangleMesh slab = mesh::shapes::moved(mesh::shapes::box({0.1, 0.1, 0.01}, 3), {-0.05, -0.05, 0});
  const StandingPiece below = piece("pins", pins, {}, 0, 0);
  for (const double start : {0.051, 0.0495}) {
    StandingPiece above = piece("slab", slab, {0, 0, start}, 0.02, 0.002);
    const Settled s = settle(above, below, down, {}, "test");
    ASSERT_EQ(s.refused, "");
    const Vec3 normal = normalized(cross(tips[1] - tips[0], tips[2] - tips[0]));
    EXPECT_LT(norm(s.world_from_object.rotate({0, 0, 1}) - normal), 1e-4);
    for (const Vec3& tip : tips)
      EXPECT_NEAR(dot(tip - s.world_from_object.translation_m, normal), 0, 3e-6)
          << "the tip lies in the slab's underside";
    EXPECT_EQ(s.feet_m.size(), 3u);
    EXPECT_EQ(mesh::intersections(placed(above, s.world_from_object), pins).size(), 0u);
  }
}

// A cone in a conical seat: contact on a slope, where the gap answers to shifts across.
TEST(Lids, AConeInAConeRestsWithoutMeeting) {
  const io::TriangleMesh seat =
      turned_round({{0, 0}, {0.06, 0}, {0.06, 0.06}, {0.055, 0.06}, {0.015, 0.02}, {0, 0.02}}, 24);
  const io::TriangleMesh stopper = turned_round({{0, 0.01}, {0.02, 0.01}, {0.05, 0.04}, {0.05, 0.06}, {0, 0.07}}, 24);
  for (const double lift : {0.016, 0.0135}) {  // floats, sinks
    StandingPiece above = piece("stopper", stopper, {0.0002, 0, lift}, 0.01, 0.002);
    const Settled s = settle(above, piece("seat", seat, {}, 0, 0), down, {}, "test");
    ASSERT_EQ(s.refused, "");
    EXPECT_EQ(s.before.gap_m > 0, lift > 0.015);
    EXPECT_GT(std::abs(s.before.gap_m), 0.0005);
    EXPECT_EQ(mesh::intersections(placed(above, s.world_from_object), seat).size(), 0u);
    above.world_from_object = s.world_from_object;
    EXPECT_LT(std::abs(seat_of(above, piece("seat", seat, {}, 0, 0), down).gap_m), 3e-6);
  }
}

TEST(Lids, WhatCannotStandIsRefusedInWords) {
  const io::TriangleMesh a = pot(), b = lid();
  const StandingPiece below = piece("pot", a, {}, 0, 0);
  EXPECT_THAT(settle(piece("lid", b, {0, 0, pot_height + 0.002}, 0.001, 0.0002), below, down, {}, "test").refused,
              HasSubstr("\"lid\" would have to move by 2 mm and "));
  EXPECT_THAT(settle(piece("lid", b, {0.08, 0, pot_height + 0.011}, 0.1, 0.1), below, down, {}, "test").refused,
              HasSubstr("would tip off \"pot\": its centre of mass is not above"));
  EXPECT_THAT(settle(piece("lid", b, {0, 0, 0.3}, 0.1, 0.1), below, down, {}, "test").refused,
              HasSubstr("nothing of \"pot\" lies under \"lid\" within"));
  io::TriangleMesh open = b;
  open.triangles.pop_back();
  EXPECT_THROW(settle(piece("lid", open, {0, 0, pot_height}, 0.1, 0.1), below, down, {}, "test"), Error);
}

}  // namespace
}  // namespace gonio::reassembly
