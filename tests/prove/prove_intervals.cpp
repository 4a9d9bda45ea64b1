// Whether 95 % intervals of reconstructed tables hold for materials that the basis has not seen, region by region.
//   prove-intervals FITS CORNELL ALUMINIUM FOLDER: writes intervals.csv; prints tables and holds claims.
// Truth: the published fits of MERL materials (tests/goniometry/reconstruction/published_fits.h), all cells up to 80
// degrees, from planned directions with 2 % of noise; three paints and aluminium as recorded, all rows but those taken
// as samples, the nearest to planned directions, or random ones. What a row errs itself is told by the recording: rows
// with light and eye exchanged (within 1.6 degrees, off the lobe) should be equal; half of their mean squared
// difference is the variance of a row. Bases: the built-in one, which knows neither these materials nor the papers'
// models; the fits of the other materials, as a user's own folder would be. Nothing here is used to choose or to
// calibrate how wide intervals are. Regions: theta_h up to 5, 20, 45, 90 degrees, theta_d up to 30, 60, 90 degrees.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/atomic_file.h"
#include "base/random.h"
#include "base/text.h"
#include "geom/angle.h"
#include "goniometry/plan.h"
#include "goniometry/reconstruct/reconstruction.h"
#include "goniometry/reconstruction/published_fits.h"
#include "goniometry/tables/tables.h"
#include "stats/intervals.h"
#include "surface/half_angle.h"

