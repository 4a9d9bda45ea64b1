// See triangulate.h.
#include "scan/triangulate.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "geom/mat3_inverse.h"
#include "scan/code_places.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::scan {
namespace {

constexpr int most_steps = 12;
constexpr double step_m = 1e-5;  // of finite differences, per metre of depth
constexpr std::size_t points_at_once = 512;
constexpr double exact_px2 = 1e-6;  // of the projector's own pixel

std::string reason(Refusal refusal) {
  return std::string(refusal_names[static_cast<std::size_t>(refusal)]);
}

void count_refusals(const Codes& codes, Cloud& cloud) {
  for (const Refusal r : codes.refusal)
    if (r != Refusal::none) ++cloud.refused[std::string(refusal_names[static_cast<std::size_t>(r)])];
}

// `chi_square`: of what its pictures contradict each other by; below zero: they cannot.
struct Solved {
  ScanPoint point;
  double chi_square = -1;
  std::size_t degrees = 1;
};

// Of the largest eigenvalue of v, m + 2 p cos(phi / 3), cos(phi) = det((v - m) / p) / 2, m a third of the trace
// (Smith 1961).
double largest_sigma(const std::array<double, 6>& c) {
  const double m = (c[0] + c[3] + c[5]) / 3, xx = c[0] - m, yy = c[3] - m, zz = c[5] - m;
  const double p = std::sqrt((xx * xx + yy * yy + zz * zz + 2 * (c[1] * c[1] + c[2] * c[2] + c[4] * c[4])) / 6);
  if (!(p > 0)) return std::sqrt(std::max(0.0, m));
  const double determinant =
                   xx * (yy * zz - c[4] * c[4]) - c[1] * (c[1] * zz - c[4] * c[2]) + c[2] * (c[1] * c[4] - yy * c[2]),
               cosine = std::clamp(determinant / (2 * p * p * p), -1.0, 1.0);
  return std::sqrt(std::max(0.0, m + 2 * p * std::cos(std::acos(cosine) / 3)));
}

// Joins what was found side by side, in order, and says by how much variances, `wider` times what is stated, were too
// small.
template <class Body>  // std::optional<Solved> of each
void gather(std::size_t count, double most_px, double wider, const Body& body, Cloud& cloud) {
  std::vector<std::optional<Solved>> found(count);
  parallel_for(0, (count + points_at_once - 1) / points_at_once, [&](std::size_t n) {
    for (std::size_t i = n * points_at_once; i < std::min(count, (n + 1) * points_at_once); ++i) found[i] = body(i);
  });
  std::size_t lost = 0;
  std::array<double, 2 * most_devices> medians{};
  for (std::size_t degrees = 1; degrees < medians.size(); ++degrees)
    medians[degrees] = stats::chi2_quantile(0.5, static_cast<double>(degrees));
  std::vector<double> chi_squares;  // over their median
  for (const std::optional<Solved>& solved : found) {
    if (!solved || solved->point.reprojection_px > most_px) {
      ++lost;
      continue;
    }
    cloud.points.push_back(solved->point);
    if (solved->chi_square >= 0) chi_squares.push_back(solved->chi_square / (wider * medians[solved->degrees]));
  }
  if (lost > 0) cloud.refused[reason(Refusal::contradictory)] += lost;
  if (!chi_squares.empty()) cloud.epipolar_chi_square = stats::median(chi_squares);
  const double factor = wider * std::max(1.0, cloud.epipolar_chi_square);
  parallel_for(0, (cloud.points.size() + points_at_once - 1) / points_at_once, [&](std::size_t n) {
    for (std::size_t i = n * points_at_once; i < std::min(cloud.points.size(), (n + 1) * points_at_once); ++i) {
      ScanPoint& point = cloud.points[i];
      for (double& v : point.covariance) v *= factor;
      point.sigma_m = largest_sigma(point.covariance);
    }
  });
}

// A projector's pixels along the ray of one camera's pixel.
class RayInProjector {
 public:
  RayInProjector(const Station& projector, Vec3 origin, Vec3 direction) : projector_(projector) {
    const auto projector_from_rig = inverse(projector.rig_from_camera);
    origin_ = projector_from_rig * origin, direction_ = projector_from_rig.rotate(direction);
  }
  std::optional<Vec2> at(double depth) const { return projector_.lens.project(origin_ + depth * direction_); }
  // Depth at which the plane (or line) of the projector's ray is nearest: a start.
  std::optional<double> start(Vec2 pixel, bool columns, bool rows) const {
    const camera::Ray ray = projector_.lens.ray(pixel);
    Vec3 normal = columns ? cross(ray.direction, Vec3{0, 1, 0}) : cross(ray.direction, Vec3{1, 0, 0});
    if (columns && rows &&
        std::abs(dot(direction_, normal)) < std::abs(dot(direction_, cross(ray.direction, {1, 0, 0}))))
      normal = cross(ray.direction, Vec3{1, 0, 0});
    const double along = dot(direction_, normal);
    if (along == 0) return std::nullopt;
    const double depth = dot(ray.origin_m - origin_, normal) / along;
    return depth > 0 && std::isfinite(depth) ? std::optional(depth) : std::nullopt;
  }

