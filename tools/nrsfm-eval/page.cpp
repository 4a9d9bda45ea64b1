// See page.h.
#include "tools/nrsfm-eval/page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/text.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::nrsfm_eval {

using namespace gonio::nrsfm;

namespace {

using manifest::EvaluatedError;
using manifest::Evaluation;
using report::number_text;

constexpr std::size_t few = 4;          // reconstructions whose errors stand in columns, with their intervals
constexpr std::size_t most_rows = 300;  // of a table
constexpr std::size_t most_open_rows = 12, most_matrix_rows = 60;
constexpr std::size_t most_boxes = 6;

// A measure under an alignment.
struct Kind {
  std::string measure, alignment, unit;
  double factor = 1;  // to what is shown: millimetres, where metres would be fractions
};

// Errors that do not depend on the answer's unit.
bool with_scale(const Kind& kind) {
  return kind.alignment.ends_with("similarity") || kind.alignment.ends_with("one-scale");
}

// Those with a scale first.
std::vector<Kind> kinds_of(const std::vector<Evaluation>& evaluations) {
  std::vector<Kind> kinds;
  std::vector<double> largest;
  for (const Evaluation& e : evaluations)
    for (const EvaluatedError& error : e.errors) {
      const auto known = std::ranges::find_if(kinds, [&](const Kind& k) {
        return k.measure == error.measure && k.alignment == error.alignment && k.unit == error.unit;
      });
      const auto at = static_cast<std::size_t>(known - kinds.begin());
      if (known == kinds.end()) kinds.push_back({error.measure, error.alignment, error.unit}), largest.push_back(0);
      largest[at] = std::max(largest[at], error.value);
    }
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (kinds[k].unit == "m" && largest[k] < 1) kinds[k].unit = "mm", kinds[k].factor = 1000;
  std::stable_partition(kinds.begin(), kinds.end(), with_scale);
  return kinds;
}

const EvaluatedError* find(const Evaluation& e, const Kind& kind) {
  for (const EvaluatedError& error : e.errors)
    if (error.measure == kind.measure && error.alignment == kind.alignment) return &error;
  return nullptr;
}

std::string unit_of(const Kind& kind) {
  if (kind.unit == "1") return {};
  return kind.unit == "of the truth" ? "unit of the truth" : kind.unit;
}

std::string with_interval(const Kind& kind, const EvaluatedError& error) {
  std::string text = number_text(kind.factor * error.value, 4);
  if (error.lower && error.upper)
    text +=
        " (" + number_text(kind.factor * *error.lower, 3) + " to " + number_text(kind.factor * *error.upper, 3) + ")";
  return text;
}

// Few reconstructions: a column for each, with intervals.
report::TableText columns_table(const std::vector<Evaluation>& evaluations, const std::vector<Kind>& kinds) {
  report::TableText table;
  const bool told = std::ranges::any_of(evaluations, [](const Evaluation& e) {
    return std::ranges::any_of(e.errors, [](const EvaluatedError& error) { return error.upper.has_value(); });
  });
  if (const auto& confidence = evaluations.front().confidence; told && confidence)
    table.caption = format("In brackets: %g %% intervals for longer sequences of the same kind.", 100 * *confidence);
  table.columns = {{"measure", "", false}, {"alignment", "", false}, {"unit", "", false}};
  for (const Evaluation& e : evaluations) table.columns.push_back({e.id});
  for (const Kind& kind : kinds) {
    table.rows.push_back({kind.measure, kind.alignment, unit_of(kind)});
    for (const Evaluation& e : evaluations) {
      const EvaluatedError* error = find(e, kind);
      table.rows.back().push_back(error ? with_interval(kind, *error) : "\u2013");
    }
  }
  return table;
}

// Many: a row for each.
report::TableText rows_table(const std::vector<Evaluation>& evaluations, const std::vector<Kind>& kinds) {
  report::TableText table;
  if (evaluations.size() > most_rows)
    table.caption = format("The first %zu of %zu; --csv writes all.", most_rows, evaluations.size());
  const bool said = std::ranges::all_of(evaluations, [](const Evaluation& e) {
    return e.id.find(e.sequence) != std::string::npos && e.id.find(e.algorithm) != std::string::npos;
  });
  table.columns = {{"reconstruction", "", false}};
  if (!said) table.columns.insert(table.columns.end(), {{"sequence", "", false}, {"algorithm", "", false}});
  for (const Kind& kind : kinds) table.columns.push_back({kind.measure + ", " + kind.alignment, unit_of(kind)});
  for (std::size_t i = 0; i < std::min(most_rows, evaluations.size()); ++i) {
    const Evaluation& e = evaluations[i];
    table.rows.push_back({e.id});
    if (!said) table.rows.back().insert(table.rows.back().end(), {e.sequence, e.algorithm});
    for (const Kind& kind : kinds) {
      const EvaluatedError* error = find(e, kind);
      table.rows.back().push_back(error ? number_text(kind.factor * error->value, 4) : "\u2013");
    }
  }
  return table;
}

// One kind of error, sequences by algorithms; several reconstructions of one cell as their mean.
report::HeatStrip matrix(const std::vector<Evaluation>& evaluations, const Kind& kind) {
  std::set<std::string> algorithms, sequences;
  std::map<std::pair<std::string, std::string>, std::vector<double>> cells;
  for (const Evaluation& e : evaluations) {
    algorithms.insert(e.algorithm), sequences.insert(e.sequence);
    if (const EvaluatedError* error = find(e, kind); error && std::isfinite(error->value))
      cells[{e.sequence, e.algorithm}].push_back(kind.factor * error->value);
  }
  report::HeatStrip strip;
  strip.title = kind.measure + ", " + kind.alignment;
  strip.label = kind.measure + (unit_of(kind).empty() ? "" : " / " + unit_of(kind));
  strip.columns.assign(algorithms.begin(), algorithms.end());
  for (const std::string& s : sequences) {
    if (strip.rows.size() == most_matrix_rows) {
      strip.caption = format("The first %zu of %zu sequences.", most_matrix_rows, sequences.size());
      break;
    }
    strip.rows.push_back(s);
    for (const std::string& a : algorithms) {
      const auto cell = cells.find({s, a});
      double sum = 0;
      if (cell != cells.end())
        for (const double v : cell->second) sum += v / static_cast<double>(cell->second.size());
      strip.values.push_back(cell == cells.end() ? std::numeric_limits<double>::quiet_NaN() : sum);
    }
  }
  return strip;
}

void add_tables(report::Page& page, const std::vector<Evaluation>& evaluations, const std::vector<Kind>& kinds) {
  const bool many = evaluations.size() > most_open_rows;
  if (many && !kinds.empty()) page.heat_strip(matrix(evaluations, kinds.front()));
  if (many) page.open_details("All errors");
  page.table(evaluations.size() <= few ? columns_table(evaluations, kinds) : rows_table(evaluations, kinds));
  if (!std::ranges::all_of(kinds, with_scale))
    page.note(
        "Errors without a scale (none, global-rotation, frame-rotation) say something of answers in the truth's unit "
        "only, those without a rotation (none) only of answers in its frame of reference.");
  if (many) page.close_details();
}

// Results of one kind of error by algorithm, where there are several of either.
stats::Design by_algorithm(const std::vector<Evaluation>& evaluations, const Kind& kind) {
  std::set<std::string> names;
  for (const Evaluation& e : evaluations)
    if (find(e, kind)) names.insert(e.algorithm);
  stats::Design design;
  design.factors = {{"algorithm", {names.begin(), names.end()}}};
  design.level.resize(1);
  for (const Evaluation& e : evaluations)
    if (const EvaluatedError* error = find(e, kind); error && std::isfinite(error->value)) {
      design.level[0].push_back(static_cast<int>(std::distance(names.begin(), names.find(e.algorithm))));
      design.y.push_back(kind.factor * error->value);
    }
  return design;
}

void add_boxes(report::Page& page, const std::vector<Evaluation>& evaluations, const std::vector<Kind>& kinds) {
  std::vector<report::Figure> boxes;
  for (const Kind& kind : kinds) {
    const stats::Design design = by_algorithm(evaluations, kind);
    if (design.factors[0].levels.size() < 2 || design.y.size() < 3 * design.factors[0].levels.size()) continue;
    if (boxes.size() == most_boxes) break;
    report::Figure figure;
    figure.svg = box_plot(design, 0, kind.measure + (unit_of(kind).empty() ? "" : " / " + unit_of(kind)));
    figure.title = kind.measure + ", " + kind.alignment;
    figure.caption = "Median, quartiles, whiskers to 1.5 times the box.";
    boxes.push_back(std::move(figure));
  }
  if (boxes.empty()) return;
  page.section("By algorithm");
  page.figures(boxes, 520);
}

// "3, 7, 12 to 15".
std::string ranges_text(const std::vector<std::int64_t>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t last = i;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(frames[i]);
    if (last > i) text += (last > i + 1 ? " to " : ", ") + std::to_string(frames[last]);
    i = last + 1;
  }
  return text;
}

