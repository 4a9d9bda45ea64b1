// From samples to a table: observations, components, cells.
#include "goniometry/reconstruct/reconstruction.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "geom/angle.h"
#include "goniometry/reconstruct/reconstruction_parts.h"
#include "surface/merl_table.h"

namespace gonio::goniometry {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr std::size_t chunk_cells = 1024;
constexpr float below_horizon = -1;
constexpr double most_open = 0.2;  // of ln: beyond, a cell is known to a fifth or worse

// Mapped values of all cells and their standard deviations, cell by cell, three channels.
struct Mapped {
  std::vector<float> x, sigma;
};

struct Solved {
  Eigen::VectorXd scores;
  Eigen::MatrixXd factor;
  double rest = 1;  // factor of rest
};

Mapped map_cells(const Basis& basis, const std::vector<Solved>& solved, bool uncertainty) {
  const std::size_t cells = basis.cells().count(), k = basis.components(), bands = solved.size();
  Mapped mapped{std::vector<float>(cells * bands), std::vector<float>(uncertainty ? cells * bands : 0)};
  std::vector<Eigen::VectorXf> scores;
  std::vector<Eigen::MatrixXf> factors;
  for (const Solved& s : solved) {
    scores.push_back(s.scores.cast<float>());
    factors.push_back(s.factor.cast<float>());
  }
  parallel_for(0, (cells + chunk_cells - 1) / chunk_cells, [&](std::size_t chunk) {
    const std::size_t first = chunk * chunk_cells, count = std::min(chunk_cells, cells - first);
    const Eigen::Map<const RowMatrix> q(basis.all_q().data() + first * k, static_cast<Eigen::Index>(count),
                                        static_cast<Eigen::Index>(k));
    for (std::size_t band = 0; band < bands; ++band) {
      const Eigen::VectorXf x = q * scores[band];
      for (std::size_t i = 0; i < count; ++i)
        mapped.x[(first + i) * bands + band] = x[static_cast<Eigen::Index>(i)] + basis.mean()[first + i];
      if (!uncertainty) continue;
      const Eigen::VectorXf variance = (q * factors[band]).rowwise().squaredNorm();
      for (std::size_t i = 0; i < count; ++i) {
        const float rest = static_cast<float>(solved[band].rest) * basis.rest()[first + i];
        mapped.sigma[(first + i) * bands + band] = std::sqrt(variance[static_cast<Eigen::Index>(i)] + rest * rest);
      }
    }
  });
  return mapped;
}

void fill_tables(const Basis& basis, const Mapped& mapped, std::size_t bands, Reconstruction& out) {
  const Cells& cells = basis.cells();
  const auto [rings, tilts, turns] = cells.bins();
  const bool uncertainty = !mapped.sigma.empty();
  out.table = {cells.bins(), std::vector<float>(3 * rings * tilts * turns, below_horizon)};
  if (uncertainty) out.sigma = out.table;
  if (uncertainty) out.sigma_ln.assign(out.table.brdf_per_sr.size(), 0);
  parallel_for(0, rings, [&](std::size_t h) {
    for (std::size_t d = 0; d < tilts; ++d) {
      const auto wider =
          static_cast<float>(out.widenings.at((static_cast<double>(h) + 0.5) / static_cast<double>(rings),
                                              (static_cast<double>(d) + 0.5) / static_cast<double>(tilts)));
      for (std::size_t p = 0; p < (turns + 1) / 2; ++p) {
        const std::uint32_t cell = cells.cell_of(h, d, p);
        if (cell == Cells::none) continue;
        const double w = cells.weight(cell), reference = static_cast<double>(basis.log_reference()[cell]);
        for (std::size_t band = 0; band < 3; ++band) {
          const std::size_t from = cell * bands + (bands == 1 ? 0 : band);
          const double f = of_level(reference + static_cast<double>(mapped.x[from]), w);
          for (const std::size_t turn : {p, turns - 1 - p}) {
            const std::size_t to = 3 * ((h * tilts + d) * turns + turn) + band;
            out.table.brdf_per_sr[to] = static_cast<float>(f);
            if (!uncertainty) continue;
            out.sigma_ln[to] = wider * mapped.sigma[from];
            out.sigma.brdf_per_sr[to] = static_cast<float>(static_cast<double>(out.sigma_ln[to]) / level_slope(f, w));
          }
        }
      }
    }
  });
}

double prior_spread(const Basis& basis) {
  double squares = 0;
  for (const float q : basis.all_q()) squares += static_cast<double>(q) * static_cast<double>(q);
  for (const float rest : basis.rest()) squares += static_cast<double>(rest) * static_cast<double>(rest);
  return std::sqrt(squares / static_cast<double>(basis.cells().count()));
}
double open_of(const Mapped& mapped, std::size_t band, std::size_t bands) {
  double squares = 0;
  for (std::size_t i = band; i < mapped.sigma.size(); i += bands)
    squares += static_cast<double>(mapped.sigma[i]) * static_cast<double>(mapped.sigma[i]);
  return std::sqrt(squares * static_cast<double>(bands) /
                   static_cast<double>(std::max<std::size_t>(mapped.sigma.size(), 1)));
}

void judge(const Basis& basis, const ReconstructOptions& options, std::size_t bands, Reconstruction& out) {
  std::vector<std::string>& notes = out.notes;
  notes.push_back("The basis: " + basis.description() + "; " + std::to_string(basis.components()) +
                  format(" components hold %.2f %% of the variance.", 100 * basis.kept_share()));
  double misfit = 1, excess = 1;
  for (std::size_t b = 0; b < bands; ++b) {
    misfit = std::max(misfit, out.channels[b].misfit);
    excess = std::max(excess, out.channels[b].excess);
  }
  if (std::max(misfit, excess) > 1.5)
    notes.push_back(
        format("The material is unlike those of the basis: its components vary %.1f times as much, and "
               "noise and what the basis leaves open are taken %.1f times as large as stated.",
               excess, misfit));
  if (options.uncertainty && options.calibrate)
    notes.push_back(
        format("Left out in turn%s and reconstructed from these directions, the basis' materials lie within "
               "95 %% intervals in %.1f %% of the cells; standard deviations are multiplied by %.2f to %.2f, region by "
               "region.",
               basis.classes() < basis.materials().size() ? " with all of their class" : "", 100 * out.covered,
               *std::ranges::min_element(out.widenings.s), *std::ranges::max_element(out.widenings.s)));
  const double left = out.channels[bands / 2].open_ln, fresh = prior_spread(basis);
  if (options.uncertainty && left > most_open && left > 0.2 * fresh)
    notes.push_back(
        format("These directions leave much open: the cells' root mean square uncertainty is a factor of %.2f, of %.2f "
               "without any measurement. brdf-fit --plan N with this table names the directions that would add most.",
               std::exp(left), std::exp(fresh)));
  const char* colour[] = {"red", "green", "blue"};
  if (options.energy)
    notes.push_back(format("It reflects at most %.3f of the light (%s, at %.0f degrees)%s.", out.energy.most,
                           bands == 1 ? "grey" : colour[out.energy.channel], out.energy.theta_rad / degree,
                           out.energy.most <= 1 ? ": energy is conserved" : ": more than arrives"));
  notes.push_back("phi_d and pi - phi_d are the same cell: the table is reciprocal and has no handedness.");
}

}  // namespace

