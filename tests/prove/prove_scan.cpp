// The thesis's scanner (chapter 3: two cameras of 9.1 MP that look inwards by 10 degrees, a projector of 1920 x 1080,
// phases of 1 and 16 periods at 9 shifts) before two balls and a plane, by rays in closed form: clouds for vdi2634.
//   prove-scan FOLDER   writes ball-1.ply, ball-2.ply, plane.ply and prints one claim a line
#include <cmath>
#include <cstdio>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/ply.h"
#include "scan/scan_world.h"

namespace {

using namespace gonio;
using tests::ScanWorld;

constexpr double ball_m = 0.025;
constexpr scan::Axis both[] = {scan::Axis::column, scan::Axis::row};

ScanWorld thesis_world() {
  ScanWorld w;
  constexpr double toe = 10 * pi / 180;
  w.distance = 0.8, w.radius = ball_m, w.across = 2;
  w.left = {3376, 2704, 4336, {-0.8 * std::tan(toe), 0, 0}, toe};
  w.right = {3376, 2704, 4336, {0.8 * std::tan(toe), 0, 0}, -toe};
  w.projector = {1920, 1080, 2600, {0, -0.05, 0}, 0};
  w.bits = 12;
  return w;
}

scan::Cloud measured(const ScanWorld& world) {
  const double periods[] = {1, 16};
  const scan::Sequence sequence = scan::cosine_sequence(1920, 1080, both, periods, 9);
  scan::Codes codes[2];
  parallel_for(0, 2, [&](std::size_t k) {
    codes[k] = tests::decoded(world, k == 0 ? world.left : world.right, sequence, false);
  });
  return scan::points_of_cameras(codes[0], tests::station_of(world.left), codes[1], tests::station_of(world.right),
                                 1920);
}

// Root mean square off the shape over what is stated, the ball's rim left out.
void check(const char* name, const ScanWorld& world, const scan::Cloud& cloud, const std::filesystem::path& path) {
  double squares = 0, sum = 0, stated = 0, count = 0;
  io::TriangleMesh mesh;
  for (const scan::ScanPoint& p : cloud.points) {
    const Vec3 at = p.position_m;
    Vec3 n = normalized(Vec3{world.tilt, 0, -1});
    if (world.shape == ScanWorld::Shape::ball) n = normalized(at - Vec3{world.ball_x, 0, world.distance});
    if (world.shape == ScanWorld::Shape::ball && n.z > -0.5) continue;
    mesh.positions_m.push_back(at);
    const std::array<double, 6>& c = p.covariance;
    const Vec3 cn{c[0] * n.x + c[1] * n.y + c[2] * n.z, c[1] * n.x + c[3] * n.y + c[4] * n.z,
                  c[2] * n.x + c[4] * n.y + c[5] * n.z};
    const double off = tests::off_shape(world, {at.x, at.y, at.z});
    squares += off * off, sum += off, stated += dot(n, cn), ++count;
  }
  io::write_ply(path, mesh);
  const double rms = std::sqrt(squares / count), own = std::sqrt(stated / count);
  std::printf(
      "structured-light %s, root mean square over what is stated: measured %.3f required 0.8 to 1.2 (%.4f mm, %.0f "
      "points)\n",
      name, rms / own, 1e3 * rms, count);
  std::printf("structured-light %s, bias over what is stated: measured %.3f required <= 0.2\n", name,
              std::abs(sum / count) / own);
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) return std::fprintf(stderr, "usage: prove-scan FOLDER\n"), 64;
  const std::filesystem::path folder = words[1];
  make_folder(folder);
  ScanWorld world = thesis_world();
  check("plane", world, measured(world), folder / "plane.ply");
  world.shape = ScanWorld::Shape::ball;
  for (const int k : {1, 2}) {
    world.ball_x = k == 1 ? -0.05 : 0.05, world.seed = static_cast<std::uint64_t>(k);
    check(format("ball %d", k).c_str(), world, measured(world), folder / format("ball-%d.ply", k));
  }
  return 0;
}
