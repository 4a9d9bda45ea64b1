// See sample_table.h.
#include "goniometry/tables/sample_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/table.h"

namespace gonio::goniometry {
namespace {

double zenith_of(Vec3 w) {
  return std::acos(std::clamp(w.z, -1.0, 1.0));
}
double azimuth_of(Vec3 w) {
  return std::hypot(w.x, w.y) > 1e-12 ? std::atan2(w.y, w.x) : 0;
}

// As the reader of the table will order them.
std::vector<std::size_t> order_of_bands(const Samples& samples) {
  std::vector<std::size_t> order(samples.bands());
  std::iota(order.begin(), order.end(), 0);
  if (!samples.band_m.empty())
    std::ranges::stable_sort(order, {}, [&](std::size_t band) { return samples.band_m[band]; });
  return order;
}

// Colours of the fit in all bands; the surface itself has room for three.
void enter_colours(const Outcome& outcome, manifest::Table& table) {
  const Fit* fit = outcome.chosen();
  const Samples& samples = outcome.read.samples;
  if (fit == nullptr || (samples.bands() <= 3 && samples.band_m.empty())) return;
  for (const auto& info : fit->model->info().parameters) {
    if (!info.rgb) continue;
    std::vector<double> values, sigmas;
    for (const std::size_t band : order_of_bands(samples)) {
      const FittedNumber* number = fit->number(info.name, band);
      if (number == nullptr) break;
      values.push_back(number->value);
      if (std::isfinite(number->sigma)) sigmas.push_back(number->sigma);
    }
    if (values.size() != samples.bands()) continue;
    table.parameters[info.name] = manifest::Parameter(values);
    if (sigmas.size() == values.size()) table.sigmas[info.name] = sigmas;
  }
}

}  // namespace

bool describes_itself(const std::filesystem::path& path) {
  return path.extension() == ".brdf" || path.extension() == ".binary";
}

manifest::Table sample_table(const Samples& samples) {
  manifest::Table table;
  const bool wavelengths = !samples.band_m.empty(), channels = !wavelengths && samples.bands() > 1,
             noise = !samples.sigma.empty();
  table.model = "surface";
  table.columns = {{"theta_i", "rad"}, {"phi_i", "rad"}, {"theta_o", "rad"}, {"phi_o", "rad"}};
  if (wavelengths) table.columns.emplace_back("wavelength_m", "m");
  if (channels) table.columns.emplace_back("channel", "1");
  table.columns.emplace_back("f", "1/sr");
  if (noise) table.columns.emplace_back("f_sigma", "1/sr"), table.sigma = {"f_sigma"};
  table.observed = {"f"};
  table.rows = manifest::Value::array();
  for (std::size_t r = 0; r < samples.rows(); ++r)
    for (std::size_t b = 0; b < samples.bands(); ++b) {
      const std::size_t at = r * samples.bands() + b;
      if (!std::isfinite(samples.f[at])) continue;
      std::vector<double> row = {zenith_of(samples.wi[r]), azimuth_of(samples.wi[r]), zenith_of(samples.wo[r]),
                                 azimuth_of(samples.wo[r])};
      if (wavelengths) row.push_back(samples.band_m[b]);
      if (channels) row.push_back(static_cast<double>(b));
      row.push_back(samples.f[at]);
      if (noise) row.push_back(samples.sigma[at]);
      table.rows.push_back(manifest::Value(row));
    }
  return table;
}

void enter_table(manifest::Document& document, const Outcome& outcome) {
  if (!document.surfaces.contains(outcome.name)) return;
  if (!outcome.table_name.empty()) {
    document.tables.at(outcome.table_name).surface = outcome.name;
    return;
  }
  manifest::Table table;
  if (outcome.file.empty()) {
    table = sample_table(outcome.read.samples);
  } else {
    table.model = "surface", table.observed = {"f"};
    table.file = manifest::add_file(document, outcome.file, file_stem(outcome.file.stem().string()));
  }
  table.surface = outcome.name;
  enter_colours(outcome, table);
  document.tables[outcome.name] = std::move(table);
}

}  // namespace gonio::goniometry
