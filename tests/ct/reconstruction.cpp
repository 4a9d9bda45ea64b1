// Filtered back-projection. The ramp's kernel is Ramachandran and Lakshminarayanan's in space (Kak & Slaney 1988,
// equation 61), so that its mean is right; readings are padded with zeros to twice their number, and interpolated
// linearly.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/parallel.h"
#include "ct/scanner.h"

namespace gonio::ct {
namespace {

using Complex = std::complex<double>;

// Radix two, in place, roots of unity made once.
class Fourier {
 public:
  explicit Fourier(std::size_t n) : n_(n) {
    for (std::size_t k = 0; k < n / 2; ++k)
      roots_.push_back(std::polar(1.0, -2 * pi * static_cast<double>(k) / static_cast<double>(n)));
    for (std::size_t i = 0, j = 0; i < n; ++i) {
      order_.push_back(j);
      std::size_t bit = n >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j |= bit;
    }
  }
  void transform(std::vector<Complex>& x) const {
    for (std::size_t i = 0; i < n_; ++i)
      if (i < order_[i]) std::swap(x[i], x[order_[i]]);
    for (std::size_t length = 2; length <= n_; length *= 2)
      for (std::size_t start = 0; start < n_; start += length)
        for (std::size_t k = 0; k < length / 2; ++k) {
          const Complex w = roots_[k * (n_ / length)], b = x[start + k + length / 2];
          const Complex t{w.real() * b.real() - w.imag() * b.imag(), w.real() * b.imag() + w.imag() * b.real()};
          x[start + k + length / 2] = x[start + k] - t;
          x[start + k] += t;
        }
  }

 private:
  std::size_t n_;
  std::vector<Complex> roots_;
  std::vector<std::size_t> order_;
};

class Ramp {
 public:
  Ramp(std::size_t columns, double pitch, bool hann) : fourier_(padded(columns)), response_(padded(columns)) {
    const std::size_t n = response_.size();
    std::vector<Complex> kernel(n, 0.0);
    kernel[0] = 1 / (4 * pitch);  // times the pitch: the sum stands for an integral
    for (std::size_t k = 1; k < n / 2; k += 2) {
      const double h = -1 / (pi * pi * static_cast<double>(k * k) * pitch);
      kernel[k] = h, kernel[n - k] = h;
    }
    fourier_.transform(kernel);
    for (std::size_t k = 0; k < n; ++k) {
      const double f = static_cast<double>(std::min(k, n - k)) / static_cast<double>(n / 2);  // of Nyquist's
      response_[k] = kernel[k].real() * (hann ? 0.5 + 0.5 * std::cos(pi * f) : 1) / static_cast<double>(n);
    }
  }
  // Two rows at once: one as the real, one as the imaginary part; the response is real and even.
  void filter(std::vector<Complex>& rows) const {
    fourier_.transform(rows);
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = std::conj(rows[k] * response_[k]);
    fourier_.transform(rows);  // of the conjugate: the inverse, conjugated
  }
  std::size_t size() const { return response_.size(); }

