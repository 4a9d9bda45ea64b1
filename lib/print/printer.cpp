// See printer.h.
#include "print/printer.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/print.h"

namespace gonio::print {
namespace {

Growth growth_of(const manifest::PrintGrowth& entry, const std::string& place) {
  const GrowthLaw law{entry.alpha_m, entry.beta_m, entry.gamma};
  if (law.threshold() >= 1)
    throw Error(Exit::data, place,
                format("says that no grey value cures: growth begins at %.4g, white is 1", law.threshold()),
                "look whether alpha_m and beta_m are metres");
  if (entry.greys.empty() && entry.heights_m.empty()) return Growth(law);
  if (entry.greys.size() != entry.heights_m.size() || entry.greys.size() < 2)
    throw Error(Exit::data, place + "/heights_m",
                format("has %zu numbers, greys %zu", entry.heights_m.size(), entry.greys.size()),
                "give a height for every grey value, two at least");
  for (std::size_t i = 1; i < entry.greys.size(); ++i)
    if (!(entry.greys[i] > entry.greys[i - 1]))
      throw Error(Exit::data, place + "/greys/" + std::to_string(i),
                  format("is %g, no more than the one before", entry.greys[i]), "give them ascending");
  return Growth(law, GrowthTable(entry.greys, entry.heights_m, std::vector<double>(entry.greys.size(), 1.0)));
}

}  // namespace

double Growth::height_m(double light, double layer_m) const {
  if (!law_) return std::max(0.0, light) * layer_m;
  if (!table_) return law_->height_m(light);
  const double last = table_->greys().back();
  if (light <= last) return table_->height_m(light);
  return table_->height_m(last) + std::max(0.0, law_->height_m(light) - law_->height_m(last));
}

double Growth::slope_m(double light, double layer_m) const {
  if (!law_) return light > 0 ? layer_m : 0;
  if (!table_) return law_->height_m(light) > 0 ? law_->beta_m / (light - law_->gamma) : 0;
  const double step = 1e-4;
  return (height_m(light + step, layer_m) - height_m(light - step, layer_m)) / (2 * step);
}

double Growth::grey(double height_m, double layer_m) const {
  if (!(height_m > 0)) return 0;
  if (!law_) return std::min(1.0, height_m / layer_m);
  if (table_) return table_->grey(height_m).value_or(1);
  return std::min(1.0, law_->grey(height_m));
}

double Growth::threshold() const {
  if (!law_) return 0;
  if (!table_) return std::max(0.0, law_->threshold());
  const auto& heights = table_->heights_m();
  const auto grows = std::ranges::upper_bound(heights, 0.0);
  if (grows == heights.begin()) return 0;
  return table_->greys()[static_cast<std::size_t>(grows - heights.begin()) - 1];
}

PixelGrid Printer::grid() const {
  return {.width_px = width_px,
          .height_px = height_px,
          .pixel_m = pixel_m,
          .corner_m = {-pixel_m.x * width_px / 2, -pixel_m.y * height_px / 2}};
}

double Printer::thickness_m(std::size_t layer) const {
  if (layers_m.empty()) return layer_m;
  return layers_m[std::min(layer, layers_m.size() - 1)];
}

Printer printer_of(const manifest::Document& document, const std::string& name) {
  const manifest::Print& entry = document.prints.at(name);
  Printer printer;
  printer.name = name, printer.place = manifest::place(document, "/prints/" + name);
  printer.width_px = static_cast<int>(entry.width_px), printer.height_px = static_cast<int>(entry.height_px);
  printer.pixel_m = {entry.pixel_m.at(0), entry.pixel_m.at(1)};
  printer.layer_m = entry.layer_m, printer.layers_m = entry.layers_m;
  if (entry.growth) printer.growth = growth_of(*entry.growth, printer.place + "/growth");
  if (entry.bleed) {
    printer.bleed = {entry.bleed->sigma_m, entry.bleed->tail_share.value_or(0), entry.bleed->tail_m.value_or(0)};
    if (printer.bleed.tail_share > 0 && !(printer.bleed.tail_m > 0))
      throw Error(Exit::data, printer.place + "/bleed/tail_m", "is missing beside tail_share",
                  "say how wide the tail is");
  }
  printer.overcure_m = entry.overcure_m;
  return printer;
}

manifest::PrintGrowth growth_entry(const GrowthFit& fit, double significance) {
  manifest::PrintGrowth entry;
  entry.alpha_m = fit.law.alpha_m, entry.beta_m = fit.law.beta_m, entry.gamma = fit.law.gamma;
  const std::array<double, 3> sigma = fit.sigma();
  entry.sigma = {{"alpha_m", {sigma[0]}}, {"beta_m", {sigma[1]}}, {"gamma", {sigma[2]}}};
  for (const auto& row : fit.covariance) entry.covariance.insert(entry.covariance.end(), row.begin(), row.end());
  entry.lack_of_fit_p = fit.lack_of_fit_p, entry.rms_m = fit.rms_m;
  entry.repetitions = static_cast<std::int64_t>(std::lround(fit.degrees)) + 1;
  if (fit.lack_of_fit_p < significance) entry.greys = fit.table.greys(), entry.heights_m = fit.table.heights_m();
  return entry;
}

}  // namespace gonio::print
