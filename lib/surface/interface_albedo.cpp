// Tables behind interface_albedo.h. Each entry is the mean of F G2 / G1 over visible normals (Heitz 2018), taken on a
// fixed midpoint grid of the two random numbers: deterministic, without noise.
#include "surface/interface_albedo.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surface/fresnel.h"
#include "surface/microfacet.h"

namespace gonio::surface {
namespace {

constexpr std::size_t cosines = 49, alphas = 32, indices = 17;
constexpr int grid_radius = 40, grid_angle = 16;

double cosine_at(std::size_t i) {
  const double t = static_cast<double>(i) / (cosines - 1);
  return t * t;
}
double alpha_at(std::size_t i) {
  return min_alpha * std::pow(max_alpha / min_alpha, static_cast<double>(i) / (alphas - 1));
}
double f0_at(std::size_t i) {
  const double t = static_cast<double>(i) / (indices - 1);
  return max_dielectric_f0 * t * t * t * t;
}

struct Cell {  // a position between two nodes
  std::size_t low = 0;
  double share = 0;  // of the upper node
};
Cell cell(double position, std::size_t nodes) {  // position 0 ... nodes - 1
  const double p = std::clamp(position, 0.0, static_cast<double>(nodes - 1));
  const std::size_t low = std::min(static_cast<std::size_t>(p), nodes - 2);
  return {low, p - static_cast<double>(low)};
}
Cell cosine_cell(double cosine) {
  return cell(std::sqrt(std::max(0.0, cosine)) * (cosines - 1), cosines);
}
Cell alpha_cell(double alpha) {
  static const double steps = (alphas - 1) / std::log(max_alpha / min_alpha);
  return cell(std::log(std::max(alpha, min_alpha) / min_alpha) * steps, alphas);
}
Cell f0_cell(double f0) {
  return cell(std::sqrt(std::sqrt(std::max(0.0, f0) / max_dielectric_f0)) * (indices - 1), indices);
}
double between(double low, double high, double share) {
  return low + (high - low) * share;
}

class Table {
 public:
  Table() : values_(indices * alphas * cosines), means_(indices * alphas) {
    for (std::size_t a = 0; a < alphas; ++a) {
      for (std::size_t c = 0; c < cosines; ++c) fill(a, c);
      for (std::size_t layer = 0; layer < indices; ++layer) means_[layer * alphas + a] = integral(layer, a);
    }
  }
  double value(std::size_t layer, Cell a, Cell c) const {
    return between(row(layer, a.low, c), row(layer, a.low + 1, c), a.share);
  }
  double mean_at(std::size_t layer, std::size_t a) const { return means_[layer * alphas + a]; }
  double mean(std::size_t layer, Cell a) const {
    return between(means_[layer * alphas + a.low], means_[layer * alphas + a.low + 1], a.share);
  }

  double row(std::size_t layer, std::size_t a, Cell c) const {
    return between(at(layer, a, c.low), at(layer, a, c.low + 1), c.share);
  }

 private:
  double& at(std::size_t layer, std::size_t a, std::size_t c) { return values_[(layer * alphas + a) * cosines + c]; }
  double at(std::size_t layer, std::size_t a, std::size_t c) const {
    return values_[(layer * alphas + a) * cosines + c];
  }

  void fill(std::size_t a, std::size_t c) {
    const Ggx ggx(alpha_at(a));
    const double z = std::max(1e-6, cosine_at(c));  // the limit at the horizon
    const Vec3 wo{std::sqrt(1 - z * z), 0, z};
    std::array<double, indices> eta{};
    for (std::size_t i = 0; i < indices; ++i) eta[i] = eta_of_f0(f0_at(i));
    std::array<double, indices> sum{};
    for (int i = 0; i < grid_radius; ++i) {
      // The far slopes, drawn for u.x near one, lose most: u.x = 1 - v^3 resolves them.
      const double v = (i + 0.5) / grid_radius, share = 3 * v * v / (grid_radius * grid_angle);
      for (int j = 0; j < grid_angle; ++j) {  // one half of the circle: the other is its mirror image
        const Vec3 h = ggx.visible_normal(wo, {1 - v * v * v, 0.5 * (j + 0.5) / grid_angle - 0.25});
        const Vec3 wi = mirrored(wo, h);
        if (wi.z <= 0) continue;
        const double weight = share * ggx.weight(wo, wi), cosine = dot(wo, h);
        for (std::size_t k = 0; k < indices; ++k) sum[k] += weight * fresnel_dielectric(cosine, eta[k]);
      }
    }
    for (std::size_t layer = 0; layer < indices; ++layer) at(layer, a, c) = sum[layer];
  }