 private:
  const Station& projector_;
  Vec3 origin_, direction_;
};

struct Decoded {
  Vec2 place;             // of the projector; the middle where an axis is not told
  double weight[2] = {};  // 1 / variance; 0: not told
};

Decoded decoded(const Codes& codes, std::size_t i, const Station& projector) {
  Decoded d{{0.5 * projector.lens.width_px(), 0.5 * projector.lens.height_px()}, {}};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (codes.place[axis].empty()) continue;
    (axis == 0 ? d.place.x : d.place.y) = codes.place[axis][i];
    d.weight[axis] = 1 / (double{codes.sigma[axis][i]} * codes.sigma[axis][i]);
  }
  return d;
}

std::optional<Solved> on_ray(const Codes& codes, std::size_t i, const Station& camera, const Station& projector) {
  const auto width = static_cast<std::size_t>(codes.width);
  const Vec2 pixel{static_cast<double>(i % width), static_cast<double>(i / width)};
  const camera::Ray seen = camera.lens.ray(pixel);
  const Vec3 origin = camera.rig_from_camera * seen.origin_m, direction = camera.rig_from_camera.rotate(seen.direction);
  const RayInProjector ray(projector, origin, direction);
  const Decoded code = decoded(codes, i, projector);
  const std::optional<double> start = ray.start(code.place, code.weight[0] > 0, code.weight[1] > 0);
  if (!start) return std::nullopt;
  double depth = *start, information = 0;
  Vec2 off;
  for (int k = 0; k < most_steps; ++k) {
    const double step = step_m * depth;
    const auto here = ray.at(depth), there = ray.at(depth + step);
    if (!here || !there) return std::nullopt;
    off = code.place - *here;
    const Vec2 slope = (*there - *here) * (1 / step);
    information = code.weight[0] * slope.x * slope.x + code.weight[1] * slope.y * slope.y;
    if (!(information > 0)) return std::nullopt;
    const double move = (code.weight[0] * slope.x * off.x + code.weight[1] * slope.y * off.y) / information;
    depth += move;
    if (!(depth > 0) || !std::isfinite(depth)) return std::nullopt;
    if (std::abs(move) < 1e-10 * depth) break;
  }
  Solved solved;
  ScanPoint& point = solved.point;
  point.position_m = origin + depth * direction, point.pixel = pixel, point.reflected = codes.reflected[i];
  const double v = 1 / information;
  const Vec3 d = direction;
  point.covariance = {v * d.x * d.x, v * d.x * d.y, v * d.x * d.z, v * d.y * d.y, v * d.y * d.z, v * d.z * d.z};
  if (code.weight[0] > 0 && code.weight[1] > 0) {
    point.reprojection_px = norm(off) / std::sqrt(2.0);
    solved.chi_square = code.weight[0] * off.x * off.x + code.weight[1] * off.y * off.y;
    point.across_px =
        static_cast<float>(std::copysign(point.reprojection_px, std::abs(off.y) > std::abs(off.x) ? off.y : off.x));
  }
  return solved;
}

// Devices' rays' common point, by the pixels' distances over their sigmas.
struct Seen {
  const Station* station = nullptr;
  const Rigid<frame::Camera, frame::Rig>* from_rig = nullptr;
  Vec2 pixel, variance_px2;
};
struct Group {
  std::array<Seen, most_devices> seen;
  std::size_t count = 0, camera = 0;  // the first camera
  float reflected = 0;
};

