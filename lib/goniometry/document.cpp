// See document.h.
#include "goniometry/document.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "goniometry/fit/checks.h"
#include "goniometry/fit/plausible.h"
#include "goniometry/spectra.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "report/number_text.h"

namespace gonio::goniometry {
namespace {

constexpr double most_held_out_ratio = 1.5;
constexpr std::size_t most_in_covariance = 200;

std::string band_called(const Samples& samples, std::size_t band) {
  return band < samples.bands() ? samples.band_name[band] : std::to_string(band);
}

std::vector<double> components(const manifest::ParameterInfo& info, const Fit& fit, std::size_t place,
                               const std::array<std::size_t, 3>& bands) {
  if (info.components == 1) return {fit.triples.front().v[place].x};
  if (!info.rgb) {
    const Rgb v = fit.triples.front().v[place];
    return {v.x, v.y, v.z};
  }
  std::vector<double> out;
  for (const std::size_t b : bands) out.push_back(fit.triples[b / 3].v[place][static_cast<int>(b % 3)]);
  return out;
}

// One sigma, or one for each written band; empty where one of them is not known.
std::vector<double> sigmas(const manifest::ParameterInfo& info, const Fit& fit,
                           const std::array<std::size_t, 3>& bands) {
  std::vector<double> out;
  const auto add = [&](const FittedNumber* number) {
    if (number != nullptr && std::isfinite(number->sigma)) out.push_back(number->sigma);
  };
  if (!info.rgb) {
    add(fit.number(info.name));
    return out;
  }
  for (const std::size_t b : bands) add(fit.number(info.name, b));
  if (out.size() != 3) out.clear();
  return out;
}

manifest::Surface surface_of(const Outcome& outcome, const Fit& fit) {
  const auto bands = written_bands(outcome.read.samples);
  manifest::Surface surface;
  surface.model = fit.model->info().id;
  const auto& parameters = fit.model->info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    surface.parameters[parameters[i].name] = components(parameters[i], fit, i, bands);
    if (const auto s = sigmas(parameters[i], fit, bands); !s.empty()) surface.sigma[parameters[i].name] = s;
  }
  return surface;
}

// The whole; beyond most_in_covariance numbers, which a spectrum of hundreds of bands has, that of what all bands share
// and of the written bands.
manifest::Value covariance_of(const Outcome& outcome, const Fit& fit) {
  const std::size_t n = fit.numbers.size();
  if (fit.covariance.size() != n * n || n == 0) return {};
  const auto bands = written_bands(outcome.read.samples);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < n; ++i)
    if (n <= most_in_covariance || fit.numbers[i].band == whole_sample ||
        std::ranges::find(bands, fit.numbers[i].band) != bands.end())
      kept.push_back(i);
  std::vector<std::string> order;
  manifest::Value rows = manifest::Value::array();
  for (const std::size_t i : kept) {
    order.push_back(number_name(fit.numbers[i], outcome.read.samples));
    std::vector<double> row;
    for (const std::size_t k : kept) row.push_back(fit.covariance[i * n + k]);
    if (!std::ranges::all_of(row, [](double v) { return std::isfinite(v); })) return {};
    rows.push_back(manifest::Value(row));
  }
  return manifest::Value::object({{"order", manifest::Value(order)}, {"values", std::move(rows)}});
}

std::optional<double> finite(double v) {
  return std::isfinite(v) && v >= 0 ? std::optional(v) : std::nullopt;
}

void enter_fit(const Outcome& outcome, const Fit& fit, manifest::SurfaceFit& out) {
  const auto& parameters = fit.model->info().parameters;
  for (const auto& info : parameters) {
    std::vector<double> values, sigma;
    for (const FittedNumber& number : fit.numbers) {
      if (number.name != info.name) continue;
      values.push_back(number.value);
      if (std::isfinite(number.sigma)) sigma.push_back(number.sigma);
    }
    if (!values.empty()) out.parameters[info.name] = values;
    if (!sigma.empty() && sigma.size() == values.size()) out.sigma[info.name] = sigma;
  }
  out.model = fit.model->info().id;
  out.covariance = covariance_of(outcome, fit);
  out.rms = finite(fit.fitted.log1p), out.held_out_rms = finite(fit.held_out.log1p);
  out.rms_decades = finite(fit.fitted.decades);
  out.energy = finite(fit.energy), out.reciprocity = finite(fit.reciprocity);
  out.converged = fit.converged;
  for (std::string& note : bound_notes(outcome, fit)) out.notes.push_back(std::move(note));
  if (fit.numbers.size() > most_in_covariance)
    out.notes.push_back("Of the covariance of " + std::to_string(fit.numbers.size()) +
                        " numbers that of the written bands is stated.");
}

void enter_candidates(const Outcome& outcome, manifest::SurfaceFit& out) {
  for (std::size_t i = 0; i < outcome.fits.candidates.size(); ++i) {
    const Fit& fit = outcome.fits.candidates[i];
    if (i == outcome.fits.chosen || !fit.same_as.empty()) continue;  // the notes name what is the same
    manifest::AlternativeFit other;
    other.model = fit.model->info().id + (fit.variant.empty() ? "" : ", " + fit.variant);
    other.parameters = static_cast<std::int64_t>(fit.numbers.size());
    other.rms = finite(fit.fitted.log1p), other.held_out_rms = finite(fit.held_out.log1p);
    other.reason = fit.reason;
    out.alternatives.push_back(std::move(other));
  }
  for (const Refusal& r : outcome.fits.refusals)
    out.refusals.push_back(r.model + (r.variant.empty() ? "" : ", " + r.variant) + ": " + r.reason);
}

