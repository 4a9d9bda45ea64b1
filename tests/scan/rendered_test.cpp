// Pictures that the renderer made of a plane, a ball and a step, and of walls that light each other, decoded: another
// path than the decoder's own. Seeds are fixed; root mean squares over 3,000 points and more have 1.3 % by chance.
#include <gtest/gtest.h>

#include <cmath>

#include "scan/rendered_world.h"

namespace gonio::scan {
namespace {

using tests::Pinhole;
using tests::RenderedWorld;
using tests::ScanWorld;

constexpr Axis both[] = {Axis::column, Axis::row};
constexpr Axis columns[] = {Axis::column};
const Pinhole camera{100, 60, 640, {-0.06, 0, 0}, 0.0873};

// Off the shape along its normal, rims and edges left out: root mean square and mean over what the points state.
struct Errors {
  double rms = 0, bias = 0;
  int count = 0;
};

Errors errors_of(const ScanWorld& shape, const Cloud& cloud) {
  double squares = 0, sum = 0, stated = 0;
  Errors e;
  for (const ScanPoint& p : cloud.points) {
    Vec3 n = normalized(Vec3{shape.tilt, 0, -1});
    if (shape.shape == ScanWorld::Shape::ball) n = normalized(p.position_m - Vec3{0, 0, shape.distance});
    if (shape.shape == ScanWorld::Shape::ball && n.z > -0.6) continue;
    if (shape.shape == ScanWorld::Shape::step && std::abs(p.position_m.x - 0.01) < 0.01) continue;
    const auto& c = p.covariance;
    const Vec3 cn{c[0] * n.x + c[1] * n.y + c[2] * n.z, c[1] * n.x + c[3] * n.y + c[4] * n.z,
                  c[2] * n.x + c[4] * n.y + c[5] * n.z};
    const double off = tests::off_shape(shape, {p.position_m.x, p.position_m.y, p.position_m.z});
    squares += off * off, sum += off, stated += dot(n, cn), ++e.count;
  }
  const double own = std::sqrt(stated / e.count);
  e.rms = std::sqrt(squares / e.count) / own, e.bias = sum / e.count / own;
  return e;
}

TEST(RenderedStructuredLight, PlaneBallAndStepHaveTheErrorsThatPointsState) {
  const double periods[] = {1, 6, 40};
  const Sequence sequence = cosine_sequence(480, 360, columns, periods, 4);
  for (const auto shape : {ScanWorld::Shape::plane, ScanWorld::Shape::ball, ScanWorld::Shape::step}) {
    ScanWorld closed;
    closed.shape = shape;
    RenderedWorld world = tests::rendered(closed);
    world.spp = 512, world.bounces = 2;  // places in a pixel: a seventh of noise
    const tests::RenderedFrames frames(world, camera, sequence);
    DecodeRequest request;
    request.sequence = sequence;
    const Codes codes = decoded(frames, world, camera, request);
    const Cloud cloud = points_of_projector(codes, tests::station_of(camera), tests::station_of(world.projector));
    const Errors e = errors_of(closed, cloud);
    EXPECT_GT(e.count, 3000);
    EXPECT_NEAR(e.rms, 1, 0.2) << static_cast<int>(shape);
    EXPECT_LT(std::abs(e.bias), 0.2) << static_cast<int>(shape);
  }
}

// Grooves of 90 degrees: even, and with a wall that lies almost along the light.
TEST(RenderedStructuredLight, BitsThatWallsMadeAnotherAreRefused) {
  int wrong = 0, wrong_refused = 0, right = 0, right_refused = 0;
  for (const double turn : {0.0, -36 * pi / 180}) {
    RenderedWorld world = tests::groove(90 * pi / 180, turn);
    world.white = 0.35, world.spp = 128;
    const Pinhole narrow{200, 20, 640, {-0.06, 0, 0}, 0.0873};
    DecodeRequest request;
    request.sequence = gray_sequence(480, 360, both);
    const tests::RenderedFrames frames(world, narrow, request.sequence);
    const Codes told = decoded(frames, world, narrow, request);
    request.indirect = false;
    const Codes plain = decoded(frames, world, narrow, request);
    for (std::size_t i = 0; i < plain.refusal.size(); ++i) {
      const auto truth = lit_by(world, narrow, static_cast<int>(i % 200), static_cast<int>(i / 200));
      if (!truth || !plain.told(i)) continue;
      const bool off = std::abs(plain.place[0][i] - truth->x) > 1.5 || std::abs(plain.place[1][i] - truth->y) > 1.5;
      ++(off ? wrong : right);
      if (told.refusal[i] == Refusal::interreflection) ++(off ? wrong_refused : right_refused);
    }
  }
  EXPECT_GT(wrong, 10);
  EXPECT_GE(wrong_refused, 0.9 * wrong) << wrong;
  EXPECT_LE(right_refused, 0.05 * right) << right;
}

}  // namespace
}  // namespace gonio::scan
