// How long `reassemble` takes over photographs of 9 MP, and what it finds in them, beside OpenCV's circle Hough
// transform (the thesis's kind of detector) on the same pictures: scripts/bench reassemble.
//
// Three pieces of thirteen dark balls on a bright, chequered and grained table, seen from VIEWS places round them.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "geom/angle.h"
#include "reassembly/detect.h"
#include "reassembly/marker_photograph.h"
#include "reassembly/place.h"
#include "render/looking_at.h"

namespace {

using namespace gonio;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr double radius_m = 0.0025;

struct Laboratory {
  std::vector<reassembly::Piece> pieces;
  std::vector<Vec3> balls;  // world
};

Laboratory laboratory() {
  Laboratory all;
  Random random(3);
  for (int p = 0; p < 3; ++p) {
    reassembly::Piece piece{"piece" + std::to_string(p + 1), {}};
    const Vec3 middle{0.16 * (p - 1), 0.05 * (p == 1), 0.06};
    while (piece.markers.size() < 13) {
      const double z = random.uniform(-0.6, 1), a = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
      const Vec3 place = 0.06 * Vec3{r * std::cos(a), r * std::sin(a), z};
      const bool free =
          std::ranges::all_of(piece.markers, [&](const auto& m) { return norm(m.centre_m - place) > 0.01; });
      if (!free) continue;
      Mat3 covariance;
      for (int i = 0; i < 3; ++i) covariance(i, i) = 1e-10;
      piece.markers.push_back(
          {piece.object + "-" + std::to_string(piece.markers.size() + 1), place, radius_m, covariance});
      all.balls.push_back(middle + place);
    }
    all.pieces.push_back(std::move(piece));
  }
  return all;
}

// The table's grey where a ray meets z = 0: checks of 25 mm, with grain.
double table_grey(Vec3 p) {
  const auto cell = [](double v) { return static_cast<long>(std::floor(v / 0.025)); };
  const double grain = std::sin(2100 * p.x) * std::sin(1700 * p.y) + std::sin(900 * p.x + 1300 * p.y);
  return ((cell(p.x) + cell(p.y)) % 2 == 0 ? 150 : 190) + 6 * grain;
}

struct Shots {
  tests::Photograph lens;
  std::vector<reassembly::View> views;
  std::vector<io::GreyImage> pictures;
  std::size_t shown = 0;  // balls within the pictures
};

tests::Photograph lens_of(int width) {
  tests::Photograph lens;
  lens.width = width, lens.height = width * 3 / 4;
  lens.focal_px = 1.9 * width, lens.fine = 2, lens.noise = 2, lens.blur_px = 1;
  lens.cx = 0.5 * (lens.width - 1), lens.cy = 0.5 * (lens.height - 1);
  return lens;
}

constexpr double away_m = 0.9;

Shots photographed(const Laboratory& lab, std::size_t views, int width) {
  Shots shots{lens_of(width), std::vector<reassembly::View>(views), std::vector<io::GreyImage>(views)};
  std::vector<std::size_t> shown(views, 0);
  parallel_for(0, views, [&](std::size_t v) {
    const double a = 2 * pi * static_cast<double>(v) / static_cast<double>(views);
    const double e = (35 + 10 * static_cast<double>(v % 3)) * degree;
    reassembly::View& view = shots.views[v];
    view.image = "v" + std::to_string(v + 1);
    view.world_from_camera = render::looking_at(
        away_m * Vec3{std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)}, {0, 0.02, 0.05});
    const auto camera_from_world = inverse(view.world_from_camera);
    tests::Photograph photo = shots.lens;
    for (const Vec3& ball : lab.balls) {
      tests::Ball b;
      b.centre_m = camera_from_world * ball, b.radius_m = radius_m, b.albedo = 45, b.lamp = {0.3, -0.8, -0.5};
      photo.balls.push_back(b);
      const Vec2 at = photo.pixel(b.centre_m);
      shown[v] += at.x > 20 && at.y > 20 && at.x < photo.width - 20 && at.y < photo.height - 20;
    }
    photo.behind = [&](double x, double y) {
      const Vec3 direction = view.world_from_camera.rotate(photo.ray(x, y)), eye = view.world_from_camera.translation_m;
      return direction.z < 0 ? table_grey(eye + direction * (-eye.z / direction.z)) : 60;
    };
    shots.pictures[v] = tests::take(photo, v);
  });
  for (const std::size_t n : shown) shots.shown += n;
  return shots;
}