// The middle of the least distance between two rays; depth along the first.
std::optional<std::pair<Vec3, double>> between(const Seen& a, const Seen& b) {
  const Seen* both[2] = {&a, &b};
  Vec3 origins[2], directions[2];
  for (int k = 0; k < 2; ++k) {
    const camera::Ray ray = both[k]->station->lens.ray(both[k]->pixel);
    origins[k] = both[k]->station->rig_from_camera * ray.origin_m;
    directions[k] = both[k]->station->rig_from_camera.rotate(ray.direction);
  }
  const Vec3 apart = origins[1] - origins[0];
  const double c = dot(directions[0], directions[1]), d = 1 - c * c;
  if (!(d > 1e-12)) return std::nullopt;
  const double s = (dot(apart, directions[0]) - c * dot(apart, directions[1])) / d,
               t = (c * dot(apart, directions[0]) - dot(apart, directions[1])) / d;
  if (!(s > 0 && t > 0)) return std::nullopt;
  return std::pair{0.5 * (origins[0] + s * directions[0] + origins[1] + t * directions[1]), s};
}

std::optional<Solved> common_point(const Group& group) {
  const auto start = between(group.seen[0], group.seen[1]);
  if (!start) return std::nullopt;
  Solved solved;
  auto [x, s] = *start;
  // The slopes once: the start is within a fraction of a pixel.
  Mat3 normal{{}};
  Vec2 slopes[most_devices][3], weights[most_devices];
  const double h = step_m * s;
  for (std::size_t k = 0; k < group.count; ++k) {
    const Seen& own = group.seen[k];
    weights[k] = {1 / own.variance_px2.x, 1 / own.variance_px2.y};
    const auto here = own.station->lens.project(*own.from_rig * x);
    for (int i = 0; i < 3; ++i) {
      const Vec3 beside = x + h * Vec3{i == 0 ? 1.0 : 0, i == 1 ? 1.0 : 0, i == 2 ? 1.0 : 0};
      const auto moved = own.station->lens.project(*own.from_rig * beside);
      if (!here || !moved) return std::nullopt;
      slopes[k][i] = (*moved - *here) * (1 / h);
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        normal(i, j) += weights[k].x * slopes[k][i].x * slopes[k][j].x + weights[k].y * slopes[k][i].y * slopes[k][j].y;
  }
  const Mat3 covariance = inverse(normal);
  if (!std::isfinite(covariance(0, 0))) return std::nullopt;
  for (int step = 0; step < 4; ++step) {
    Vec3 right;
    double chi_square = 0, square = 0, side = 0;
    for (std::size_t k = 0; k < group.count; ++k) {
      const auto here = group.seen[k].station->lens.project(*group.seen[k].from_rig * x);
      if (!here) return std::nullopt;
      const Vec2 off = group.seen[k].pixel - *here;
      const Vec2 weighed{weights[k].x * off.x, weights[k].y * off.y};
      chi_square += dot(weighed, off), square += dot(off, off);
      if (k == 0) side = std::abs(off.y) > std::abs(off.x) ? off.y : off.x;
      right += Vec3{dot(slopes[k][0], weighed), dot(slopes[k][1], weighed), dot(slopes[k][2], weighed)};
    }
    solved.chi_square = chi_square;
    solved.point.reprojection_px = std::sqrt(square / static_cast<double>(group.count));
    solved.point.across_px = static_cast<float>(std::copysign(solved.point.reprojection_px, side));
    const Vec3 move = covariance * right;
    x += move;
    if (norm(move) < 1e-7 * s) break;
  }
  solved.degrees = 2 * group.count - 3;
  solved.point.position_m = x, solved.point.pixel = group.seen[0].pixel, solved.point.reflected = group.reflected;
  solved.point.camera = static_cast<std::uint8_t>(group.camera);
  solved.point.covariance = {covariance(0, 0), covariance(0, 1), covariance(0, 2),
                             covariance(1, 1), covariance(1, 2), covariance(2, 2)};
  return solved;
}

}  // namespace

