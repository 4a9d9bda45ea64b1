// Contrast of a pattern from photographs, start to end (contrast/measure/measure.h).
#include "contrast/measure/measure.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "contrast/measure/cell_reading.h"
#include "contrast/measure/matrix_code.h"
#include "contrast/measure/measure_code.h"
#include "contrast/measure/measure_input.h"
#include "contrast/measure/measure_views.h"
#include "contrast/measure/view_shift.h"
#include "manifest/document.h"
#include "stats/distributions.h"

namespace gonio::contrast {
namespace {

constexpr double smallest_cell_px = 3;
constexpr double least_inner = 0.25, least_across_px = 2.5;  // for min_pixels pixels to lie within

std::string reasons(const CellMeans& means) {
  std::string text;
  const auto add = [&](int cells, const char* what) {
    if (cells > 0) text += (text.empty() ? "" : ", ") + std::to_string(cells) + " cells " + what;
  };
  add(means.saturated, "saturated");
  add(means.outside, "outside the picture");
  add(means.masked, "masked or not finite");
  add(means.few, "with too few pixels");
  return text;
}

void check_size(const Input& input, const InputView& view, double cell_px) {
  if (cell_px >= smallest_cell_px) return;
  throw Error(Exit::data, view.place,
              format("shows cells of %.2g px; at least %g px are needed", cell_px, smallest_cell_px),
              "photograph from nearer, or correct rows, columns and cell_m of \"" + input.name + "\"");
}

struct Seen {  // a view that shows enough, and which of the input's views it is
  std::vector<MeasuredView> views;
  std::vector<std::size_t> of_input;
};

void check_placements(const Seen& seen, const Input& input) {
  for (int k = 0; k < 2; ++k)
    if (std::ranges::count(seen.views, k, &MeasuredView::placement) == 0)
      throw Error(Exit::data, input.place,
                  "has no image of \"" + input.placement[static_cast<std::size_t>(k)] +
                      "\" that can be measured: " + (input.dropped.empty() ? "" : input.dropped.back()),
                  "expose less where cells are saturated, and keep the whole pattern in the picture");
}

// Means over the share of each cell that the place's uncertainty leaves (measure.h).
void read_cells(const GreyView& grey, const Input& input, const InputView& of, const MeasureOptions& options,
                MeasuredView& view) {
  const double side = shortest_side_px(input.pattern, *of.map).value_or(1);
  const double coordinates = 2 * static_cast<double>(input.views.size());
  view.place_px = largest_sigma_px(of.spread);
  view.needed_px = 0.5 + stats::normal_upper_quantile(options.alarm_rate / 2 / coordinates) * view.place_px;
  const double least = std::max(least_inner, least_across_px / side);
  view.inner = std::min(options.inner, std::max(least, 1 - 2 * view.needed_px / side));
  view.margin_px = (1 - view.inner) / 2 * side;
  view.means = cell_means(grey, input.pattern, *of.map, view.inner);
}

Seen look(const manifest::Document& document, const MeasureOptions& options, Input& input) {
  Seen seen;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    const InputView& of = input.views[i];
    const auto side = shortest_side_px(input.pattern, *of.map);
    check_size(input, of, side.value_or(0));
    MeasuredView view;
    view.image = of.id;
    view.placement = of.placement;
    view.lights = of.lights;
    read_cells(read_view(document, of, options), input, of, options, view);
    const auto counted = std::ranges::count_if(view.means.mean, [](double v) { return std::isfinite(v); });
    if (2 * static_cast<std::size_t>(counted) < input.pattern.cells()) {
      input.dropped.push_back(of.id + ": less than half of the cells count (" + reasons(view.means) + ")");
      continue;
    }
    if (counted < static_cast<std::ptrdiff_t>(input.pattern.cells()))
      input.notes.push_back(of.id + ": left out " + reasons(view.means));
    seen.views.push_back(std::move(view));
    seen.of_input.push_back(i);
  }
  check_placements(seen, input);
  return seen;
}

void find_bits(const Seen& seen, Input& input) {
  std::vector<const CellMeans*> means;
  std::vector<int> placement;
  for (const MeasuredView& view : seen.views) {
    means.push_back(&view.means);
    placement.push_back(view.placement);
  }
  input.pattern.bits = split_cells(input.pattern, means, placement);
  if (!input.pattern.known())
    throw Error(Exit::data, input.place, "shows no two kinds of cells in these images, and its bits are not stated",
                "give the pattern's file, or for a data matrix its text");
}

// Views in which one of the two kinds of cells does not count at all.
void drop_one_sided(const Members& members, Seen& seen, Input& input) {
  for (std::size_t v = seen.views.size(); v-- > 0;)
    for (std::size_t bit = 0; bit < 2; ++bit) {
      const CellMeans& means = seen.views[v].means;
      if (std::ranges::any_of(members[bit], [&](std::size_t cell) { return std::isfinite(means.mean[cell]); }))
        continue;
      input.dropped.push_back(seen.views[v].image + ": no cell of bit " + std::to_string(bit) + " counts (" +
                              reasons(means) + ")");
      seen.views.erase(seen.views.begin() + static_cast<std::ptrdiff_t>(v));
      seen.of_input.erase(seen.of_input.begin() + static_cast<std::ptrdiff_t>(v));
      break;
    }
  check_placements(seen, input);
}

// Twice: with the brightness of the classes, and then, laid better, with each cell's own.
void refine(const manifest::Document& document, const MeasureOptions& options, const Members& members, Input& input,
            Seen& seen) {
  for (std::size_t v = 0; v < seen.views.size(); ++v) {
    MeasuredView& view = seen.views[v];
    InputView& of = input.views[seen.of_input[v]];
    const GreyView grey = read_view(document, of, options);
    const ViewMap stated = *of.map;
    const CornerCovariance prior = of.spread;
    ViewShift shift;
    for (const bool own : {false, true}) {
      const ViewFit fit = fit_view(input.pattern, members, view.means);
      std::vector<double> brightness(input.pattern.cells());
      for (std::size_t cell = 0; cell < brightness.size(); ++cell)
        brightness[cell] = own && std::isfinite(view.means.mean[cell])
                               ? view.means.mean[cell]
                               : fit.of[input.pattern.bits[cell]].expected[cell];
      shift = lay_onto(grey, input.pattern, stated, brightness, prior, view.place_px, shift.by_px);
      if (!shift.credible) break;
      of.map = stated.moved(shift.by_px, input.pattern.size_m());
      of.spread = shift.covariance;
      read_cells(grey, input, of, options, view);
    }
    if (shift.credible) {
      for (const Vec2 by : shift.by_px) view.shift_px = view.shift_px + by * 0.25;
      continue;
    }
    of.map = stated;
    of.spread = prior;
    read_cells(grey, input, of, options, view);
    if (shift.distance2 > 0)
      input.notes.push_back(of.id +
                            format(": the pattern seems to lie %.2g sigmas from where the poses say; it was left "
                                   "where they say: state the poses' true sigma, or --robot-position and --robot-angle",
                                   std::sqrt(shift.distance2)));
  }
}

// Contrast that moves when the pattern is laid one sigma beside its place counts as uncertainty.
void add_place_error(const manifest::Document& document, const MeasureOptions& options, const Members& members,
                     const Input& input, const InputView& of, MeasuredView& view) {
  if (!(view.place_px > 0)) return;
  const GreyView grey = read_view(document, of, options);
  double michelson = 0, difference = 0;
  for (const Vec2 step : {Vec2{view.place_px, 0}, Vec2{0, view.place_px}}) {
    MeasuredView beside;
    beside.means =
        cell_means(grey, input.pattern, of.map->moved({step, step, step, step}, input.pattern.size_m()), view.inner);
    const ViewFit fit = fit_view(input.pattern, members, beside.means);
    if (fit.of[0].cells == 0 || fit.of[1].cells == 0) continue;
    enter_contrast(input.pattern, fit, beside);
    michelson += std::pow(beside.michelson.value - view.michelson.value, 2);
    difference += std::pow(beside.difference.value - view.difference.value, 2);
  }
  view.michelson.sigma = std::sqrt(view.michelson.sigma * view.michelson.sigma + michelson);
  view.difference.sigma = std::sqrt(view.difference.sigma * view.difference.sigma + difference);
}

std::vector<metric::Estimate> cell_turns(const Measured& result) {
  std::vector<metric::Estimate> cells(result.pattern.cells(), {std::nan(""), std::nan("")});
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    double sum = 0, variance = 0;
    int count = 0;
    for (const Turn& turn : result.turns) {
      const CellMeans &a = result.views[turn.before].means, &b = result.views[turn.after].means;
      const metric::Estimate c = michelson_of({a.mean[cell], a.sigma[cell]}, {b.mean[cell], b.sigma[cell]});
      if (!std::isfinite(c.value)) continue;
      sum += c.value;
      variance += c.sigma * c.sigma;
      ++count;
    }
    if (count > 0) cells[cell] = {sum / count, std::sqrt(variance) / count};
  }
  return cells;
}

