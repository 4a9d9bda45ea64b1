// See plan_model.h.
#include "acquisition/plan/plan_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "acquisition/laboratory/usual.h"
#include "acquisition/motion/line.h"
#include "acquisition/motion/way.h"
#include "acquisition/plan/drawn_shapes.h"
#include "acquisition/plan/planner.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {
namespace {

constexpr double mark_m = 0.025, missed_mark_m = 0.012;

// Of the step's lamps the slowest, and all its exposures.
double standing_time(const manifest::Laboratory& section, const manifest::PlanStep& step) {
  double settles = 0, exposed = 0;
  for (const std::string& name : step.lamps)
    if (const auto lamp = section.lamps.find(name); lamp != section.lamps.end())
      settles = std::max(settles, lamp->second.settle_s.value_or(0));
  for (const double e : step.exposures_s) exposed += e;
  return settles + (step.exposures_s.empty() ? usual_exposure_s : exposed);
}

class Schedule {
 public:
  Schedule(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan)
      : section_(document.laboratory.entry.front()), laboratory_(laboratory), plan_(plan) {}

  PlanTimes run() {
    for (std::size_t k = 0; k < plan_.steps.size(); ++k) {
      move(k);
      turn_tables(plan_.steps[k]);
      PlanMoment stays = times_.moments.back();
      stays.time_s += standing_time(section_, plan_.steps[k]);
      times_.stands.push_back({times_.moments.back().time_s, stays.time_s});
      enter(std::move(stays));
    }
    return std::move(times_);
  }

 private:
  // A moment of the time of the last one takes its place.
  void enter(PlanMoment moment) {
    auto& all = times_.moments;
    if (!all.empty() && !(moment.time_s > all.back().time_s))
      all.back().state = std::move(moment.state), all.back().turntables = std::move(moment.turntables);
    else
      all.push_back(std::move(moment));
  }

  void move(std::size_t k) {
    const Way way = way_to(laboratory_, plan_, k);
    if (times_.moments.empty()) enter({0, way.front(), {}});
    double length = 0;
    for (std::size_t s = 1; s < way.size(); ++s) length += largest_turn(laboratory_, way[s - 1], way[s]);
    if (!(length > 0)) return;
    const double said = plan_.steps[k].duration_s.value_or(0), duration = said > 0 ? said : way_time(laboratory_, way);
    for (std::size_t s = 1; s < way.size(); ++s) {
      PlanMoment next = times_.moments.back();
      next.time_s += duration * largest_turn(laboratory_, way[s - 1], way[s]) / length;
      next.state = way[s];
      enter(std::move(next));
    }
  }

  void turn_tables(const manifest::PlanStep& step) {
    PlanMoment next = times_.moments.back();
    double longest = 0;
    for (const auto& [name, angle] : step.turntable_rad) {
      const auto table = section_.turntables.find(name);
      if (table == section_.turntables.end()) continue;
      longest = std::max(
          longest, trapezoid_time(angle - next.turntables[name],
                                  table->second.speed_rad_per_s.value_or(usual_table_speed_rad_per_s),
                                  table->second.acceleration_rad_per_s2.value_or(usual_table_acceleration_rad_per_s2)));
      next.turntables[name] = angle;
    }
    next.time_s += longest;
    enter(std::move(next));
  }

  const manifest::Laboratory& section_;
  const Laboratory& laboratory_;
  const manifest::Plan& plan_;
  PlanTimes times_;
};

using CameraPose = Rigid<frame::World, frame::Camera>;

// Where the step's camera photographs: as asked, else where the laboratory believes it then.
std::optional<CameraPose> camera_pose(const manifest::Document& document, const Laboratory& laboratory,
                                      const LaboratoryModel& lab, const manifest::Plan& plan, std::size_t k) {
  const manifest::PlanStep& step = plan.steps[k];
  if (step.world_from_camera) return *step.world_from_camera;
  if (!lab.cameras.contains(step.camera)) return std::nullopt;
  return world_from_camera(document, laboratory, step.camera, state_at(laboratory, plan, k));
}

class Marks {
 public:
  Marks(const manifest::Document& document, LaboratoryModel& lab) : document_(document), lab_(lab) {}

  // Marks at one place are one: the views of many lamps or exposures.
  io::ModelNode& at(const CameraPose& pose, const std::string& name, int mesh, Tint tint) {
    const auto tenth_mm = [](double v) { return std::lround(v * 1e4); };
    const Vec3 p = pose.translation_m, ahead = pose.rotate({0, 0, 0.1});
    const auto [found, is_new] = places_.try_emplace({tenth_mm(p.x), tenth_mm(p.y), tenth_mm(p.z), tenth_mm(ahead.x),
                                                      tenth_mm(ahead.y), tenth_mm(ahead.z), static_cast<int>(tint)},
                                                     lab_.model.nodes.size());
    if (is_new)
      lab_.model.nodes.push_back({.name = name,
                                  .placed = {pose.rotation, pose.translation_m},
                                  .mesh = mesh,
                                  .colour = static_cast<int>(tint)});
    return lab_.model.nodes[found->second];
  }
  int view_mesh(const std::string& camera) {
    const auto [at, is_new] = meshes_.try_emplace(camera, -1);
    if (is_new) at->second = add(pyramid(picture_corners(document_, camera, mark_m)));
    return at->second;
  }
  int missed_mesh() {
    if (missed_ < 0) missed_ = add(double_pyramid(missed_mark_m));
    return missed_;
  }