Observed observe(const Basis& basis, const Samples& samples, std::size_t band, const ReconstructOptions& options,
                 std::vector<Dropped>& dropped) {
  std::vector<std::size_t> rows;
  const auto place = [&](std::size_t r) {
    return r < samples.place.size() ? samples.place[r] : samples.name + ":" + std::to_string(r);
  };
  const auto sigma_of = [&](std::size_t i) {
    return samples.sigma.empty() ? options.relative_noise * std::abs(samples.f[i]) : samples.sigma[i];
  };
  for (std::size_t r = 0; r < samples.rows(); ++r) {
    const std::size_t i = r * samples.bands() + band;
    const double f = samples.f[i];
    const char* reason = nullptr;
    if (!(samples.wi[r].z > 0 && samples.wo[r].z > 0))
      reason = "below the horizon";
    else if (!std::isfinite(f))
      continue;  // dropped before
    else if (f < 0 && !(f > -5 * sigma_of(i) && !samples.sigma.empty()))
      reason = "negative reflectance";
    else if (!std::isfinite(sigma_of(i)) || sigma_of(i) < 0)
      reason = "no standard deviation";
    if (reason)
      dropped.push_back({place(r), reason});
    else
      rows.push_back(r);
  }
  const auto k = static_cast<Eigen::Index>(basis.components()), m = static_cast<Eigen::Index>(rows.size());
  Observed o{Eigen::MatrixXd::Zero(m, k), Eigen::VectorXd(m), Eigen::VectorXd(m), Eigen::VectorXd(m), {}};
  for (Eigen::Index row = 0; row < m; ++row) {
    const std::size_t r = rows[static_cast<std::size_t>(row)], i = r * samples.bands() + band;
    const Cells::Blend blend = basis.cells().blend(samples.wo[r], samples.wi[r]);
    const double w = cosine_weight(samples.wi[r], samples.wo[r]);
    double level = 0, rest = 0;
    for (std::size_t c = 0; c < blend.cell.size(); ++c) {
      const auto cell = blend.cell[c];
      level += blend.share[c] * static_cast<double>(basis.log_reference()[cell] + basis.mean()[cell]);
      rest += blend.share[c] * static_cast<double>(basis.rest()[cell]);
      const auto q = basis.q(cell);
      for (Eigen::Index j = 0; j < k; ++j)
        o.q(row, j) += blend.share[c] * static_cast<double>(q[static_cast<std::size_t>(j)]);
    }
    o.y[row] = log_level(samples.f[i], w) - level;
    const double noise = sigma_of(i) * level_slope(samples.f[i], w);
    o.own[row] = noise * noise;
    o.noise[row] = noise * noise + rest * rest + 1e-12;
    o.blend.push_back(blend);
  }
  return o;
}