void compare_placements(const Input& input, const std::vector<ViewFit>& fits, const Seen& seen, Measured& result) {
  for (const auto& [before, after] : partners(input, seen.views, seen.of_input)) {
    Turn turn{before, after, {}};
    for (std::size_t bit = 0; bit < 2; ++bit) {
      const ClassFit &a = fits[before].of[bit], &b = fits[after].of[bit];
      turn.michelson[bit] = michelson_of({a.mean, a.sigma}, {b.mean, b.sigma});
    }
    result.turns.push_back(turn);
    result.views[before].partner = after;
    result.views[after].partner = before;
  }
  if (result.turns.empty())
    result.notes.push_back("no view before the turn has a partner after it within 1 degree: turns are not compared");
  result.cell_turn = cell_turns(result);
  if (!result.pose[0] || !result.pose[1]) return;
  const Vec3 x = result.pose[0]->world_from_pattern.rotate({1, 0, 0}),
             y = result.pose[0]->world_from_pattern.rotate({0, 1, 0});
  const Vec3 to = result.pose[1]->world_from_pattern.rotate({1, 0, 0});
  result.turn_rad = std::atan2(dot(to, y), dot(to, x));
}

void warn(Measured& result, const MeasureOptions& options) {
  for (const MeasuredView& view : result.views)
    if (view.margin_px < view.needed_px * (1 - 1e-9))
      result.notes.push_back(view.image +
                             format(": the strip of %.2g px left out beside each border is less than the %.2g px that "
                                    "the uncertainty of the place asks for: neighbours may mix, and sound cells look "
                                    "bad; photograph from nearer, state better poses, or mark more corners",
                                    view.margin_px, view.needed_px));
  if (options.inner > 0.9)
    result.notes.push_back("with an inner share above 0.9 neighbouring cells mix by the lens's blur");
  for (int k = 0; k < 2; ++k)
    if (const auto& pose = result.pose[static_cast<std::size_t>(k)];
        pose && pose->degrees > 0 && pose->chi2 > 2 * pose->degrees)
      result.notes.push_back(format(
          "corners of \"%s\" fit the cameras' poses worse than their sigmas say (chi^2 %.3g for %d degrees of freedom; "
          "rms %.2g px): sigmas are widened",
          result.placement[static_cast<std::size_t>(k)].c_str(), pose->chi2, pose->degrees, pose->rms_px));
}

}  // namespace

