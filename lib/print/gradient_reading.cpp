// Reading of gradients in a height map; see calibration_sample.h.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "linear/solve.h"
#include "print/calibration_sample.h"

namespace gonio::print {
namespace {

constexpr double least_likeness = 0.5;
constexpr int margin_px = 2;         // of a field, where light of its neighbours counts
constexpr double least_share = 0.5;  // of a field's points that must have been measured

Vec2 on_platform(const MapPlace& p, const io::HeightMap& map, double x, double y) {
  const double u = x * map.step_x_m, v = -y * map.step_y_m, c = std::cos(p.turn_rad), s = std::sin(p.turn_rad);
  return {p.at_m.x + c * u - s * v, p.at_m.y + s * u + c * v};
}

// What a point of the sample is expected to be: -1 nothing that counts, else the height that its grey asks for.
struct Expected {
  PixelBox box{};
  std::vector<float> height_m;
  std::vector<std::uint8_t> bare;  // slab, far from all light
};
Expected expected_of(const CalibrationSample& sample, const Printer& printer) {
  Expected e;
  e.box = sample.slab;
  const std::vector<float> greys = sample_layer(sample, printer, sample.slab_layers);
  const double layer_m = printer.thickness_m(sample.slab_layers);
  const int wide = e.box.x_end - e.box.x_begin, high = e.box.y_end - e.box.y_begin;
  for (const float grey : greys)
    e.height_m.push_back(
        static_cast<float>(std::min(layer_m, printer.growth.height_m(static_cast<double>(grey), layer_m))));
  e.bare.assign(greys.size(), 1);
  for (int y = 0; y < high; ++y)
    for (int x = 0; x < wide; ++x) {
      if (!(greys[static_cast<std::size_t>(y * wide + x)] > 0)) continue;
      for (int j = std::max(0, y - margin_px); j <= std::min(high - 1, y + margin_px); ++j)
        for (int i = std::max(0, x - margin_px); i <= std::min(wide - 1, x + margin_px); ++i)
          e.bare[static_cast<std::size_t>(j * wide + i)] = 0;
    }
  for (const SampleWedge& w : sample.wedges)  // higher than the layer
    for (int y = w.box.y_begin; y < w.box.y_end; ++y)
      for (int x = w.box.x_begin; x < w.box.x_end; ++x)
        e.height_m[static_cast<std::size_t>((y - e.box.y_begin) * wide + x - e.box.x_begin)] =
            std::numeric_limits<float>::quiet_NaN();
  return e;
}

// Pixel of the printer's picture in which a place of the platform lies.
std::array<int, 2> pixel_at(const PixelGrid& grid, Vec2 at) {
  return {static_cast<int>(std::floor((at.x - grid.corner_m.x) / grid.pixel_m.x)),
          static_cast<int>(std::floor((at.y - grid.corner_m.y) / grid.pixel_m.y))};
}

// The map's points, thinned to about two a pixel: place relative to the map's, and height.
struct Point {
  Vec2 at;
  double z = 0;
};
std::vector<Point> thinned(const io::HeightMap& map, const Printer& printer, const MapPlace& place) {
  const auto every = [](double pixel_m, double step_m) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(pixel_m / step_m / 2));
  };
  std::vector<Point> points;
  for (std::size_t y = 0; y < map.height; y += every(printer.pixel_m.y, map.step_y_m))
    for (std::size_t x = 0; x < map.width; x += every(printer.pixel_m.x, map.step_x_m))
      if (std::isfinite(map.at(x, y)))
        points.push_back({on_platform(place, map, static_cast<double>(x), static_cast<double>(y)), map.at(x, y)});
  return points;
}

// Pearson's, of measured and expected heights, with the map moved by `shift_m`.
double likeness(const std::vector<Point>& points, const Expected& e, const PixelGrid& grid, Vec2 shift_m) {
  const int wide = e.box.x_end - e.box.x_begin;
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (const Point& p : points) {
    const auto [i, j] = pixel_at(grid, {p.at.x + shift_m.x, p.at.y + shift_m.y});
    if (i < e.box.x_begin || i >= e.box.x_end || j < e.box.y_begin || j >= e.box.y_end) continue;
    const auto h =
        static_cast<double>(e.height_m[static_cast<std::size_t>((j - e.box.y_begin) * wide + i - e.box.x_begin)]);
    if (!std::isfinite(h)) continue;
    n += 1, a += p.z, b += h, aa += p.z * p.z, bb += h * h, ab += p.z * h;
  }
  if (n < 100 || n < 0.3 * static_cast<double>(points.size())) return -1;
  const double va = aa / n - a * a / (n * n), vb = bb / n - b * b / (n * n);
  return va > 0 && vb > 0 ? (ab / n - a * b / (n * n)) / std::sqrt(va * vb) : -1;
}

// Whole pixels first, then thirds of them about the best.
std::pair<Vec2, double> best_shift(const std::vector<Point>& points, const Expected& e, const Printer& printer,
                                   double search_px) {
  const PixelGrid grid = printer.grid();
  Vec2 best{};
  double most = -2;
  double step = 1;
  int reach = static_cast<int>(std::ceil(search_px));
  for (int level = 0; level < 3; ++level, step /= 3, reach = 2) {
    const int side = 2 * reach + 1;
    std::vector<double> found(static_cast<std::size_t>(side * side));
    const auto at = [&](std::size_t k) {
      return Vec2{best.x + (static_cast<int>(k) % side - reach) * step * printer.pixel_m.x,
                  best.y + (static_cast<int>(k) / side - reach) * step * printer.pixel_m.y};
    };
    parallel_for(0, found.size(), [&](std::size_t k) { found[k] = likeness(points, e, grid, at(k)); });
    const auto k = static_cast<std::size_t>(std::ranges::max_element(found) - found.begin());
    most = found[k];
    best = at(k);
  }
  return {best, most};
}