Cloud points_of_projector(const Codes& codes, const Station& camera, const Station& projector, double most_px) {
  Cloud cloud;
  count_refusals(codes, cloud);
  std::vector<std::uint8_t> ambiguous(codes.refusal.size());
  for (const std::uint32_t i : ambiguous_pixels(codes, projector.lens.width_px()))
    ambiguous[i] = 1, ++cloud.refused[reason(Refusal::ambiguous)];
  std::vector<std::size_t> told;
  for (std::size_t i = 0; i < codes.refusal.size(); ++i)
    if (codes.told(i) && ambiguous[i] == 0) told.push_back(i);
  gather(
      told.size(), most_px, 1, [&](std::size_t n) { return on_ray(codes, told[n], camera, projector); }, cloud);
  return cloud;
}

Cloud points_of_rig(std::span<const Look> cameras, const Station* projector, int projector_width_px, double most_px) {
  if (cameras.size() + (projector != nullptr) > most_devices)
    throw Error(Exit::usage, "--camera", "is given " + std::to_string(cameras.size()) + " times",
                "a rig of " + std::to_string(most_devices) + " devices at most");
  Cloud cloud;
  count_refusals(*cameras[0].codes, cloud);
  std::vector<std::vector<CodePlace>> places(cameras.size());
  std::vector<std::size_t> ambiguous(cameras.size());
  parallel_for(0, cameras.size(),
               [&](std::size_t k) { places[k] = places_of(*cameras[k].codes, projector_width_px, &ambiguous[k]); });
  if (ambiguous[0] > 0) cloud.refused[reason(Refusal::ambiguous)] += ambiguous[0];
  std::vector<Rigid<frame::Camera, frame::Rig>> from_rig;
  for (const Look& look : cameras) from_rig.push_back(inverse(look.camera.rig_from_camera));
  if (projector != nullptr) from_rig.push_back(inverse(projector->rig_from_camera));
  // Of each pixel of the projector the places in all cameras that have it.
  std::vector<std::array<const CodePlace*, most_devices>> sets;
  std::vector<std::size_t> next(cameras.size());
  while (true) {
    std::int64_t code = -1;
    for (std::size_t k = 0; k < places.size(); ++k)
      if (next[k] < places[k].size() && (code < 0 || places[k][next[k]].code < code)) code = places[k][next[k]].code;
    if (code < 0) break;
    std::array<const CodePlace*, most_devices> set{};
    std::size_t seen = projector != nullptr ? 1 : 0;
    for (std::size_t k = 0; k < places.size(); ++k)
      if (next[k] < places[k].size() && places[k][next[k]].code == code) set[k] = &places[k][next[k]++], ++seen;
    if (seen > 1) sets.push_back(set);
  }
  cloud.matched = sets.size();
  double wider = 1;  // alike for all, so that points stay where they are
  if (std::ranges::all_of(cameras, [](const Look& look) { return look.codes->whole; })) {
    wider = 0;
    for (const std::vector<CodePlace>& own : places)
      wider += saw_factor(own, projector_width_px) / static_cast<double>(places.size());
  }
  gather(
      sets.size(), most_px, wider,
      [&](std::size_t n) {
        Group group;
        std::int64_t code = 0;
        for (std::size_t k = 0; k < cameras.size(); ++k) {
          const CodePlace* place = sets[n][k];
          if (place == nullptr) continue;
          if (group.count == 0) group.camera = k, group.reflected = place->reflected, code = place->code;
          group.seen[group.count++] = {&cameras[k].camera, &from_rig[k], place->pixel, place->variance_px2};
        }
        if (projector != nullptr)
          group.seen[group.count++] = {
              projector, &from_rig.back(),
              Vec2{static_cast<double>(code % projector_width_px), static_cast<double>(code / projector_width_px)},
              Vec2{exact_px2, exact_px2}};
        return common_point(group);
      },
      cloud);
  return cloud;
}

Cloud points_of_cameras(const Codes& first, const Station& first_camera, const Codes& second,
                        const Station& second_camera, int projector_width_px, double most_px) {
  const Look both[] = {{&first, first_camera}, {&second, second_camera}};
  return points_of_rig(both, nullptr, projector_width_px, most_px);
}

}  // namespace gonio::scan
