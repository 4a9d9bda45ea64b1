// A whole lobe at once: paths that escape are sorted into cells of the hemisphere (lobe.h).
#include "relief/lobe_paths.h"

namespace gonio::relief {
namespace {

struct Sums {
  std::vector<Rgb> table, picture;
  Rgb reflected, lost, cut;
  std::array<double, 4> by_facets{};
};

struct Cells {
  const LobeCells& n;
  std::size_t table_cell(Vec3 w) const {
    const double theta = std::acos(std::clamp(w.z, 0.0, 1.0)), turn = std::atan2(w.y, w.x) / (2 * pi);
    const int t = std::min(n.theta - 1, static_cast<int>(theta / (pi / 2) * n.theta)),
              p = std::min(n.phi - 1, static_cast<int>((turn - std::floor(turn)) * n.phi));
    return static_cast<std::size_t>(t * n.phi + p);
  }
  std::size_t picture_cell(Vec3 w) const {
    const auto cell = [&](double x) { return std::clamp(static_cast<int>((x + 1) / 2 * n.side), 0, n.side - 1); };
    return static_cast<std::size_t>(cell(-w.y) * n.side + cell(w.x));
  }
  // integral of cos over a cell
  double table_projected(std::size_t cell) const {
    const double t = static_cast<double>(static_cast<int>(cell) / n.phi), step = pi / 2 / n.theta;
    const double low = std::sin(t * step), high = std::sin((t + 1) * step);
    return (high * high - low * low) * pi / n.phi;
  }
  double picture_projected() const { return 4.0 / (n.side * n.side); }
};

// value and sigma of every cell over the batches
std::vector<Estimate> estimates(const std::vector<Sums>& batch, std::vector<Rgb> Sums::*member, double scale,
                                const std::function<double(std::size_t)>& projected) {
  std::vector<Estimate> all((batch.front().*member).size());
  parallel_for(
      0, all.size(),
      [&](std::size_t cell) {
        std::array<Rgb, batches> means;
        for (std::size_t b = 0; b < batches; ++b) means[b] = (batch[b].*member)[cell] * (scale / projected(cell));
        all[cell] = estimate_of(means);
      },
      256);
  return all;
}

Estimate total(const std::vector<Sums>& batch, Rgb Sums::*member, double scale) {
  std::array<Rgb, batches> means;
  for (std::size_t b = 0; b < batches; ++b) means[b] = batch[b].*member * scale;
  return estimate_of(means);
}

Sums traced_batch(const Relief& relief, const Material& material, Vec3 wo, const Cells& cells, std::int64_t paths,
                  int most_facets, Random& random, const std::function<Vec2(std::int64_t)>& place) {
  Sums sums;
  sums.table.resize(static_cast<std::size_t>(cells.n.theta * cells.n.phi));
  sums.picture.resize(static_cast<std::size_t>(cells.n.side * cells.n.side));
  for (std::int64_t k = 0; k < paths; ++k) {
    const Path path =
        traced(relief, material, wo, place(k), random, most_facets, [](const Hit&, const Basis&, Vec3, Rgb) {});
    sums.lost += path.lost, sums.cut += path.cut;
    if (!path.escaped || path.leaves.z <= 0) continue;
    sums.reflected += path.throughput;
    sums.by_facets[static_cast<std::size_t>(std::min(4, path.facets) - 1)] += mean(path.throughput);
    sums.table[cells.table_cell(path.leaves)] += path.throughput;
    if (cells.n.side > 0) sums.picture[cells.picture_cell(path.leaves)] += path.throughput;
  }
  return sums;
}

}  // namespace

LobeTable lobe_table(const Relief& relief, const Material& material, Vec3 wo, const LobeCells& n,
                     const Effort& effort) {
  check_lobe(relief, wo, "wo");
  const Cells cells{n};
  const std::int64_t per_batch = std::max<std::int64_t>(1, effort.paths / batches);
  std::vector<Sums> batch(batches);
  run_batches(effort, [&](std::size_t b, Random& random, const auto& place) {
    batch[b] = traced_batch(relief, material, wo, cells, per_batch, effort.most_facets, random, place);
  });
  const double scale = 1 / static_cast<double>(per_batch);
  LobeTable lobe;
  lobe.theta_cells = n.theta, lobe.phi_cells = n.phi, lobe.side = n.side;
  lobe.table = estimates(batch, &Sums::table, scale, [&](std::size_t c) { return cells.table_projected(c); });
  lobe.picture = estimates(batch, &Sums::picture, scale, [&](std::size_t) { return cells.picture_projected(); });
  lobe.energy.reflected = total(batch, &Sums::reflected, scale);
  lobe.energy.lost = total(batch, &Sums::lost, scale);
  lobe.energy.cut = total(batch, &Sums::cut, scale);
  const auto one_path = [&](std::vector<Estimate>& all_cells, const auto& projected) {
    const Rgb carried = lobe.energy.reflected.value * (scale / batches);
    for (std::size_t c = 0; c < all_cells.size(); ++c) {
      Rgb& sigma = all_cells[c].sigma;
      const auto least = [&](double s, double share) {
        return s > 0 ? s : (share > 0 ? share : scale / batches) / projected(c);
      };
      sigma = {least(sigma.x, carried.x), least(sigma.y, carried.y), least(sigma.z, carried.z)};
    }
  };
  one_path(lobe.table, [&](std::size_t c) { return cells.table_projected(c); });
  one_path(lobe.picture, [&](std::size_t) { return cells.picture_projected(); });
  double all = 0;
  for (const Sums& s : batch)
    for (std::size_t i = 0; i < 4; ++i) lobe.energy.by_facets[i] += s.by_facets[i], all += s.by_facets[i];
  if (all > 0)
    for (double& share : lobe.energy.by_facets) share /= all;
  for (std::size_t cell = 0; cell < lobe.table.size(); ++cell) {
    if (mean(lobe.table[cell].value) <= mean(lobe.peak.value)) continue;
    lobe.peak = lobe.table[cell];
    lobe.peak_theta_rad = lobe.theta_rad(static_cast<int>(cell) / n.phi);
    lobe.peak_phi_rad = lobe.phi_rad(static_cast<int>(cell) % n.phi);
  }
  return lobe;
}

}  // namespace gonio::relief
