// Corners in a projector's pixels and the projector that they calibrate, in a world of closed forms: errors against
// what is stated, what a scan with it hits, and projectors that run the wrong way round. GONIO_ROUNDS: calibrations of
// other noise that are counted (40 on a proof day); what three show is held tightly enough to see a sigma that is 1.5
// times too small.
#include "scan/projector_corners.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "camera/camera_model.h"
#include "scan/board_world.h"
#include "scan/triangulate.h"

namespace gonio::scan {
namespace {

using tests::BoardSession;
using tests::BoardWorld;

constexpr int poses = 9;

const BoardSession& session() {
  static const BoardSession made{BoardWorld{}, tests::cosines_and_white(BoardWorld{}, {1, 8, 40}, 3), poses};
  return made;
}

std::uint64_t rounds() {
  const char* text = std::getenv("GONIO_ROUNDS");
  return text == nullptr ? 3 : std::strtoull(text, nullptr, 10);
}

// Of one coordinate: what the projector's corners miss by beyond what the camera's carry, squared, and what is stated.
struct Corners {
  double squares = 0, stated = 0, count = 0;
};
void hold_corners(const BoardWorld& world, const std::vector<camera::View>& views, Corners& sums) {
  const std::vector<tests::Turned> boards = world.poses(poses);
  for (std::size_t p = 0; p < boards.size(); ++p)
    for (const camera::Corner& c : views[2 * p + 1].corners) {
      const auto seen = std::ranges::find(views[2 * p].corners, c.id, &camera::Corner::id);
      const Vec2 at = world.board().corner_m(c.id);
      const auto there = boards[p]({at.x, at.y, 0});
      const auto in_camera = world.camera.pixel(there),
                 in_projector = world.projector.pixel(world.projector_from_camera(there));
      const Vec2 carried = seen->pixel - Vec2{in_camera[0], in_camera[1]};
      const auto& s = c.looked_up->at[0].slope;
      const Vec2 off = c.pixel - Vec2{in_projector[0], in_projector[1]} -
                       Vec2{s[0] * carried.x + s[1] * carried.y, s[2] * carried.x + s[3] * carried.y};
      sums.squares += dot(off, off), sums.stated += c.looked_up->own[0] + c.looked_up->own[2], sums.count += 2;
    }
}

struct Counted {
  double inside = 0, all = 0;
  void operator()(double found, double truth, std::optional<double> sigma) {
    ASSERT_TRUE(sigma);
    ++all, inside += std::abs(found - truth) < 1.96 * *sigma ? 1 : 0;
  }
};
void hold_numbers(const BoardWorld& world, const camera::Calibration& c, Counted& count) {
  const tests::BentLens* lenses[] = {&world.camera, &world.projector};
  for (std::size_t k = 0; k < 2; ++k) {
    const camera::Intrinsics& lens = c.cameras[k].lens;
    count(lens.fx_px, lenses[k]->fx, c.sigma("fx_px", k)), count(lens.fy_px, lenses[k]->fy, c.sigma("fy_px", k));
    count(lens.cx_px, lenses[k]->cx, c.sigma("cx_px", k)), count(lens.cy_px, lenses[k]->cy, c.sigma("cy_px", k));
    count(lens.distortion[0], lenses[k]->k1, c.sigma("k1", k));
    count(lens.distortion[1], lenses[k]->k2, c.sigma("k2", k));
  }
  const auto projector_from_camera = inverse(c.cameras[1].rig_from_camera);
  const Vec3 turn = rotation_vector_of(projector_from_camera.rotation);
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    count(turn[i], world.projector_from_camera.turn[k], c.sigma(std::string("rotation_") + axes[i] + "_rad", 1));
    count(projector_from_camera.translation_m[i], world.projector_from_camera.shift[k],
          c.sigma(std::string("translation_") + axes[i] + "_m", 1));
  }
}

TEST(ProjectorCorners, CalibrateAProjectorWithinItsIntervals) {
  const BoardWorld& world = session().world();
  Corners corners;
  Counted numbers;
  for (std::uint64_t seed = 1; seed <= rounds(); ++seed) {
    const std::vector<camera::View> views = session().views(seed);
    hold_corners(world, views, corners);
    const camera::Calibration c = camera::calibrate(views, session().setup());
    ASSERT_TRUE(c.converged);
    EXPECT_TRUE(c.complaints.empty()) << c.complaints.front();
    hold_numbers(world, c, numbers);
  }
  EXPECT_GT(corners.count, 900 * rounds());
  EXPECT_NEAR(std::sqrt(corners.squares / corners.stated), 1, 0.08);
  EXPECT_LT(std::sqrt(corners.squares / corners.count), 0.02);
  RecordProperty("inside", std::to_string(numbers.inside / numbers.all));
  const double share = numbers.inside / numbers.all;
  EXPECT_GT(share, rounds() < 20 ? 0.88 : 0.93) << "of " << numbers.all;
  EXPECT_LT(share, rounds() < 20 ? 1.01 : 0.985);  // the scatter between shots widens intervals, and narrows none
}

// The calibration with one of its numbers changed.
camera::Calibration changed(camera::Calibration c, std::size_t number, double by) {
  const camera::SharedParameter& p = c.shared[number];
  camera::CalibratedCamera& own = c.cameras[p.of];
  if (p.kind == camera::SharedParameter::Kind::rig) {
    std::array<double, 6> change{};
    change[(p.name.starts_with("rotation") ? 0u : 3u) + static_cast<std::size_t>(p.name[p.name.find('_') + 1] - 'x')] =
        by;
    const auto back = inverse(own.rig_from_camera);
    const camera::BoardPose moved = camera::moved({back.rotation, back.translation_m}, change);
    own.rig_from_camera = inverse(Rigid<frame::Camera, frame::Rig>{moved.rotation, moved.translation_m});
  } else {
    double* lens[] = {&own.lens.fx_px, &own.lens.fy_px, &own.lens.cx_px, &own.lens.cy_px};
    const auto at = std::ranges::find(camera::pinhole_names, p.name);
    (at != camera::pinhole_names.end() ? *lens[at - camera::pinhole_names.begin()]
                                       : own.lens.distortion[camera::distortion_index(p.name, "test")]) += by;
  }
  return c;
}

Cloud measured(const camera::Calibration& c, const Codes& codes) {
  std::vector<Station> stations;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& setup = session().setup().cameras[k];
    stations.push_back(
        {camera::CameraModel(c.cameras[k].lens, setup.width_px, setup.height_px), c.cameras[k].rig_from_camera});
  }
  return points_of_projector(codes, stations[0], stations[1]);
}

