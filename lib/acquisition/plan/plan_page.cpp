#include "acquisition/plan/plan_page.h"

#include <algorithm>
#include <cmath>

#include "acquisition/motion/body.h"
#include "acquisition/motion/line.h"
#include "acquisition/motion/way.h"
#include "acquisition/plan/planner.h"
#include "acquisition/plan/solid_mesh.h"
#include "base/text.h"
#include "geom/angle.h"
#include "manifest/sections/plan.h"
#include "report/mesh_view.h"
#include "report/page.h"

namespace gonio::acquisition {
namespace {

constexpr std::size_t moments = 5, most_samples = 600;
constexpr double far_enough_m = 0.2;  // beyond that clearances are not told apart

struct Moment {
  double time_s = 0;
  State state;
  bool view = false;  // the arms stand and photograph
};

// The plan over time: every state of its ways, and between them so many that about `most_samples` are drawn.
std::vector<Moment> moments_of(const Laboratory& laboratory, const manifest::Plan& plan) {
  std::vector<Moment> all;
  const std::size_t between_two = std::clamp<std::size_t>(most_samples / (plan.steps.size() + 1), 1, 20);
  double time = 0;
  for (std::size_t k = 0; k < plan.steps.size(); ++k) {
    const Way way = way_to(laboratory, plan, k);
    if (all.empty()) all.push_back({0, way.front(), false});
    double length = 0;
    for (std::size_t s = 1; s < way.size(); ++s) length += largest_turn(laboratory, way[s - 1], way[s]);
    const double duration = plan.steps[k].duration_s.value_or(0);
    for (std::size_t s = 1; s < way.size(); ++s) {
      const double share = length > 0 ? duration * largest_turn(laboratory, way[s - 1], way[s]) / length : 0;
      for (std::size_t i = 1; i <= between_two; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(between_two);
        all.push_back({time + t * share, between(laboratory, way[s - 1], way[s], t), false});
      }
      time += share;
    }
    all.back().view = true;
  }
  return all;
}

void add_mesh(report::ViewedMesh& to, const SolidMesh& mesh, const Mat3& rotation, Vec3 origin_m, float value) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3 v : mesh.vertices_m) {
    const Vec3 p = rotation * v + origin_m;
    to.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    to.value.push_back(value);
  }
  for (const auto& t : mesh.triangles) to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

report::MeshView laboratory_view(const Laboratory& laboratory, const manifest::Plan& plan,
                                 const std::vector<Moment>& all) {
  const std::vector<Body> bodies = bodies_of(laboratory);
  const auto arms = static_cast<float>(laboratory.arms.size());
  report::MeshView view;
  view.name = "the laboratory";
  view.label = "0 what stands";
  float number = 0;
  for (const auto& [name, arm] : laboratory.arms) view.label += format(", %.0f ", double{++number}) + name;
  view.label += format(", %.0f views", double{arms} + 1);
  view.high = double{arms} + 1;
  const SolidMesh dot = mesh_of(Solid{"view", Solid::Shape::box, {0.008, 0.008, 0.008}, {}, {}, "", 0, false, {}});
  for (std::size_t m = 0; m < moments; ++m) {
    const Moment& moment = all[m * (all.size() - 1) / (moments - 1)];
    report::ViewedMesh mesh;
    mesh.name = format("%.0f s", moment.time_s);
    const std::vector<PlacedBody> at = placed(laboratory, bodies, moment.state);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      add_mesh(mesh, mesh_of(*bodies[b].solid), at[b].rotation, at[b].origin_m, static_cast<float>(bodies[b].arm + 1));
    for (const manifest::PlanStep& step : plan.steps)
      if (step.world_from_camera) add_mesh(mesh, dot, Mat3{}, step.world_from_camera->translation_m, arms + 1);
    view.meshes.push_back(std::move(mesh));
  }
  return view;
}

report::Plot joints_plot(const LaboratoryArm& arm, const std::vector<Moment>& all) {
  report::Plot plot;
  plot.title = arm.name, plot.x_label = "time / s", plot.y_label = "joint angle / deg";
  for (std::size_t j = 0; j < arm.links.size(); ++j) {
    report::Series series;
    series.name = format("joint %zu", j + 1);
    for (const Moment& m : all) {
      series.x.push_back(m.time_s);
      series.y.push_back(joints_of(arm, m.state)[j] / degree);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

void plot_over_time(report::Page& page, const Laboratory& laboratory, const std::vector<Moment>& all) {
  const Surroundings surroundings(laboratory);
  report::Series clearance, singular;
  for (const Moment& m : all) {
    clearance.x.push_back(m.time_s), singular.x.push_back(m.time_s);
    clearance.y.push_back(1e3 * surroundings.clearance(m.state, far_enough_m).distance_m);
    singular.y.push_back(smallest_singular(laboratory, m.state));
  }
  report::Plot near, dexterous;
  near.title = "Distance of the two nearest solids", near.x_label = "time / s", near.y_label = "clearance / mm";
  near.caption = format("Distances beyond %.0f mm are drawn at that.", 1e3 * far_enough_m);
  near.marks = {{report::Mark::Axis::y, 1e3 * laboratory.margin_m, "limit"}};
  near.series = {std::move(clearance)}, near.zero_y = true;
  dexterous.title = "How far from singular postures", dexterous.x_label = "time / s";
  dexterous.y_label = "smallest singular value / m", dexterous.zero_y = true;
  dexterous.marks = {{report::Mark::Axis::y, laboratory.smallest_singular_m, "limit"}};
  dexterous.series = {std::move(singular)};
  page.plots({near, dexterous});
  std::vector<report::Plot> joints;
  for (const auto& [name, arm] : laboratory.arms) joints.push_back(joints_plot(arm, all));
  page.plots(joints);
}

void list_unreachable(report::Page& page, const manifest::Plan& plan) {
  if (plan.unreachable.empty()) return;
  page.section("Views out of reach");
  report::TableText table;
  table.columns = {{"view", "", false}, {"why", "", false}, {"the nearest that can be reached stands at", "m", false}};
  for (const manifest::UnreachableView& view : plan.unreachable) {
    std::string there = "none was found";
    if (view.nearest && view.nearest->world_from_camera) {
      const Vec3 p = view.nearest->world_from_camera->translation_m;
      there = format("%.3f, %.3f, %.3f", p.x, p.y, p.z);
    }
    table.rows.push_back({view.image, view.why, there});
  }
  page.table(table);
}

}  // namespace

std::string plan_page(const Laboratory& laboratory, const manifest::Plan& plan) {
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
    const std::vector<Moment> all = moments_of(laboratory, plan);
    page.section("The laboratory");
    report::Figure drawing;
    drawing.svg = report::html(laboratory_view(laboratory, plan, all));
    drawing.caption = "Small cubes: where the camera photographs. Buttons: moments of the plan.";
    page.figures({drawing}, 640);
    page.section("Over time");
    plot_over_time(page, laboratory, all);
  }
  list_unreachable(page, plan);
  page.footer("Plan " + plan.id);
  return page.html();
}

}  // namespace gonio::acquisition