namespace {

using namespace gonio;
using goniometry::Basis;
using goniometry::Cells;
using goniometry::Material;
using goniometry::PlannedPair;
using goniometry::Samples;

constexpr goniometry::Bins bins = {90, 18, 24};
constexpr std::size_t counts[] = {5, 10, 20};
constexpr double noise = 0.02, normal_95 = 1.96;
constexpr std::array<double, 4> edges_h = {5, 20, 45, 90};
constexpr std::array<double, 3> edges_d = {30, 60, 90};
constexpr std::size_t regions = edges_h.size() * edges_d.size();

// Three channels of every row.
struct Truth {
  std::string name;
  Samples samples;                 // all that is known
  std::vector<bool> measured;      // of them
  std::array<double, 3> row_ln{};  // what a row errs, standard deviation of ln(f w + epsilon)
};

std::size_t region_of(Vec3 wo, Vec3 wi) {
  const auto at = surface::half_angles(wo, wi);
  std::size_t h = 0, d = 0;
  while (h + 1 < edges_h.size() && at.theta_h > edges_h[h] * degree) ++h;
  while (d + 1 < edges_d.size() && at.theta_d > edges_d[d] * degree) ++d;
  return h * edges_d.size() + d;
}

struct Tally {
  double within = 0, all = 0;
  std::vector<double> ratios;
  void add(double ratio) {
    within += ratio <= normal_95;
    ++all;
    ratios.push_back(ratio);
  }
  double share() const { return all > 0 ? within / all : 1; }
};

struct Result {
  std::array<std::array<Tally, 3>, regions> tallies;
  std::vector<double> shares, widening, error;  // material by material
  Tally of_channel(std::size_t channel) const {
    Tally sum;
    for (const auto& region : tallies) {
      sum.within += region[channel].within, sum.all += region[channel].all;
      sum.ratios.insert(sum.ratios.end(), region[channel].ratios.begin(), region[channel].ratios.end());
    }
    return sum;
  }
  double all() const {
    double within = 0, count = 0;
    for (const auto& region : tallies)
      for (const Tally& t : region) within += t.within, count += t.all;
    return within / count;
  }
};

std::vector<std::size_t> places_of(const Cells& cells) {
  std::vector<std::size_t> places(cells.count());
  for (std::size_t place = 0; place < bins[0] * bins[1] * bins[2]; ++place)
    if (const auto cell = cells.cell_of(place / bins[2] / bins[1], place / bins[2] % bins[1], place % bins[2]);
        cell != Cells::none && place % bins[2] < (bins[2] + 1) / 2)
      places[cell] = place;
  return places;
}

// What of a truth was not measured, held against the reconstruction at the same directions.
void compare(const Basis& basis, const std::vector<std::size_t>& places, const Truth& truth,
             const goniometry::Reconstruction& out, Result& result) {
  Tally here;
  double squares = 0;
  for (std::size_t r = 0; r < truth.samples.rows(); ++r) {
    if (truth.measured[r]) continue;
    const Vec3 wo = truth.samples.wo[r], wi = truth.samples.wi[r];
    const Cells::Blend blend = basis.cells().blend(wo, wi);
    const double w = goniometry::cosine_weight(wi, wo);
    auto& region = result.tallies[region_of(wo, wi)];
    for (std::size_t band = 0; band < 3; ++band) {
      double level = 0, sigma = 0;
      for (std::size_t k = 0; k < blend.cell.size(); ++k) {
        const std::size_t at = 3 * places[blend.cell[k]] + band;
        level += blend.share[k] * goniometry::log_level(static_cast<double>(out.table.brdf_per_sr[at]),
                                                        basis.cells().weight(blend.cell[k]));
        sigma += blend.share[k] * static_cast<double>(out.sigma_ln[at]);
      }
      const double f = truth.samples.f[3 * r + band];
      const double ratio = std::abs(goniometry::log_level(f, w) - level) / std::hypot(sigma, truth.row_ln[band]);
      region[band].add(ratio);
      here.add(ratio);
      const double scale = 100 * wi.z * wo.z, g = goniometry::of_level(level, w);
      squares += std::pow(std::log1p(scale * f) - std::log1p(scale * g), 2);
    }
  }
  result.shares.push_back(here.share());
  result.widening.push_back(out.widening);
  result.error.push_back(std::sqrt(squares / here.all));
}

Samples rows_like(const Samples& all) {
  return {.name = all.name, .band_name = {"r", "g", "b"}};
}
void add_row(Samples& to, Vec3 wo, Vec3 wi, const std::array<double, 3>& f, double relative, Random& random) {
  to.wi.push_back(wi);
  to.wo.push_back(wo);
  for (const double value : f) {
    to.f.push_back(value * (1 + relative * random.normal()));
    to.sigma.push_back(value * noise);
  }
}

// A material as the middles of all cells up to 80 degrees.
Truth truth_of(const Material& material, const Cells& cells) {
  Truth truth{.name = material.name};
  truth.samples = rows_like({.name = material.name});
  Random none(0);
  for (std::size_t c = 0; c < cells.count(); ++c) {
    const auto [wo, wi] = cells.directions(c);
    if (std::min(wo.z, wi.z) < std::cos(80 * degree)) continue;
    const Rgb f = material.brdf(wo, wi);
    add_row(truth.samples, wo, wi, {f[0], f[1], f[2]}, 0, none);
  }
  truth.measured.assign(truth.samples.rows(), false);
  return truth;
}
Samples measure(const Material& material, const std::vector<PlannedPair>& pairs, std::uint64_t seed) {
  Samples samples = rows_like({.name = material.name});
  Random random(29, seed);
  for (const PlannedPair& pair : pairs) {
    const Rgb f = material.brdf(pair.wo(), pair.wi());
    add_row(samples, pair.wo(), pair.wi(), {f[0], f[1], f[2]}, noise, random);
  }
  return samples;
}

double distance(const Samples& a, std::size_t row, const PlannedPair& pair) {
  const auto p = surface::half_angles(a.wo[row], a.wi[row]), q = surface::half_angles(pair.wo(), pair.wi());
  const auto folded = [](double phi) { return std::abs(std::remainder(phi, pi)); };
  return std::pow(std::sqrt(p.theta_h) - std::sqrt(q.theta_h), 2) + std::pow(p.theta_d - q.theta_d, 2) +
         std::pow(std::sin(q.theta_d) * (folded(p.phi_d) - folded(q.phi_d)), 2);
}

// Rows that are taken as measured: the nearest to planned pairs, or, without pairs, `n` at random.
Samples choose(Truth& truth, const std::vector<PlannedPair>& pairs, std::size_t n, std::uint64_t seed) {
  Samples samples = rows_like(truth.samples);
  Random random(31, seed);
  truth.measured.assign(truth.samples.rows(), false);
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = random.below(static_cast<std::uint32_t>(truth.samples.rows()));
    if (!pairs.empty()) {
      double least = 1e9;
      for (std::size_t r = 0; r < truth.samples.rows(); ++r)
        if (const double d = distance(truth.samples, r, pairs[k]); !truth.measured[r] && d < least) best = r, least = d;
    }
    if (truth.measured[best]) continue;
    truth.measured[best] = true;
    const double* f = truth.samples.f.data() + 3 * best;
    const Vec3 wo = truth.samples.wo[best], wi = truth.samples.wi[best];
    add_row(samples, wo, wi, {f[0], f[1], f[2]}, 0, random);
    for (std::size_t band = 0; band < 3; ++band) {
      double& sigma = samples.sigma[samples.sigma.size() - 3 + band];
      sigma = std::max(sigma, truth.row_ln[band] / goniometry::level_slope(f[band], goniometry::cosine_weight(wi, wo)));
    }
  }
  return samples;
}

