#include "volume/phantoms.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace gonio::volume::phantom {
namespace {

double normal_share(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

// exp(-x) I0(x), Abramowitz & Stegun 9.8.1 and 9.8.2.
double scaled_bessel(double x) {
  if (x < 3.75) {
    const double t = x * x / 14.0625;
    return std::exp(-x) *
           (1 + t * (3.5156229 + t * (3.0899424 + t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))));
  }
  const double t = 3.75 / x;
  return (0.39894228 +
          t * (0.01328592 +
               t * (0.00225319 +
                    t * (-0.00157565 +
                         t * (0.00916281 + t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377)))))))) /
         std::sqrt(x);
}

constexpr double table_step = 0.02;

class Memory final : public io::VolumeSource {
 public:
  explicit Memory(io::VolumeData data) : data_(std::move(data)) { head_ = data_.head; }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    const std::size_t slice = head_.size[0] * head_.size[1];
    std::copy_n(data_.values.begin() + static_cast<std::ptrdiff_t>(first * slice), count * slice, to.begin());
  }

 private:
  io::VolumeData data_;
};

// White noise smeared along one axis, periodic.
void smear(std::vector<float>& v, const std::array<std::size_t, 3>& size, std::size_t axis, double sd) {
  const int reach = static_cast<int>(std::ceil(4 * sd));
  std::vector<double> kernel;
  double squares = 0;
  for (int d = -reach; d <= reach; ++d) kernel.push_back(std::exp(-0.5 * d * d / (sd * sd)));
  for (const double k : kernel) squares += k * k;
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? size[0] : size[0] * size[1], n = size[axis];
  std::vector<double> line(n);
  for (std::size_t start = 0; start < v.size(); ++start) {
    if (start / stride % n != 0) continue;
    for (std::size_t i = 0; i < n; ++i) line[i] = v[start + i * stride];
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      for (int d = -reach; d <= reach; ++d)
        sum += kernel[static_cast<std::size_t>(d + reach)] * line[(i + 4 * n + static_cast<std::size_t>(d + reach) - static_cast<std::size_t>(reach)) % n];
      v[start + i * stride] = static_cast<float>(sum / std::sqrt(squares));
    }
  }
}

}  // namespace

double ball(Vec3 place, Vec3 centre, double radius, double w) {
  const double r = norm(place - centre), in = (radius - r) / w, out = (radius + r) / w;
  if (r < 1e-6) {  // the limit
    return std::erf(radius / (w * std::sqrt(2.0))) - std::sqrt(2 / pi) * radius / w * std::exp(-0.5 * in * in);
  }
  return normal_share(in) + normal_share(out) - 1 -
         w / (r * std::sqrt(2 * pi)) * (std::exp(-0.5 * in * in) - std::exp(-0.5 * out * out));
}

double half_space(Vec3 place, Vec3 at, Vec3 normal, double w) {
  return normal_share(-dot(place - at, normal) / w);
}

Disc::Disc(double radius, double w) {
  constexpr double dr = 0.01;
  for (double rho = 0; rho < radius + 8 * w + 1; rho += table_step) {
    double sum = 0;
    for (double r = std::max(dr / 2, rho - 8 * w); r < radius; r += dr) {
      const double h = std::min(dr, radius - r + dr / 2), middle = r;
      const double d = middle - rho;
      sum += h * middle / (w * w) * std::exp(-0.5 * d * d / (w * w)) * scaled_bessel(middle * rho / (w * w));
      if (middle > rho + 8 * w) break;
    }
    table_.push_back(sum);
  }
}
double Disc::at(double rho) const {
  const double x = rho / table_step;
  const auto n = static_cast<std::size_t>(x);
  if (n + 1 >= table_.size()) return 0;
  return table_[n] + (x - static_cast<double>(n)) * (table_[n + 1] - table_[n]);
}

io::VolumeData sampled(std::array<std::size_t, 3> size, const Field& field, double noise, double q, std::uint64_t seed,
                       Vec3 scale) {
  io::VolumeData data;
  data.head.size = size;
  data.head.type = io::VoxelType::f32;
  data.values.resize(data.head.voxels());
  if (noise > 0) {
    Random random(seed, 77);
    for (float& v : data.values) v = static_cast<float>(random.normal());
    if (q > 0)
      for (std::size_t axis = 0; axis < 3; ++axis) smear(data.values, size, axis, std::sqrt(-0.25 / std::log(q)));
  }
  std::size_t n = 0;
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i, ++n)
        data.values[n] = static_cast<float>(
            noise * data.values[n] +
            field(Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} * scale));
  return data;
}

std::unique_ptr<io::VolumeSource> in_memory(io::VolumeData data) {
  return std::make_unique<Memory>(std::move(data));
}

Contour grid_surface(std::size_t m, std::size_t n, const std::function<Patch(double, double)>& at, Vec3 scale) {
  Contour c;
  for (std::size_t b = 0; b < n; ++b)
    for (std::size_t a = 0; a < m; ++a) {
      const Patch p = at(static_cast<double>(a) / static_cast<double>(m), static_cast<double>(b) / static_cast<double>(n - 1));
      const Vec3 i{p.place.x / scale.x, p.place.y / scale.y, p.place.z / scale.z}, g = normalized(p.normal * scale);
      c.positions.push_back({static_cast<float>(i.x), static_cast<float>(i.y), static_cast<float>(i.z)});
      c.normals.push_back({static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)});
    }
  for (std::size_t b = 0; b + 1 < n; ++b)
    for (std::size_t a = 0; a < m; ++a) {
      const auto v = [&](std::size_t x, std::size_t y) { return static_cast<std::uint32_t>(y * m + x % m); };
      c.triangles.push_back({v(a, b), v(a + 1, b), v(a + 1, b + 1)});
      c.triangles.push_back({v(a, b), v(a + 1, b + 1), v(a, b + 1)});
    }
  return c;
}