 private:
  static std::size_t padded(std::size_t columns) {
    std::size_t n = 2;
    while (n < 2 * columns) n *= 2;
    return n;
  }
  Fourier fourier_;
  std::vector<double> response_;
};

// Every row of every view, weighted by `weight(u, v)` before.
template <class Weight>
Projections filtered(const Projections& p, const Scanner& s, const Weight& weight) {
  Projections q{p.views, p.columns, p.rows, std::vector<float>(p.values.size())};
  const Ramp ramp(p.columns, s.voxel_m, s.hann);
  parallel_for(0, p.views, [&](std::size_t view) {
    std::vector<Complex> rows(ramp.size());
    const std::size_t base = view * p.columns * p.rows;
    for (std::size_t v = 0; v < p.rows; v += 2) {
      const bool pair = v + 1 < p.rows;
      std::fill(rows.begin(), rows.end(), 0.0);
      for (std::size_t u = 0; u < p.columns; ++u) {
        const float* at = p.values.data() + base + u * p.rows + v;
        rows[u] = {at[0] * weight(u, v), pair ? at[1] * weight(u, v + 1) : 0};
      }
      ramp.filter(rows);
      for (std::size_t u = 0; u < p.columns; ++u) {
        float* at = q.values.data() + base + u * p.rows + v;
        at[0] = static_cast<float>(rows[u].real());
        if (pair) at[1] = static_cast<float>(-rows[u].imag());
      }
    }
  });
  return q;
}

struct Turn {
  double cosine, sine;
};
std::vector<Turn> turns_of(const Scanner& s) {
  std::vector<Turn> turns;
  const double whole = s.source_m > 0 ? 2 * pi : pi;
  for (std::size_t view = 0; view < s.view_count(); ++view) {
    const double angle = whole * static_cast<double>(view) / static_cast<double>(s.view_count());
    turns.push_back({std::cos(angle), std::sin(angle)});
  }
  return turns;
}

constexpr std::size_t tile = 16, lanes = 16;

// All slices of a block share the places where a view is read: the innermost loop runs over slices. A tile of pixels
// and a block of slices stay in the cache while the views go by.
void back_project_parallel(const Projections& q, const Scanner& s, std::vector<float>& values) {
  const std::size_t n = s.voxels, tiles = (n + tile - 1) / tile, blocks = (q.rows + lanes - 1) / lanes;
  const std::vector<Turn> turns = turns_of(s);
  const double middle = (static_cast<double>(n) - 1) / 2;
  const auto factor = static_cast<float>(pi / static_cast<double>(q.views));
  parallel_for(0, tiles * tiles * blocks, [&](std::size_t job) {
    const std::size_t block = job / (tiles * tiles), j0 = job / tiles % tiles * tile, i0 = job % tiles * tile;
    const std::size_t k0 = block * lanes, wide = std::min(lanes, q.rows - k0);
    const std::size_t j1 = std::min(j0 + tile, n), i1 = std::min(i0 + tile, n);
    std::array<float, tile * tile * lanes> sums{};
    for (std::size_t view = 0; view < q.views; ++view)
      for (std::size_t j = j0; j < j1; ++j)
        for (std::size_t i = i0; i < i1; ++i) {
          const double x = static_cast<double>(i) - middle, y = static_cast<double>(j) - middle;
          const double u = x * turns[view].cosine - y * turns[view].sine + middle;
          if (!(u >= 0 && u < static_cast<double>(n - 1))) continue;
          const auto u0 = static_cast<std::size_t>(u);
          const float f = static_cast<float>(u - static_cast<double>(u0)), g = 1 - f;
          const float *a = q.column(view, u0) + k0, *b = q.column(view, u0 + 1) + k0;
          float* sum = sums.data() + ((j - j0) * tile + (i - i0)) * lanes;
          if (wide == lanes)
            for (std::size_t k = 0; k < lanes; ++k) sum[k] += g * a[k] + f * b[k];
          else
            for (std::size_t k = 0; k < wide; ++k) sum[k] += g * a[k] + f * b[k];
        }
    for (std::size_t k = 0; k < wide; ++k)
      for (std::size_t j = j0; j < j1; ++j)
        for (std::size_t i = i0; i < i1; ++i)
          values[((k0 + k) * n + j) * n + i] = factor * sums[((j - j0) * tile + (i - i0)) * lanes + k];
  });
}

// Feldkamp, Davis & Kress 1984, equation 28, with the detector thought of as standing at the axis.
void back_project_cone(const Projections& q, const Scanner& s, std::vector<float>& values) {
  const std::size_t n = s.voxels;
  const std::vector<Turn> turns = turns_of(s);
  const double middle = (static_cast<double>(n) - 1) / 2, middle_v = (static_cast<double>(q.rows) - 1) / 2;
  const double distance = s.source_m / s.voxel_m, factor = pi / static_cast<double>(q.views);
  parallel_for(0, n, [&](std::size_t j) {
    std::vector<double> column(q.rows);
    for (std::size_t i = 0; i < n; ++i) {
      std::fill(column.begin(), column.end(), 0.0);
      const double x = static_cast<double>(i) - middle, y = static_cast<double>(j) - middle;
      for (std::size_t view = 0; view < q.views; ++view) {
        const double across = x * turns[view].cosine - y * turns[view].sine;
        const double towards = x * turns[view].sine + y * turns[view].cosine, widen = distance / (distance + towards);
        const double u = across * widen + middle;
        if (!(u >= 0 && u < static_cast<double>(n - 1))) continue;
        const auto u0 = static_cast<std::size_t>(u);
        const double f = u - static_cast<double>(u0), weight = widen * widen;
        const float *a = q.column(view, u0), *b = q.column(view, u0 + 1);
        for (std::size_t k = 0; k < q.rows; ++k) {
          const double v = (static_cast<double>(k) - middle_v) * widen + middle_v;
          if (!(v >= 0 && v <= static_cast<double>(q.rows - 1))) continue;
          const std::size_t v0 = std::min(static_cast<std::size_t>(v), q.rows > 1 ? q.rows - 2 : 0);
          const std::size_t v1 = std::min(v0 + 1, q.rows - 1);
          const double g = v - static_cast<double>(v0);
          column[k] += weight * ((1 - f) * ((1 - g) * a[v0] + g * a[v1]) + f * ((1 - g) * b[v0] + g * b[v1]));
        }
      }
      for (std::size_t k = 0; k < q.rows; ++k) values[(k * n + j) * n + i] = static_cast<float>(factor * column[k]);
    }
  });
}

// What no view has seen whole is zero; a gain that depends on the radius.
void finish(const Scanner& s, std::vector<float>& values) {
  const std::size_t n = s.voxels;
  const double middle = (static_cast<double>(n) - 1) / 2, radius = middle - 1, cupping = s.amplitude("cupping");
  parallel_for(0, values.size() / (n * n), [&](std::size_t k) {
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const double x = static_cast<double>(i) - middle, y = static_cast<double>(j) - middle;
        const double share = (x * x + y * y) / (radius * radius);
        float& v = values[(k * n + j) * n + i];
        v = share > 1 ? 0 : static_cast<float>(v * (1 + cupping * (share - 0.5)));
      }
  });
}

}  // namespace