// Heights of the bare slab as a plane: at the middle of the map, and slopes over the platform.
std::array<double, 3> plane_of(const std::vector<Point>& points, const Expected& e, const PixelGrid& grid, Vec2 shift,
                               Vec2 middle, const std::string& place) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  const int wide = e.box.x_end - e.box.x_begin;
  std::size_t used = 0;
  for (const Point& p : points) {
    const auto [i, j] = pixel_at(grid, {p.at.x + shift.x, p.at.y + shift.y});
    if (i < e.box.x_begin || i >= e.box.x_end || j < e.box.y_begin || j >= e.box.y_end) continue;
    if (e.bare[static_cast<std::size_t>((j - e.box.y_begin) * wide + i - e.box.x_begin)] == 0) continue;
    const Eigen::Vector3d row(1, (p.at.x - middle.x) * 1e3, (p.at.y - middle.y) * 1e3);
    a += row * row.transpose(), b += row * p.z, ++used;
  }
  if (used < 50)
    throw Error(Exit::data, place, format("shows %zu points of bare slab", used),
                "measure a field with the gaps about the strips");
  const Eigen::Vector3d x = linear::solve_ldlt(a, b);
  return {x[0], x[1] * 1e3, x[2] * 1e3};
}

}  // namespace

SampleReading read_gradients(const io::HeightMap& map, const CalibrationSample& sample, const Printer& printer,
                             const MapPlace& near, double search_px, const std::string& place) {
  const Expected e = expected_of(sample, printer);
  const std::vector<Point> points = thinned(map, printer, near);
  SampleReading reading;
  const auto [shift, like] = best_shift(points, e, printer, search_px);
  reading.likeness = like, reading.place = near;
  reading.place.at_m = {near.at_m.x + shift.x, near.at_m.y + shift.y};
  if (!(like >= least_likeness))
    throw Error(Exit::data, place,
                format("does not look like the calibration sample near there: correlation %.2f, %.2f is needed", like,
                       least_likeness),
                "say better where its first point lies (--at), or search further (--search)");
  const PixelGrid grid = printer.grid();
  const Vec2 middle = on_platform(near, map, static_cast<double>(map.width) / 2, static_cast<double>(map.height) / 2);
  reading.plane = plane_of(points, e, grid, shift, middle, place);
  struct Sum {
    double z = 0;
    std::size_t n = 0, all = 0;
  };
  std::vector<Sum> sums(sample.gradients.size());
  const int wide = e.box.x_end - e.box.x_begin;
  std::vector<std::int32_t> of_pixel(e.height_m.size(), -1);
  for (std::size_t f = 0; f < sample.gradients.size(); ++f) {
    const PixelBox& b = sample.gradients[f].box;
    for (int y = b.y_begin + margin_px; y < b.y_end - margin_px; ++y)
      for (int x = b.x_begin + margin_px; x < b.x_end - margin_px; ++x)
        of_pixel[static_cast<std::size_t>((y - e.box.y_begin) * wide + x - e.box.x_begin)] =
            static_cast<std::int32_t>(f);
  }
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x) {
      const Vec2 at = on_platform(reading.place, map, static_cast<double>(x), static_cast<double>(y));
      const auto [i, j] = pixel_at(grid, at);
      if (i < e.box.x_begin || i >= e.box.x_end || j < e.box.y_begin || j >= e.box.y_end) continue;
      const std::int32_t f = of_pixel[static_cast<std::size_t>((j - e.box.y_begin) * wide + i - e.box.x_begin)];
      if (f < 0) continue;
      Sum& sum = sums[static_cast<std::size_t>(f)];
      ++sum.all;
      if (const double z = map.at(x, y); std::isfinite(z))
        sum.z += z - reading.plane[0] - reading.plane[1] * (at.x - shift.x - middle.x) -
                 reading.plane[2] * (at.y - shift.y - middle.y),
            ++sum.n;
    }
  const std::size_t greys = sample.gradients.size() / static_cast<std::size_t>(sample.repetitions);
  for (std::size_t k = 0; k < greys; ++k) reading.gradient.greys.push_back(sample.gradients[k].grey);
  const double points_of_field = (sample.gradients[0].box.x_end - sample.gradients[0].box.x_begin - 2 * margin_px) *
                                 (sample.gradients[0].box.y_end - sample.gradients[0].box.y_begin - 2 * margin_px) *
                                 printer.pixel_m.x * printer.pixel_m.y / (map.step_x_m * map.step_y_m);
  for (std::size_t r = 0; r < static_cast<std::size_t>(sample.repetitions); ++r) {
    std::vector<double> heights;
    for (std::size_t k = 0; k < greys; ++k)
      if (const Sum& s = sums[r * greys + k]; static_cast<double>(s.n) >= least_share * points_of_field)
        heights.push_back(s.z / static_cast<double>(s.n));
    if (heights.size() == greys)
      reading.gradient.repetitions_m.push_back(std::move(heights));
    else
      ++reading.incomplete;
  }
  return reading;
}

}  // namespace gonio::print
