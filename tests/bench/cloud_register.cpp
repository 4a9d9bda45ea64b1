// Two views of a camera and a projector, one of them misplaced: the other side of scripts/bench cloud-register.
//   bench-cloud-register BUNNY.obj COUNT
// prints, of bumps, of half as much overlap, and of the bunny, the root mean square over COUNT worlds of how far points
// lie from where they belong once views are registered, and the seconds: ours, PCL's generalized ICP, PCL's ICP with
// normals.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "bench/registration/pcl_peers.h"
#include "mesh/obj_file.h"
#include "mesh/register/register_world.h"

namespace {

using namespace gonio;

constexpr double reach_m = 0.012;  // of pairs, for all three

struct Method {
  const char* name;
  double squares = 0, seconds = 0;
};

// Mean square distance of the second view's points from where they were before they were misplaced.
double missed(const mesh::MeasuredPoints& points, const mesh::ViewMotion& motion, const mesh::ViewMotion& error) {
  double sum = 0, count = 0;
  const mesh::ViewMotion left = motion * error, back = inverse(error);
  for (std::size_t i = 0; i < points.view.size(); ++i) {
    if (points.view[i] != 1) continue;
    const Vec3 off = left * (back * points.positions_m[i]) - back * points.positions_m[i];
    sum += dot(off, off), ++count;
  }
  return sum / count;
}

void compare(const char* name, const io::TriangleMesh& thing, const tests::SeenViews& views, int count) {
  Method methods[] = {{"ours"}, {"PCL GICP"}, {"PCL ICP with normals"}};
  for (int world = 0; world < count; ++world) {
    mesh::MeasuredPoints points = tests::seen(thing, views, static_cast<std::uint64_t>(world));
    Random random(3, static_cast<std::uint64_t>(world));
    const auto three = [&](double s) { return Vec3{s * random.normal(), s * random.normal(), s * random.normal()}; };
    const Vec3 turn = three(2e-3);
    const mesh::ViewMotion error{quaternion_of_rotation_vector(turn), three(5e-4)};
    tests::misplace(points, 1, error);
    const auto timed = [&](Method& method, const auto& find) {
      const auto begin = std::chrono::steady_clock::now();
      method.squares += missed(points, find(), error) / count;
      method.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / count;
    };
    timed(methods[0], [&] {
      return mesh::register_views(points, {}, {.refine = true, .limit_m = 1e-2, .reach_m = reach_m}).views[1].motion;
    });
    timed(methods[1], [&] { return bench::by_gicp(points, reach_m); });
    timed(methods[2], [&] { return bench::by_icp_with_normals(points, reach_m); });
  }
  for (const Method& m : methods)
    std::printf("%-14s %-22s %8.4f mm, %6.2f times ours, %6.2f s\n", name, m.name, 1e3 * std::sqrt(m.squares),
                std::sqrt(m.squares / methods[0].squares), m.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  const int count = std::atoi(argv[2]);
  compare("bumps", tests::free_form(), {.side = 90, .f_px = 270}, count);
  compare("half overlap", tests::free_form(),
          {.cameras = {{-0.18, 0.03, 0.3}, {0.18, -0.02, 0.3}}, .side = 90, .f_px = 400}, count);
  io::TriangleMesh bunny = tests::read_obj(argv[1]);
  Vec3 low{1, 1, 1}, high{-1, -1, -1};
  for (const Vec3 p : bunny.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  for (Vec3& p : bunny.positions_m) p = p - 0.5 * (low + high);
  compare("bunny", bunny, {.cameras = {{-0.15, 0.05, 0.4}, {0.15, 0, 0.4}}, .side = 110, .f_px = 260}, count);
}