metric::Estimate Measured::mean_michelson(int which) const {
  double sum = 0, variance = 0;
  int count = 0;
  for (const MeasuredView& view : views) {
    if (view.placement != which) continue;
    sum += view.michelson.value;
    variance += view.michelson.sigma * view.michelson.sigma;
    ++count;
  }
  return count > 0 ? metric::Estimate{sum / count, std::sqrt(variance) / count}
                   : metric::Estimate{std::nan(""), std::nan("")};
}

Measured measure(const manifest::Document& document, const std::string& name, const std::vector<CornerMark>& marks,
                 const MeasureOptions& options) {
  Input input = read_input(document, name, marks, options);
  Seen seen = look(document, options, input);
  Measured result;
  result.pattern_name = input.name;
  result.bits_found = !input.pattern.known();
  if (result.bits_found) find_bits(seen, input);
  if (result.bits_found && input.data_matrix) settle_code(input.pattern);
  const Members members = members_of(input.pattern);
  drop_one_sided(members, seen, input);
  if (options.refine) refine(document, options, members, input, seen);
  enter_directions(input, seen.views, seen.of_input);
  std::vector<ViewFit> fits;
  std::vector<std::vector<double>> deviation;
  for (std::size_t v = 0; v < seen.views.size(); ++v) {
    MeasuredView& view = seen.views[v];
    fits.push_back(fit_view(input.pattern, members, view.means));
    enter_contrast(input.pattern, fits.back(), view);
    add_place_error(document, options, members, input, input.views[seen.of_input[v]], view);
    deviation.push_back(deviations(input.pattern, fits.back(), view.means));
  }
  result.pattern = input.pattern;
  result.placement = input.placement;
  result.pose = input.pose;
  result.views = seen.views;
  result.notes = input.notes;
  result.dropped = input.dropped;
  compare_placements(input, fits, seen, result);
  result.defects = find_defects(result.pattern, deviation, options.alarm_rate, options.seed);
  if (input.data_matrix) result.code = measured_code(result);
  if (input.data_matrix && !result.code)
    result.notes.push_back("the data matrix could not be read: too many cells differ from any code");
  warn(result, options);
  return result;
}

}  // namespace gonio::contrast
