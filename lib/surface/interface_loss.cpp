// Tables behind interface_loss.h. Each entry is a mean over visible normals, taken on a fixed midpoint grid of the two
// random numbers: deterministic, without noise.
#include "surface/interface_loss.h"

#include <bit>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "surface/fresnel.h"
#include "surface/refraction.h"
#include "surface/slopes_grid.h"

namespace gonio::surface {
namespace {

constexpr double max_eta = 4, max_step = (max_eta - 1) / (max_eta + 1);

double square(double x) {
  return x * x;
}
double fraction(std::size_t i, std::size_t nodes) {
  return nodes > 1 ? static_cast<double>(i) / static_cast<double>(nodes - 1) : 0;
}

struct Cell {  // a position between two nodes
  std::size_t low = 0;
  double share = 0;  // of the upper node
};
Cell cell(double position, std::size_t nodes) {  // position 0 ... 1
  if (nodes == 1) return {};
  const double p = std::clamp(position, 0.0, 1.0) * static_cast<double>(nodes - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(p), nodes - 2);
  return {low, p - static_cast<double>(low)};
}

struct Grid {
  std::size_t cosines, azimuths, alphas, anisotropies, indices;
  int radii, angles;  // of the quadrature
  bool isotropic() const { return azimuths == 1; }
  std::size_t rows() const { return 2 * indices + 1; }  // of one side, of the other, of the mirror
  double cosine(std::size_t i) const { return square(fraction(i, cosines)); }
  double alpha(std::size_t i) const { return square(fraction(i, alphas)); }
  double azimuth_cosine(std::size_t i) const { return isotropic() ? 1 : fraction(i, azimuths); }
  double anisotropy(std::size_t i) const { return (1 - std::pow(0.1, fraction(i, anisotropies))) / 0.9; }
  double eta(std::size_t row) const {  // 0: the mirror
    if (row == 2 * indices) return 0;
    const double step = max_step * square(fraction(row % indices, indices)), above = (1 + step) / (1 - step);
    return row < indices ? above : 1 / above;
  }
};
constexpr Grid isotropic_grid{41, 1, 25, 1, 20, 32, 12}, anisotropic_grid{29, 9, 25, 9, 20, 20, 14};

// Power that a direction gets back by way of one facet; eta 0: the mirror.
template <Slopes kind>
double returned(const Facets<kind>& facets, Vec3 wo, double seen, Vec3 h, double eta) {
  const double cosine = dot(wo, h), mirrors = eta > 0 ? fresnel_dielectric(cosine, eta) : 1;
  const Vec3 wi = mirrored(wo, h);
  double sum = wi.z > 0 ? mirrors * facets.reflection_weight(wo, wi, seen) : 0;
  if (mirrors >= 1) return sum;
  const Vec3 wt = refracted(wo, h, eta);
  if (wt.z < 0) sum += (1 - mirrors) * facets.transmission_weight(wt);
  return sum;
}

}  // namespace

struct LossBlock {  // of one index, anisotropy and alpha
  std::once_flag once;
  std::vector<double> values;  // (azimuth, cosine)
  double mean = 0;
};

// Blocks are computed when they are first asked for.
struct LossTable {
  Slopes kind;
  Grid grid;
  SlopesGrid normals;
  std::vector<double> weights;  // of entries in a mean
  std::unique_ptr<LossBlock[]> blocks;

  LossTable(Slopes slopes, const Grid& g)
      : kind(slopes),
        grid(g),
        normals(slopes, g.radii, g.angles, g.isotropic()),
        blocks(std::make_unique<LossBlock[]>(g.rows() * g.anisotropies * g.alphas)) {
    set_weights();
  }

  const LossBlock& block(std::size_t row, std::size_t anisotropy, std::size_t alpha) const {
    LossBlock& found = blocks[(row * grid.anisotropies + anisotropy) * grid.alphas + alpha];
    std::call_once(found.once, [&] {
      const Roughness roughness{grid.alpha(alpha), grid.anisotropy(anisotropy), 0};
      found.values.resize(grid.azimuths * grid.cosines);
      if (alpha == 0) return;  // a smooth interface loses nothing
      for (std::size_t i = 0; i < found.values.size(); ++i) {
        found.values[i] = kind == Slopes::ggx ? entry<Slopes::ggx>(roughness, grid.eta(row), i)
                                              : entry<Slopes::beckmann>(roughness, grid.eta(row), i);
        found.mean += weights[i] * found.values[i];
      }
    });
    return found;
  }