 private:
  int add(io::TriangleMesh mesh) {
    lab_.model.meshes.push_back(std::move(mesh));
    return static_cast<int>(lab_.model.meshes.size()) - 1;
  }
  const manifest::Document& document_;
  LaboratoryModel& lab_;
  std::map<std::array<long, 7>, std::size_t> places_;
  std::map<std::string, int> meshes_;
  int missed_ = -1;
};

void mark_views(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
                const PlanTimes& times, const std::set<std::size_t>* taken, LaboratoryModel& lab) {
  Marks marks(document, lab);
  for (std::size_t k = 0; k < plan.steps.size(); ++k) {
    const auto pose = camera_pose(document, laboratory, lab, plan, k);
    if (!pose) continue;
    const manifest::PlanStep& step = plan.steps[k];
    io::ModelNode& mark = marks.at(*pose, step.image, marks.view_mesh(step.camera), Tint::to_take);
    const int done = static_cast<int>(Tint::taken);
    if (taken == nullptr)  // of several at one place the last
      mark.changes = {{times.stands[k].until_s, done}};
    else
      mark.changes = taken->contains(k) ? std::vector{io::ColourChange{-1, done}} : std::vector<io::ColourChange>{};
  }
  for (const manifest::UnreachableView& view : plan.unreachable)
    if (view.world_from_camera) marks.at(*view.world_from_camera, view.image, marks.missed_mesh(), Tint::unreachable);
}

// Lit from where the arms stand until the last exposure.
void light_lamps(const manifest::Plan& plan, const PlanTimes& times, LaboratoryModel& lab) {
  for (const auto& [name, node] : lab.lamps) {
    auto& changes = lab.model.nodes[static_cast<std::size_t>(node)].changes;
    for (std::size_t k = 0; k < plan.steps.size(); ++k) {
      if (std::ranges::find(plan.steps[k].lamps, name) == plan.steps[k].lamps.end()) continue;
      if (!changes.empty() && changes.back().from_s >= times.stands[k].from_s)
        changes.pop_back();  // it stays on
      else
        changes.push_back({times.stands[k].from_s, static_cast<int>(Tint::lit)});
      changes.push_back({times.stands[k].until_s, static_cast<int>(Tint::lamp)});
    }
  }
}

std::string words_of_step(const manifest::PlanStep& step) {
  std::string words = step.image;
  if (!step.purpose.empty() && step.purpose != "view") words += " (" + step.purpose + ")";
  if (step.straight.value_or(false)) words += ", in a straight line";
  return words;
}

}  // namespace

PlanTimes times_of(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan) {
  return Schedule(document, laboratory, plan).run();
}

State state_at_time(const Laboratory& laboratory, const PlanTimes& times, double time_s) {
  const auto& all = times.moments;
  const auto after = std::ranges::upper_bound(all, time_s, {}, &PlanMoment::time_s);
  if (after == all.begin()) return all.front().state;
  if (after == all.end()) return all.back().state;
  const PlanMoment &a = *(after - 1), &b = *after;
  return between(laboratory, a.state, b.state, (time_s - a.time_s) / (b.time_s - a.time_s));
}

LaboratoryModel plan_model(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
                           const PlanTimes& times, const std::set<std::size_t>* taken) {
  LaboratoryModel lab = laboratory_model(document, laboratory);
  if (plan.steps.empty()) return lab;
  lab.model.keys.clear();
  for (const PlanMoment& moment : times.moments)
    lab.model.keys.push_back({moment.time_s, hinge_angles(document, laboratory, moment.state, moment.turntables)});
  double before = 0;
  for (std::size_t k = 0; k < plan.steps.size(); ++k) {
    const PlanStand stand = times.stands[k];
    if (stand.from_s > before) lab.model.words.push_back({before, "to " + words_of_step(plan.steps[k])});
    lab.model.words.push_back({stand.from_s, words_of_step(plan.steps[k]), true});
    before = stand.until_s;
  }
  mark_views(document, laboratory, plan, times, taken, lab);
  light_lamps(plan, times, lab);
  return lab;
}

std::vector<report::ColourKey> legend_of(const io::MovingModel& model) {
  const std::pair<Tint, const char*> all[] = {{Tint::camera, "what a camera sees"},
                                              {Tint::lamp, "lamp"},
                                              {Tint::lit, "lamp, lit"},
                                              {Tint::turntable, "turntable"},
                                              {Tint::to_take, "view to be taken"},
                                              {Tint::taken, "view taken"},
                                              {Tint::unreachable, "view out of reach"}};
  std::vector<report::ColourKey> keys;
  for (const auto& [tint, words] : all) {
    const int colour = static_cast<int>(tint);
    const bool shown = std::ranges::any_of(model.nodes, [colour](const io::ModelNode& n) {
      return n.mesh >= 0 &&
             (n.colour == colour || std::ranges::find(n.changes, colour, &io::ColourChange::colour) != n.changes.end());
    });
    if (shown) keys.push_back({colour, words});
  }
  return keys;
}

}  // namespace gonio::acquisition