// The calibrated pair measures a board of which it did not see this recording: points against the true plane, and how
// far their middle may lie off by what the calibration says of itself.
TEST(ProjectorCorners, ACalibratedProjectorHitsAPlane) {
  const BoardWorld& world = session().world();
  const camera::Calibration c = camera::calibrate(session().views(2), session().setup());
  const std::size_t pose = 4;
  Codes codes = session().codes(pose, 77);
  const tests::Turned board = world.poses(poses)[pose];
  const auto n = tests::Turned{board.turn, {}}({0, 0, 1});
  const Vec3 normal{n[0], n[1], n[2]}, on_plane{board.shift[0], board.shift[1], board.shift[2]};
  const Cloud cloud = measured(c, codes);
  double squares = 0, sum = 0, stated = 0, count = 0;
  for (const ScanPoint& p : cloud.points) {
    if (p.sigma_m > 3e-3) continue;  // of black squares
    const auto& v = p.covariance;
    const Vec3 vn{v[0] * normal.x + v[1] * normal.y + v[2] * normal.z,
                  v[1] * normal.x + v[3] * normal.y + v[4] * normal.z,
                  v[2] * normal.x + v[4] * normal.y + v[5] * normal.z};
    const double off = dot(p.position_m - on_plane, normal);
    squares += off * off, sum += off, stated += dot(normal, vn), ++count;
  }
  ASSERT_GT(count, 10000);
  const double middle = sum / count;
  EXPECT_NEAR(std::sqrt((squares / count - middle * middle) / (stated / count)), 1, 0.15);
  EXPECT_LT(cloud.epipolar_chi_square, 2);
  for (std::size_t i = 0, told = 0; i < codes.refusal.size(); ++i)  // few are enough for slopes
    if (codes.told(i) && told++ % 100 != 0) codes.refusal[i] = Refusal::masked;
  const auto mean_off = [&](const camera::Calibration& of) {
    double all = 0, points = 0;
    for (const ScanPoint& p : measured(of, codes).points) all += dot(p.position_m - on_plane, normal), ++points;
    return all / points;
  };
  const std::size_t numbers = c.shared.size();
  std::vector<double> slope;
  for (std::size_t i = 0; i < numbers; ++i) {
    const double step = 0.01 * std::sqrt(c.covariance[i * numbers + i]);
    slope.push_back((mean_off(changed(c, i, step)) - mean_off(changed(c, i, -step))) / (2 * step));
  }
  double variance = 0;
  for (std::size_t i = 0; i < numbers; ++i)
    for (std::size_t j = 0; j < numbers; ++j) variance += slope[i] * slope[j] * c.covariance[i * numbers + j];
  EXPECT_LT(std::abs(middle), 2.6 * std::sqrt(variance)) << std::sqrt(variance);
  EXPECT_LT(std::sqrt(variance), 5e-4);
}