 private:
  template <Slopes slopes>
  double entry(const Roughness& roughness, double eta, std::size_t i) const {
    const Facets<slopes> facets(roughness);
    const double z = std::max(1e-6, grid.cosine(i % grid.cosines));  // the limit at the horizon
    const double r = std::sqrt(1 - z * z), cosine = grid.azimuth_cosine(i / grid.cosines);
    const Vec3 wo{r * cosine, r * std::sqrt(1 - cosine * cosine), z};
    const double seen = facets.area_seen(wo);
    double sum = 0;
    normals.over(facets, wo, [&](Vec3 h, double share) { sum += share * returned(facets, wo, seen, h, eta); });
    return std::clamp(1 - sum, 0.0, 1.0);
  }

  // 2 L cosine d(cosine) = 4 L t^3 dt, t = sqrt(cosine), and the share of the azimuths: hats between nodes.
  void set_weights() {
    constexpr int steps = 4000;
    std::vector<double> along(grid.cosines), around(grid.azimuths);
    const auto spread = [](std::vector<double>& hats, double position, double amount) {
      const Cell c = cell(position, hats.size());
      hats[c.low] += amount * (1 - c.share);
      if (hats.size() > 1) hats[c.low + 1] += amount * c.share;
    };
    for (int i = 0; i < steps; ++i) {
      const double t = (i + 0.5) / steps, low = std::pow(t - 0.5 / steps, 4), high = std::pow(t + 0.5 / steps, 4);
      spread(along, t, high - low);
      spread(around, std::cos(pi / 2 * t), 1.0 / steps);
    }
    for (const double a : around)
      for (const double c : along) weights.push_back(a * c);
  }
};

namespace {

// Where a direction lies in the blocks of a grid.
struct Place {
  struct Read {
    double value, rise;  // to the next azimuth
  };
  std::size_t at, next = 0;  // next: from one azimuth to the other; 0 where there is one
  double by_cosine, by_azimuth = 0;

  Place(const Grid& grid, Vec3 w) {
    const Cell c = cell(std::sqrt(std::abs(w.z)), grid.cosines);
    at = c.low, by_cosine = c.share;
    if (grid.isotropic()) return;
    const double s2 = w.x * w.x + w.y * w.y;
    const Cell q = cell(s2 > 0 ? std::abs(w.x) / std::sqrt(s2) : 1, grid.azimuths);
    at += q.low * grid.cosines, by_azimuth = q.share, next = grid.cosines;
  }
  Read read(const double* block) const {
    const double *low = block + at, *high = low + next, value = low[0] + (low[1] - low[0]) * by_cosine;
    if (next == 0) return {value, 0};
    const double rise = high[0] + (high[1] - high[0]) * by_cosine - value;
    return {value + rise * by_azimuth, rise};
  }
};

const LossTable& table_of(Slopes kind, bool isotropic) {
  static const LossTable ggx(Slopes::ggx, isotropic_grid), beckmann(Slopes::beckmann, isotropic_grid),
      ggx_axes(Slopes::ggx, anisotropic_grid), beckmann_axes(Slopes::beckmann, anisotropic_grid);
  if (kind == Slopes::ggx) return isotropic ? ggx : ggx_axes;
  return isotropic ? beckmann : beckmann_axes;
}

}  // namespace

InterfaceLoss::InterfaceLoss(Slopes kind, const Roughness& roughness, double eta)
    : table_(&table_of(kind, roughness.anisotropy == 0)) {
  const Grid& grid = table_->grid;
  const Cell alpha = cell(std::sqrt(roughness.alpha), grid.alphas);
  const Cell anisotropy = cell(-std::log10(1 - 0.9 * roughness.anisotropy), grid.anisotropies);
  Cell row = cell(std::sqrt(std::abs(eta - 1) / ((eta + 1) * max_step)), grid.indices);
  if (eta < 1) row.low += grid.indices;
  if (eta == 0) row = {2 * grid.indices, 0};
  const auto add = [&](const Cell& c, std::size_t high, std::size_t& node, double& share) {
    node = c.low + high;
    share *= high ? c.share : 1 - c.share;
  };
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::size_t r = 0, s = 0, a = 0;
    double share = 1;
    add(row, corner & 1, r, share);
    add(anisotropy, corner >> 1 & 1, s, share);
    add(alpha, corner >> 2, a, share);
    if (!(share > 0)) continue;
    const LossBlock& block = table_->block(r, s, a);
    corners_[count_++] = {block.values.data(), share};
    mean_ += share * block.mean;
  }
}