void add_flips(report::Page& page, const std::vector<Evaluation>& evaluations) {
  std::vector<std::string> items;
  for (const Evaluation& e : evaluations) {
    if (e.mirrored.value_or(false)) items.push_back(e.id + ": the whole sequence is mirrored.");
    for (const char* kind : {"depth-reversal", "mirror"}) {
      std::vector<std::int64_t> frames;
      for (const manifest::DetectedFlip& flip : e.flips)
        if (flip.kind == kind) frames.push_back(flip.frame);
      if (!frames.empty()) items.push_back(e.id + ": " + kind + " in frames " + ranges_text(frames) + ".");
    }
  }
  if (items.empty()) return;
  const std::size_t all = items.size();
  if (all > most_rows) items.resize(most_rows), items.push_back(format("... and %zu more", all - most_rows));
  page.section("Flips");
  page.paragraph(
      "Orthographic tracks do not tell a shape from its mirror image in depth. Frames that are flipped against the "
      "majority of their sequence:");
  if (all > most_open_rows) page.open_details(format("%zu findings", all));
  page.list(items);
  if (all > most_open_rows) page.close_details();
}

void add_notes(report::Page& page, const std::vector<Evaluation>& evaluations) {
  std::vector<std::string> items;
  for (const Evaluation& e : evaluations)
    for (const std::string& note : e.notes)
      if (items.size() < most_rows) items.push_back(e.id + ": " + note + ".");
  if (items.empty()) return;
  page.open_details("Notes");
  page.list(items);
  page.close_details();
}