// The caps at the poles, a hundredth of the sphere, are left out.
Contour sphere_surface(Vec3 centre, double radius, Vec3 scale) {
  const auto n = static_cast<std::size_t>(std::max(8.0, pi * radius));
  return grid_surface(
      2 * n, n,
      [&](double u, double v) {
        const double z = -0.98 + 1.96 * v, phi = 2 * pi * u, rho = std::sqrt(1 - z * z);
        const Vec3 d{rho * std::cos(phi), rho * std::sin(phi), z};
        return Patch{centre + d * radius, d};
      },
      scale);
}

Contour tube_surface(Vec3 centre, Vec3 axis, double radius, double length, bool inwards) {
  const Basis basis(normalized(axis));
  return grid_surface(static_cast<std::size_t>(2 * pi * radius), static_cast<std::size_t>(length), [&](double u, double v) {
    const double phi = 2 * pi * (inwards ? -u : u);
    const Vec3 d = basis.t * std::cos(phi) + basis.b * std::sin(phi);
    return Patch{centre + d * radius + basis.n * ((v - 0.5) * length), inwards ? -d : d};
  });
}

Contour rough_surface(const io::VolumeData& data, double threshold) {
  const auto [nx, ny, nz] = data.head.size;
  const auto value = [&](std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) {
    const auto inside = [](std::ptrdiff_t a, std::size_t n) { return a >= 0 && a < static_cast<std::ptrdiff_t>(n); };
    if (!inside(i, nx) || !inside(j, ny) || !inside(k, nz)) return 2 * threshold - 1e3;
    return static_cast<double>(data.at(i, j, k));
  };
  Contour c;
  const std::size_t wide = nx + 1, high = ny + 1;
  std::vector<std::uint32_t> vertex(wide * high * (nz + 1), UINT32_MAX);
  const auto cell = [&](std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) {  // corners i, i + 1, from -1
    return static_cast<std::size_t>(((k + 1) * static_cast<std::ptrdiff_t>(high) + j + 1) * static_cast<std::ptrdiff_t>(wide) + i + 1);
  };
  const auto last = [](std::size_t n) { return static_cast<std::ptrdiff_t>(n); };
  for (std::ptrdiff_t k = -1; k < last(nz); ++k)
    for (std::ptrdiff_t j = -1; j < last(ny); ++j)
      for (std::ptrdiff_t i = -1; i < last(nx); ++i) {
        std::array<double, 8> v{};
        for (int n = 0; n < 8; ++n) v[n] = value(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2)) - threshold;
        Vec3 sum, gradient;
        int crossed = 0;
        for (int n = 0; n < 8; ++n)
          for (int axis = 0; axis < 3; ++axis) {
            const int m = n | 1 << axis;
            if (m == n) continue;
            const double d = v[m] - v[n];
            gradient += Vec3{axis == 0 ? d : 0, axis == 1 ? d : 0, axis == 2 ? d : 0};
            if ((v[n] > 0) == (v[m] > 0)) continue;
            const double t = std::clamp(v[n] / (v[n] - v[m]), 0.05, 0.95);
            sum += Vec3{(n & 1) + (axis == 0 ? t : 0), (n >> 1 & 1) + (axis == 1 ? t : 0), (n >> 2) + (axis == 2 ? t : 0)};
            ++crossed;
          }
        if (crossed == 0) continue;
        vertex[cell(i, j, k)] = static_cast<std::uint32_t>(c.positions.size());
        const Vec3 p = sum / crossed, g = normalized(-gradient);
        c.positions.push_back({static_cast<float>(i + p.x), static_cast<float>(j + p.y), static_cast<float>(k + p.z)});
        c.normals.push_back({static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)});
      }
  for (std::ptrdiff_t k = 0; k < last(nz); ++k)
    for (std::ptrdiff_t j = 0; j < last(ny); ++j)
      for (std::ptrdiff_t i = 0; i < last(nx); ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const bool in = value(i, j, k) > threshold;
          if (in == (value(i + (axis == 0), j + (axis == 1), k + (axis == 2)) > threshold)) continue;
          const int u = (axis + 1) % 3, w = (axis + 2) % 3;
          std::array<std::uint32_t, 4> q{};
          for (int n = 0; n < 4; ++n) {
            const int du = n == 1 || n == 2 ? 0 : 1, dw = n >= 2 ? 0 : 1;
            q[n] = vertex[cell(i - (u == 0 ? du : w == 0 ? dw : 0), j - (u == 1 ? du : w == 1 ? dw : 0),
                               k - (u == 2 ? du : w == 2 ? dw : 0))];
          }
          if (std::ranges::count(q, UINT32_MAX) > 0) continue;
          if (!in) std::swap(q[1], q[3]);
          c.triangles.push_back({q[0], q[1], q[2]});
          c.triangles.push_back({q[0], q[2], q[3]});
        }
  return c;
}

void append(Contour& to, const Contour& more) {
  const auto base = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), more.positions.begin(), more.positions.end());
  to.normals.insert(to.normals.end(), more.normals.begin(), more.normals.end());
  for (const auto& t : more.triangles) to.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

}  // namespace gonio::volume::phantom