struct Count {
  std::size_t right = 0, wrong = 0;
  void add(const Shots& shots, const Laboratory& lab, std::size_t view, Vec2 at) {
    const bool is_ball = std::ranges::any_of(lab.balls, [&](const Vec3& ball) {
      return norm(shots.lens.pixel(inverse(shots.views[view].world_from_camera) * ball) - at) < 1.5;
    });
    ++(is_ball ? right : wrong);
  }
};

double own(Shots& shots, const Laboratory& lab) {
  reassembly::DetectWish wish;
  wish.least_half_angle_rad = 0.5 * radius_m / away_m, wish.largest_half_angle_rad = 2 * radius_m / away_m;
  const camera::CameraModel camera = shots.lens.camera();
  auto start = Clock::now();
  parallel_for(0, shots.views.size(),
               [&](std::size_t v) { shots.views[v].outlines = detect_spheres(shots.pictures[v], camera, wish).found; });
  const double detecting_s = seconds_since(start);
  start = Clock::now();
  reassembly::PlaceWish place_wish;
  place_wish.radius_m = radius_m;
  const auto bundles = reassembly::bundles(shots.views, place_wish);
  const auto placement = reassembly::place(shots.views, bundles, lab.pieces, place_wish);
  const double placing_s = seconds_since(start);
  Count count;
  for (std::size_t v = 0; v < shots.views.size(); ++v)
    for (const auto& o : shots.views[v].outlines) count.add(shots, lab, v, o.centre_px);
  const double each_s = detecting_s / static_cast<double>(shots.views.size());
  std::printf("reassemble: %.2f s a picture, %zu right, %zu wrong; placing %.2f s:", each_s, count.right, count.wrong,
              placing_s);
  for (const auto& p : placement.pieces) std::printf(" %s %zu of 13", p.object.c_str(), p.pairs.size());
  std::printf("\n40 such views: %.0f s\n", 40 * each_s + placing_s);
  return each_s;
}

void peer(Shots& shots, const Laboratory& lab, double own_s) {
  const double expected_px = shots.lens.focal_px * radius_m / away_m;
  const auto start = Clock::now();
  Count count;
  for (std::size_t v = 0; v < shots.views.size(); ++v) {
    const cv::Mat grey(shots.lens.height, shots.lens.width, CV_8U, shots.pictures[v].bytes.data());
    std::vector<cv::Vec3f> circles;
    cv::HoughCircles(grey, circles, cv::HOUGH_GRADIENT, 1, expected_px, 100, 20, static_cast<int>(0.5 * expected_px),
                     static_cast<int>(2 * expected_px));
    for (const auto& c : circles) count.add(shots, lab, v, {c[0], c[1]});
  }
  const double each_s = seconds_since(start) / static_cast<double>(shots.views.size());
  std::printf("cv::HoughCircles: %.2f s a picture, %zu right, %zu wrong; ratio of times %.1f\n", each_s, count.right,
              count.wrong, own_s / each_s);
}

}  // namespace

int main(int argc, char** argv) {
  const int views = argc > 1 ? std::atoi(argv[1]) : 6, width = argc > 2 ? std::atoi(argv[2]) : 3456;
  set_threads(2);
  const Laboratory lab = laboratory();
  Shots shots = photographed(lab, static_cast<std::size_t>(views), width);
  std::printf("%d pictures of %.1f MP, two threads; %zu balls of radius %.1f px\n", views,
              1e-6 * shots.lens.width * shots.lens.height, shots.shown, shots.lens.focal_px * radius_m / away_m);
  peer(shots, lab, own(shots, lab));
}
