// See polarizers.h.
#include "photograph/polarizers.h"

#include <array>
#include <cmath>

#include "base/parallel.h"
#include "geom/angle.h"

namespace gonio::photograph {
namespace {

constexpr int reach = 2, side = 2 * reach + 1;
using Window = std::array<double, static_cast<std::size_t>(side* side)>;  // weights, row by row
constexpr std::size_t place(int dx, int dy) {
  return static_cast<std::size_t>((dy + reach) * side + dx + reach);
}
using Stokes = std::array<Window, 3>;

int filter(int x, int y) {
  return (y & 1) * 2 + (x & 1);
}

// What a polarizer's reading counts in s0, s1 and s2.
std::array<double, 3> share(int of) {
  const double twice = 2 * polarizer_angle(of & 1, of >> 1);
  return {0.5, std::cos(twice), std::sin(twice)};
}

struct Found {  // s0, s1, s2
  std::array<double, 3> value{}, variance{};
  ExposureRange exposures{};
};

class Polarizers {
 public:
  Polarizers(const MosaicSamples& samples, Demosaicing how) : s_(samples) {
    for (int own = 0; own < polarizer_count; ++own) usual_[static_cast<std::size_t>(own)] = stokes(own, how);
  }

  // False where a polarizer has no sample beside the pixel.
  bool at_pixel(int x, int y, Found& found) const {
    if (apply(usual_[static_cast<std::size_t>(filter(x, y))], x, y, found)) return true;
    Stokes left{};
    for (int of = 0; of < polarizer_count; ++of) {
      Window w{};
      double all = 0;
      const bool own = of == filter(x, y) && trusted(x, y);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if ((own && (dx != 0 || dy != 0)) || filter(x + dx, y + dy) != of || !trusted(x + dx, y + dy)) continue;
          all += w[place(dx, dy)] = 1;
        }
      if (!(all > 0)) return false;
      add(w, 1 / all, of, left);
    }
    return apply(left, x, y, found);
  }

 private:
  bool trusted(int x, int y) const {
    return x >= 0 && y >= 0 && x < s_.width && y < s_.height && s_.trusted[at(x, y)] != 0;
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(s_.width) + static_cast<std::size_t>(x);
  }

  static void add(const Window& w, double factor, int of, Stokes& stokes) {
    const std::array<double, 3> shares = share(of);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < w.size(); ++i) stokes[k][i] += shares[k] * factor * w[i];
  }

  // The nearest samples of a polarizer lie one step off along one axis or both, and their mean is off by half of the
  // second difference along these axes: an eighth of the one over two steps, which the pixel's own lattice tells.
  static Stokes stokes(int own, Demosaicing how) {
    Stokes all{};
    for (int of = 0; of < polarizer_count; ++of) {
      const int across = (of ^ own) & 1, down = (of ^ own) >> 1;
      Window w{};
      for (int dy = -down; dy <= down; ++dy)
        for (int dx = -across; dx <= across; ++dx)
          if ((across == 0 || dx != 0) && (down == 0 || dy != 0)) w[place(dx, dy)] = 1.0 / ((1 + across) * (1 + down));
      if (how == Demosaicing::gradient) {
        w[place(0, 0)] += (across + down) / 4.0;
        for (const int step : {-reach, reach}) w[place(step, 0)] -= across / 8.0, w[place(0, step)] -= down / 8.0;
      }
      add(w, 1, of, all);
    }
    return all;
  }

  bool apply(const Stokes& weights, int x, int y, Found& found) const {
    found = {};
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx) {
        const std::size_t i = place(dx, dy);
        if (weights[0][i] == 0 && weights[1][i] == 0 && weights[2][i] == 0) continue;
        if (!trusted(x + dx, y + dy)) return false;
        const double v = s_.value[at(x + dx, y + dy)], noise = s_.variance[at(x + dx, y + dy)];
        for (std::size_t k = 0; k < 3; ++k)
          found.value[k] += weights[k][i] * v, found.variance[k] += weights[k][i] * weights[k][i] * noise;
        found.exposures.add(range_of(s_, at(x + dx, y + dy)));
      }
    return true;
  }

  const MosaicSamples& s_;
  std::array<Stokes, polarizer_count> usual_{};
};

}  // namespace

double behind_polarizer(double s0, double s1, double s2, double angle_rad) {
  return 0.5 * (s0 + s1 * std::cos(2 * angle_rad) + s2 * std::sin(2 * angle_rad));
}

int polarizer_degrees(int x, int y) {
  constexpr std::array<int, polarizer_count> degrees = {90, 45, 135, 0};
  return degrees[static_cast<std::size_t>(filter(x, y))];
}

double polarizer_angle(int x, int y) {
  return polarizer_degrees(x, y) * pi / 180;
}

Demosaiced stokes_of_polarizers(const MosaicSamples& samples, Demosaicing how) {
  const std::vector<std::string> names{"Y", "s1.Y", "s2.Y"};
  Demosaiced result{io::Image(samples.width, samples.height, names), io::Image(samples.width, samples.height, names),
                    std::vector<std::uint8_t>(samples.trusted.begin(), samples.trusted.end()),
                    std::vector<std::uint8_t>(samples.value.size(), ExposureRange{}.first),
                    std::vector<std::uint8_t>(samples.value.size(), ExposureRange{}.last)};
  const Polarizers work(samples, how);
  parallel_for(0, static_cast<std::size_t>(samples.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < samples.width; ++x) {
      const std::size_t i = row * static_cast<std::size_t>(samples.width) + static_cast<std::size_t>(x);
      Found found;
      if (!work.at_pixel(x, y, found)) result.trusted[i] = 0, found = {};
      for (int k = 0; k < 3; ++k) {
        result.colour.at(x, y, k) = static_cast<float>(found.value[static_cast<std::size_t>(k)]);
        result.variance.at(x, y, k) = static_cast<float>(found.variance[static_cast<std::size_t>(k)]);
      }
      result.first[i] = found.exposures.first, result.last[i] = found.exposures.last;
    }
  });
  return result;
}

}  // namespace gonio::photograph
