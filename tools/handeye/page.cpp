#include "tools/handeye/page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::handeye {

using namespace gonio::robot;

namespace {

using report::KeyNumber;
using report::number_text;
using report::Page;
using report::percent_text;
using report::Plot;
using report::Series;
using report::TableText;
using report::Tone;
using report::with_sigma;
using robot::handeye::Analysis;
using robot::handeye::HeldOutView;
using robot::handeye::Kind;

constexpr double mm = 1e3, deg = 180 / pi;

std::string mount_name(const HandEyeInput& input) {
  return input.setup.kind == Kind::eye_in_hand ? "tool" : "base";
}
std::string stand_name(const HandEyeInput& input) {
  return input.setup.kind == Kind::eye_in_hand ? "base" : "tool";
}

std::string headline(const Analysis& a) {
  if (!a.observability.unobservable.empty())
    return "These poses do not determine " + a.observability.unobservable.front() + ".";
  if (!a.complaints.empty()) return "Not to be trusted: " + a.complaints.front() + ".";
  if (const auto within = a.within_m()) {
    return "At a pose not seen, the board lies within " + number_text(*within * mm, 2) +
           " mm of where the robot says, at 95 %.";
  }
  return "Too few poses to test the result on one left out.";
}

std::vector<KeyNumber> key_numbers(const HandEyeInput& input, const Analysis& a) {
  std::vector<KeyNumber> numbers;
  const auto& r = a.consensus.refined;
  if (const auto* h = a.held_out_of(a.method)) {
    numbers.push_back({"Position, pose left out", number_text(h->rms.translation_m * mm, 3), "mm", "root mean square"});
    numbers.push_back({"Angle, pose left out", number_text(h->rms.rotation_rad * deg, 3), "deg", "root mean square"});
    numbers.push_back({"Corners, pose left out", number_text(h->rms.rms_px, 3), "px", "through the robot"});
  }
  if (a.method == "joint" && a.observability.mount_from_camera) {
    const double s = std::max({r.sigma(3), r.sigma(4), r.sigma(5)});
    numbers.push_back({"Camera on the " + mount_name(input), "\u00b1 " + number_text(s * mm, 2), "mm",
                       "largest of its three sigmas"});
  }
  numbers.push_back({"Robot noise", number_text(r.noise.robot_m * mm, 2), "mm",
                     number_text(r.noise.robot_rad * deg, 2) + " deg about each axis"});
  numbers.push_back(
      {"Turn of the seen board", number_text(r.noise.board_rad * deg, 2), "deg",
       "about each axis, beyond the corners\u2019 noise: lens or board are not quite what they are taken for"});
  const auto out = std::ranges::count(a.consensus.counts, false);
  numbers.push_back({"Poses", std::to_string(input.views.size() - static_cast<std::size_t>(out)), "",
                     out == 0 ? "no outlier" : std::to_string(out) + " outliers left out",
                     out == 0 ? Tone::neutral : Tone::bad});
  return numbers;
}

void add_mountings(Page& page, const HandEyeInput& input, const Analysis& a) {
  page.section("Mountings");
  TableText table;
  table.columns = {{"Motion", "", false}, {"x", "mm"},       {"y", "mm"},      {"z", "mm"},
                   {"turn x", "deg"},     {"turn y", "deg"}, {"turn z", "deg"}};
  const auto row = [&](const std::string& name, Vec3 t, Vec3 turn, std::size_t first, bool known) {
    std::vector<std::string> cells{name};
    const std::array<double, 6> value{t.x * mm, t.y * mm, t.z * mm, turn.x * deg, turn.y * deg, turn.z * deg};
    for (std::size_t k = 0; k < 6; ++k) {
      const double s = a.consensus.refined.sigma(first + (k + 3) % 6) * (k < 3 ? mm : deg);
      cells.push_back(!known                ? "not determined"
                      : a.method == "joint" ? with_sigma(value[k], s)
                                            : number_text(value[k], 6));
    }
    table.rows.push_back(cells);
  };
  const auto& x = a.solution.mount_from_camera;
  const auto& z = a.solution.stand_from_board;
  row(mount_name(input) + "_from_camera", x.translation_m, rotation_vector_of(x.rotation), 0,
      a.observability.mount_from_camera);
  row(stand_name(input) + "_from_board", z.translation_m, rotation_vector_of(z.rotation), 6,
      a.observability.stand_from_board);
  table.caption = "Turns are rotation vectors; their sigmas are those of a small turn about the " + mount_name(input) +
                  "\u2019s or " + stand_name(input) + "\u2019s axes. Sigmas include the noise of robot and corners" +
                  (input.setup.lens_order.empty() ? "." : " and the uncertainty of the camera\u2019s calibration.");
  page.table(table);
}

void add_correlations(Page& page, const Analysis& a) {
  if (a.method != "joint" || !a.observability.unobservable.empty()) return;
  report::HeatStrip strip;
  strip.title = "Correlations";
  strip.label = "correlation";
  strip.caption = "A camera that can shift if only the board shifts with it shows as a dark pair.";
  strip.diverging = true;
  strip.limit = 1;
  for (const std::string& body : {std::string("camera"), std::string("board")})
    for (const char* part : {" turn x", " turn y", " turn z", " x", " y", " z"}) strip.rows.push_back(body + part);
  strip.columns = strip.rows;
  const auto& r = a.consensus.refined;
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = 0; j < 12; ++j) strip.values.push_back(r.covariance[12 * i + j] / (r.sigma(i) * r.sigma(j)));
  page.heat_strip(strip);
}