void add_errors(report::Page& page, const std::vector<Evaluation>& evaluations) {
  const std::vector<Kind> kinds = kinds_of(evaluations);
  std::set<std::string> sequences, algorithms;
  std::size_t mirrored = 0, flipped = 0, restless = 0;
  for (const Evaluation& e : evaluations) {
    sequences.insert(e.sequence), algorithms.insert(e.algorithm);
    mirrored += e.mirrored.value_or(false), flipped += !e.flips.empty(), restless += !e.converged.value_or(true);
  }
  page.section("Errors");
  if (evaluations.size() > 1)
    page.key_numbers({{"Reconstructions", std::to_string(evaluations.size()), "", ""},
                      {"Sequences", std::to_string(sequences.size()), "", ""},
                      {"Algorithms", std::to_string(algorithms.size()), "", ""},
                      {"Mirrored", std::to_string(mirrored), "", "only a reflection lays them onto the truth"},
                      {"With flips", std::to_string(flipped), "", "in some frames"}});
  if (restless > 0)
    page.note(format("The robust error's search of %zu reconstructions ended before it stood still.", restless));
  add_tables(page, evaluations, kinds);
  add_notes(page, evaluations);
  add_boxes(page, evaluations, kinds);
  add_flips(page, evaluations);
}

void add_views(report::Page& page, const EvaluationPage& p) {
  page.section("In space");
  page.paragraph(
      "Drag to turn a view, or use the arrow keys; a double click turns it back. Thin lines join points of the truth "
      "that stay near each other.");
  if (p.views.size() < p.evaluations.size())
    page.note(format("%zu of %zu reconstructions: of each algorithm the one of median error; --views sets how many.",
                     p.views.size(), p.evaluations.size()));
  std::vector<report::Figure> figures;
  for (const View& view : p.views) {
    report::Figure figure;
    figure.svg = report::html(view.motion), figure.title = view.title, figure.caption = view.caption;
    figures.push_back(std::move(figure));
  }
  page.figures(figures, 520);
}

// One sentence: the least error, or what ranks first.
std::string headline(const EvaluationPage& p) {
  if (p.analysis)
    for (const Part& part : p.analysis->parts)
      if (!part.ranks.empty()) {
        const stats::Factor& f = part.design.factors[static_cast<std::size_t>(part.ranked)];
        const stats::Rank& first = part.ranks.front();
        return f.levels[static_cast<std::size_t>(first.level)] + " has the least expected error, " +
               number_text(first.mean, 4) + (p.analysis->unit.empty() ? "" : " " + p.analysis->unit) +
               (first.lower == first.upper ? "; no other rank is open to it"
                                           : format("; ranks %g to %g are open to it", first.lower, first.upper));
      }
  if (p.evaluations.empty()) return "What decides the errors";
  const std::vector<Kind> kinds = kinds_of(p.evaluations);
  const Evaluation* best = nullptr;
  for (const Evaluation& e : p.evaluations)
    if (const EvaluatedError* error = find(e, kinds.front()))
      if (!best || error->value < find(*best, kinds.front())->value) best = &e;
  if (!best) return "Nothing was measured";
  return (p.evaluations.size() > 1 ? "Least " : "") + kinds.front().measure + ": " +
         number_text(kinds.front().factor * find(*best, kinds.front())->value, 4) +
         (unit_of(kinds.front()).empty() ? "" : " " + unit_of(kinds.front())) + ", " + best->id;
}

}  // namespace

std::string evaluation_page(const EvaluationPage& p) {
  report::Page page("nrsfm-eval", headline(p),
                    "Shapes that deform, reconstructed from the tracks of one camera, beside the truth. Every error is "
                    "named with what was laid onto the truth before: the answer depends on it.");
  if (!p.evaluations.empty()) add_errors(page, p.evaluations);
  if (!p.views.empty()) add_views(page, p);
  if (p.analysis) add_analysis(page, *p.analysis);
  page.footer("nrsfm-eval, gonio " GONIO_VERSION ". This page is one file and loads nothing.");
  return page.html();
}

}  // namespace gonio::tools::nrsfm_eval
