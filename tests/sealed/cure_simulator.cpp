// See cure_simulator.h.
#include "sealed/cure_simulator.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/parallel.h"

namespace gonio::sealed {
namespace {

constexpr int depth_cells = 12, steps = 6;
constexpr double critical_conversion = 0.3, darkest = 2e-3;

// The integral of the normal law's integral.
double ramp(double u, double s) {
  const double z = u / s;
  return u * 0.5 * std::erfc(-z / std::sqrt(2.0)) + s * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
}

// Scattered from every cell, whose light is even, with the spread that it has there, along one axis: the share of a
// cell j away is the mean over it of a cell's light under a Gaussian. From the middles of cells alone, a third of a
// pixel apart, light would be spread by 0.1 pixels less than it is said to be, in the mean square.
void spread_along(std::vector<double>& field, int side, bool along_x, const std::vector<double>& sigma) {
  std::map<double, std::vector<double>> shares;  // of the cells from 0 on, by the spread; the other side is alike
  for (const double s : sigma) {
    if (s < 1e-6 || shares.contains(s)) continue;
    std::vector<double>& own = shares[s];
    for (int j = 0; j <= static_cast<int>(4.5 * s) + 2; ++j)
      own.push_back(ramp(j + 1, s) - 2 * ramp(j, s) + ramp(j - 1, s));
  }
  std::vector<double> result(field.size(), 0.0);
  parallel_for(0, static_cast<std::size_t>(side), [&](std::size_t line) {
    const auto at = [&](int k) {
      const std::size_t other = static_cast<std::size_t>(k), n = static_cast<std::size_t>(side);
      return along_x ? line * n + other : other * n + line;
    };
    const std::vector<double>* own = nullptr;
    double known = -1;
    for (int k = 0; k < side; ++k) {
      const double value = field[at(k)], s = sigma[at(k)];
      if (value == 0) continue;
      if (s < 1e-6) {
        result[at(k)] += value;
        continue;
      }
      if (s != known) own = &shares.at(s), known = s;
      const int reach = static_cast<int>(own->size()) - 1;
      for (int j = std::max(0, k - reach); j <= std::min(side - 1, k + reach); ++j)
        result[at(j)] += value * (*own)[static_cast<std::size_t>(std::abs(j - k))];
    }
  });
  field.swap(result);
}

// An area of cells that lies dx, dy cells further.
std::vector<double> moved(const std::vector<double>& field, int side, double dx, double dy) {
  std::vector<double> result(field.size());
  const auto value = [&](int x, int y) {
    return x < 0 || y < 0 || x >= side || y >= side ? 0 : field[static_cast<std::size_t>(y * side + x)];
  };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double u = x - dx, v = y - dy, fx = u - std::floor(u), fy = v - std::floor(v);
      const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
      result[static_cast<std::size_t>(y * side + x)] = (1 - fy) * ((1 - fx) * value(i, j) + fx * value(i + 1, j)) +
                                                       fy * ((1 - fx) * value(i, j + 1) + fx * value(i + 1, j + 1));
    }
  return result;
}

std::vector<double> projected(const Cure& c, const Greys& picture, int layer) {
  const int side = c.side_px * cells_per_pixel;
  std::vector<double> light(static_cast<std::size_t>(side * side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      light[static_cast<std::size_t>(y * side + x)] =
          picture[static_cast<std::size_t>(y / cells_per_pixel * c.side_px + x / cells_per_pixel)];
  if (c.shifted_from > 0 && layer >= c.shifted_from)
    light = moved(light, side, c.shift_x_px * cells_per_pixel, c.shift_y_px * cells_per_pixel);
  if (c.defocus_px > 0) {
    std::vector<double> sigma(light.size());
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double u = (x + 0.5) / side, v = (y + 0.5) / side;
        const double far[] = {u, 1 - u, v, 1 - v};
        sigma[static_cast<std::size_t>(y * side + x)] = c.defocus_px * cells_per_pixel * far[c.defocus_side];
      }
    spread_along(light, side, true, sigma);
    spread_along(light, side, false, sigma);
  }
  if (c.core_px > 0 || c.tail_share > 0) {
    std::vector<double> core = light, near = light, far = light;
    smoothed(core, side, c.core_px * cells_per_pixel);
    smoothed(near, side, c.tail_px * cells_per_pixel);
    smoothed(far, side, 3 * c.tail_px * cells_per_pixel);
    for (std::size_t i = 0; i < light.size(); ++i)
      light[i] = (1 - c.tail_share) * core[i] + c.tail_share * (0.65 * near[i] + 0.35 * far[i]);
  }
  for (double& v : light) v = c.lamp * (v + c.leak);
  return light;
}

// One stack of volumes: what is left of oxygen, radicals, and radicals that have acted, from the membrane downwards.
struct Vat {
  int side = 0, layers = 0;
  std::vector<float> oxygen, radicals, acted;  // [layer][depth][y][x]
  std::size_t plane() const { return static_cast<std::size_t>(side) * static_cast<std::size_t>(side); }
  std::size_t place(int layer, int depth) const {
    return (static_cast<std::size_t>(layer) * depth_cells + static_cast<std::size_t>(depth)) * plane();
  }
};

// Radicals that act while they last, of white at the membrane: the scale of all that is critical.
struct Rates {
  double critical = 0;  // radicals that must have acted, where light of 1 makes 1
  double oxygen = 0;    // taken before
};
Rates rates_of(const Cure& c) {
  const double all = (1 + c.leak) * std::exp(-c.white / c.penetration);
  return {all * (1 - c.oxygen), all * c.oxygen};
}

void diffuse(std::vector<float>& field, const Vat& vat, int layer, double number) {
  const std::size_t n = static_cast<std::size_t>(vat.side);
  parallel_for(0, depth_cells, [&](std::size_t d) {
    float* plane = field.data() + vat.place(layer, static_cast<int>(d));
    std::vector<float> before(plane, plane + vat.plane());
    for (std::size_t y = 0; y < n; ++y)
      for (std::size_t x = 0; x < n; ++x) {
        const std::size_t i = y * n + x;
        const float own = before[i];
        float sum = 0;
        if (x > 0) sum += before[i - 1] - own;
        if (x + 1 < n) sum += before[i + 1] - own;
        if (y > 0) sum += before[i - n] - own;
        if (y + 1 < n) sum += before[i + n] - own;
        plane[i] = own + static_cast<float>(number) * sum;
      }
  });
}

// The lamp over the layers from `top` down to where it is dark.
void shine(const Cure& c, Vat& vat, int top, const std::vector<double>& light) {
  const double rate = 1 + c.drift * (top - 0.5 * (vat.layers - 1));
  const double spread = c.spread_px * cells_per_pixel, number = 0.5 * spread * spread / steps;
  const double cell = 1.0 / depth_cells / c.penetration;  // attenuation lengths
  const double within = (1 - std::exp(-cell)) / cell;     // mean over a cell, of what enters it
  for (int layer = top; layer >= (c.stays ? 0 : top); --layer) {
    const double enters = std::exp(-(top - layer) / c.penetration);
    if (enters < darkest) break;
    for (int step = 0; step < steps; ++step) {
      parallel_for(0, depth_cells, [&](std::size_t d) {
        const std::size_t first = vat.place(layer, static_cast<int>(d));
        const double share = rate * enters * std::exp(-static_cast<double>(d) * cell) * within / steps;
        for (std::size_t i = 0; i < vat.plane(); ++i) {
          float made = static_cast<float>(share * light[i]);
          const float taken = std::min(made, vat.oxygen[first + i]);
          vat.oxygen[first + i] -= taken;
          vat.radicals[first + i] += made - taken;
        }
      });
      diffuse(vat.radicals, vat, layer, number);
      parallel_for(0, depth_cells, [&](std::size_t d) {  // three quarters act and are gone before the next step
        const std::size_t first = vat.place(layer, static_cast<int>(d));
        for (std::size_t i = 0; i < vat.plane(); ++i) {
          const float part = (step + 1 < steps ? 0.75f : 1.0f) * vat.radicals[first + i];
          vat.acted[first + i] += part, vat.radicals[first + i] -= part;
        }
      });
    }
  }
}

// Thickness of the gel below the membrane, in layers.
double thickness(const Cure& c, const Vat& vat, int layer, std::size_t i, const Rates& rates) {
  // Conversion 1 - exp(-k acted), k such that the critical one is that of `rates.critical`.
  const double critical = rates.critical, k = -std::log(1 - critical_conversion) / critical;
  const auto beyond = [&](double acted) {  // along Beer and Lambert's law, to where it is critical
    return c.penetration * std::log((std::max(acted, 1e-12) + rates.oxygen) / (critical + rates.oxygen));
  };
  double last = 0;
  for (int d = 0; d < depth_cells; ++d) {
    const double acted = static_cast<double>(vat.acted[vat.place(layer, d) + i]);
    const double conversion = 1 - std::exp(-k * acted);
    if (conversion < critical_conversion) {
      const double middle = (d + 0.5) / depth_cells;
      if (d == 0) return acted > 0 ? std::max(0.0, middle + beyond(acted)) : 0;
      const double t = std::log(last / critical) / std::log(last / std::max(acted, 1e-12));
      return middle - (1 - t) / depth_cells;
    }
    last = acted;
  }
  return std::min(1.0, 1 - 0.5 / depth_cells + beyond(last));
}

std::vector<double> beside_open(const Cure& c, const Greys& picture) {
  const int side = c.side_px * cells_per_pixel;
  std::vector<double> open(static_cast<std::size_t>(side * side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      open[static_cast<std::size_t>(y * side + x)] =
          picture[static_cast<std::size_t>(y / cells_per_pixel * c.side_px + x / cells_per_pixel)] < 0.05 ? 0 : 1;
  smoothed(open, side, 2.0 * cells_per_pixel);
  for (double& v : open) v = 1 - v;
  return open;
}

double scratched(const Cure& c, int x, int y) {
  const double side = c.side_px * cells_per_pixel, u = (x + 0.5) / side - 0.5, v = (y + 0.5) / side - 0.5;
  const double across = u * std::cos(c.scratch_angle) + v * std::sin(c.scratch_angle) - (c.scratch_at - 0.5);
  const double cells = across * side / (1.2 * cells_per_pixel);
  return c.scratch * std::exp(-0.5 * cells * cells);
}

}  // namespace

void smoothed(std::vector<double>& field, int side, double sigma) {
  const std::vector<double> everywhere(field.size(), sigma);
  spread_along(field, side, true, everywhere);
  spread_along(field, side, false, everywhere);
}

std::vector<double> cured(const Cure& c, const std::vector<Greys>& pictures) {
  Vat vat;
  vat.side = c.side_px * cells_per_pixel, vat.layers = static_cast<int>(pictures.size());
  const std::size_t cells = vat.plane() * depth_cells * pictures.size();
  const Rates rates = rates_of(c);
  vat.oxygen.assign(cells, static_cast<float>(rates.oxygen));
  vat.radicals.assign(cells, 0.0f);
  vat.acted.assign(cells, 0.0f);
  for (int layer = 0; layer < vat.layers; ++layer) {
    const Greys& picture = pictures[static_cast<std::size_t>(layer)];
    if (c.side_oxygen > 0) {
      const std::vector<double> open = beside_open(c, picture);
      for (int d = 0; d < depth_cells; ++d)
        for (std::size_t i = 0; i < vat.plane(); ++i)
          vat.oxygen[vat.place(layer, d) + i] +=
              static_cast<float>(c.side_oxygen * (rates.critical + rates.oxygen) * open[i]);
    }
    shine(c, vat, layer, projected(c, picture, layer + 1));
  }
  std::vector<double> heights(vat.plane(), 0.0);
  for (std::size_t i = 0; i < vat.plane(); ++i)
    for (int layer = vat.layers - 1; layer >= 0; --layer) {
      const double gap = 1 - c.bulge, thick = std::min(gap, thickness(c, vat, layer, i, rates));
      if (thick <= 0) continue;
      heights[i] = layer + thick;
      if (c.scratch != 0) heights[i] += scratched(c, static_cast<int>(i) % vat.side, static_cast<int>(i) / vat.side);
      break;
    }
  return heights;
}

std::vector<double> wedge(const Cure& cure, const std::vector<double>& greys) {
  Cure sound;
  sound.side_px = 9, sound.layers = 1;
  sound.penetration = cure.penetration, sound.leak = cure.leak, sound.white = cure.white;
  sound.oxygen = cure.oxygen, sound.spread_px = cure.spread_px;
  std::vector<double> result;
  const std::size_t side = 9 * cells_per_pixel;
  for (const double g : greys) result.push_back(cured(sound, {Greys(81, g)})[side / 2 * side + side / 2]);
  return result;
}

}  // namespace gonio::sealed
