// See board_world.h.
#include "scan/board_world.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/parallel.h"
#include "camera/corner_detection.h"
#include "io/image.h"

namespace gonio::tests {
namespace {

using Point = std::array<double, 3>;

using Axes = std::array<Point, 3>;  // where x, y and z go
Axes axes_of(const Turned& t) {
  const Turned turn{t.turn, {}};
  return {turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})};
}
Point turned(const Axes& a, Point p) {
  Point q{};
  for (std::size_t k = 0; k < 3; ++k) q[k] = a[0][k] * p[0] + a[1][k] * p[1] + a[2][k] * p[2];
  return q;
}

double albedo(const BoardWorld& w, double x, double y) {  // of the board's plane; the origin is the first inner corner
  const double a = x / w.square + 1, b = y / w.square + 1;  // squares from the outer corner
  if (a < 0 || b < 0 || a > w.columns + 1 || b > w.rows + 1) {
    const bool margin = a > -1 && b > -1 && a < w.columns + 2 && b < w.rows + 2;
    return margin ? w.white : w.around;
  }
  return (static_cast<int>(std::floor(a)) + static_cast<int>(std::floor(b))) % 2 == 0 ? w.black : w.white;
}

}  // namespace

std::array<double, 2> BentLens::pixel(Point p) const {
  const double x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y, bent = 1 + r2 * (k1 + r2 * k2);
  return {fx * x * bent + cx, fy * y * bent + cy};
}

Point BentLens::direction(double u, double v) const {
  const double a = (u - cx) / fx, b = (v - cy) / fy;
  double x = a, y = b;
  for (int k = 0; k < 15; ++k) {
    const double r2 = x * x + y * y, bent = 1 + r2 * (k1 + r2 * k2);
    x = a / bent, y = b / bent;
  }
  return {x, y, 1};
}

Point Turned::operator()(Point p) const {
  const double angle = std::sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
  if (angle == 0) return {p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]};
  const Point n{turn[0] / angle, turn[1] / angle, turn[2] / angle};
  const double c = std::cos(angle), s = std::sin(angle), along = (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) * (1 - c);
  return {c * p[0] + s * (n[1] * p[2] - n[2] * p[1]) + along * n[0] + shift[0],
          c * p[1] + s * (n[2] * p[0] - n[0] * p[2]) + along * n[1] + shift[1],
          c * p[2] + s * (n[0] * p[1] - n[1] * p[0]) + along * n[2] + shift[2]};
}

std::vector<Turned> BoardWorld::poses(int count) const {
  std::vector<Turned> all;
  const Point middle{0.5 * (columns - 1) * square, 0.5 * (rows - 1) * square, 0};
  for (int k = 0; k < count; ++k) {
    const double azimuth = 2 * 3.14159265358979 * k / 5.0 + 0.3, tilt = 0.35 + 0.1 * (k % 3);
    Turned pose{{tilt * std::cos(azimuth), tilt * std::sin(azimuth), 0.1 * (k % 4 - 1.5)}, {}};
    const Point off = pose(middle);
    const Point target{0.045 * ((k % 3) - 1), 0.035 * ((k / 3) % 3 - 1), 0.5 + 0.03 * (k % 4)};
    pose.shift = {target[0] - off[0], target[1] - off[1], target[2] - off[2]};
    all.push_back(pose);
  }
  return all;
}

camera::Board BoardWorld::board() const {
  return {camera::BoardKind::checkerboard, columns, rows, square, 0, "", {}};
}

std::vector<std::vector<float>> light_of(const BoardWorld& w, const Turned& camera_from_board,
                                         const scan::Sequence& sequence) {
  std::vector<std::vector<double>> shown;  // by frame, along its axis
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    const bool rows = sequence.frames[f].axis == scan::Axis::row;
    std::vector<double>& own = shown.emplace_back();
    for (int u = 0; u < (rows ? sequence.height_px : sequence.width_px); ++u)
      own.push_back(scan::light_at(sequence, f, rows ? 0 : u, rows ? u : 0));
  }
  std::vector<std::vector<float>> light(sequence.frames.size(),
                                        std::vector<float>(static_cast<std::size_t>(w.camera.width * w.camera.height)));
  const Point n = Turned{camera_from_board.turn, {}}({0, 0, 1}), t = camera_from_board.shift;
  const double height = n[0] * t[0] + n[1] * t[1] + n[2] * t[2];
  const Point back{-camera_from_board.turn[0], -camera_from_board.turn[1], -camera_from_board.turn[2]};
  const Axes rotation = axes_of({back, {}}), projector = axes_of(w.projector_from_camera);
  parallel_for(0, static_cast<std::size_t>(w.camera.height), [&](std::size_t row) {
    const auto met = [&](double x, double y) {
      const Point d = w.camera.direction(x, y);
      const double s = height / (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
      return Point{s * d[0], s * d[1], s * d[2]};
    };
    const auto seen = [&](Point p) {
      const Point q = turned(rotation, {p[0] - t[0], p[1] - t[1], p[2] - t[2]});
      return albedo(w, q[0], q[1]);
    };
    for (int x = 0; x < w.camera.width; ++x) {
      const double y = static_cast<double>(row), here = seen(met(x, y));
      bool edge = false;
      for (int k = 0; k < 4; ++k) edge |= seen(met(x + (k % 2) - 0.5, y + (k / 2) - 0.5)) != here;
      const int n1 = edge ? w.at_edges : w.across, n2 = n1 * n1;
      for (int k = 0; k < n2; ++k) {
        const double i = k % n1, j = k / n1;  // no two in one row or column
        const Point p = met(x + (i + 0.5) / n1 + (j + 0.5) / n2 - 0.5 / n1 - 0.5,
                            y + (j + 0.5) / n1 + (i + 0.5) / n2 - 0.5 / n1 - 0.5);
        const Point q = turned(projector, p), s = w.projector_from_camera.shift;
        std::array<double, 2> u = w.projector.pixel({q[0] + s[0], q[1] + s[1], q[2] + s[2]});
        if (w.mirrored) u[0] = w.projector.width - 1 - u[0];
        if (w.exchanged) std::swap(u[0], u[1]);
        const double share = seen(p) / n2;
        for (std::size_t f = 0; f < shown.size(); ++f) {
          const double at = sequence.frames[f].axis == scan::Axis::row ? u[1] : u[0];
          double lit = 0;
          if (at > -0.5 && at < static_cast<double>(shown[f].size()) - 0.5) {
            const double c = std::clamp(at, 0.0, static_cast<double>(shown[f].size()) - 1.001);
            const auto e = static_cast<std::size_t>(c);
            lit = shown[f][e] * (1 - (c - double(e))) + shown[f][e + 1] * (c - double(e));
          }
          light[f][row * static_cast<std::size_t>(w.camera.width) + static_cast<std::size_t>(x)] +=
              static_cast<float>(share * (w.ambient + w.projected * lit));
        }
      }
    }
  });
  return light;
}

