// See spectra.h.
#include "goniometry/spectra.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "goniometry/document.h"
#include "report/number_text.h"

namespace gonio::goniometry {
namespace {

constexpr std::size_t few = 3;

bool by_wavelength(const Samples& s) {
  return s.band_m.size() == s.bands();
}

double abscissa(const Samples& s, std::size_t band) {
  return by_wavelength(s) ? s.band_m[band] * 1e9 : static_cast<double>(band + 1);
}

std::string abscissa_label(const Samples& s) {
  return by_wavelength(s) ? "wavelength / nm" : "band";
}

// Bands from short to long waves.
std::vector<std::size_t> in_order(const Samples& s) {
  std::vector<std::size_t> order(s.bands());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t b) { return abscissa(s, b); });
  return order;
}

report::Plot spectrum(const Outcome& outcome, const Fit& fit, const manifest::ParameterInfo& info) {
  const Samples& s = outcome.read.samples;
  report::Series range{.kind = report::Series::Kind::band, .name = "95 % interval", .style = 0},
      value{.kind = report::Series::Kind::line, .name = info.name, .style = 0},
      bound{.kind = report::Series::Kind::points, .name = "at a bound", .style = 1};
  for (const std::size_t b : in_order(s)) {
    const FittedNumber* n = fit.number(info.name, b);
    if (n == nullptr) continue;
    const double x = abscissa(s, b);
    value.x.push_back(x), value.y.push_back(n->value);
    range.x.push_back(x), range.y.push_back((n->low + n->high) / 2), range.sigma.push_back((n->high - n->low) / 2);
    if (n->at != FittedNumber::At::inside) bound.x.push_back(x), bound.y.push_back(n->value);
  }
  report::Plot plot{.title = info.name + " of the bands",
                    .caption =
                        "As fitted, all bands at once, with 95 % intervals of each band alone; their "
                        "correlations are in the manifest.",
                    .x_label = abscissa_label(s),
                    .y_label = info.name + (info.unit == "1" ? "" : " / " + info.unit),
                    .series = {std::move(range), std::move(value)},
                    .zero_y = true};
  if (!bound.x.empty()) plot.series.push_back(std::move(bound));
  return plot;
}

std::string interval_text(const FittedNumber& n) {
  return report::number_text(n.low, 3) + " to " + report::number_text(n.high, 3);
}

std::string at_text(const FittedNumber& n) {
  return n.at == FittedNumber::At::inside ? "" : n.at == FittedNumber::At::lower ? "lower" : "upper";
}

}  // namespace

bool has_spectra(const Outcome& outcome) {
  return outcome.chosen() != nullptr && outcome.read.samples.bands() > few;
}

std::vector<Spectrum> spectra_of(const Outcome& outcome) {
  std::vector<Spectrum> spectra;
  if (!has_spectra(outcome)) return spectra;
  const Fit& fit = *outcome.chosen();
  for (const auto& info : fit.model->info().parameters)
    if (fit.number(info.name, 0) != nullptr) spectra.push_back({info.name, spectrum(outcome, fit, info)});
  return spectra;
}

report::Plot band_error_plot(const Outcome& outcome) {
  const Samples& s = outcome.read.samples;
  report::Series error{.kind = report::Series::Kind::line};
  if (const Fit* fit = outcome.chosen(); fit != nullptr && fit->band_log1p.size() == s.bands())
    for (const std::size_t b : in_order(s)) error.x.push_back(abscissa(s, b)), error.y.push_back(fit->band_log1p[b]);
  return {.title = "Error of the bands",
          .caption = "Root mean square of measured minus fitted.",
          .x_label = abscissa_label(s),
          .y_label = "rms of log(1 + 100 f cos cos)",
          .series = {std::move(error)},
          .zero_y = true};
}

std::string numbers_csv(const Outcome& outcome) {
  const Samples& s = outcome.read.samples;
  std::string out = "number,band,wavelength_m,value,sigma,low,high,bound\n";
  const Fit* fit = outcome.chosen();
  if (fit == nullptr) return out;
  for (const FittedNumber& n : fit->numbers) {
    const bool shared = n.band == whole_sample;
    out += n.name + "," + (shared ? "" : quoted(s.band_name[n.band])) + ",";
    out += shared || !by_wavelength(s) ? "," : format("%.6g,", s.band_m[n.band]);
    out += format("%.9g,", n.value) + (std::isfinite(n.sigma) ? format("%.4g", n.sigma) : "");
    out += format(",%.6g,%.6g,", n.low, n.high) + at_text(n) + "\n";
  }
  return out;
}

std::vector<std::string> bound_notes(const Outcome& outcome, const Fit& fit) {
  const Samples& s = outcome.read.samples;
  std::vector<std::string> notes;
  for (const auto& info : fit.model->info().parameters)
    for (const auto at : {FittedNumber::At::lower, FittedNumber::At::upper}) {
      std::vector<const FittedNumber*> there;
      for (const FittedNumber& n : fit.numbers)
        if (n.name == info.name && n.at == at) there.push_back(&n);
      const std::string where = at == FittedNumber::At::lower ? "its lower bound" : "its upper bound";
      if (there.size() <= few) {
        for (const FittedNumber* n : there)
          notes.push_back(number_name(*n, s) + " is at " + where + "; 95 % interval " + interval_text(*n) + ".");
        continue;
      }
      std::string bands;
      for (const FittedNumber* n : there) bands += (bands.empty() ? "" : ", ") + s.band_name[n->band];
      notes.push_back(info.name + " is at " + where + " in " + std::to_string(there.size()) + " of " +
                      std::to_string(s.bands()) + " bands: " + bands + ".");
    }
  return notes;
}

}  // namespace gonio::goniometry
