// See page.h.
#include "tools/brdf-fit/page.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "goniometry/document.h"
#include "goniometry/plots.h"
#include "goniometry/spectra.h"
#include "io/picture.h"
#include "render/preview.h"
#include "report/number_text.h"
#include "report/page.h"
#include "stats/intervals.h"

namespace gonio::tools::brdf_fit {

using namespace gonio::goniometry;

namespace {

using report::KeyNumber;
using report::number_text;
using report::Page;
using report::Tone;

// Of the cells above zero.
double median_relative_sigma(const Reconstruction& r) {
  std::vector<double> relative;
  for (std::size_t i = 0; i < std::min(r.table.brdf_per_sr.size(), r.sigma.brdf_per_sr.size()); ++i)
    if (r.table.brdf_per_sr[i] > 0 && r.sigma.brdf_per_sr[i] > 0)
      relative.push_back(static_cast<double>(r.sigma.brdf_per_sr[i]) / static_cast<double>(r.table.brdf_per_sr[i]));
  return stats::median(relative);
}

std::vector<KeyNumber> key_numbers(const Outcome& outcome) {
  std::vector<KeyNumber> keys;
  if (outcome.reconstruction) {
    const Reconstruction& r = *outcome.reconstruction;
    keys.push_back({"Largest reflectance", number_text(r.energy.most, 3), "", "1 is all of the light",
                    r.energy.most > 1.02 ? Tone::bad : Tone::good});
    if (const double typical = median_relative_sigma(r); std::isfinite(typical))
      keys.push_back({"Uncertainty of a cell", "\u00b1" + number_text(100 * typical, 2), "%", "one sigma, median"});
    keys.push_back(
        {"Intervals widened by", number_text(r.widening, 3), "", "so that they hold for left-out materials"});
  } else if (const Fit* fit = outcome.chosen()) {
    const bool poor = fit->held_out.log1p > 1.5 * fit->fitted.log1p + 1e-3;
    keys.push_back({"rms of the fit", number_text(fit->fitted.log1p, 3), "", "of log(1 + 100 f cos cos)"});
    keys.push_back({"rms on held-out directions", number_text(fit->held_out.log1p, 3), "", "the same, not fitted",
                    poor ? Tone::bad : Tone::good});
    keys.push_back({"rms in decades", number_text(fit->fitted.decades, 3), "", "of log10 f"});
    keys.push_back({"Largest reflectance", number_text(fit->energy, 3), "", "1 is all of the light",
                    fit->energy > 1.02 ? Tone::bad : Tone::good});
  }
  keys.push_back({"Pairs of directions", std::to_string(outcome.read.samples.rows()), "",
                  std::to_string(outcome.read.dropped.size()) + " left out"});
  return keys;
}

report::TableText number_table(const Outcome& outcome, const Fit& fit) {
  report::TableText table{.columns = {{.name = "number", .numeric = false},
                                      {.name = "value \u00b1 one sigma"},
                                      {.name = "95 % interval"},
                                      {.name = "", .numeric = false}}};
  const auto bands = written_bands(outcome.read.samples);
  for (const FittedNumber& n : fit.numbers) {
    const bool written = n.band == whole_sample || std::ranges::find(bands, n.band) != bands.end();
    if (has_spectra(outcome) && !written) continue;
    const bool known = std::isfinite(n.sigma) && n.sigma > 0;
    table.rows.push_back({number_name(n, outcome.read.samples),
                          known ? report::with_sigma(n.value, n.sigma) : number_text(n.value, 4),
                          number_text(n.low, 4) + " to " + number_text(n.high, 4),
                          n.at == FittedNumber::At::inside  ? ""
                          : n.at == FittedNumber::At::lower ? "at its lower bound"
                                                            : "at its upper bound"});
  }
  if (table.rows.size() < fit.numbers.size())
    table.caption = "Of the " + std::to_string(outcome.read.samples.bands()) +
                    " bands the three that stand for red, green and blue; all are drawn below, and are numbers in the "
                    "manifest and, with --out, in NAME-numbers.csv.";
  return table;
}

void add_alternatives(Page& page, const Outcome& outcome) {
  report::TableText table{.caption =
                              "By their error on held-out directions. Chosen is the simplest whose mean square "
                              "exceeds the least by no more than one standard error, or 2 % of it.",
                          .columns = {{.name = "model", .numeric = false},
                                      {.name = "numbers"},
                                      {.name = "rms"},
                                      {.name = "rms held out"},
                                      {.name = "decades"},
                                      {.name = "", .numeric = false}}};
  for (std::size_t i = 0; i < outcome.fits.candidates.size(); ++i) {
    const Fit& fit = outcome.fits.candidates[i];
    if (!fit.same_as.empty()) continue;
    table.rows.push_back({fit.model->info().id + (fit.variant.empty() ? "" : ", " + fit.variant),
                          std::to_string(fit.numbers.size()), number_text(fit.fitted.log1p, 3),
                          number_text(fit.held_out.log1p, 3), number_text(fit.fitted.decades, 3),
                          i == outcome.fits.chosen ? "chosen" : fit.reason});
  }
  if (table.rows.empty()) return;
  page.section("What else was tried");
  page.table(table);
}

void add_refusals(Page& page, const Outcome& outcome) {
  if (outcome.fits.refusals.empty()) return;
  page.subsection("What these samples cannot tell");
  std::vector<std::string> items;
  for (const Refusal& r : outcome.fits.refusals)
    items.push_back(r.model + (r.variant.empty() ? "" : ", " + r.variant) + ": " + r.reason);
  page.list(items);
}

void add_samples(Page& page, const Outcome& outcome) {
  const ReadTable& read = outcome.read;
  page.section("What was measured");
  page.paragraph(outcome.source + ": " + std::to_string(read.samples.rows()) + " pairs of directions in " +
                 std::to_string(read.samples.bands()) + (read.samples.bands() == 1 ? " band." : " bands."));
  std::vector<std::string> notes = read.notes;
  if (!read.convention.sentence.empty()) notes.push_back(read.convention.sentence);
  for (const std::string& note : outcome.fits.notes) notes.push_back(note);
  if (outcome.reconstruction)
    for (const std::string& note : outcome.reconstruction->notes) notes.push_back(note);
  page.list(notes);
  std::map<std::string, std::pair<std::size_t, std::string>> reasons;
  for (const Dropped& d : read.dropped) {
    auto& [count, first] = reasons[d.reason];
    if (count++ == 0) first = d.place;
  }
  if (reasons.empty()) return;
  report::TableText table{
      .caption = "Left out",
      .columns = {{.name = "rows"}, {.name = "reason", .numeric = false}, {.name = "first", .numeric = false}}};
  for (const auto& [reason, what] : reasons) table.rows.push_back({std::to_string(what.first), reason, what.second});
  page.table(table);
}

void add_plots(Page& page, const Outcome& outcome) {
  const std::size_t band = written_bands(outcome.read.samples)[1];
  page.section("Where it fits");
  std::vector<report::Plot> plots;
  if (auto scans = scan_plot(outcome, band))
    plots.push_back(std::move(*scans));
  else
    page.note("No scan in the plane of incidence has five samples.");
  plots.push_back(lobe_plot(outcome, band));
  page.plots(plots);
  page.heat_strip(residual_map(outcome));
}

}  // namespace

std::string page_of(const Outcome& outcome, const io::Image& sphere) {
  const Verdict verdict = verdict_of(outcome);
  const Tone tone = verdict.exit == Exit::done ? Tone::good : Tone::bad;
  Page page("brdf-fit: " + outcome.name, verdict.sentence,
            "A surface for " + outcome.source + ", told from its reflectance at " +
                std::to_string(outcome.read.samples.rows()) + " pairs of directions.",
            tone);
  page.key_numbers(key_numbers(outcome));
  const Fit* fit = outcome.chosen();
  if (sphere.pixels() > 0)
    page.figures({{.png = io::encode_png(render::preview(sphere)),
                   .title = "A sphere of this surface",
                   .caption = "Under a lamp high on the left and a dim sky; the 99th percentile is white."}},
                 300);
  if (fit != nullptr && !outcome.reconstruction) {
    page.section("The surface");
    page.paragraph(fit->model->info().id + ": " + fit->model->info().sentence + " " + fit->verdict);
    page.table(number_table(outcome, *fit));
    if (has_spectra(outcome)) {
      std::vector<report::Plot> plots;
      for (auto& [number, plot] : spectra_of(outcome)) plots.push_back(std::move(plot));
      plots.push_back(band_error_plot(outcome));
      page.plots(plots);
    }
  }
  if (fit != nullptr || outcome.reconstruction) add_plots(page, outcome);
  add_alternatives(page, outcome);
  add_refusals(page, outcome);
  add_samples(page, outcome);
  return page.html();
}

}  // namespace gonio::tools::brdf_fit
