// See measurements.h.
#include "glass/refine/measurements.h"

#include <algorithm>
#include <cmath>

#include "surface/refraction.h"

namespace gonio::glass {
namespace {

constexpr double leaving = 0.05;         // cells from a surface, before it can be met again
constexpr double level_of_two = 1.5158;  // of an angle of two Gaussian components 68.3 % lie within so many deviations
constexpr double huber = 3;              // widths of the robust costs, standard deviations
constexpr double bounded = 9;            // square of the width of the light's
constexpr double floor_depth = 0.5, floor_sigma = 0.2;  // cells
constexpr double band_px = 1.5, slack_px = 1, reach_px = 3.5;

struct Robust {
  double cost, weight;
};
Robust pseudo_huber(double square) {
  const double root = std::sqrt(1 + square / (huber * huber));
  return {2 * huber * huber * (root - 1), 1 / root};
}
Robust geman(double square) {
  const double over = 1 / (1 + square / bounded);
  return {square * over, over * over};
}

void whiten(Rows& rows, double weight) {
  const double root = std::sqrt(weight);
  for (std::size_t k = 0; k < rows.count; ++k) {
    rows.residual[k] *= root;
    for (double& slope : rows.slopes[k]) slope *= root;
  }
}

}  // namespace

std::vector<Measurement> Measuring::outlines(std::size_t number) const {
  const View& view = views_[number];
  std::vector<Measurement> all;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      if (std::abs(view.outline_px[view.pixel(x, y)]) < reach_px) all.push_back({Kind::outline, number, x, y, {}});
  return all;
}

std::vector<Measurement> Measuring::normals(std::size_t number) const {
  const View& view = views_[number];
  std::vector<Measurement> all;
  if (!view.network) return all;
  for (int y = static_cast<int>(number % 2); y < view.height; y += sigmas_.normals_step)
    for (int x = static_cast<int>(number % 3); x < view.width; x += sigmas_.normals_step) {
      const std::size_t at = view.pixel(x, y);
      if (view.outline_px[at] < 1) continue;
      if (norm(view.network->front[at]) > 0) all.push_back({Kind::front, number, x, y, {}});
      if (norm(view.network->back[at]) > 0) all.push_back({Kind::back, number, x, y, {}});
    }
  return all;
}

std::vector<Measurement> Measuring::lights(std::size_t number) const {
  const View& view = views_[number];
  std::vector<Measurement> all, kept;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      if (view.outline_px[view.pixel(x, y)] > sigmas_.light_margin) all.push_back({Kind::light, number, x, y, {}});
  const std::size_t step = all.size() / static_cast<std::size_t>(sigmas_.light_most) + 1;
  for (std::size_t i = 0; i < all.size(); i += step) kept.push_back(all[i]);
  return kept;
}

PixelRay Measuring::ray(const SplineField& field, std::size_t number, int x, int y) const {
  const View& view = views_[number];
  return {field.cells(view.eye_m()), view.direction(x, y), view.camera_x()};
}

bool Measuring::straight(const SplineField& field, const PixelRay& ray, Path& path) const {
  const Passage line = passage(field, ray.origin, ray.direction);
  if (line.crossings.size() < 2 || !line.crossings.front().enters || line.crossings.back().enters) return false;
  path.first = patch(field, ray.origin + ray.direction * line.crossings.front().t);
  path.second = patch(field, ray.origin + ray.direction * line.crossings.back().t);
  return true;
}

bool Measuring::refracted(const SplineField& field, const PixelRay& ray, double index, Path& path) const {
  const Passage line = passage(field, ray.origin, ray.direction);
  if (line.crossings.empty() || !line.crossings.front().enters) return false;
  const Vec3 entry = ray.origin + ray.direction * line.crossings.front().t;
  path.first = patch(field, entry);
  const Vec3 outward = -normalized(path.first.jet.slope);
  if (!(dot(ray.direction, outward) < 0)) return false;
  const Vec3 inside = surface::refracted(-ray.direction, outward, index);
  const Passage within = passage(field, entry, inside, leaving);
  if (within.crossings.empty() || within.crossings.front().enters) return false;
  const Vec3 exit = entry + inside * within.crossings.front().t;
  path.second = patch(field, exit);
  const Vec3 outward2 = -normalized(path.second.jet.slope);
  const double c = dot(inside, outward2);
  if (!(c > 0) || (1 - c * c) * index * index >= 1) return false;
  path.beyond = surface::refracted(-inside, -outward2, 1 / index);
  return passage(field, exit, path.beyond, leaving).crossings.empty();
}

bool Measuring::hidden(const SplineField& field, std::size_t view, const Path& path) const {
  const auto& others = views_[view].others;
  const light::Panel& panel = views_[view].screen->panel();
  const Vec3 exit_m = field.metres(path.second.at);
  const double towards = -dot(path.beyond, panel.frame.n);
  return others && towards > 0 &&
         others->blocked(exit_m, path.beyond, dot(exit_m - panel.centre_m, panel.frame.n) / towards);
}

std::vector<Measurement> Measuring::floor(const SplineField& field, double z_m) const {
  std::vector<Measurement> all;
  for (int j = 2; j + 2 < field.nodes()[1]; ++j)
    for (int i = 2; i + 2 < field.nodes()[0]; ++i) {
      Vec3 point = field.metres({1.0 * i, 1.0 * j, 0});
      point.z = z_m - floor_depth * field.cell_m();
      all.push_back({Kind::floor, 0, i, j, point});
    }
  return all;
}

double Measuring::floor_cost(const Asked& asked, const Measurement& m, Rows* rows) const {
  const Vec3 point = asked.field.cells(m.point_m);
  const double r = std::max(0.0, asked.field.value(point) + floor_depth) / floor_sigma;
  if (rows == nullptr || r == 0) return r * r;
  rows->count = 1, rows->places = 1;
  rows->at[0] = asked.field.support(point);
  rows->residual[0] = r, rows->slopes[0][0] = 1 / floor_sigma;
  return r * r;
}

double Measuring::outline_misfit_px(const Asked& asked, std::span<const Measurement> measurements) const {
  std::vector<double> off;
  for (const Measurement& m : measurements) {
    const View& view = views_[m.view];
    const double outline = m.kind == Kind::outline ? view.outline_px[view.pixel(m.x, m.y)] : 2 * band_px;
    if (std::abs(outline) > band_px) continue;
    const PixelRay line = ray(asked.field, m.view, m.x, m.y);
    const Passage through = passage(asked.field, line.origin, line.direction);
    if (through.meets_grid) off.push_back(std::abs(through.greatest * view.focal_px / through.at - outline));
  }
  if (off.empty()) return 0;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return 1.4826 * *middle;  // of a Gaussian
}

double Measuring::outline_cost(const Asked& asked, const Measurement& m, Rows* rows) const {
  const View& view = views_[m.view];
  const PixelRay line = ray(asked.field, m.view, m.x, m.y);
  const Passage through = passage(asked.field, line.origin, line.direction);
  if (!through.meets_grid) return 0;
  const double worth = through.at / view.focal_px;  // cells a pixel
  const double outline = view.outline_px[view.pixel(m.x, m.y)], found = through.greatest / worth;
  double off = found - outline;
  if (outline > band_px) off = std::min(0.0, found - slack_px);
  if (outline < -band_px) off = std::max(0.0, found + slack_px);
  const double r = off / sigmas_.outline_px;
  const Robust robust = pseudo_huber(r * r);
  if (rows == nullptr || off == 0) return robust.cost;
  rows->count = 1, rows->places = 1;
  const Vec3 deepest = line.origin + line.direction * through.at;
  rows->at[0] = asked.field.support(deepest);
  rows->residual[0] = r, rows->slopes[0][0] = 1 / (worth * sigmas_.outline_px);
  // The deepest place moves along the ray by -(direction . slope's change) / curvature, and a pixel's worth with it.
  const double curvature = dot(line.direction, asked.field.jet(deepest).curve * line.direction);
  const double by = curvature < -1e-3 ? found / (through.at * curvature * sigmas_.outline_px) : 0;
  for (std::size_t l = 0; l < 3; ++l) rows->slopes[0][l + 1] = by * line.direction[static_cast<int>(l)];
  whiten(*rows, robust.weight);
  return robust.cost;
}

double Measuring::normal_cost(const Asked& asked, const Measurement& m, Rows* rows) const {
  const View& view = views_[m.view];
  const PixelRay line = ray(asked.field, m.view, m.x, m.y);
  const std::size_t at = view.pixel(m.x, m.y);
  const bool front = m.kind == Kind::front;
  Path path;
  if (!straight(asked.field, line, path)) return pseudo_huber(huber * huber).cost;
  const SurfacePatch& met = front ? path.first : path.second;
  const Vec3 told = (front ? view.network->front : view.network->back)[at];
  const double stated = (front ? view.network->front_sigma_rad : view.network->back_sigma_rad)[at];
  // An angle has two components. Errors that hang together over an area count as one: each pixel gets a share.
  const double sigma = std::max(stated, 0.02) / level_of_two * std::max(1.0, sigmas_.normals_px / sigmas_.normals_step);
  const Vec3 off = (-normalized(met.jet.slope) - told) / sigma;
  const Robust robust = pseudo_huber(dot(off, off));
  if (rows == nullptr) return robust.cost;
  rows->count = 3, rows->places = 1;
  rows->at[0] = asked.field.support(met.at);
  const auto slopes = normal_slopes(met, line.origin, line.direction);
  for (std::size_t k = 0; k < 3; ++k) {
    rows->residual[k] = off[static_cast<int>(k)];
    for (std::size_t l = 0; l < 4; ++l) rows->slopes[k][l] = slopes[k][l] / sigma;
  }
  whiten(*rows, robust.weight);
  return robust.cost;
}

double Measuring::light_cost(const Asked& asked, const Measurement& m, double& variance, Rows* rows) const {
  const View& view = views_[m.view];
  PixelRay line = ray(asked.field, m.view, m.x, m.y);
  const ScreenPicture screen = view.screen->scaled(asked.field.low_m(), asked.field.cell_m());
  Path path;
  if (!refracted(asked.field, line, asked.glass.index, path)) return bounded;
  line.hidden = hidden(asked.field, m.view, path);
  const SeenThrough seen =
      seen_through(line, path.first, path.second, asked.glass, screen, *view.emitter, asked.blur_px);
  if (!seen.valid) return bounded;
  if (variance < 0) variance = seen.variance;
  const double share = sigmas_.light_share * screen.mean_luminance();
  const double sigma = std::sqrt(share * share + view.noise * view.noise + variance);
  std::array<double, 3> off{};
  double square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    off[k] = (seen.stokes[k] - view.stokes[k][view.pixel(m.x, m.y)]) / sigma;
    square += off[k] * off[k];
  }
  const Robust robust = geman(square);
  if (rows == nullptr) return robust.cost;
  rows->count = 3, rows->places = 2, rows->knows_globals = true;
  rows->at = {asked.field.support(path.first.at), asked.field.support(path.second.at)};
  const PathSlopes slopes = slopes_of(line, path.first, path.second, asked.glass, screen, *view.emitter, asked.blur_px);
  for (std::size_t k = 0; k < 3; ++k) {
    rows->residual[k] = off[k];
    for (std::size_t n = 0; n < path_numbers; ++n) rows->slopes[k][n] = slopes[k][n] / sigma;
  }
  whiten(*rows, robust.weight);
  return robust.cost;
}

double Measuring::cost(const Asked& asked, const Measurement& m, double& variance, Rows* rows) const {
  if (m.kind == Kind::outline) return outline_cost(asked, m, rows);
  if (m.kind == Kind::floor) return floor_cost(asked, m, rows);
  if (m.kind == Kind::light) return light_cost(asked, m, variance, rows);
  return normal_cost(asked, m, rows);
}

double Measuring::unexplained(const Asked& asked, std::size_t number) const {
  double sum = 0, count = 0;
  for (const Measurement& m : lights(number)) {
    double variance = -1;
    sum += light_cost(asked, m, variance, nullptr) / bounded, ++count;
  }
  return count > 0 ? sum / count : 1;
}

}  // namespace gonio::glass
