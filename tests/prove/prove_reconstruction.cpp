// Reconstruction from few directions of materials that the basis has not seen: every material of the published fits
// (tests/goniometry/reconstruction/published_fits.h) is left out, reconstructed from n planned directions by a basis of
// the others, and compared cell by cell. Measured-like, not measured: smooth models fitted to measurements.
//   prove-reconstruction DATA FOLDER: writes errors.csv, spread.csv, plans.csv and index.html; prints what was found.
// Bins: 90 of theta_h as in the database, because lobes need them, and 18 x 24 of theta_d and phi_d, along which tables
// are smooth. Directions are planned once, on the basis of all materials.
// Error: root mean square over cells of the difference of log1p(100 f cos_i cos_o), mean of channels; and of log10 f.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/text.h"
#include "goniometry/plan.h"
#include "goniometry/reconstruct/reconstruction.h"
#include "goniometry/reconstruction/published_fits.h"
#include "report/page.h"
#include "stats/intervals.h"

namespace {

using namespace gonio;
using goniometry::Basis;
using goniometry::Cells;
using goniometry::Material;
using goniometry::PlannedPair;
using goniometry::PlanOptions;
using goniometry::ReconstructOptions;
using goniometry::Samples;
using Method = ReconstructOptions::Method;

constexpr goniometry::Bins bins = {90, 18, 24};
constexpr std::size_t counts[] = {1, 2, 5, 10, 20};
constexpr double noise = 0.02;

struct Score {
  double log1p = 0, decades = 0, covered = 0, widening = 1;
};

Samples measure(const Material& material, const std::vector<PlannedPair>& pairs, std::uint64_t seed) {
  Samples samples{.name = material.name, .band_name = {"r", "g", "b"}};
  Random random(11, seed);
  for (const PlannedPair& pair : pairs) {
    samples.wi.push_back(pair.wi());
    samples.wo.push_back(pair.wo());
    const Rgb f = material.brdf(pair.wo(), pair.wi());
    for (int band = 0; band < 3; ++band) {
      samples.f.push_back(f[band] * (1 + noise * random.normal()));
      samples.sigma.push_back(f[band] * noise);
    }
  }
  return samples;
}

// Cells above 80 degrees are left out: a goniometer does not see them, and fits were not made for them.
struct Place {
  std::size_t place;
  Vec3 wo, wi;
};
std::vector<Place> compared_cells(const Cells& cells) {
  const double least = std::cos(80 * pi / 180);
  std::vector<Place> places;
  for (std::size_t h = 0; h < bins[0]; ++h)
    for (std::size_t d = 0; d < bins[1]; ++d)
      for (std::size_t p = 0; p < bins[2] / 2; ++p) {
        const auto cell = cells.cell_of(h, d, p);
        if (cell == Cells::none) continue;
        const auto [wo, wi] = cells.directions(cell);
        if (wo.z >= least && wi.z >= least) places.push_back({(h * bins[1] + d) * bins[2] + p, wo, wi});
      }
  return places;
}

Score compare(const Material& truth, const goniometry::Reconstruction& out, const std::vector<Place>& places) {
  double log1p = 0, decades = 0;
  std::size_t covered = 0, all = 0;
  for (const Place& at : places) {
    const Rgb f = truth.brdf(at.wo, at.wi);
    const double cosines = at.wo.z * at.wi.z, w = goniometry::cosine_weight(at.wi, at.wo);
    for (int band = 0; band < 3; ++band) {
      const std::size_t i = 3 * at.place + band;
      const double g = out.table.brdf_per_sr[i];
      log1p += std::pow(std::log1p(100 * f[band] * cosines) - std::log1p(100 * g * cosines), 2);
      decades += std::pow(std::log10(std::max(f[band], 1e-4) / std::max(g, 1e-4)), 2);
      if (!out.sigma_ln.empty())
        covered += std::abs(goniometry::log_level(f[band], w) - goniometry::log_level(g, w)) <= 1.96 * out.sigma_ln[i];
      ++all;
    }
  }
  const auto n = static_cast<double>(all);
  return {std::sqrt(log1p / n), std::sqrt(decades / n), static_cast<double>(covered) / n, out.widening};
}

struct Way {
  const char* name;
  Method method;
  bool builtin;
};
constexpr Way ways[] = {{"MAP, noise-weighted", Method::map, false},
                        {"Tikhonov, eta 40", Method::tikhonov, false},
                        {"MAP, built-in basis", Method::map, true}};

using Errors = std::vector<std::vector<std::vector<Score>>>;  // way, count, material

Errors leave_out_in_turn(const std::vector<Material>& materials, const std::vector<std::vector<PlannedPair>>& plans,
                         const Basis& builtin, const std::vector<Place>& places) {
  Errors errors(std::size(ways), std::vector<std::vector<Score>>(std::size(counts)));
  for (std::size_t m = 0; m < materials.size(); ++m) {
    auto others = materials;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(m));
    const Basis without(*goniometry::tables_of(others, bins), "published fits of other materials");
    for (std::size_t n = 0; n < std::size(counts); ++n) {
      const Samples samples = measure(materials[m], plans[n], m);
      for (std::size_t w = 0; w < std::size(ways); ++w) {
        ReconstructOptions options;
        options.method = ways[w].method;
        options.energy = false;
        options.uncertainty = options.calibrate = ways[w].method == Method::map;
        const auto out = reconstruct(ways[w].builtin ? builtin : without, samples, options);
        errors[w][n].push_back(compare(materials[m], out, places));
      }
    }
    std::fprintf(stderr, "\r%zu of %zu materials", m + 1, materials.size());
  }
  std::fprintf(stderr, "\n");
  return errors;
}