void enter_samples(const Outcome& outcome, manifest::SurfaceFit& out) {
  const Samples& s = outcome.read.samples;
  out.source = outcome.source;
  for (const std::string& band : s.band_name) out.bands.push_back(band.empty() ? "f" : band);
  out.wavelengths_m = s.band_m;
  if (s.bands() > 3)
    for (const std::string& name : written_names(outcome)) out.written_bands.push_back(name);
  out.rows = static_cast<std::int64_t>(s.rows());
  for (const Dropped& d : outcome.read.dropped) {
    const auto same = std::ranges::find(out.dropped, d.reason, &manifest::DroppedRows::reason);
    if (same != out.dropped.end())
      ++same->rows;
    else
      out.dropped.push_back({d.reason, d.place, 1});
  }
  const Convention& c = outcome.read.convention;
  out.mirror = c.mirror == Mirror::same ? "phi_i" : "phi_i + pi";
  if (c.brightness_ratio > 0) out.mirror_ratio = c.brightness_ratio;
  out.notes = outcome.read.notes;
  if (!c.sentence.empty()) out.notes.push_back(c.sentence);
  for (const std::string& note : outcome.fits.notes) out.notes.push_back(note);
  out.basis = outcome.basis;
  out.files = outcome.files;
}

Verdict verdict_of_reconstruction(const Outcome& outcome) {
  const Reconstruction& r = *outcome.reconstruction;
  const std::string start =
      "A full table was reconstructed from " + std::to_string(outcome.read.samples.rows()) + " pairs of directions";
  if (r.energy.most > 1 + energy_tolerance) {
    const std::string much = report::number_text(r.energy.most, 3) + " times the light that it receives";
    return {"doubtful",
            start + ", but it reflects up to " + much + ", where there were few samples to hold it down: more of them" +
                " near grazing help." + (outcome.renders() ? "" : " It is written, and not entered in surfaces."),
            Exit::quality};
  }
  return {"good", start + "; it reflects at most " + report::number_text(r.energy.most, 3) + " of the light.",
          Exit::done};
}

}  // namespace

std::string number_name(const FittedNumber& number, const Samples& samples) {
  if (number.band == whole_sample) return number.name;
  const std::string band = band_called(samples, number.band);
  return band.empty() ? number.name : number.name + "[" + band + "]";
}

Verdict verdict_of(const Outcome& outcome) {
  if (outcome.reconstruction) return verdict_of_reconstruction(outcome);
  const Fit* fit = outcome.chosen();
  if (fit == nullptr)
    return {"refused",
            outcome.fits.refusals.empty() ? "These samples tell no surface."
                                          : "These samples tell no surface: " + outcome.fits.refusals.front().reason,
            Exit::negative};
  std::string start = outcome.name + " is " + fit->model->info().id +
                      (fit->variant.empty() ? "" : " (" + fit->variant + ")") + ": rms " +
                      report::number_text(fit->fitted.log1p, 3);
  const bool held_out = std::isfinite(fit->held_out.log1p);
  if (held_out) start += ", on held-out directions " + report::number_text(fit->held_out.log1p, 3);
  if (!fit->converged) return {"doubtful", start + "; but the fit did not converge.", Exit::quality};
  if (fit->energy > 1 + energy_tolerance)
    return {
        "doubtful",
        start + "; but it reflects up to " + report::number_text(fit->energy, 3) + " of the light that it receives.",
        Exit::quality};
  if (worse_than_a_constant(*fit, outcome.read.samples))
    return {"doubtful", start + ": a constant would err less. Are the values a BRDF in 1/sr?", Exit::quality};
  if (held_out && fit->held_out.log1p > most_held_out_ratio * fit->fitted.log1p + 1e-3)
    return {"doubtful", start + ": it does not carry over to directions that it has not seen.", Exit::quality};
  for (const std::string& caution : {brighter_than_possible(*fit), unlike_metals(*fit)})
    if (!caution.empty()) start += "; " + caution;
  return {"good", start + ".", Exit::done};
}

void enter(manifest::Document& document, const Outcome& outcome, const std::string& table_file) {
  const Verdict verdict = verdict_of(outcome);
  manifest::SurfaceFit out;
  enter_samples(outcome, out);
  enter_candidates(outcome, out);
  const Fit* fit = outcome.chosen();
  if (fit != nullptr) {
    enter_fit(outcome, *fit, out);
    document.surfaces[outcome.name] = surface_of(outcome, *fit);
  }
  if (outcome.reconstruction) {
    out.model = "merl";
    out.energy = outcome.reconstruction->energy.most;
    for (const std::string& note : outcome.reconstruction->notes) out.notes.push_back(note);
    manifest::Surface surface;
    surface.model = "merl";
    surface.file = table_file;
    if (outcome.renders()) document.surfaces[outcome.name] = surface;
  }
  if (out.model.empty()) out.model = "none";
  out.verdict = verdict.word, out.sentence = verdict.sentence;
  document.surface_fits[outcome.name] = std::move(out);
}

}  // namespace gonio::goniometry
