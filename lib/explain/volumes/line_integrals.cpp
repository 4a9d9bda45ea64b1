// See line_integrals.h.
#include "explain/volumes/line_integrals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"

namespace gonio::explain::volumes {
namespace {

constexpr std::size_t fine = 3;  // samples of a pixel, along its row and its column

// Where the samples of a view lie: u = (first_u + i / fine) bins off the axis, z alike in slices off the first.
struct SampleGrid {
  std::size_t across = 0, along = 0;
  double first_u = 0, first_z = 0;
};
SampleGrid sample_grid(const Detector& d, std::size_t view) {
  // Every other view mirrors the one before: their mean is the middle of a pixel.
  const auto turn = [&](double ratio) {
    const double at = std::fmod((static_cast<double>(view / 2) + 0.5) * ratio, 1.0);
    return view % 2 == 0 ? at : 1 - at;
  };
  return {d.bins * fine, d.slices * fine, turn(0.61803398874989485) / fine - 0.5 - d.middle(),
          turn(0.75487766624669276) / fine - 0.5};
}

struct Corner {
  double u = 0, z = 0, depth = 0;  // u and z in samples of the grid
};

// Twice the area of p and the edge from corner a to b, the same to the last digit whichever triangle asks.
double side_of(const std::vector<Corner>& corners, std::uint32_t a, std::uint32_t b, double u, double z) {
  const bool swapped = a > b;
  const Corner &p = corners[swapped ? b : a], &q = corners[swapped ? a : b];
  const double side = (q.u - p.u) * (z - p.z) - (q.z - p.z) * (u - p.u);
  return swapped ? -side : side;
}

std::pair<std::size_t, std::size_t> samples_between(double low, double high, std::size_t n) {
  const double last = static_cast<double>(n);
  return {static_cast<std::size_t>(std::clamp(std::ceil(low), 0.0, last)),
          static_cast<std::size_t>(std::clamp(std::floor(high) + 1, 0.0, last))};
}

// Calls add(sample across, sample along, path) for every sample of a view whose ray meets the ball.
template <class Add>
void for_samples_of(const Ball& ball, const Detector& d, const SampleGrid& grid, std::size_t view, const Add& add) {
  const double angle = pi * static_cast<double>(view) / static_cast<double>(d.views);
  const double across = ball.centre_m.x * std::cos(angle) + ball.centre_m.y * std::sin(angle);
  const double at_u = (across / d.bin_m - grid.first_u) * fine, wide_u = ball.radius_m / d.bin_m * fine;
  const double at_z = (ball.centre_m.z / d.slice_m + d.half_height() - grid.first_z) * fine,
               wide_z = ball.radius_m / d.slice_m * fine;
  const auto [z0, z1] = samples_between(at_z - wide_z, at_z + wide_z, grid.along);
  const auto [u0, u1] = samples_between(at_u - wide_u, at_u + wide_u, grid.across);
  for (std::size_t v = z0; v < z1; ++v)
    for (std::size_t n = u0; n < u1; ++n) {
      const double off_u = (static_cast<double>(n) - at_u) / wide_u, off_z = (static_cast<double>(v) - at_z) / wide_z;
      const double rest = 1 - off_u * off_u - off_z * off_z;
      if (rest > 0) add(n, v, 2 * ball.radius_m * std::sqrt(rest));
    }
}

class Drawing {
 public:
  Drawing(const mesh::Mesh& mesh, const Detector& d, std::size_t view, std::span<const Ball> beside)
      : grid_(sample_grid(d, view)) {
    const double angle = pi * static_cast<double>(view) / static_cast<double>(d.views);
    const double c = std::cos(angle), s = std::sin(angle);
    corners_.reserve(mesh.positions_m.size());
    for (const Vec3& p : mesh.positions_m)
      corners_.push_back({((p.x * c + p.y * s) / d.bin_m - grid_.first_u) * fine,
                          (p.z / d.slice_m + d.half_height() - grid_.first_z) * fine, p.y * c - p.x * s});
    path_.assign(grid_.across * grid_.along, 0.0);
    turns_.assign(path_.size(), 0);
    for (const auto& t : mesh.triangles) draw(t);
    for (const Ball& ball : beside)
      for_samples_of(ball, d, grid_, view, [&](std::size_t n, std::size_t v, double path) {
        path_[v * grid_.across + n] += ball.share * path;
      });
  }
  // The mean over a pixel of exp(-per_m path); samples that met a hole of the mesh do not count.
  double intensity(std::size_t bin, std::size_t slice, double per_m) const {
    double sum = 0, count = 0;
    for (std::size_t v = slice * fine; v < (slice + 1) * fine; ++v)
      for (std::size_t u = bin * fine; u < (bin + 1) * fine; ++u) {
        const std::size_t n = v * grid_.across + u;
        if (turns_[n] != 0) continue;
        sum += path_[n] > 0 ? std::exp(-per_m * path_[n]) : 1;
        count += 1;
      }
    return count > 0 ? sum / count : 1;
  }