std::vector<double> of(const std::vector<Score>& scores, double Score::*member) {
  std::vector<double> values;
  for (const Score& s : scores) values.push_back(s.*member);
  return values;
}

struct Spread {
  std::string name;
  double decades = 0, log1p = 0;
};
// Both papers' fits of the same material, over the cells up to 80 degrees.
std::vector<Spread> spread_between(const std::vector<Material>& bagher, const std::vector<Material>& low,
                                   const std::vector<Place>& places) {
  std::vector<Spread> spreads;
  for (const Material& a : bagher)
    for (const Material& b : low) {
      if (a.name != b.name) continue;
      Spread spread{a.name};
      for (const Place& at : places) {
        const Rgb fa = a.brdf(at.wo, at.wi), fb = b.brdf(at.wo, at.wi);
        for (int band = 0; band < 3; ++band) {
          const double scale = 100 * at.wo.z * at.wi.z;
          spread.decades += std::pow(std::log10(std::max(fa[band], 1e-4) / std::max(fb[band], 1e-4)), 2);
          spread.log1p += std::pow(std::log1p(scale * fa[band]) - std::log1p(scale * fb[band]), 2);
        }
      }
      const auto n = static_cast<double>(3 * places.size());
      spreads.push_back({a.name, std::sqrt(spread.decades / n), std::sqrt(spread.log1p / n)});
    }
  return spreads;
}

std::string errors_csv(const std::vector<std::string>& names, const Errors& errors) {
  std::string text = "material,way,directions,rms_log1p,rms_decades,covered,widening\n";
  for (std::size_t m = 0; m < names.size(); ++m)
    for (std::size_t w = 0; w < std::size(ways); ++w)
      for (std::size_t n = 0; n < std::size(counts); ++n) {
        const Score& s = errors[w][n][m];
        text += names[m] + ",\"" + ways[w].name + "\"," + std::to_string(counts[n]) +
                format(",%.5f,%.5f,", s.log1p, s.decades) +
                (ways[w].method == Method::map ? format("%.4f,%.3f\n", s.covered, s.widening) : ",\n");
      }
  return text;
}

report::Plot error_plot(const Errors& errors, double Score::*member, const std::string& label) {
  report::Plot plot{.title = "Error of materials left out", .x_label = "directions", .y_label = label};
  plot.log_x = plot.log_y = true;
  for (std::size_t w = 0; w < std::size(ways); ++w)
    for (const auto& [quantile, words] : {std::pair{0.5, "median"}, {0.9, "90 %"}}) {
      report::Series series{.kind = report::Series::Kind::line, .name = std::string(ways[w].name) + ", " + words};
      for (std::size_t n = 0; n < std::size(counts); ++n) {
        series.x.push_back(static_cast<double>(counts[n]));
        series.y.push_back(stats::quantile(of(errors[w][n], member), quantile));
      }
      plot.series.push_back(series);
    }
  return plot;
}

