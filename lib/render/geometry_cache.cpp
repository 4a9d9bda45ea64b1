// Geometry of views without their appearance; see geometry_cache.h. World frame, metres, W/m^2.
//
// One cosine-weighted path estimates all coefficients at once: with directions of density cos / pi,
//   E(x) = integral of L cos dw  ~  pi L(y1) = albedo(y1) E(y1),
// so a path carries no weight but the monomial of the surfaces it visited. At each vertex every lamp is sampled once;
// environments are what the path meets where it leaves the scene.
#include "render/geometry_cache.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "render/strata.h"

namespace gonio::render {
namespace {

constexpr std::size_t grain = 64;  // points or rows of a parallel chunk

int side_of(int samples) {
  return std::clamp(static_cast<int>(std::sqrt(static_cast<double>(samples))), 1, 16);
}

Vec3 cosine_direction(Vec3 normal, Vec2 u) {
  const double r = std::sqrt(u.x), phi = 2 * pi * u.y;
  return Basis(normal).to_world({r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u.x)});
}

Rgb irradiance_of(const RayCaster& caster, const SurfacePoint& point, const light::Sample& sample) {
  if (!sample.valid) return {};
  const double cosine = dot(point.normal, sample.direction);
  if (cosine <= 0 || caster.occluded(point, sample.direction, sample.distance_m)) return {};
  return sample.weight * cosine;
}

class IndirectTracer {
 public:
  IndirectTracer(const RayCaster& caster, const Monomials& monomials, std::span<const light::Emitter* const> emitters,
                 int side)
      : caster_(caster), monomials_(monomials), emitters_(emitters), share_(1.0 / (side * side)) {}

  // Adds one path's contributions to `coefficients` (sources x monomials).
  void trace(const SurfacePoint& start, Vec2 u, Random& random, std::span<float> coefficients) const {
    SurfacePoint at = start;
    for (std::size_t visited = 0;;) {
      const Vec3 direction = cosine_direction(at.normal, u);
      if (!(dot(at.geometric_normal, direction) > 0)) return;
      const auto next = caster_.closest_from(at, direction);
      if (!next) return add_environments(at.position_m, direction, visited, coefficients);
      visited = monomials_.times(visited, next->surface);
      if (visited == monomials_.size()) return;
      at = *next;
      add_lamps(at, visited, random, coefficients);
      u = {random.uniform(), random.uniform()};
    }
  }

 private:
  void add(std::size_t source, std::size_t monomial, double value, std::span<float> coefficients) const {
    coefficients[source * monomials_.size() + monomial] += static_cast<float>(value * share_);
  }
  void add_environments(Vec3 origin_m, Vec3 direction, std::size_t visited, std::span<float> coefficients) const {
    for (std::size_t i = 0; i < emitters_.size(); ++i)
      if (emitters_[i]->infinite())
        add(i, visited, pi * mean(emitters_[i]->hit(origin_m, direction).radiance), coefficients);
  }
  void add_lamps(const SurfacePoint& at, std::size_t visited, Random& random, std::span<float> coefficients) const {
    for (std::size_t i = 0; i < emitters_.size(); ++i) {
      if (emitters_[i]->infinite()) continue;
      const light::Sample sample = emitters_[i]->sample(at.position_m, {random.uniform(), random.uniform()});
      add(i, visited, mean(irradiance_of(caster_, at, sample)), coefficients);
    }
  }

  const RayCaster& caster_;
  const Monomials& monomials_;
  std::span<const light::Emitter* const> emitters_;
  double share_;
};

}  // namespace

std::vector<ViewPoint> view_points(const RayCaster& caster, const scene::View& view, int side) {
  const int width = view.camera.width_px(), height = view.camera.height_px();
  const Mat3 rotation = matrix_of(view.world_from_camera.rotation);
  const auto cast = [&](Vec2 pixel) {
    const camera::Ray ray = view.camera.ray(pixel);
    const Vec3 direction = rotation * ray.direction;
    const auto met = caster.closest(rotation * ray.origin_m + view.world_from_camera.translation_m, direction);
    return ViewPoint{met.has_value(), met.value_or(SurfacePoint{}), -direction};
  };
  const std::size_t per_row = static_cast<std::size_t>(width) * static_cast<std::size_t>(side * side);
  std::vector<ViewPoint> points(per_row * static_cast<std::size_t>(height));
  parallel_for(0, static_cast<std::size_t>(height), [&](std::size_t row) {
    ViewPoint* out = points.data() + row * per_row;
    for (int x = 0; x < width; ++x)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          *out++ = cast({x - 0.5 + (i + 0.5) / side, static_cast<double>(row) - 0.5 + (j + 0.5) / side});
  });
  return points;
}