scan::CameraFrame read_with_noise(const BoardWorld& w, const std::vector<float>& light, std::uint64_t seed) {
  std::mt19937_64 random(seed * 7919 + 17);
  std::normal_distribution<float> normal;
  scan::CameraFrame frame;
  for (const float v : light)
    frame.light.push_back(v + normal(random) * static_cast<float>(std::sqrt(double{v} / w.gain + w.read * w.read)));
  return frame;
}

BoardSession::BoardSession(BoardWorld world, scan::Sequence sequence, int poses)
    : world_(std::move(world)), sequence_(std::move(sequence)) {
  for (const Turned& pose : world_.poses(poses)) light_.push_back(light_of(world_, pose, sequence_));
}

scan::CameraFrame BoardSession::frame(std::size_t pose, std::size_t frame, std::uint64_t seed) const {
  return read_with_noise(world_, light_[pose][frame], (seed * 1000 + pose) * 100 + frame);
}

camera::Detection BoardSession::seen(std::size_t pose, std::uint64_t seed) const {
  io::Image white(world_.camera.width, world_.camera.height, {"Y"});
  white.data = frame(pose, sequence_.frames.size() - 1, seed).light;
  return camera::detect_board(white, world_.board(), {});
}

scan::Codes BoardSession::codes(std::size_t pose, std::uint64_t seed) const {
  scan::DecodeRequest request;
  request.sequence = sequence_, request.width = world_.camera.width, request.height = world_.camera.height;
  request.read = [&](std::size_t f) { return frame(pose, f, seed); };
  request.noise = manifest::Noise{world_.gain, world_.read};
  return scan::decode(request);
}

scan::ProjectorCorners BoardSession::corners(std::size_t pose, std::uint64_t seed) const {
  const camera::Detection found = seen(pose, seed);
  const scan::Codes told = codes(pose, seed);
  return scan::projector_corners({{0, &found, &told}}, world_.board());
}

std::vector<camera::View> BoardSession::views(std::uint64_t seed) const {
  std::vector<camera::View> views(2 * light_.size());
  parallel_for(0, light_.size(), [&](std::size_t p) {
    const camera::Detection found = seen(p, seed);
    const scan::Codes told = codes(p, seed);
    const scan::ProjectorCorners lit = scan::projector_corners({{0, &found, &told}}, world_.board());
    views[2 * p] = {"camera", found.corners, found.noise_px, 0, 0, p};
    views[2 * p + 1] = {"projector", lit.detection.corners, lit.detection.noise_px, 1, 0, p};
  });
  return views;
}

camera::CalibrationSetup BoardSession::setup() const {
  camera::CalibrationSetup setup;
  const BentLens* lenses[] = {&world_.camera, &world_.projector};
  const char* names[] = {"camera", "projector"};
  for (int c = 0; c < 2; ++c) {
    camera::CameraSetup own{names[c], lenses[c]->width, lenses[c]->height, "radial-tangential", {"k3", "p1", "p2"}, {}};
    setup.cameras.push_back(own);
  }
  setup.boards.push_back({"board", world_.board(), false, {}});
  return setup;
}

scan::Sequence cosines_and_white(const BoardWorld& world, std::vector<double> periods, int shifts) {
  constexpr scan::Axis both[] = {scan::Axis::column, scan::Axis::row};
  scan::Sequence s = scan::cosine_sequence(world.projector.width, world.projector.height, both, periods, shifts);
  s.frames.push_back({.what = scan::Shown::What::white});
  return s;
}

}  // namespace gonio::tests
