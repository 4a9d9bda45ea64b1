#include "mesh/register/register_page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "io/picture.h"
#include "mesh/register/register_words.h"
#include "report/colour_map.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::mesh {
namespace {

constexpr int cells = 96;      // of a map, along its longer side
constexpr double colours = 3;  // standard deviations that get full colour
constexpr std::size_t most_pairs = 24;

std::string figure(double value, double sigma) {
  return report::with_sigma(value, sigma);
}

std::vector<OverlapResidual> of_pair(const Registration& found, const PairFigures& pair) {
  std::vector<OverlapResidual> own;
  for (const OverlapResidual& r : found.residuals)
    if (std::minmax<std::size_t>(r.view, r.other) == std::minmax(pair.first, pair.second)) own.push_back(r);
  return own;
}

// Signed towards the first view: of points of the second, the other way round.
double signed_z(const OverlapResidual& r, const PairFigures& pair) {
  return (r.view == pair.first ? 1 : -1) * r.off_m / r.sigma_m;
}

report::Plot histogram(const std::vector<OverlapResidual>& residuals, const PairFigures& pair) {
  constexpr int bins = 48;
  constexpr double most = 6;
  report::Series found{.kind = report::Series::Kind::bars, .name = "found"}, stated{.name = "as stated"};
  std::vector<double> counts(bins, 0);
  for (const OverlapResidual& r : residuals) {
    const double z = std::clamp(signed_z(r, pair), -most, most * (1 - 1e-9));
    ++counts[static_cast<std::size_t>((z + most) / (2 * most) * bins)];
  }
  const double width = 2 * most / bins, total = static_cast<double>(residuals.size());
  for (int k = 0; k <= bins; ++k) found.edges.push_back(-most + width * k);
  for (const double count : counts) found.y.push_back(count / (total * width));
  for (int k = 0; k <= 120; ++k) {
    const double z = -most + 2 * most * k / 120;
    stated.x.push_back(z), stated.y.push_back(std::exp(-0.5 * z * z) / std::sqrt(2 * pi));
  }
  return {.title = "Distances over what is predicted",
          .caption = "Beyond 6 they count in the outermost bars.",
          .x_label = "distance / standard deviation",
          .y_label = "density",
          .series = {found, stated},
          .zero_y = true};
}

// As the first view's camera sees the overlap, parallel projection; the mean of each cell.
report::Figure map_of(const std::vector<OverlapResidual>& residuals, const PairFigures& pair, Vec3 camera) {
  Vec3 middle;
  for (const OverlapResidual& r : residuals) middle += r.at_m / static_cast<double>(residuals.size());
  const Vec3 towards = normalized(camera - middle);
  const Vec3 above = std::abs(towards.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 right = normalized(cross(above, towards)), up = cross(towards, right);
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  const auto place = [&](const OverlapResidual& r) {
    return Vec2{dot(r.at_m - middle, right), dot(r.at_m - middle, up)};
  };
  for (const OverlapResidual& r : residuals) {
    const Vec2 p = place(r);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)}, high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double cell = std::max({high.x - low.x, high.y - low.y, 1e-9}) / (cells - 1);
  const int width = static_cast<int>((high.x - low.x) / cell) + 1,
            height = static_cast<int>((high.y - low.y) / cell) + 1;
  std::vector<double> sum(static_cast<std::size_t>(width * height), 0), count = sum;
  for (const OverlapResidual& r : residuals) {
    const Vec2 p = place(r);
    const auto at = static_cast<std::size_t>(static_cast<int>((high.y - p.y) / cell) * width +
                                             static_cast<int>((p.x - low.x) / cell));
    sum[at] += signed_z(r, pair), ++count[at];
  }
  io::Image picture(width, height, {"R", "G", "B"});
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const report::Colour c =
        count[i] > 0 ? report::signed_colour(sum[i] / count[i] / colours) : report::Colour{0.55f, 0.55f, 0.55f};
    for (std::size_t k = 0; k < 3; ++k) picture.data[3 * i + k] = c[k];
  }
  return {.png = io::encode_png(picture),
          .title = "Where they lie",
          .caption =
              "Means over what is predicted of one, as the first view's camera sees it: red where the first view "
              "lies before the second, blue behind; full colour at 3. Grey: no overlap. An even colour or a "
              "slope is a pose; stripes and edges are the points'."};
}