  // 2 E cosine d(cosine) = 4 E t^3 dt, t = sqrt(cosine): in each cell a polynomial of degree 4, exact with three Gauss
  // points.
  double integral(std::size_t layer, std::size_t a) const {
    constexpr std::array<double, 3> node = {0.1127016653792583, 0.5, 0.8872983346207417};
    constexpr std::array<double, 3> weight = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    double sum = 0;
    for (std::size_t c = 0; c + 1 < cosines; ++c) {
      for (std::size_t q = 0; q < node.size(); ++q) {
        const double t = (static_cast<double>(c) + node[q]) / (cosines - 1);
        sum += weight[q] / (cosines - 1) * 4 * t * t * t * row(layer, a, {c, node[q]});
      }
    }
    return sum;
  }

  std::vector<double> values_, means_;
};

const Table& table() {
  static const Table t;
  return t;
}

// Where an interface lies between the nodes, and what it returned lately: one direction after another meets the same
// interface, and one row of a measured table after another the same cosine. Remembered by each thread; a value is the
// same, to the bit, whether it is found here or in the table.
struct Place {
  static constexpr std::size_t directions = 64;
  double alpha = -1, f0 = -1, mean = 0;
  Cell a, f;
  double a_rate = 0, f_rate = 0;  // of positions by alpha and f0
  std::array<double, directions> cosine{}, value{};

  void move_to(double new_alpha, double new_f0) {
    alpha = new_alpha, f0 = new_f0;
    a = alpha_cell(alpha), f = f0_cell(f0);
    a_rate = alpha >= min_alpha && alpha < max_alpha ? (alphas - 1) / std::log(max_alpha / min_alpha) / alpha : 0;
    f_rate =
        f0 > 0 && f0 < max_dielectric_f0 ? (indices - 1) * std::sqrt(std::sqrt(f0 / max_dielectric_f0)) / (4 * f0) : 0;
    mean = std::nan("");
    cosine.fill(std::nan(""));
  }
};

std::uint64_t mixed(double x) {
  return std::bit_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u;
}

Place& place_of(double alpha, double f0) {
  constexpr int bits = 2;
  thread_local std::array<Place, 1u << bits> remembered;
  Place& place = remembered[(mixed(alpha) ^ mixed(f0)) >> (64 - bits)];
  if (place.alpha != alpha || place.f0 != f0) place.move_to(alpha, f0);
  return place;
}

// Of a bilinear cell with these corners (f0, alpha).
AlbedoSlopes slopes_of(const Place& place, double v00, double v01, double v10, double v11) {
  const double low = between(v00, v01, place.a.share), high = between(v10, v11, place.a.share);
  return {between(low, high, place.f.share), between(v01 - v00, v11 - v10, place.f.share) * place.a_rate,
          (high - low) * place.f_rate};
}

}  // namespace

AlbedoSlopes dielectric_albedo_slopes(double cosine, double alpha, double f0) {
  const Place& place = place_of(alpha, f0);
  const Cell c = cosine_cell(cosine);
  const auto corner = [&](std::size_t f, std::size_t a) { return table().row(place.f.low + f, place.a.low + a, c); };
  return slopes_of(place, corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1));
}

AlbedoSlopes dielectric_albedo_mean_slopes(double alpha, double f0) {
  const Place& place = place_of(alpha, f0);
  const auto corner = [&](std::size_t f, std::size_t a) { return table().mean_at(place.f.low + f, place.a.low + a); };
  return slopes_of(place, corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1));
}

double dielectric_albedo(double cosine, double alpha, double f0) {
  Place& place = place_of(alpha, f0);
  const std::size_t slot = mixed(cosine) >> 58;
  if (place.cosine[slot] == cosine) return place.value[slot];
  const Cell c = cosine_cell(cosine);
  const Table& t = table();
  place.cosine[slot] = cosine;
  return place.value[slot] =
             between(t.value(place.f.low, place.a, c), t.value(place.f.low + 1, place.a, c), place.f.share);
}

double dielectric_albedo_mean(double alpha, double f0) {
  Place& place = place_of(alpha, f0);
  if (std::isnan(place.mean))
    place.mean = between(table().mean(place.f.low, place.a), table().mean(place.f.low + 1, place.a), place.f.share);
  return place.mean;
}

}  // namespace gonio::surface