Received received(const RayCaster& caster, const SurfacePoint& point, const light::Emitter& emitter, int samples,
                  std::uint64_t seed) {
  Received sum;
  Random random(seed);
  const int side = side_of(samples), count = side * side;
  for (int i = 0; i < count; ++i) {
    const Vec2 u{(i % side + random.uniform()) / side, (i / side + random.uniform()) / side};
    const light::Sample sample = emitter.sample(point.position_m, u);
    const bool seen = sample.valid && !caster.occluded(point, sample.direction, sample.distance_m);
    const double cosine = seen ? std::max(0.0, dot(point.normal, sample.direction)) : 0;
    if (sample.delta) return {seen ? 1.0 : 0.0, sample.weight * cosine};
    sum.visibility += seen ? 1.0 / count : 0;
    sum.irradiance += sample.weight * (cosine / count);
  }
  return sum;
}

Monomials::Monomials(std::size_t surfaces, int degree) : surfaces_(surfaces) {
  exponents_.assign(surfaces, 0);
  std::size_t first = 0;  // of the previous degree
  for (int d = 1; d <= degree; ++d) {
    const std::size_t last = size();
    // Each monomial once: multiply only by surfaces that do not come before the last one in it.
    for (std::size_t m = first; m < last; ++m) {
      std::size_t from = 0;
      for (std::size_t s = 0; s < surfaces; ++s)
        if (exponents_[m * surfaces + s] > 0) from = s;
      for (std::size_t s = from; s < surfaces; ++s) {
        std::vector<std::uint8_t> next(exponents_.begin() + static_cast<std::ptrdiff_t>(m * surfaces),
                                       exponents_.begin() + static_cast<std::ptrdiff_t>((m + 1) * surfaces));
        ++next[s];
        exponents_.insert(exponents_.end(), next.begin(), next.end());
      }
    }
    first = last;
  }
  next_.assign(size() * surfaces, size());
  for (std::size_t m = 0; m < size(); ++m)
    for (std::size_t s = 0; s < surfaces; ++s) {
      std::vector<std::uint8_t> wanted(exponents(m).begin(), exponents(m).end());
      ++wanted[s];
      for (std::size_t k = m + 1; k < size(); ++k)
        if (std::ranges::equal(exponents(k), wanted)) next_[m * surfaces + s] = k;
    }
}

std::vector<double> Monomials::evaluate(std::span<const double> albedos) const {
  std::vector<double> values(size(), 0.0);
  values[0] = 1;
  for (std::size_t m = 0; m < size(); ++m)
    for (std::size_t s = 0; s < surfaces_; ++s)
      if (const std::size_t k = times(m, s); k < size()) values[k] = values[m] * albedos[s];
  return values;
}

IndirectIrradiance indirect_irradiance(const RayCaster& caster, std::size_t surfaces,
                                       std::span<const SurfacePoint> points,
                                       std::span<const light::Emitter* const> emitters,
                                       const IndirectOptions& options) {
  IndirectIrradiance result{Monomials(surfaces, options.bounces), emitters.size(), {}};
  const std::size_t stride = emitters.size() * result.monomials.size();
  result.coefficients.assign(points.size() * stride, 0.0f);
  const int side = side_of(options.paths);
  const IndirectTracer tracer(caster, result.monomials, emitters, side);
  parallel_for(
      0, points.size(),
      [&](std::size_t i) {
        Random random(options.seed, i);
        const std::span<float> coefficients(result.coefficients.data() + i * stride, stride);
        for (int cell = 0; cell < side * side; ++cell) {
          const Vec2 u{(cell % side + random.uniform()) / side, (cell / side + random.uniform()) / side};
          tracer.trace(points[i], u, random, coefficients);
        }
      },
      grain);
  return result;
}

}  // namespace gonio::render