report::Plot materials_plot(const Errors& errors, std::size_t way) {
  report::Plot plot{.title = std::string("Every material: ") + ways[way].name,
                    .x_label = "directions",
                    .y_label = "rms of log1p(100 f cos cos)"};
  plot.log_x = plot.log_y = true;
  for (std::size_t m = 0; m < errors[way][0].size(); ++m) {
    report::Series series{.kind = report::Series::Kind::line, .style = 0};
    for (std::size_t n = 0; n < std::size(counts); ++n) {
      series.x.push_back(static_cast<double>(counts[n]));
      series.y.push_back(errors[way][n][m].log1p);
    }
    plot.series.push_back(series);
  }
  return plot;
}

report::TableText materials_table(const std::vector<std::string>& names, const Errors& errors) {
  report::TableText table{.caption = "rms of log1p(100 f cos cos): MAP | Tikhonov | MAP with the built-in basis"};
  table.columns.push_back({"material", "", false});
  for (const std::size_t n : counts) table.columns.push_back({std::to_string(n), "", false});
  for (std::size_t m = 0; m < names.size(); ++m) {
    std::vector<std::string> row = {names[m]};
    for (std::size_t n = 0; n < std::size(counts); ++n)
      row.push_back(format("%.3f | %.3f | %.3f", errors[0][n][m].log1p, errors[1][n][m].log1p, errors[2][n][m].log1p));
    table.rows.push_back(row);
  }
  return table;
}

// Criteria of plans held against the error that they lead to: materials of the basis' own kind, drawn anew.
std::string compare_plans(const Basis& basis, const std::vector<Material>& materials, const std::vector<Place>& places,
                          double& average_error, double& random_error) {
  std::string text = "criterion,directions,predicted_sigma_ln,condition,median_rms_log1p\n";
  const std::pair<const char*, PlanOptions::Criterion> criteria[] = {
      {"average", PlanOptions::Criterion::average},
      {"determinant", PlanOptions::Criterion::determinant},
      {"condition", PlanOptions::Criterion::condition}};
  const auto tell = [&](const char* name, const std::vector<PlannedPair>& pairs) {
    std::vector<double> errors;
    ReconstructOptions options;
    options.uncertainty = options.energy = false;
    for (std::size_t m = 0; m < materials.size(); ++m)
      errors.push_back(
          compare(materials[m], reconstruct(basis, measure(materials[m], pairs, m), options), places).log1p);
    const auto quality = plan_quality(basis, pairs);
    text += name +
            format(",%zu,%.4f,%.1f,%.4f\n", pairs.size(), quality.sigma_ln, quality.condition, stats::median(errors));
    return stats::median(errors);
  };
  Random random(23);
  const double most = 80 * pi / 180;
  for (const std::size_t n : {5u, 10u, 20u}) {
    for (const auto& [name, criterion] : criteria) {
      PlanOptions options;
      options.criterion = criterion;
      const double error = tell(name, goniometry::plan(basis, n, options).pairs);
      if (criterion == PlanOptions::Criterion::average && n == 10) average_error = error;
    }
    std::vector<double> chance;
    for (int repeat = 0; repeat < 5; ++repeat) {
      std::vector<PlannedPair> pairs;
      for (std::size_t i = 0; i < n; ++i)
        pairs.push_back({std::acos(random.uniform(std::cos(most), 1)), 0, std::acos(random.uniform(std::cos(most), 1)),
                         random.uniform(0, pi)});
      chance.push_back(tell("random", pairs));
    }
    if (n == 10) random_error = stats::median(chance);
  }
  return text;
}

bool claim(const std::string& what, double measured, const char* relation, double required) {
  const bool met = relation[0] == '<' ? measured <= required : measured >= required;
  std::printf("%s: measured %.4f, required %s %.4f%s\n", what.c_str(), measured, relation, required,
              met ? "" : "  NOT MET");
  return met;
}

struct Study {
  std::vector<std::string> names;
  std::vector<Spread> spreads;
  Errors errors;
};