std::array<double, 3> row_noise(const Samples& samples) {
  constexpr double near = 1.6 * degree;
  const auto theta = [](Vec3 w) { return std::acos(std::min(w.z, 1.0)); };
  const auto turn = [&](std::size_t r) {
    const Vec3 i = samples.wi[r], o = samples.wo[r];
    return std::abs(std::atan2(i.x * o.y - i.y * o.x, i.x * o.x + i.y * o.y));
  };
  std::array<double, 3> squares{};
  double count = 0;
  for (std::size_t r = 0; r < samples.rows(); ++r)
    for (std::size_t k = 0; k < samples.rows(); ++k) {
      const double ti = theta(samples.wi[r]), to = theta(samples.wo[r]);
      if (ti <= to + near || std::abs(ti - theta(samples.wo[k])) > near || std::abs(to - theta(samples.wi[k])) > near ||
          std::abs(turn(r) - turn(k)) > near ||
          surface::half_angles(samples.wo[r], samples.wi[r]).theta_h < 20 * degree)
        continue;
      for (std::size_t band = 0; band < 3; ++band)
        squares[band] += std::pow(
            goniometry::log_level(samples.f[3 * r + band], goniometry::cosine_weight(samples.wi[r], samples.wo[r])) -
                goniometry::log_level(samples.f[3 * k + band], goniometry::cosine_weight(samples.wi[k], samples.wo[k])),
            2);
      ++count;
    }
  for (double& s : squares) s = count > 0 ? std::sqrt(s / count / 2) : noise;
  std::printf("%s: %.0f pairs of exchanged rows; a row errs by %.3f %.3f %.3f of ln(f w + 0.001)\n",
              samples.name.c_str(), count, squares[0], squares[1], squares[2]);
  return squares;
}

std::vector<Truth> recorded(const std::filesystem::path& cornell, const std::filesystem::path& aluminium) {
  std::vector<Truth> truths;
  const auto add = [&](const std::filesystem::path& file, const goniometry::TableOptions& options) {
    Samples all = read_table(file, options).samples;
    std::vector<std::string> notes;
    all = goniometry::rgb_of_bands(all, notes);
    Truth truth{.name = file.stem().string()};
    truth.samples = rows_like(all);
    Random none(0);
    for (std::size_t r = 0; r < all.rows(); ++r) {
      std::array<double, 3> f;
      for (std::size_t band = 0; band < 3; ++band) f[band] = all.f[r * all.bands() + (all.bands() == 1 ? 0 : band)];
      if (std::min(all.wi[r].z, all.wo[r].z) >= std::cos(80 * degree) && *std::ranges::min_element(f) > 0)
        add_row(truth.samples, all.wo[r], all.wi[r], f, 0, none);
    }
    truth.row_ln = row_noise(truth.samples);
    truths.push_back(truth);
  };
  for (const char* paint : {"garnet_red", "krylon_blue", "acryl_blue"})
    add(cornell / (std::string(paint) + ".brdf"), {});
  add(aluminium,
      {.columns = goniometry::parse_columns(
           "theta_i=phi_in:deg,phi_i=theta_in:deg,theta_o=phi_out:deg,phi_o=theta_out:deg,f=brdf", "study")});
  return truths;
}

void print(const std::string& set, std::size_t n, const Result& result, std::string& csv) {
  std::printf(
      "%-34s %3zu  all %5.1f %%  r g b %5.1f %5.1f %5.1f  materials %5.1f (10 %%) %5.1f (median)  widening %.2f"
      "  rms %.3f  q95/1.96 %.2f\n",
      set.c_str(), n, 100 * result.all(), 100 * result.of_channel(0).share(), 100 * result.of_channel(1).share(),
      100 * result.of_channel(2).share(), 100 * stats::quantile(result.shares, 0.1), 100 * stats::median(result.shares),
      stats::mean(result.widening), stats::median(result.error),
      stats::quantile(result.of_channel(1).ratios, 0.95) / normal_95);
  for (std::size_t region = 0; region < regions; ++region)
    for (std::size_t band = 0; band < 3; ++band) {
      const Tally& t = result.tallies[region][band];
      csv +=
          "\"" + set + "\"," +
          format("%zu,%g,%g,%s,%.0f,%.4f,%.3f\n", n, edges_h[region / edges_d.size()], edges_d[region % edges_d.size()],
                 band == 0   ? "r"
                 : band == 1 ? "g"
                             : "b",
                 t.all, t.share(), t.all > 0 ? stats::quantile(t.ratios, 0.95) / normal_95 : 0);
    }
}

