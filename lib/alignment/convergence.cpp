// See convergence.h.
#include "alignment/convergence.h"

#include <algorithm>

#include "report/number_text.h"

namespace gonio::alignment {
namespace {

constexpr int strong = 0, faint = 10;  // styles of lines (report/plot.h): drawn through; dotted

std::string name_of(const Tried& t, bool again) {
  if (t.fate == Tried::Fate::taken) return "taken: " + t.from;
  return again ? "" : "dropped";
}

std::string word_of(Tried::Fate fate) {
  switch (fate) {
    case Tried::Fate::taken: return "taken";
    case Tried::Fate::same_end: return "ends where the other does";
    case Tried::Fate::left: return "left before shadows were looked at";
    default: return "dropped";
  }
}

}  // namespace

report::Plot convergence_plot(const std::string& body, const std::vector<Tried>& tried) {
  report::Plot plot{.title = "Convergence of " + body,
                    .caption =
                        "Of the rims' points that count; a point without a rim near it is off by the search's "
                        "reach. A search begins with objects' own rims and a rough mesh, shadows follow; of "
                        "several objects the last steps are those of all together.",
                    .x_label = "iteration",
                    .y_label = "offset of rims, rms / px",
                    .log_y = true};
  bool again = false;
  for (const bool taken : {false, true})  // over the others
    for (const Tried& t : tried) {
      if ((t.fate == Tried::Fate::taken) != taken || t.rms_px.empty()) continue;
      report::Series line{.name = name_of(t, again), .style = taken ? strong : faint};
      for (std::size_t i = 0; i < t.rms_px.size(); ++i)
        line.x.push_back(static_cast<double>(i)), line.y.push_back(std::max(1e-4, t.rms_px[i]));
      again = again || !taken;
      plot.series.push_back(std::move(line));
    }
  return plot;
}

report::TableText table_of_starts(const std::string& body, const std::vector<Tried>& tried) {
  report::TableText t{.caption = "Starts for " + body + ".",
                      .columns = {{"Start", "", false},
                                  {"Iterations"},
                                  {"rms at the start", "px"},
                                  {"At the end", "px"},
                                  {"Seen of the model's", "%"},
                                  {"End", "", false}},
                      .rows = {}};
  for (auto start = tried.rbegin(); start != tried.rend(); ++start) {
    if (start->rms_px.empty()) continue;
    t.rows.push_back({start->from, std::to_string(start->rms_px.size() - 1),
                      report::number_text(start->rms_px.front(), 3), report::number_text(start->rms_px.back(), 3),
                      start->explained > 0 ? report::number_text(100 * start->explained, 3) : "",
                      word_of(start->fate)});
  }
  return t;
}

}  // namespace gonio::alignment