void write_page(const Study& study, const std::filesystem::path& folder) {
  const std::vector<double> map20 = of(study.errors[0][4], &Score::log1p), map1 = of(study.errors[0][0], &Score::log1p);
  std::vector<double> spread;
  for (const Spread& s : study.spreads) spread.push_back(s.decades);
  report::Page page("Reconstruction from few directions",
                    format("From 20 directions, materials that the basis has not seen come back to %.3f (median rms of "
                           "log1p), from one to %.3f",
                           stats::median(map20), stats::median(map1)),
                    "Published fits of MERL materials as measured-like truth, each left out in turn; 2 % noise; cells "
                    "up to 80 degrees of a 90 x 18 x 24 table.");
  page.section("Error over the number of directions");
  page.plots({error_plot(study.errors, &Score::log1p, "rms of log1p(100 f cos cos)"),
              error_plot(study.errors, &Score::decades, "rms of log10 f")});
  page.plots({materials_plot(study.errors, 0), materials_plot(study.errors, 2)});
  page.section("Every material");
  page.table(materials_table(study.names, study.errors));
  page.section("The two papers' fits of the same material");
  page.paragraph(format("Rms of log10 of their ratio over all cells: median %.3f, between %.3f and %.3f decades.",
                        stats::median(spread), stats::quantile(spread, 0), stats::quantile(spread, 1)));
  report::TableText table{.columns = {{"material", "", false}, {"rms", "decades"}, {"rms of log1p", ""}}};
  for (const Spread& s : study.spreads)
    table.rows.push_back({s.name, format("%.3f", s.decades), format("%.3f", s.log1p)});
  page.table(table);
  write_file(folder / "index.html", page.html());
}

int run(const std::filesystem::path& fits, const std::filesystem::path& folder) {
  make_folder(folder);
  const auto bagher = tests::materials_of(tests::read_bagher_fits(fits / "merl_sgd_fits_bagher2012.csv"));
  const auto low = tests::materials_of(tests::read_low_fits(fits / "merl_abc_fits_low2012.csv"));
  const Basis all(*goniometry::tables_of(bagher, bins), "Bagher's fits");
  const Basis builtin = goniometry::builtin_basis({.bins = bins});
  const auto places = compared_cells(all.cells());
  std::vector<std::vector<PlannedPair>> plans;
  for (const std::size_t n : counts) plans.push_back(goniometry::plan(all, n).pairs);

  Study study;
  for (const Material& m : bagher) study.names.push_back(m.name);
  study.spreads = spread_between(bagher, low, places);
  study.errors = leave_out_in_turn(bagher, plans, builtin, places);
  std::string spread_csv = "material,rms_decades,rms_log1p\n";
  std::vector<double> spread;
  for (const Spread& s : study.spreads) {
    spread_csv += s.name + format(",%.4f,%.4f\n", s.decades, s.log1p);
    spread.push_back(s.decades);
  }
  double average_error = 0, random_error = 0;
  const std::string plans_csv = compare_plans(builtin, low, places, average_error, random_error);
  write_file(folder / "errors.csv", errors_csv(study.names, study.errors));
  write_file(folder / "spread.csv", spread_csv);
  write_file(folder / "plans.csv", plans_csv);
  write_page(study, folder);

  std::printf("%zu materials of both papers: rms of log10 of their ratio, median %.3f, %.3f to %.3f decades\n",
              spread.size(), stats::median(spread), stats::quantile(spread, 0), stats::quantile(spread, 1));
  std::printf("%-22s %10s %12s %12s %12s %10s\n", "way", "directions", "median log1p", "90 % log1p", "median dec.",
              "covered");
  for (std::size_t w = 0; w < std::size(ways); ++w)
    for (std::size_t n = 0; n < std::size(counts); ++n) {
      const auto errors = of(study.errors[w][n], &Score::log1p);
      std::printf("%-22s %10zu %12.4f %12.4f %12.4f %10s\n", ways[w].name, counts[n], stats::median(errors),
                  stats::quantile(errors, 0.9), stats::median(of(study.errors[w][n], &Score::decades)),
                  ways[w].method == Method::map
                      ? format("%.3f", stats::mean(of(study.errors[w][n], &Score::covered))).c_str()
                      : "-");
    }
  std::fputs(plans_csv.c_str(), stdout);
  const auto median_error = [&](std::size_t w, std::size_t n) {
    return stats::median(of(study.errors[w][n], &Score::log1p));
  };
  bool met = true;
  met &= claim("error of 20 directions over that of 1 (MAP)", median_error(0, 4) / median_error(0, 0), "<", 0.6);
  met &= claim("error of MAP over that of Tikhonov, 20 directions", median_error(0, 4) / median_error(1, 4), "<", 1.02);
  met &= claim("error of planned over random directions (10, built-in)", average_error / random_error, "<", 1);
  const double covered = stats::mean(of(study.errors[0][4], &Score::covered));
  met &= claim("95 % intervals cover, 20 directions", covered, ">", 0.90);
  met &= claim("95 % intervals cover, 20 directions", covered, "<", 0.985);
  return met ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return argc == 3 ? run(argv[1], argv[2]) : 64;
}
