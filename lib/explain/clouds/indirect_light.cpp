// See indirect_light.h.
#include "explain/clouds/indirect_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "geom/vector.h"
#include "render/sampler.h"

namespace gonio::explain {
namespace {

using Point = IndirectLight::Point;
constexpr std::uint32_t first_paths = 64, paths = 4096;
constexpr double open = 0.02;   // share of the first paths that meet something, below which they are enough
constexpr double clear = 1e-6;  // metres above the surface, where a path begins

Vec3 spread_about(Vec3 normal, Vec2 random) {
  const double r = std::sqrt(random.x), turn = 2 * pi * random.y;
  return Basis(normal).to_world({r * std::cos(turn), r * std::sin(turn), std::sqrt(std::max(0.0, 1 - random.x))});
}

class Gatherer {
 public:
  Gatherer(const CloudShape& shape, const scan::Station& projector)
      : shape_(shape),
        projector_(projector),
        unmoved_(shape.freedoms().size(), 0.0),
        camera_from_rig_(inverse(projector.rig_from_camera)) {}

  struct Lit {
    double irradiance = 0;  // over the projector's own
    Vec2 pixel;
  };
  // Nothing where the projector's light does not reach.
  Lit lit(Vec3 at, Vec3 normal) const {
    const Vec3 way = projector_.rig_from_camera.translation_m - at;
    const double distance = norm(way), cosine = dot(way, normal) / distance;
    if (!(cosine > 0)) return {};
    const auto pixel = projector_.lens.project(camera_from_rig_ * at);
    if (!pixel || pixel->x < -0.5 || pixel->y < -0.5 || pixel->x > projector_.lens.width_px() - 0.5 ||
        pixel->y > projector_.lens.height_px() - 0.5)
      return {};
    const auto met = shape_.met(at + clear * normal, way * (1 / distance), unmoved_);
    if (met && met->distance_m < distance) return {};
    return {cosine / (distance * distance), *pixel};
  }
  std::optional<Point> next(const Point& from, Vec2 random) const {
    const Vec3 direction = spread_about(from.normal, random), begin = from.at + clear * from.normal;
    const auto met = shape_.met(begin, direction, unmoved_);
    if (!met) return std::nullopt;
    return Point{begin + met->distance_m * direction, met->normal, {}};
  }

 private:
  const CloudShape& shape_;
  const scan::Station& projector_;
  std::vector<double> unmoved_;
  Rigid<frame::Camera, frame::Rig> camera_from_rig_;
};

}  // namespace

IndirectLight::IndirectLight(const CloudShape& shape, std::span<const Point> points, const scan::Station& projector,
                             std::span<const double> periods_x, std::span<const double> periods_y)
    : counts_{periods_x.size(), periods_y.size()} {
  const Gatherer gatherer(shape, projector);
  const std::size_t each = periods_x.size() + periods_y.size();
  series_.resize(points.size() * each), hidden_.resize(points.size());
  const double width = projector.lens.width_px(), height = projector.lens.height_px();
  const auto add = [&](std::size_t p, std::size_t bounce, const Gatherer::Lit& lit, double weight) {
    const Vec2 off = lit.pixel - points[p].told;
    for (std::size_t k = 0; k < each; ++k) {
      const double turns =
          k < periods_x.size() ? periods_x[k] * off.x / width : periods_y[k - periods_x.size()] * off.y / height;
      series_[p * each + k].term[bounce] += std::polar(weight * lit.irradiance, 2 * pi * turns);
    }
  };
  parallel_for(0, points.size(), [&](std::size_t p) {
    const double direct = gatherer.lit(points[p].at, points[p].normal).irradiance;
    if (!(direct > 0)) return;
    std::uint32_t followed = 0, met = 0;
    const auto follow = [&](std::uint32_t last) {
      for (; followed < last; ++followed) {
        render::Sampler sampler(1, p, followed);
        std::optional<Point> at = points[p];
        for (std::size_t bounce = 0; bounce < bounces && (at = gatherer.next(*at, sampler.two())); ++bounce) {
          met += bounce == 0;
          add(p, bounce, gatherer.lit(at->at, at->normal), 1 / direct);
        }
      }
    };
    follow(first_paths);
    if (met > open * first_paths) follow(paths);
    hidden_[p] = static_cast<double>(met) / followed;
    for (std::size_t k = 0; k < each; ++k)
      for (std::complex<double>& term : series_[p * each + k].term) term /= followed;
  });
  any_ = std::ranges::any_of(hidden_, [](double share) { return share > 0; });
}

double IndirectLight::turn(std::size_t point, std::size_t axis, std::size_t periods, double albedo) const {
  if (!any_ || albedo == 0) return 0;
  const Series& series = series_[point * (counts_[0] + counts_[1]) + axis * counts_[0] + periods];
  std::complex<double> sum = 1;
  double power = 1;
  for (const std::complex<double>& term : series.term) sum += (power *= albedo) * term;
  return std::arg(sum);
}

}  // namespace gonio::explain