report::TableText pair_table(const Registration& found, const std::vector<std::string>& names) {
  report::TableText table{.caption = "",
                          .columns = {{"Pair", "", false},
                                      {"Overlap", "%"},
                                      {"Apart", "mm rms"},
                                      {"Over what is stated"},
                                      {"Middle half"},
                                      {"Poses' part"},
                                      {"Points' part"},
                                      {"Motion", "mm"},
                                      {"Turn", "deg"},
                                      {"By chance", "p"}},
                          .rows = {}};
  for (const PairFigures& p : found.pairs)
    table.rows.push_back(
        {names[p.first] + ", " + names[p.second], format("%.0f, %.0f", 100 * p.overlap[0], 100 * p.overlap[1]),
         report::number_text(1e3 * p.rms_m, 3), figure(p.consistency, p.sigma), report::number_text(p.typical, 3),
         report::number_text(p.rigid, 3), figure(p.rest, p.rest_sigma), report::number_text(1e3 * p.shift_m, 2),
         report::number_text(180 / pi * p.turn_rad, 2), report::number_text(p.rigid_p, 2)});
  return table;
}

report::TableText view_table(const Registration& found, const std::vector<std::string>& names,
                             const RegisterWish& wish) {
  report::TableText table{.caption = "",
                          .columns = {{"View", "", false}, {"Moved by", "", false}, {"Held"}, {"Open", "", false}},
                          .rows = {}};
  for (std::size_t v = 0; v < found.views.size(); ++v) {
    const ViewShift& view = found.views[v];
    std::string open;
    for (const std::string& one : view.open) open += (open.empty() ? "" : "; ") + one;
    table.rows.push_back({names[v],
                          v == wish.fixed          ? "stays"
                          : !found.refused.empty() ? "not moved"
                                                   : shift_words(view),
                          format("%zu of 6", view.held), open});
  }
  return table;
}

}  // namespace

std::string register_page(const MeasuredPoints& points, const Registration& found,
                          const std::vector<std::string>& names, const RegisterWish& wish) {
  const Consistency& c = found.after;
  std::string views;
  for (const std::string& one : names) views += (views.empty() ? "" : ", ") + one;
  report::Page page("Views", found.pairs.empty() ? "No two views overlap." : consistency_sentence(c) + ".",
                    "Of " + views + ".");
  page.section("Agreement");
  page.key_numbers({{"over what is stated", figure(c.value, c.sigma), "", "1: as stated",
                     c.value > 2 ? report::Tone::bad : report::Tone::neutral},
                    {"points' part", figure(c.rest, c.rest_sigma), "", "what motions of views would leave"},
                    {"poses' part", report::number_text(c.rigid, 3), "",
                     "p = " + report::number_text(c.rigid_p, 2) + " by chance"}});
  if (wish.refine && found.refused.empty())
    page.paragraph("Before views were moved: " + report::number_text(found.before.value, 3) + " times what is stated.");
  if (!found.refused.empty()) page.paragraph("Nothing was moved: " + found.refused + ".");
  page.table(pair_table(found, names));
  page.note(
      format("Squares add up: of the figure, the poses' part and the points' part. %zu distances in %zu patches "
             "of surface that count as independent.",
             c.residuals, c.patches));
  if (!found.views.empty()) {
    page.section("Motions");
    page.table(view_table(found, names, wish));
  }
  page.section("Pairs");
  for (std::size_t k = 0; k < std::min(found.pairs.size(), most_pairs); ++k) {
    const PairFigures& pair = found.pairs[k];
    const std::vector<OverlapResidual> residuals = of_pair(found, pair);
    page.subsection(names[pair.first] + " and " + names[pair.second]);
    page.plot(histogram(residuals, pair));
    page.figures({map_of(residuals, pair, points.viewpoints_m[pair.first][0])}, 380);
  }
  return page.html();
}

}  // namespace gonio::mesh
