// The statistics of a set: what it is made of, how deep light goes, how noisy it is, and some of its cells.
#include "report/page.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "io/picture.h"
#include "io/raster.h"
#include "render/preview.h"
#include "report/number_text.h"
#include "tools/glass-make/call.h"

namespace gonio::tools::glass_make {
namespace {

using namespace gonio::glass;
using report::number_text;

std::vector<report::ScoreBar> counts(const Gathered& gathered, const std::string& fact) {
  std::map<std::string, std::size_t> count;
  for (const CellRow& row : gathered.rows)
    if (const auto found = row.facts.find(fact); found != row.facts.end()) ++count[found->second];
  std::vector<report::ScoreBar> bars;
  for (const auto& [value, n] : count)
    bars.push_back({.label = value, .value = std::to_string(n), .size = static_cast<double>(n)});
  return bars;
}

report::Plot histogram(const std::string& title, const std::string& x_label, std::vector<double> values, int bins,
                       const std::string& what = "cells") {
  report::Plot plot{.title = title, .x_label = x_label, .y_label = what, .zero_y = true};
  if (values.empty()) return plot;
  const auto [low, high] = std::ranges::minmax(values);
  const double step = high > low ? (high - low) / bins : 1;
  report::Series bars{.kind = report::Series::Kind::bars};
  for (int i = 0; i <= bins; ++i) bars.edges.push_back(low + i * step);
  bars.y.assign(static_cast<std::size_t>(bins), 0);
  for (const double v : values)
    ++bars.y[std::min(static_cast<std::size_t>((v - low) / step), static_cast<std::size_t>(bins - 1))];
  plot.series = {bars};
  return plot;
}

std::vector<double> numbers(const Gathered& gathered, const std::string& fact) {
  std::vector<double> all;
  for (const CellRow& row : gathered.rows)
    if (const auto found = row.facts.find(fact); found != row.facts.end()) all.push_back(std::stod(found->second));
  return all;
}

report::Plot depths(const Gathered& gathered) {
  report::Plot plot{.title = "Surfaces that a refracted ray crosses",
                    .caption = "of all pixels that meet an object",
                    .x_label = "surfaces",
                    .y_label = "pixels",
                    .log_y = true};
  report::Series bars{.kind = report::Series::Kind::bars};
  std::size_t last = gathered.interfaces.size();
  while (last > 1 && gathered.interfaces[last - 1] == 0) --last;
  for (std::size_t i = 1; i < last; ++i) {
    bars.edges.push_back(static_cast<double>(i) - 0.5);
    bars.y.push_back(static_cast<double>(gathered.interfaces[i]));
  }
  bars.edges.push_back(static_cast<double>(last) - 0.5);
  if (last > 1) plot.series = {bars};
  return plot;
}

void add_cells(report::Page& page, const GlassSet& set, const Gathered& gathered) {
  constexpr std::size_t shown = 6;
  const std::size_t step = std::max<std::size_t>(1, gathered.rows.size() / shown);
  for (std::size_t n = 0, k = 0; n < gathered.rows.size() && k < shown; n += step, ++k) {
    const CellRow& row = gathered.rows[n];
    const std::filesystem::path folder = set.folder() / "cells" / row.name;
    std::vector<report::Figure> figures;
    const auto add = [&](const std::string& title, const io::Image& picture) {
      figures.push_back({.png = io::encode_png(picture), .title = title});
    };
    const io::Image bare = io::read_picture(folder / "bare.exr");
    add("screen alone", render::preview(bare));
    add("with the room", render::preview(io::read_picture(folder / "lit.exr")));
    for (const auto& [layer, picture] : render::layer_previews(bare)) add(layer, picture);
    page.subsection(row.facts.at("form") + " of " + row.facts.at("glass") + ", cell " + std::to_string(row.number) +
                    " (" + name_of(row.share) + ")");
    page.figures(figures, 150);
  }
}

}  // namespace

std::string page_of(const GlassSet& set, const Gathered& gathered) {
  std::map<Share, std::size_t> cells;
  std::map<Share, std::set<std::size_t>> objects;
  std::size_t quiet = 0;
  std::vector<double> errors, coverage, mean_depth;
  for (const CellRow& row : gathered.rows) {
    ++cells[row.share], objects[row.share].insert(row.object);
    coverage.push_back(row.coverage), mean_depth.push_back(row.mean_interfaces);
    for (const auto& [image, error] : row.relative_error) {
      errors.push_back(error);
      quiet += error <= set.wish().relative_error ? 1 : 0;
    }
  }
  report::Page page(
      "glass", format("%zu cells of glass before a screen", gathered.rows.size()),
      format("objects: %zu, views of each: %zu, %d x %d pixels, seed %llu", set.wish().objects, set.wish().views,
             set.wish().width_px, set.wish().height_px, static_cast<unsigned long long>(set.wish().seed)));
  std::vector<report::KeyNumber> keys;
  for (const Share share : {Share::training, Share::validation, Share::test})
    keys.push_back({name_of(share), std::to_string(cells[share]), "cells",
                    "objects: " + std::to_string(objects[share].size()), report::Tone::neutral});
  keys.push_back({"quiet enough",
                  number_text(100.0 * static_cast<double>(quiet) / static_cast<double>(errors.size()), 3), "%",
                  "of the pictures reach " + number_text(100 * set.wish().relative_error, 3) + " %",
                  quiet == errors.size() ? report::Tone::good : report::Tone::neutral});
  page.key_numbers(keys);
  page.section("What it is made of");
  for (const auto& [fact, heading] : {std::pair{"form", "Families"}, std::pair{"glass", "Glass"},
                                      std::pair{"pattern", "Screen shows"}, std::pair{"filled", "Liquid inside"}}) {
    page.subsection(heading);
    page.score_bars(counts(gathered, fact));
  }
  page.section("Shape and light");
  page.plots({histogram("Genus", "genus, all surfaces", numbers(gathered, "genus"), 12),
              histogram("Size", "largest extent / m", numbers(gathered, "size_m"), 12),
              histogram("Bubbles", "bubbles in an object", numbers(gathered, "bubbles"), 9),
              histogram("Roughness", "alpha", numbers(gathered, "alpha"), 12)});
  page.plots({depths(gathered), histogram("Mean over a cell", "surfaces crossed", mean_depth, 16)});
  page.section("Coverage and noise");
  page.plots({histogram("Coverage", "share of the picture", coverage, 16),
              histogram("Noise", "relative error of a picture", errors, 16, "pictures")});
  page.section("Some cells");
  add_cells(page, set, gathered);
  return page.html();
}

}  // namespace gonio::tools::glass_make