void add_methods(Page& page, const Analysis& a) {
  if (a.held_out.empty()) return;
  page.section("Methods, on poses left out");
  TableText table;
  table.caption =
      "Every pose was left out in turn, and the board\u2019s place through the robot compared with what the camera saw "
      "there. Root mean squares; outliers take no part. Reprojection: corners alone, as if the robot\u2019s poses were "
      "exact.";
  table.columns = {{"Method", "", false}, {"Position", "mm"}, {"Angle", "deg"}, {"Corners", "px"}};
  for (const auto& e : a.held_out) {
    const std::string mark = e.method == a.method        ? " (written)"
                             : e.method == a.best_closed ? " (best closed form)"
                                                         : "";
    table.rows.push_back({e.method + mark, number_text(e.rms.translation_m * mm, 4),
                          number_text(e.rms.rotation_rad * deg, 4), number_text(e.rms.rms_px, 4)});
  }
  page.table(table);
}

Plot residual_plot(const HandEyeInput& input, const Analysis& a, const std::string& title, const std::string& unit,
                   double HeldOutView::*member, double scale) {
  Plot plot;
  plot.title = title;
  plot.x_label = "pose, in the order of the table";
  plot.y_label = unit;
  plot.zero_y = true;
  plot.series = {{.kind = Series::Kind::points, .name = a.best_closed + ", closed form"},
                 {.kind = Series::Kind::points, .name = a.method == "joint" ? "joint refinement" : a.method}};
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    plot.series[0].x.push_back(static_cast<double>(i + 1));
    plot.series[1].x.push_back(static_cast<double>(i + 1));
    plot.series[0].y.push_back(a.before[i].*member * scale);
    plot.series[1].y.push_back(a.after[i].*member * scale);
  }
  return plot;
}

void add_poses(Page& page, const HandEyeInput& input, const Analysis& a) {
  page.section("Residuals of every pose");
  page.plots({residual_plot(input, a, "Position of the board", "distance / mm", &HeldOutView::translation_m, mm),
              residual_plot(input, a, "Angle of the board", "angle / deg", &HeldOutView::rotation_rad, deg),
              residual_plot(input, a, "Corners through the robot", "root mean square / px", &HeldOutView::rms_px, 1)});
  TableText table;
  table.columns = {{"Image", "", false}, {"Before", "mm"}, {"After", "mm"},  {"Before", "deg"}, {"After", "deg"},
                   {"Before", "px"},     {"After", "px"},  {"Distance", ""}, {"", "", false}};
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    const HeldOutView &b = a.before[i], &c = a.after[i];
    table.rows.push_back({input.views[i].image, number_text(b.translation_m * mm, 3),
                          number_text(c.translation_m * mm, 3), number_text(b.rotation_rad * deg, 3),
                          number_text(c.rotation_rad * deg, 3), number_text(b.rms_px, 3), number_text(c.rms_px, 3),
                          number_text(std::sqrt(a.consensus.refined.mismatches[i].distance2), 3),
                          a.consensus.counts[i] ? "" : "outlier"});
  }
  table.caption = "Before: " + a.best_closed +
                  "; after: what was written. Distance: of robot and camera in standard deviations, six coordinates "
                  "together; beyond " +
                  number_text(std::sqrt(a.consensus.limit2), 3) + " a pose is an outlier.";
  page.table(table);
}

void add_parts(Page& page, const Analysis& a) {
  page.section("Where the scatter comes from");
  TableText table;
  table.columns = {{"Part", "", false}, {"Position of the board", "mm"}};
  table.rows = {{"scatter over the poses", number_text(a.scatter.translation_m * mm, 3)},
                {"robot: noise of its poses", number_text(a.parts.robot_m * mm, 3)},
                {"camera: noise of the corners", number_text(a.parts.camera_m * mm, 3)},
                {"unexplained", number_text(a.parts.unexplained_m * mm, 3)}};
  table.caption =
      "The robot\u2019s part is estimated from what the corners\u2019 noise cannot explain. A badly calibrated lens "
      "and a bent board count there as well: explain tells them apart.";
  page.table(table);
}

}  // namespace

std::string handeye_page(const HandEyeInput& input, const Analysis& a) {
  const Tone tone = a.complaints.empty() ? Tone::good : Tone::bad;
  Page page("Hand-eye calibration", headline(a),
            "Camera \u201c" + input.camera + "\u201d, board \u201c" + input.board + "\u201d, " +
                std::string(robot::handeye::name_of(input.setup.kind)) + ", " + std::to_string(input.views.size()) +
                " poses.",
            tone);
  page.section("Verdict");
  if (!a.complaints.empty()) page.list(a.complaints);
  page.key_numbers(key_numbers(input, a));
  const auto outliers = outlier_lines(input, a);
  if (!outliers.empty()) {
    page.subsection("Outliers");
    page.list(outliers);
  }
  page.subsection("Poses to add");
  if (a.next.empty())
    page.paragraph("None of the poses that were tried would narrow the camera\u2019s place by two per cent.");
  else
    page.list(a.next);
  add_mountings(page, input, a);
  add_correlations(page, a);
  add_methods(page, a);
  add_poses(page, input, a);
  add_parts(page, a);
  page.section("What the numbers mean");
  page.list(
      {"Position: distance between the board\u2019s middle as the camera saw it through the robot, and where the "
       "result puts it.",
       "Corners: root mean square distance in the image between found corners and the board predicted through the "
       "robot.",
       "Robot noise: one coordinate of the tool\u2019s position, and the turn about one axis, by restricted maximum "
       "likelihood.",
       "\u00b1: one standard deviation, widened for few poses so that 1.96 of them hold at 95 %."});
  page.footer("handeye, gonio " GONIO_VERSION ". This page is one file and loads nothing.");
  return page.html();
}

}  // namespace gonio::tools::handeye