InterfaceLoss InterfaceLoss::of(Slopes kind, const Roughness& roughness, double eta) {
  struct Slot {
    double alpha, anisotropy, eta;
    Slopes kind;
    InterfaceLoss loss;
  };
  constexpr std::size_t slots = 16;
  thread_local std::array<std::optional<Slot>, slots> remembered;
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  const std::uint64_t mix =
      (bits(roughness.alpha) ^ 3 * bits(roughness.anisotropy) ^ 5 * bits(eta)) * 0x9e3779b97f4a7c15u;
  std::optional<Slot>& slot = remembered[mix >> 60];
  if (!slot || slot->alpha != roughness.alpha || slot->anisotropy != roughness.anisotropy || slot->eta != eta ||
      slot->kind != kind)
    slot = Slot{roughness.alpha, roughness.anisotropy, eta, kind, {kind, roughness, eta}};
  return slot->loss;
}

double InterfaceLoss::towards(Vec3 w) const {
  const Place place(table_->grid, w);
  double sum = 0;
  for (std::size_t k = 0; k < count_; ++k) sum += corners_[k].share * place.read(corners_[k].values).value;
  return sum;
}

InterfaceLossSlopes::InterfaceLossSlopes(Slopes kind, double alpha, double anisotropy)
    : table_(&table_of(kind, anisotropy == 0)) {
  const Grid& grid = table_->grid;
  const Cell a = cell(std::sqrt(alpha), grid.alphas), s = cell(-std::log10(1 - 0.9 * anisotropy), grid.anisotropies);
  const double last_a = static_cast<double>(grid.alphas - 1), last_s = static_cast<double>(grid.anisotropies - 1);
  const double a_rate = alpha > 0 && alpha < 1 ? last_a / (2 * std::sqrt(alpha)) : 0;
  const double s_rate = anisotropy < 1 ? last_s * 0.9 / ((1 - 0.9 * anisotropy) * std::log(10.0)) : 0;
  for (std::size_t high_s = 0; high_s < (grid.isotropic() ? 1 : 2); ++high_s)
    for (std::size_t high_a = 0; high_a < 2; ++high_a) {
      const LossBlock& block = table_->block(2 * grid.indices, s.low + high_s, a.low + high_a);
      const double of_a = high_a ? a.share : 1 - a.share, of_s = high_s ? s.share : 1 - s.share;
      Corner& corner = corners_[count_++];
      corner = {block.values.data(), of_a * of_s, (high_a ? a_rate : -a_rate) * of_s,
                grid.isotropic() ? 0 : (high_s ? s_rate : -s_rate) * of_a};
      mean_.value += corner.share * block.mean;
      mean_.by_alpha += corner.by_alpha * block.mean;
      mean_.by_anisotropy += corner.by_anisotropy * block.mean;
    }
}

InterfaceLossSlopes InterfaceLossSlopes::of(Slopes kind, double alpha, double anisotropy) {
  struct Slot {
    double alpha, anisotropy;
    Slopes kind;
    InterfaceLossSlopes loss;
  };
  constexpr std::size_t slots = 4;
  thread_local std::array<std::optional<Slot>, slots> remembered;
  const std::uint64_t mix =
      (std::bit_cast<std::uint64_t>(alpha) ^ 3 * std::bit_cast<std::uint64_t>(anisotropy)) * 0x9e3779b97f4a7c15u;
  std::optional<Slot>& slot = remembered[mix >> 62];
  if (!slot || slot->alpha != alpha || slot->anisotropy != anisotropy || slot->kind != kind)
    slot = Slot{alpha, anisotropy, kind, {kind, alpha, anisotropy}};
  return slot->loss;
}

LossSlopes InterfaceLossSlopes::towards(Vec3 w) const {
  const Place place(table_->grid, w);
  LossSlopes sum;
  for (std::size_t k = 0; k < count_; ++k) {
    const auto [value, rise] = place.read(corners_[k].values);
    sum.value += corners_[k].share * value;
    sum.by_alpha += corners_[k].by_alpha * value;
    sum.by_anisotropy += corners_[k].by_anisotropy * value;
    sum.by_cosine += corners_[k].share * rise * static_cast<double>(table_->grid.azimuths - 1);
  }
  return sum;
}

}  // namespace gonio::surface