void print_regions(const Result& result) {
  std::printf("  theta_h up to x theta_d up to, green, %% within and cells:");
  for (std::size_t region = 0; region < regions; ++region) {
    const Tally& t = result.tallies[region][1];
    if (region % edges_d.size() == 0) std::printf("\n  %4.0f:", edges_h[region / edges_d.size()]);
    std::printf("   %3.0f: %5.1f (%6.0f; %5.2f)", edges_d[region % edges_d.size()], 100 * t.share(), t.all,
                t.all > 0 ? stats::quantile(t.ratios, 0.95) / normal_95 : 0);
  }
  std::printf("\n");
}

bool claim(const std::string& what, double measured, double least, double most) {
  const bool met = measured >= least && measured <= most;
  std::printf("%s: measured %.3f, required %.3f to %.3f%s\n", what.c_str(), measured, least, most,
              met ? "" : "  NOT MET");
  return met;
}

// Every published fit by the built-in basis; each by a basis of all others.
Result of_materials(const std::vector<Material>& materials, const Basis& basis, std::size_t n) {
  Result result;
  const auto places = places_of(basis.cells());
  const auto pairs = goniometry::plan(basis, n).pairs;
  for (std::size_t m = 0; m < materials.size(); ++m)
    compare(basis, places, truth_of(materials[m], basis.cells()),
            reconstruct(basis, measure(materials[m], pairs, m), {.energy = false}), result);
  return result;
}
Result of_folder(const std::vector<Material>& materials, std::size_t n) {
  Result result;
  const Basis all(*goniometry::tables_of(materials, bins), "all");
  const auto places = places_of(all.cells());
  const auto pairs = goniometry::plan(all, n).pairs;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    auto others = materials;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(m));
    const Basis without(*goniometry::tables_of(others, bins), "others");
    compare(without, places, truth_of(materials[m], all.cells()),
            reconstruct(without, measure(materials[m], pairs, m), {.energy = false}), result);
  }
  return result;
}

int run(const std::filesystem::path& fits, const std::filesystem::path& cornell, const std::filesystem::path& aluminium,
        const std::filesystem::path& folder) {
  make_folder(folder);
  const auto bagher = tests::materials_of(tests::read_bagher_fits(fits / "merl_sgd_fits_bagher2012.csv"));
  const auto low = tests::materials_of(tests::read_low_fits(fits / "merl_abc_fits_low2012.csv"));
  const Basis builtin = goniometry::builtin_basis({.bins = bins});
  const auto places = places_of(builtin.cells());
  std::vector<Truth> rows = recorded(cornell, aluminium);
  std::string csv = "set,directions,theta_h_up_to,theta_d_up_to,channel,cells,covered,q95_over_1_96\n";
  bool met = true;
  const auto report = [&](const std::string& set, std::size_t n, const Result& result, double least, double most) {
    print(set, n, result, csv);
    if (least > 0)
      met &=
          claim("95 % intervals cover, " + set + ", " + std::to_string(n) + " directions", result.all(), least, most);
  };
  for (const std::size_t n : counts) {
    const Result first = of_materials(bagher, builtin, n), second = of_materials(low, builtin, n),
                 own = of_folder(bagher, n);
    report("Bagher's fits, built-in", n, first, 0.90, 0.985);
    print_regions(first);
    report("Low's fits, built-in", n, second, 0.90, 0.985);
    print_regions(second);
    report("Bagher's fits, own folder", n, own, 0.93, 0.97);
    print_regions(own);
    const auto pairs = goniometry::plan(builtin, n).pairs;
    for (Truth& truth : rows) {
      Result result, random;
      compare(builtin, places, truth, reconstruct(builtin, choose(truth, pairs, n, 0), {.energy = false}), result);
      for (std::uint64_t seed = 1; seed <= 8; ++seed)
        compare(builtin, places, truth, reconstruct(builtin, choose(truth, {}, n, seed), {.energy = false}), random);
      report(truth.name + ", built-in", n, result, 0.90, 1);
      report(truth.name + ", built-in, random rows", n, random, 0, 1);
    }
  }
  write_file(folder / "intervals.csv", csv);
  return met ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return argc == 5 ? run(argv[1], argv[2], argv[3], argv[4]) : 64;
}
