// Bowl, teapot and lids: glassware.h.
#include "glassware.h"

#include <cmath>
#include <stdexcept>

#include "ct/profile.h"

namespace gonio::reassembly_experiment {
namespace {

using ct::ShapePtr;

constexpr double marker_radius_m = 0.0025;
constexpr double sunk = 0.12;      // of a marker's radius, into its glue
constexpr double foot_m = 0.003;   // height of the feet
constexpr double play_m = 0.0004;  // between a lid and its vessel, whose rims are not ground
constexpr double degree = pi / 180;

struct Spot {
  double longitude, latitude;  // degrees; latitude is the ellipse's parameter
};

// Spheres on the ellipsoid of half-axes (a, a, b) about (0, 0, z).
std::vector<ct::Ball> glued(double a, double b, double z, const std::vector<Spot>& spots) {
  std::vector<ct::Ball> balls;
  for (const Spot& spot : spots) {
    const double l = spot.longitude * degree, t = spot.latitude * degree;
    const Vec3 at{a * std::cos(t) * std::cos(l), a * std::cos(t) * std::sin(l), b * std::sin(t)};
    const Vec3 n = normalized(Vec3{at.x / (a * a), at.y / (a * a), at.z / (b * b)});
    balls.push_back({at + Vec3{0, 0, z} + n * ((1 - sunk) * marker_radius_m), marker_radius_m});
  }
  return balls;
}

// A ring from the table into the wall of the ellipse (a, b) about (0, z), of which it takes up half a wall.
ShapePtr foot_under(double a, double b, double z, double wall) {
  const auto low = [&](double r) { return z - b * std::sqrt(1 - r * r / (a * a)) + 0.5 * wall; };
  return ct::lathe(
      {}, {{foot_inner_m, 0}, {foot_outer_m, 0}, {foot_outer_m, low(foot_outer_m)}, {foot_inner_m, low(foot_inner_m)}});
}

Glassware bowl() {
  constexpr double a = 0.055, b = 0.045, z = foot_m + b, wall = 0.0028;
  const ShapePtr cup = ct::lathe({}, ct::wall_of(a, b, z, -pi / 2, 0, wall));
  return {"bowl",
          "soda",
          1.52,
          {14, 4, 10},
          ct::united({cup, foot_under(a, b, z, wall)}),
          glued(a, b, z,
                {{8, -12},
                 {35, -38},
                 {71, -20},
                 {104, -44},
                 {139, -11},
                 {171, -31},
                 {198, -17},
                 {226, -46},
                 {243, -22},
                 {259, -8},
                 {277, -34},
                 {301, -15},
                 {328, -42}}),
          {0, 0, 0.024},
          0.130,
          0.076};
}

Glassware bowl_lid() {
  constexpr double a = 0.055, b = 0.020, z = 0.048 + play_m, wall = 0.0028;
  const ShapePtr cap = ct::lathe({}, ct::wall_of(a, b, z, 0, pi / 2, wall));
  const ShapePtr knob = ct::ball({0, 0, z + b + 0.006}, 0.008);
  return {"bowl-lid",
          "soda",
          1.52,
          {14, 4, 10},
          ct::united({cap, knob}),
          glued(a, b, z,
                {{15, 34},
                 {52, 55},
                 {83, 28},
                 {121, 47},
                 {166, 30},
                 {205, 58},
                 {228, 33},
                 {262, 49},
                 {289, 27},
                 {322, 52},
                 {347, 38}}),
          {0, 0, z + 0.014},
          0.130,
          0.068};
}

Glassware pot() {
  constexpr double extent = 0.193, wall = 0.003;
  const auto [a, b, opening] = ct::teapot_sizes(extent);
  const double z = foot_m + b;
  const ShapePtr body = ct::turned(ct::teapot_body(extent, wall), ct::rotation_about({0, 0, 1}, 0), {0, 0, z});
  const ShapePtr hollow =
      ct::turned(ct::ellipsoid({}, {a - wall, a - wall, b - wall}), ct::rotation_about({0, 0, 1}, 0), {0, 0, z});
  return {"pot",
          "borosilicate",
          1.47,
          {4, 3, 9},
          ct::united({body, ct::without(foot_under(a, b, z, wall), hollow)}),
          glued(a, b, z,
                {{41, 14},
                 {77, -31},
                 {98, 33},
                 {126, -9},
                 {222, 24},
                 {236, -28},
                 {251, 2},
                 {268, 31},
                 {279, -17},
                 {297, 12},
                 {306, 38},
                 {318, -22},
                 {334, 27}}),
          {0, 0, 0.046},
          0.182,
          0.114};
}

Glassware pot_lid() {
  const double extent = 0.193;
  const auto [body_a, body_b, opening] = ct::teapot_sizes(extent);
  constexpr double a = 0.025, b = 0.011, wall = 0.0024;
  // Its inner edge, radius a - wall, stands on the pot.
  const double z = foot_m + body_b * (1 + std::sqrt(1 - (a - wall) * (a - wall) / (body_a * body_a))) + play_m;
  const ShapePtr cap = ct::lathe({}, ct::wall_of(a, b, z, 0, pi / 2, wall));
  const ShapePtr knob = ct::ball({0, 0, z + b + 0.0045}, 0.006);
  return {
      "pot-lid",
      "borosilicate",
      1.47,
      {4, 3, 9},
      ct::united({cap, knob}),
      glued(a, b, z,
            {{5, 25}, {48, 52}, {77, 22}, {118, 31}, {164, 50}, {187, 24}, {231, 30}, {264, 54}, {291, 21}, {334, 33}}),
      {0, 0, z + 0.010},
      0.072,
      0.048};
}

}  // namespace

const std::vector<Glassware>& glassware() {
  static const std::vector<Glassware> all{bowl(), bowl_lid(), pot(), pot_lid()};
  return all;
}

const Glassware& piece_named(const std::string& name) {
  for (const Glassware& piece : glassware())
    if (piece.name == name) return piece;
  throw std::invalid_argument("no piece " + name + "; bowl, bowl-lid, pot, pot-lid");
}

Rigid<frame::Object, frame::Light> tomograph_from_standing(const Glassware& piece, std::size_t voxels) {
  const Mat3 turn = ct::rotation_about({0.8, 0.6, 0}, 6 * degree) * ct::rotation_about({0, 0, 1}, 1.1);
  const Vec3 off = Vec3{0.31, -0.23, 0.17} * (piece.across_m / static_cast<double>(voxels));
  return {quaternion_of(turn), off - turn * piece.middle};
}

Scanned scanned(const Glassware& piece, std::size_t voxels, double photons, std::uint64_t seed) {
  const auto to = tomograph_from_standing(piece, voxels);
  const Mat3 turn = matrix_of(to.rotation);
  Scanned result;
  ct::Phantom& phantom = result.phantom;
  phantom.name = piece.name;
  phantom.parts.push_back({"glass", ct::turned(piece.glass, turn, to.translation_m), ct::glass()});
  std::vector<ShapePtr> balls;
  for (const ct::Ball& marker : piece.markers) {
    phantom.markers.push_back({to * marker.centre, marker.radius});
    balls.push_back(ct::ball(phantom.markers.back().centre, marker.radius));
  }
  phantom.parts.push_back({"markers", ct::united(std::move(balls)), ct::filled_plastic()});
  ct::Scanner& scanner = result.scanner;
  scanner.voxels = voxels, scanner.photons = photons, scanner.seed = seed;
  // As its maker calibrates it: readings linearised for glass, save a fifth.
  scanner.imperfections["beam-hardening"] = 0.2;
  scanner.voxel_m = piece.across_m / static_cast<double>(voxels);
  scanner.slices = static_cast<std::size_t>(std::ceil(piece.high_m / scanner.voxel_m));
  return result;
}

}  // namespace gonio::reassembly_experiment