TEST(ProjectorCorners, TellsWhichWayRoundTheProjectorRuns) {
  for (const bool exchanged : {false, true}) {
    BoardWorld world;
    world.mirrored = !exchanged, world.exchanged = exchanged, world.across = 3;
    const BoardSession one(world, tests::cosines_and_white(world, {1, 8, 40}, 3), 1);
    const ProjectorCorners lit = one.corners(0, 1);
    EXPECT_GT(lit.turned_over, 10);
    EXPECT_EQ(lit.exchanged, exchanged);
  }
  const ProjectorCorners right = session().corners(0, 1);
  EXPECT_LT(right.turned_over, -50);
  EXPECT_FALSE(right.exchanged);
}

TEST(ProjectorCorners, SayWhyThereAreNone) {
  BoardWorld world;
  world.projected = 0, world.ambient = 0.6, world.across = 3;  // switched off by day
  const BoardSession one(world, tests::cosines_and_white(world, {1, 8, 40}, 3), 1);
  const ProjectorCorners none = one.corners(0, 1);
  EXPECT_TRUE(none.detection.corners.empty());
  EXPECT_EQ(none.detection.problem,
            "of 54 corners of the board the codes tell 0: 100 % of the pixels about them are dark");
}

// Twice the noise of one camera: the mean of two lies nearer to the better one and is better than either.
TEST(ProjectorCorners, OfTwoCamerasAreTheirMean) {
  const BoardWorld& world = session().world();
  const camera::Detection seen = session().seen(2, 1);
  const Codes codes = session().codes(2, 1), others = session().codes(2, 5);
  const auto one = projector_corners({{0, &seen, &codes}}, world.board()),
             two = projector_corners({{0, &seen, &codes}, {1, &seen, &others}}, world.board());
  ASSERT_EQ(one.detection.corners.size(), two.detection.corners.size());
  for (std::size_t k = 0; k < one.detection.corners.size(); ++k) {
    const camera::Corner &a = one.detection.corners[k], &b = two.detection.corners[k];
    EXPECT_LT(b.sigma_px, a.sigma_px);
    EXPECT_NEAR(b.looked_up->own[0] / a.looked_up->own[0], 0.5, 0.2);
    ASSERT_EQ(b.looked_up->at.size(), 2u);
    EXPECT_NEAR(b.looked_up->at[0].slope[0] + b.looked_up->at[1].slope[0], a.looked_up->at[0].slope[0], 0.1);
  }
}

}  // namespace
}  // namespace gonio::scan
