#include "acquisition/plan/planner.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "acquisition/motion/line.h"
#include "acquisition/plan/candidates.h"
#include "acquisition/plan/edges.h"
#include "acquisition/plan/nearest_view.h"
#include "acquisition/plan/stations.h"
#include "acquisition/plan/tour.h"
#include "base/error.h"
#include "base/random.h"
#include "base/text.h"
#include "manifest/document.h"

namespace gonio::acquisition {
namespace {

// Without arms there is no singularity, and without solids nothing to stay clear of.
std::optional<double> if_finite(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

constexpr int most_rounds = 12;
constexpr std::size_t tour_rounds_each = 8, most_tour_rounds = 6000;  // of ruin and recreate, per view
constexpr double forbidden_s = 1e7;

// With as much more margin as a walk may overlook, so that the margin itself holds everywhere; no more than home has.
Laboratory careful(const Laboratory& laboratory) {
  Laboratory with = laboratory;
  const double wanted = laboratory.margin_m + walking_step_m;
  State home;
  for (const auto& [name, arm] : laboratory.arms) home[name] = arm.home;
  const double there = Surroundings(laboratory).clearance(home, wanted).distance_m;
  with.margin_m = std::clamp((1 - 1e-9) * there, laboratory.margin_m, wanted);
  return with;
}

struct Planner {
  const manifest::Document& document;
  const Laboratory laboratory;
  const std::vector<manifest::PlanStep>& asked;
  const PlanOptions& options;
  Surroundings surroundings;
  Configurations configurations;
  Vec3 target_m;
  CandidateSearch search;
  std::vector<Station> stations;
  std::vector<std::string> why;  // of each station; empty: reachable
  std::vector<Candidates> candidates;
  // Clusters: the views' stations first, then those met between them.
  Clusters views, all;
  std::vector<std::size_t> station_of, cluster_of;  // of clusters, of stations
  std::vector<std::size_t> cluster_of_candidate;
  std::optional<PlanEdges> edges;

  Planner(const manifest::Document& d, const Laboratory& l, const std::vector<manifest::PlanStep>& a,
          const PlanOptions& o)
      : document(d),
        laboratory(careful(l)),
        asked(a),
        options(o),
        surroundings(laboratory),
        configurations(laboratory),
        target_m(o.target_m.value_or(common_target(a))),
        search(d, laboratory, surroundings, target_m),
        stations(stations_of(a, o)) {}

  bool as_asked() const { return options.keep_order || !options.straight.empty(); }
  const manifest::PlanStep& step_of(std::size_t station) const { return asked[stations[station].steps.front()]; }
  std::string robot_of(std::size_t station) const {
    return step_of(station).camera.empty() ? "" : camera_arm(document, step_of(station));
  }
  std::vector<bool> reachable() const {
    std::vector<bool> is(stations.size());
    for (std::size_t k = 0; k < stations.size(); ++k) is[k] = why[k].empty();
    return is;
  }
  double cost(std::size_t a, std::size_t b) const { return edges->cost(a, b); }

  void check() const;
  void find_candidates();
  void number_clusters();
  std::vector<Visit> visits(const std::vector<std::size_t>& tour) const;
  std::vector<std::size_t> choose(const std::vector<Visit>& stops) const;
  bool drop_closed(const std::vector<Visit>& stops, const std::vector<std::size_t>& chosen);
  void order(std::vector<Visit>& stops, std::vector<std::size_t>& chosen);
  void settle(manifest::PlanStep& step, const State& state) const;
  void write(const std::vector<Visit>& stops, const std::vector<std::size_t>& chosen, manifest::Plan& plan) const;
  void write_unreachable(manifest::Plan& plan) const;
};

void Planner::check() const {
  std::set<std::string> images;
  for (const manifest::PlanStep& step : asked)
    if (!images.insert(step.image).second)
      throw Error(Exit::data, "plan", "image \"" + step.image + "\" is asked twice", "give every view its own id");
  const auto needs = [&](int every, const std::string& purpose) {
    if (every > 0 && std::ranges::none_of(asked, [&](const auto& s) { return s.purpose == purpose; }))
      throw Error(Exit::data, "plan",
                  format("a %s frame every %d views, and no step of that purpose is asked", purpose.c_str(), every),
                  "ask for a view of it");
  };
  needs(options.reference_every, "reference"), needs(options.board_every, "board");
  const State home = configurations.state(configurations.home());
  if (!surroundings.free(home, laboratory.margin_m)) {
    const Clearance c = surroundings.clearance(home, laboratory.margin_m + 1e-6);
    throw Error(Exit::data, manifest::place(document, "/laboratory/robots"),
                format("at home %s comes within %.3g m of %s, limit %.3g m", c.first.c_str(), c.distance_m,
                       c.second.c_str(), laboratory.margin_m),
                "give the arms another home_rad");
  }
  if (const std::string broken = broken_at(laboratory, home, smallest_singular(laboratory, home)); !broken.empty())
    throw Error(Exit::data, manifest::place(document, "/laboratory/robots"), "at home " + broken,
                "give the arms another home_rad, or the laboratory wider limits");
}

void Planner::find_candidates() {
  std::vector<const manifest::PlanStep*> steps;
  for (std::size_t k = 0; k < stations.size(); ++k) steps.push_back(&step_of(k));
  candidates = search.find(steps);
  why.clear();
  for (const Candidates& c : candidates) why.push_back(c.all.empty() ? c.why : "");
}

void Planner::number_clusters() {
  views.first = {0}, all.first = {0};
  station_of.clear(), cluster_of.assign(stations.size(), 0), cluster_of_candidate.clear();
  std::vector<PlanCandidate> numbered;
  for (const bool between : {false, true})
    for (std::size_t k = 0; k < stations.size(); ++k) {
      if (!why[k].empty() || stations[k].between.empty() == between) continue;
      const manifest::PlanStep& step = step_of(k);
      double table = 0;
      for (const auto& [name, angle] : step.turntable_rad) table += angle;
      const bool straight = !options.straight.empty() && step.camera == options.straight && step.world_from_camera;
      for (const Configuration& joints : candidates[k].all) {
        numbered.push_back({configurations.placed(joints), k, table, straight && !between ? robot_of(k) : ""});
        cluster_of_candidate.push_back(station_of.size());
      }
      cluster_of[k] = station_of.size();
      station_of.push_back(k);
      all.first.push_back(numbered.size());
      if (!between) views.first.push_back(numbered.size());
    }
  edges.emplace(laboratory, surroundings, configurations, std::move(numbered), options.seed);
}

std::vector<Visit> Planner::visits(const std::vector<std::size_t>& tour) const {
  std::vector<Visit> stops;
  if (as_asked()) {
    stops = visits_as_asked(asked, stations, reachable());
  } else {
    std::vector<std::size_t> order;
    for (const std::size_t c : tour) order.push_back(station_of[cluster_of_candidate[c]]);
    if (options.shuffle) {
      std::ranges::sort(order);
      Random random(options.seed, 0x5f0ff1e);
      for (std::size_t k = order.size(); k > 1; --k)
        std::swap(order[k - 1], order[random.below(static_cast<std::uint32_t>(k))]);
    }
    stops = visits_of(asked, stations, order);
  }
  const auto far = [&](std::size_t a, std::size_t b) {
    return cost(all.first[cluster_of[a]], all.first[cluster_of[b]]);
  };
  return interleaved(std::move(stops), asked, stations, reachable(), options, far);
}

// A station that is visited more than once always has the same joints: those that it would have most often.
std::vector<std::size_t> Planner::choose(const std::vector<Visit>& stops) const {
  std::vector<std::size_t> order;
  for (const Visit& v : stops) order.push_back(cluster_of[v.station]);
  const std::vector<std::size_t> free = choose_along(all, order, [&](auto a, auto b) { return cost(a, b); });
  std::vector<std::size_t> times(cluster_of_candidate.size()), visited(all.count()), fixed(all.count(), tour_home);
  for (const std::size_t c : free) ++times[c], ++visited[cluster_of_candidate[c]];
  for (const std::size_t c : free) {
    const std::size_t k = cluster_of_candidate[c];
    if (visited[k] > 1 && (fixed[k] == tour_home || times[c] > times[fixed[k]])) fixed[k] = c;
  }
  return choose_along(all, order, [&](std::size_t a, std::size_t b) {
    const auto other = [&](std::size_t c) {
      return c != tour_home && fixed[cluster_of_candidate[c]] != tour_home && fixed[cluster_of_candidate[c]] != c;
    };
    return other(a) || other(b) ? forbidden_s : cost(a, b);
  });
}

// Takes out the stations behind closed edges; false where there are none.
bool Planner::drop_closed(const std::vector<Visit>& stops, const std::vector<std::size_t>& chosen) {
  bool any = false;
  for (std::size_t k = 0; k <= chosen.size(); ++k) {
    const std::size_t from = k == 0 ? tour_home : chosen[k - 1], to = k < chosen.size() ? chosen[k] : tour_home;
    if (from == to || cost(from, to) < PlanEdges::closed_s) continue;
    // The end of the tour cannot lead home: its last view goes.
    std::string& reason = why[stops[std::min(k, chosen.size() - 1)].station];
    if (reason.empty()) reason = "no way there: " + edges->way(from, to).fault, any = true;
    ++k;  // the next edge begins where none will stand
  }
  return any;
}

void Planner::order(std::vector<Visit>& stops, std::vector<std::size_t>& chosen) {
  for (bool dropped = true; dropped;) {
    number_clusters();
    std::vector<std::size_t> tour;
    for (std::size_t c = 0; c < views.count(); ++c) tour.push_back(views.first[c]);
    bool open = false;
    for (int round = 0; round < most_rounds && !(open && round > 1); ++round) {
      if (!as_asked() && !options.shuffle && views.count() > 0) {
        const std::size_t rounds = std::min(most_tour_rounds, tour_rounds_each * views.count());
        tour = shortest_tour(views, [&](auto a, auto b) { return cost(a, b); },
                             {.seed = options.seed + static_cast<std::uint64_t>(round),
                              .rounds = round == 0 ? rounds : rounds / 4,
                              .start = round == 0 ? std::vector<std::size_t>{} : tour});
      }
      stops = visits(tour);
      chosen = choose(stops);
      open = chosen.empty() || edges->walk(chosen);
    }
    // What lines failed on in the last round is searched for now; only what is closed for good costs a view.
    if (!open) open = edges->walk(chosen);
    dropped = !open && drop_closed(stops, chosen);
  }
}

// Where a camera that may be turned about its axis really is.
void Planner::settle(manifest::PlanStep& step, const State& state) const {
  if (!step.roll_rad) return;
  step.roll_rad.reset();
  if (!step.robot.empty() && step.world_from_camera)
    static_cast<Rigid<frame::World, frame::Camera>&>(*step.world_from_camera) =
        world_from_camera(document, laboratory, step.camera, state);
}

void Planner::write(const std::vector<Visit>& stops, const std::vector<std::size_t>& chosen,
                    manifest::Plan& plan) const {
  double duration = 0, singular = 0, clearance = 0, turn = 0, detours = 0, straight = 0;
  bool moved = false;
  for (std::size_t k = 0; k < stops.size(); ++k) {
    const std::size_t from = k == 0 ? tour_home : chosen[k - 1];
    const WalkedWay way = edges->way(from, chosen[k]);
    const State state = way.states.back();
    for (std::size_t f = 0; f < stops[k].frames.size(); ++f) {
      const Frame& frame = stops[k].frames[f];
      manifest::PlanStep step = asked[frame.step];
      step.image = frame.image, step.purpose = frame.purpose;
      if (frame.purpose == "dark" && asked[frame.step].purpose != "dark") step.lamps.clear(), step.light_m.clear();
      set_joints(step, state, robot_of(stops[k].station));
      settle(step, state);
      step.via.clear();
      if (f == 0 && from != chosen[k]) {
        for (std::size_t s = 1; s + 1 < way.states.size(); ++s) step.via.push_back(way.states[s]);
        if (way.straight) step.straight = true;
        step.duration_s = way.figures.duration_s;
        step.clearance_m = if_finite(way.figures.clearance_m);
        step.smallest_singular_m = if_finite(way.figures.smallest_singular_m);
      } else {
        step.duration_s = 0;
      }
      plan.steps.push_back(std::move(step));
    }
    if (from == chosen[k]) continue;
    duration += way.figures.duration_s, turn = std::max(turn, way.figures.largest_turn_rad);
    singular = moved ? std::min(singular, way.figures.smallest_singular_m) : way.figures.smallest_singular_m;
    clearance = moved ? std::min(clearance, way.figures.clearance_m) : way.figures.clearance_m;
    detours += way.states.size() > 2 && !way.straight, straight += way.straight, moved = true;
  }
  plan.figures["moving_s"] = duration, plan.figures["detours"] = detours, plan.figures["straight_ways"] = straight;
  if (!moved) return;
  if (if_finite(singular)) plan.figures["smallest_singular_m"] = singular;
  if (if_finite(clearance)) plan.figures["smallest_clearance_m"] = clearance;
  plan.figures["largest_turn_rad"] = turn;
}

void Planner::write_unreachable(manifest::Plan& plan) const {
  double reached = 0;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    if (why[k].empty()) {
      reached += static_cast<double>(stations[k].steps.size());
      continue;
    }
    const auto nearest = nearest_reachable(search, configurations, step_of(k), why[k], target_m, robot_of(k));
    for (const std::size_t s : stations[k].steps) {
      manifest::UnreachableView view{asked[s].image, why[k], asked[s].world_from_camera, {}};
      if (nearest) {
        view.nearest = asked[s];
        view.nearest->world_from_camera = nearest->world_from_camera, view.nearest->light_m = nearest->light_m;
        view.nearest->robot = nearest->robot, view.nearest->joints_rad = nearest->joints_rad;
        view.nearest->other_arms = nearest->other_arms;
        State state = nearest->other_arms;
        if (!nearest->robot.empty()) state[nearest->robot] = nearest->joints_rad;
        settle(*view.nearest, state);
      }
      plan.unreachable.push_back(std::move(view));
    }
  }
  plan.figures["views_asked"] = static_cast<double>(asked.size()), plan.figures["views_reached"] = reached;
}

}  // namespace

manifest::Plan make_plan(const manifest::Document& document, const Laboratory& laboratory,
                         const std::vector<manifest::PlanStep>& asked, const std::string& pattern,
                         const PlanOptions& options, Progress* progress) {
  Planner planner(document, laboratory, asked, options);
  planner.check();
  planner.find_candidates();
  if (progress != nullptr) progress->advance(asked.size() / 2);
  manifest::Plan plan;
  plan.pattern = pattern, plan.seed = options.seed;
  std::vector<Visit> stops;
  std::vector<std::size_t> chosen;
  planner.order(stops, chosen);
  planner.write(stops, chosen, plan);
  planner.write_unreachable(plan);
  if (progress != nullptr) progress->advance(asked.size() - asked.size() / 2);
  plan.id = plan_id(document, plan);
  return plan;
}

}  // namespace gonio::acquisition