Energy energy_of(const io::MerlTable& table) {
  // Dark enough to pass the limits of a table to be rendered, whatever it holds: pi times its largest number is
  // below 1.
  const float largest = std::max(1e-30F, *std::ranges::max_element(table.brdf_per_sr)), scale = 0.1F / largest;
  io::MerlTable dark = table;
  for (float& f : dark.brdf_per_sr) f = f >= 0 ? f * scale : f;
  const surface::MeasuredTable measured(std::move(dark), "table");
  Energy energy;
  for (int step = 0; step < 48; ++step) {
    const double theta = (step + 0.5) * pi / 2 / 48;
    const Rgb albedo = measured.albedo({std::sin(theta), 0, std::cos(theta)}) / static_cast<double>(scale);
    for (int band = 0; band < 3; ++band)
      if (albedo[band] > energy.most) energy = {albedo[band], theta, band};
  }
  return energy;
}

// With E = exp(z sigma_ln): f E + (epsilon / w) (E - 1), and epsilon / w = sigma / sigma_ln - f.
CellInterval interval(const Reconstruction& reconstruction, std::size_t place, std::size_t band, double z) {
  const std::size_t at = 3 * place + band;
  const auto f = static_cast<double>(reconstruction.table.brdf_per_sr.at(at));
  const auto sigma_ln = static_cast<double>(reconstruction.sigma_ln.at(at));
  if (f < 0 || !(sigma_ln > 0)) return {f, f};
  const double floor = std::max(0.0, static_cast<double>(reconstruction.sigma.brdf_per_sr.at(at)) / sigma_ln - f);
  const double up = std::exp(z * sigma_ln);
  return {std::max(0.0, f / up - floor * (1 - 1 / up)), f * up + floor * (up - 1)};
}

Reconstruction reconstruct(const Basis& basis, const Samples& given, const ReconstructOptions& options) {
  Reconstruction out;
  const Samples samples = rgb_of_bands(given, out.notes);
  std::vector<Solved> solved;
  for (std::size_t band = 0; band < samples.bands(); ++band) {
    std::vector<Dropped> dropped;
    const Observed o = observe(basis, samples, band, options, dropped);
    if (band == 0) out.dropped = std::move(dropped);
    if (o.y.size() == 0)
      throw Error(Exit::data, samples.name, "leaves no usable sample in band \"" + samples.band_name[band] + "\"",
                  "directions above the horizon with finite reflectances are needed");
    const Prior prior = standard_prior(basis.components());
    const PriorScales scales = likely_scales(o, prior, o.y);
    const Estimator e = estimator(scaled(o, scales), scaled(prior, scales), options, basis.samples());
    const Eigen::VectorXd c = e.gain * o.y;
    ChannelFit& fit = out.channels[band];
    fit.scores.assign(c.data(), c.data() + c.size());
    fit.observations = static_cast<std::size_t>(o.y.size());
    fit.chi2 = chi2_of(o, prior, o.y);
    fit.misfit = std::sqrt(scales.noise);
    fit.excess = std::sqrt(scales.prior);
    fit.rms_ln = (o.y - o.q * c).norm() / std::sqrt(static_cast<double>(o.y.size()));
    if (options.uncertainty && options.calibrate && band == samples.bands() / 2) {
      const Calibration calibration = calibrate(basis, o, options);
      out.widenings = calibration.widening;
      out.widening = out.widenings.typical();
      out.covered = calibration.covered;
    }
    solved.push_back({c, e.factor, fit.misfit});
  }
  const Mapped mapped = map_cells(basis, solved, options.uncertainty);
  for (std::size_t band = 0; band < solved.size(); ++band)
    out.channels[band].open_ln = open_of(mapped, band, solved.size());
  if (samples.bands() == 1) out.channels[1] = out.channels[2] = out.channels[0];
  fill_tables(basis, mapped, solved.size(), out);
  if (options.energy) out.energy = energy_of(out.table);
  judge(basis, options, solved.size(), out);
  return out;
}

}  // namespace gonio::goniometry
