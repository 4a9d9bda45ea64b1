// See plan_page.h.
#include "acquisition/plan/plan_page.h"

#include <algorithm>
#include <cmath>

#include "acquisition/motion/line.h"
#include "acquisition/motion/way.h"
#include "base/text.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {
namespace {

constexpr std::size_t samples = 600;  // of a plot over time, beside the photographs
constexpr double far_enough_m = 0.2;  // beyond that clearances are not told apart
constexpr int drawing_px = 960;

// Evenly, and where arms stand to photograph.
std::vector<double> times_to_plot(const PlanTimes& times) {
  std::vector<double> all;
  for (std::size_t k = 0; k <= samples; ++k)
    all.push_back(times.end_s() * static_cast<double>(k) / static_cast<double>(samples));
  if (times.stands.size() <= samples)
    for (const PlanStand& stand : times.stands) all.push_back(stand.from_s);
  std::ranges::sort(all);
  const auto tail = std::ranges::unique(all);
  all.erase(tail.begin(), tail.end());
  return all;
}

report::Plot plot_over_time(const std::string& title, const std::string& y_label) {
  report::Plot plot;
  plot.title = title, plot.x_label = "time / s", plot.y_label = y_label, plot.over_time = true;
  return plot;
}

// Joints turn evenly from moment to moment: their lines need no more, unless there are too many moments.
std::vector<report::Plot> joints_plots(const Laboratory& laboratory, const PlanTimes& times,
                                       const std::vector<double>& at) {
  std::vector<std::pair<double, State>> states;
  if (times.moments.size() <= at.size())
    for (const PlanMoment& moment : times.moments) states.emplace_back(moment.time_s, moment.state);
  else
    for (const double t : at) states.emplace_back(t, state_at_time(laboratory, times, t));
  std::vector<report::Plot> plots;
  for (const auto& [name, arm] : laboratory.arms) {
    report::Plot plot = plot_over_time(name, "joint angle / deg");
    for (std::size_t j = 0; j < arm.links.size(); ++j) {
      report::Series series;
      series.name = format("joint %zu", j + 1);
      for (const auto& [t, state] : states) {
        series.x.push_back(t);
        series.y.push_back(joints_of(arm, state)[j] / degree);
      }
      plot.series.push_back(std::move(series));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::vector<report::Plot> limits_plots(const Laboratory& laboratory, const PlanTimes& times,
                                       const std::vector<double>& at) {
  const Surroundings surroundings(laboratory);
  report::Series clearance, singular;
  for (const double t : at) {
    const State state = state_at_time(laboratory, times, t);
    clearance.x.push_back(t), singular.x.push_back(t);
    clearance.y.push_back(1e3 * surroundings.clearance(state, far_enough_m).distance_m);
    singular.y.push_back(smallest_singular(laboratory, state));
  }
  report::Plot near = plot_over_time("Distance of the two nearest solids", "clearance / mm");
  near.caption = format("Distances beyond %.0f mm are drawn at that.", 1e3 * far_enough_m);
  for (double& y : clearance.y) y = std::min(y, 1e3 * far_enough_m);
  near.marks = {{report::Mark::Axis::y, 1e3 * laboratory.margin_m, "limit"}};
  near.series = {std::move(clearance)}, near.zero_y = true;
  report::Plot dexterous = plot_over_time("How far from singular postures", "smallest singular value / m");
  dexterous.marks = {{report::Mark::Axis::y, laboratory.smallest_singular_m, "limit"}};
  dexterous.series = {std::move(singular)}, dexterous.zero_y = true;
  return {near, dexterous};
}

std::string point(Vec3 p) {
  return format("%.3f, %.3f, %.3f", p.x, p.y, p.z);
}

// What stands there, where, and what reaches it: all that the drawing shows, as text.
report::TableText parts_of(const manifest::Document& document, const LaboratoryModel& lab) {
  const manifest::Laboratory& section = document.laboratory.entry.front();
  const auto places = io::placed_nodes(lab.model, 0);
  report::TableText table;
  table.columns = {{"name", "", false},
                   {"what", "", false},
                   {"where, at home", "m", false},
                   {"held by", "", false},
                   {"reached by", "", false}};
  const auto where = [&](const std::map<std::string, int>& nodes, const std::string& name) {
    const auto at = nodes.find(name);
    return at == nodes.end() ? "no place is described" : point(places[static_cast<std::size_t>(at->second)].origin_m);
  };
  for (const auto& [name, robot] : section.robots)
    table.rows.push_back({name, robot.model,
                          robot.world_from_base ? point(robot.world_from_base->translation_m) : point({}), "",
                          robot.url});
  for (const auto& [name, camera] : section.cameras)
    table.rows.push_back({name, document.cameras.contains(name) ? "camera" : "camera; its lens is not described",
                          where(lab.cameras, name), camera.robot, camera.url});
  for (const auto& [name, lamp] : section.lamps)
    table.rows.push_back({name, "lamp", where(lab.lamps, name), lamp.robot, lamp.url});
  for (const auto& [name, turns] : section.turntables)
    table.rows.push_back({name, "turntable", where(lab.turntables, name), "", turns.url});
  for (const auto& [name, screen] : section.screens)
    table.rows.push_back({name, screen.kind, where(lab.screens, name), "", screen.url});
  for (const manifest::SolidBody& body : section.obstacles)
    table.rows.push_back({body.name, "stands around",
                          body.world_from_body ? point(body.world_from_body->translation_m) : point({}), "", ""});
  return table;
}

std::string counted(std::size_t count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

}  // namespace

PlanDrawing drawing_of(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan) {
  PlanDrawing drawing;
  drawing.times = times_of(document, laboratory, plan);
  const std::vector<double> at = times_to_plot(drawing.times);
  drawing.joints = joints_plots(laboratory, drawing.times, at);
  if (!laboratory.arms.empty()) drawing.limits = limits_plots(laboratory, drawing.times, at);
  return drawing;
}

void show_model(report::Page& page, io::MovingModel model, double start_s, const std::string& caption) {
  report::Figure figure;
  report::MeshView view = view_of(std::move(model));
  view.start_s = start_s;
  view.legend = legend_of(view.moving);
  figure.svg = report::html(view);
  figure.caption = caption;
  page.figures({figure}, drawing_px);
}

void show_over_time(report::Page& page, const PlanDrawing& drawing) {
  if (!drawing.limits.empty()) page.plots(drawing.limits);
  if (!drawing.joints.empty()) page.plots(drawing.joints);
}

void list_unreachable(report::Page& page, const manifest::Plan& plan) {
  if (plan.unreachable.empty()) return;
  page.section("Views out of reach");
  report::TableText table;
  table.columns = {{"view", "", false}, {"why", "", false}, {"the nearest that can be reached stands at", "m", false}};
  for (const manifest::UnreachableView& view : plan.unreachable) {
    const bool found = view.nearest && view.nearest->world_from_camera;
    table.rows.push_back(
        {view.image, view.why, found ? point(view.nearest->world_from_camera->translation_m) : "none was found"});
  }
  page.table(table);
}

std::string laboratory_page(const manifest::Document& document, const Laboratory& laboratory) {
  const manifest::Laboratory& section = document.laboratory.entry.front();
  const LaboratoryModel lab = laboratory_model(document, laboratory);
  report::Page page("A laboratory",
                    counted(section.robots.size(), "arm") + ", " + counted(section.cameras.size(), "camera") + ", " +
                        counted(section.lamps.size(), "lamp"),
                    "As its description says; the arms stand at home. Nothing was asked of any device.");
  page.section("The laboratory");
  show_model(
      page, lab.model, 0,
      std::string("Drag or arrow keys turn it, the wheel or + and - bring it nearer, Shift and drag move it.") +
          (section.turntables.empty() ? "" : " Turntables are drawn 20 cm wide: how large they are is not described."));
  page.section("What stands there");
  page.table(parts_of(document, lab));
  return page.html();
}

std::string plan_page(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan) {
  const auto figure = [&](const char* name) {
    const auto at = plan.figures.find(name);
    return at == plan.figures.end() ? 0.0 : at->second;
  };
  const std::size_t missed = plan.unreachable.size();
  report::Page page("A plan", format("%zu pictures, %.0f s of motion", plan.steps.size(), figure("moving_s")),
                    "Pattern: " + plan.pattern + ". Plan " + plan.id.substr(0, 12) + ".",
                    missed == 0 ? report::Tone::good : report::Tone::neutral);
  page.key_numbers({{"views reached", format("%.0f of %.0f", figure("views_reached"), figure("views_asked")), "", "",
                     missed == 0 ? report::Tone::good : report::Tone::bad},
                    {"in motion", format("%.1f", figure("moving_s")), "s", ""},
                    {"smallest clearance", format("%.1f", 1e3 * figure("smallest_clearance_m")), "mm", ""},
                    {"smallest singular value", format("%.3f", figure("smallest_singular_m")), "m", ""},
                    {"largest turn of a joint", format("%.0f", figure("largest_turn_rad") / degree), "deg", ""}});
  if (!plan.steps.empty()) {
    const PlanDrawing drawing = drawing_of(document, laboratory, plan);
    page.section("The laboratory");
    show_model(page, plan_model(document, laboratory, plan, drawing.times).model, 0,
               "Space plays and pauses, Page Up and Page Down go from view to view; drag or arrow keys turn it, the "
               "wheel or + and - bring it nearer. The time is that of motions, turntables, lamps that settle and "
               "exposures; what cameras need to hand their pictures over comes on top.");
    page.section("Over time");
    show_over_time(page, drawing);
  }
  list_unreachable(page, plan);
  page.footer("Plan " + plan.id);
  return page.html();
}

}  // namespace gonio::acquisition