 private:
  void draw(const std::array<std::uint32_t, 3>& t) {
    const Corner &a = corners_[t[0]], &b = corners_[t[1]], &c = corners_[t[2]];
    const auto [z0, z1] = samples_between(std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z}), grid_.along);
    const auto [u0, u1] = samples_between(std::min({a.u, b.u, c.u}), std::max({a.u, b.u, c.u}), grid_.across);
    if (z0 >= z1 || u0 >= u1) return;
    // The ray runs along the depth; u, depth and z are right-handed, so that u and z are left-handed seen along it: a
    // triangle that is drawn counter-clockwise in (u, z) faces against the ray, which enters there.
    const double area = (b.u - a.u) * (c.z - a.z) - (b.z - a.z) * (c.u - a.u);
    if (area == 0) return;
    const int sign = area > 0 ? 1 : -1;
    for (std::size_t v = z0; v < z1; ++v)
      for (std::size_t u = u0; u < u1; ++u) {
        // No corner of a mesh has these digits.
        const double x = static_cast<double>(u) + 1.2345671e-7, y = static_cast<double>(v) + 2.3456713e-7;
        const double wa = side_of(corners_, t[1], t[2], x, y), wb = side_of(corners_, t[2], t[0], x, y),
                     wc = side_of(corners_, t[0], t[1], x, y);
        if (sign * wa < 0 || sign * wb < 0 || sign * wc < 0) continue;
        const std::size_t n = v * grid_.across + u;
        path_[n] -= sign * (wa * a.depth + wb * b.depth + wc * c.depth) / (wa + wb + wc);
        turns_[n] = static_cast<std::int8_t>(turns_[n] + sign);
      }
  }
  SampleGrid grid_;
  std::vector<Corner> corners_;
  std::vector<double> path_;
  std::vector<std::int8_t> turns_;
};

}  // namespace

std::vector<float> intensities(const mesh::Mesh& mesh, const Detector& d, double per_m, std::span<const Ball> beside) {
  std::vector<float> values(d.size());
  parallel_for(0, d.views, [&](std::size_t view) {
    const Drawing drawing(mesh, d, view, beside);
    for (std::size_t k = 0; k < d.slices; ++k)
      for (std::size_t n = 0; n < d.bins; ++n)
        values[d.line(k, view) + n] = static_cast<float>(drawing.intensity(n, k, per_m));
  });
  return values;
}

std::vector<float> paths(std::span<const Ball> balls, const Detector& d) {
  std::vector<float> values(d.size(), 0.0f);
  parallel_for(0, d.views, [&](std::size_t view) {
    const SampleGrid grid = sample_grid(d, view);
    for (const Ball& ball : balls)
      for_samples_of(ball, d, grid, view, [&](std::size_t n, std::size_t v, double path) {
        values[d.line(v / fine, view) + n / fine] += static_cast<float>(path / (fine * fine));
      });
  });
  return values;
}

}  // namespace gonio::explain::volumes