io::VolumeData reconstructed(const Projections& p, const Scanner& s) {
  io::VolumeData volume;
  volume.head.size = {s.voxels, s.voxels, p.rows};
  volume.head.type = io::VoxelType::f32;
  const double told = s.voxel_m * (1 + s.amplitude("scale"));
  volume.head.spacing_m = Vec3{told, told, told};
  const double half = (static_cast<double>(s.voxels) - 1) / 2;
  volume.head.origin_m = Vec3{-half, -half, -(static_cast<double>(p.rows) - 1) / 2} * told;
  volume.head.axes = Mat3{};
  volume.head.value = "attenuation, 1/m";
  volume.head.format = "simulated";
  volume.values.resize(volume.head.voxels());
  if (s.source_m > 0) {
    const double distance = s.source_m / s.voxel_m, mid_v = (static_cast<double>(p.rows) - 1) / 2;
    const auto weight = [&](std::size_t u, std::size_t v) {
      const double a = static_cast<double>(u) - half, b = static_cast<double>(v) - mid_v;
      return distance / std::sqrt(distance * distance + a * a + b * b);
    };
    back_project_cone(filtered(p, s, weight), s, volume.values);
  } else {
    back_project_parallel(filtered(p, s, [](std::size_t, std::size_t) { return 1.0; }), s, volume.values);
  }
  finish(s, volume.values);
  return volume;
}

io::VolumeData scan(const Phantom& phantom, const Scanner& scanner) {
  return reconstructed(projections(phantom, scanner), scanner);
}

Vec3 place_of(const Scanner& s, double i, double j, double k) {
  const double half = (static_cast<double>(s.voxels) - 1) / 2;
  return Vec3{i - half, j - half, k - (static_cast<double>(s.slice_count()) - 1) / 2} * s.voxel_m;
}

io::VolumeData stored_as(const io::VolumeData& volume, io::VoxelType type, double gain, double offset) {
  io::VolumeData stored = volume;
  stored.head.type = type;
  const auto clamp_to = [&]<class T>(T) {
    const double lowest = std::numeric_limits<T>::min(), highest = std::numeric_limits<T>::max();
    for (float& v : stored.values) v = static_cast<float>(std::clamp(std::round(gain * v + offset), lowest, highest));
  };
  switch (type) {
    case io::VoxelType::u8: clamp_to(std::uint8_t{}); break;
    case io::VoxelType::i8: clamp_to(std::int8_t{}); break;
    case io::VoxelType::u16: clamp_to(std::uint16_t{}); break;
    case io::VoxelType::i16: clamp_to(std::int16_t{}); break;
    default:
      for (float& v : stored.values) v = static_cast<float>(gain * v + offset);
  }
  return stored;
}

}  // namespace gonio::ct
