#include "acquisition/plan/stations.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/random.h"
#include "base/text.h"
#include "linear/solve.h"

namespace gonio::acquisition {
namespace {

using manifest::PlanStep;

std::string what_it_asks(const PlanStep& step) {
  std::string key;
  const auto add = [&](double v) { key += format("%.17g,", v); };
  if (step.world_from_camera) {
    const auto& p = *step.world_from_camera;
    key += step.camera + ":";
    for (const double v : {p.rotation.w, p.rotation.x, p.rotation.y, p.rotation.z}) add(v);
    for (int k = 0; k < 3; ++k) add(p.translation_m[k]);
    add(step.roll_rad.value_or(0));
  }
  // Which of its lamps is held decides where the arm stands.
  if (!step.light_m.empty()) {
    for (const std::string& lamp : step.lamps) key += "|" + lamp;
    for (const double v : step.light_m) add(v);
  }
  for (const auto& [name, angle] : step.turntable_rad) key += "|" + name + ":", add(angle);
  return key;
}

std::string between_views(const PlanStep& step, const PlanOptions& options) {
  if (step.purpose == "reference" && options.reference_every > 0) return step.purpose;
  if (step.purpose == "board" && options.board_every > 0) return step.purpose;
  return {};
}

Frame frame_of(const std::vector<PlanStep>& asked, std::size_t step) {
  return {step, asked[step].image, asked[step].purpose.empty() ? "view" : asked[step].purpose};
}

// Visits of one purpose between views, its stations in turn.
struct Interruption {
  std::string purpose;
  int every = 0, since = 0;
  std::vector<std::size_t> stations;
  std::size_t taken = 0;

  Visit next(const std::vector<PlanStep>& asked, const std::vector<Station>& all) {
    const std::size_t station = stations[taken % stations.size()];
    const std::size_t round = taken / stations.size() + 1;
    ++taken, since = 0;
    Visit visit{station, {}};
    for (const std::size_t s : all[station].steps)
      visit.frames.push_back({s, format("%s-take-%zu", asked[s].image.c_str(), round), purpose});
    return visit;
  }
};

// One of the frames of each of some visits, drawn; where they are to stand: behind which visit, by number.
std::vector<std::vector<Visit>> repeats_behind(const std::vector<Visit>& views, const PlanOptions& options,
                                               const std::function<double(std::size_t, std::size_t)>& far) {
  std::vector<std::vector<Visit>> behind(views.size());
  std::vector<std::pair<std::size_t, Frame>> left;  // visit
  std::size_t frames = 0;
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const Frame& f : views[v].frames) left.emplace_back(v, f), ++frames;
  Random random(options.seed, 0x4e9ea7);
  for (std::size_t k = left.size(); k > 1; --k)
    std::swap(left[k - 1], left[random.below(static_cast<std::uint32_t>(k))]);
  const auto count =
      std::min(left.size(), static_cast<std::size_t>(std::lround(options.repeat_share * static_cast<double>(frames))));
  left.resize(count);
  const std::size_t apart = views.size() / 4;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t place = std::min(views.size() - 1, (k + 1) * views.size() / (count + 1));
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < left.size(); ++r) {
      const std::size_t from = left[r].first, gap = from > place ? from - place : place - from;
      // Where none is far enough in time, the farthest.
      const double c =
          gap >= apart ? far(views[place].station, views[from].station) : 1e9 * static_cast<double>(1 + apart - gap);
      if (c < least) least = c, best = r;
    }
    Frame frame = left[best].second;
    frame.image += "-take-2", frame.purpose = "repeat";
    behind[place].push_back({views[left[best].first].station, {frame}});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return behind;
}

}  // namespace

std::vector<Station> stations_of(const std::vector<PlanStep>& asked, const PlanOptions& options) {
  std::map<std::string, std::size_t> known;
  std::vector<Station> stations;
  for (std::size_t s = 0; s < asked.size(); ++s) {
    const std::string between = between_views(asked[s], options);
    const auto [at, added] = known.try_emplace(between + "#" + what_it_asks(asked[s]), stations.size());
    if (added) stations.push_back({{}, between});
    stations[at->second].steps.push_back(s);
  }
  return stations;
}

std::vector<Visit> visits_of(const std::vector<PlanStep>& asked, const std::vector<Station>& stations,
                             const std::vector<std::size_t>& order) {
  std::vector<Visit> visits;
  for (const std::size_t station : order) {
    visits.push_back({station, {}});
    for (const std::size_t s : stations[station].steps) visits.back().frames.push_back(frame_of(asked, s));
  }
  return visits;
}

std::vector<Visit> visits_as_asked(const std::vector<PlanStep>& asked, const std::vector<Station>& stations,
                                   const std::vector<bool>& reachable) {
  std::vector<std::size_t> station_of(asked.size());
  for (std::size_t k = 0; k < stations.size(); ++k)
    for (const std::size_t s : stations[k].steps) station_of[s] = k;
  std::vector<Visit> visits;
  for (std::size_t s = 0; s < asked.size(); ++s) {
    const std::size_t k = station_of[s];
    if (!reachable[k] || !stations[k].between.empty()) continue;
    if (visits.empty() || visits.back().station != k) visits.push_back({k, {}});
    visits.back().frames.push_back(frame_of(asked, s));
  }
  return visits;
}

std::vector<Visit> interleaved(std::vector<Visit> views, const std::vector<PlanStep>& asked,
                               const std::vector<Station>& stations, const std::vector<bool>& reachable,
                               const PlanOptions& options, const std::function<double(std::size_t, std::size_t)>& far) {
  if (views.empty()) return views;
  std::vector<Interruption> between{{"reference", options.reference_every, 0, {}, 0},
                                    {"board", options.board_every, 0, {}, 0}};
  for (Interruption& i : between)
    for (std::size_t k = 0; k < stations.size(); ++k)
      if (reachable[k] && stations[k].between == i.purpose) i.stations.push_back(k);
  const auto behind = repeats_behind(views, options, far);
  std::vector<Visit> all;
  int since_dark = 0;
  std::size_t dark = 0;
  for (Interruption& i : between)
    if (!i.stations.empty()) all.push_back(i.next(asked, stations));
  const auto take = [&](Visit visit, bool last) {
    const int frames = static_cast<int>(visit.frames.size());
    since_dark += frames;
    if (options.dark_every > 0 && since_dark >= options.dark_every) {
      visit.frames.push_back({visit.frames.back().step, format("dark-%04zu", ++dark), "dark"});
      since_dark = 0;
    }
    all.push_back(std::move(visit));
    for (Interruption& i : between) {
      i.since += frames;
      if (!i.stations.empty() && (i.since >= i.every || last)) all.push_back(i.next(asked, stations));
    }
  };
  for (std::size_t v = 0; v < views.size(); ++v) {
    const bool end = v + 1 == views.size();
    take(std::move(views[v]), end && behind[v].empty());
    for (std::size_t r = 0; r < behind[v].size(); ++r) take(behind[v][r], end && r + 1 == behind[v].size());
  }
  return all;
}

std::string place_key(const PlanStep& step) {
  std::string key = step.camera + "|" + step.robot;
  const auto add = [&key](const std::vector<double>& joints) {
    for (const double v : joints) key += format(",%.12g", v);
  };
  add(step.joints_rad);
  for (const auto& [name, joints] : step.other_arms) key += "|" + name, add(joints);
  for (const auto& [name, angle] : step.turntable_rad) key += "|" + name, add({angle});
  return key;
}

Vec3 common_target(const std::vector<PlanStep>& asked) {
  // (sum of (1 - f f') + w) x = sum of (1 - f f') p + w m: nearest to all axes p + t f; the small w, towards the mean
  // point half a metre before the cameras, decides what the axes leave open.
  constexpr double w = 1e-6;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (const PlanStep& step : asked) {
    if (!step.world_from_camera) continue;
    const Vec3 forward = step.world_from_camera->rotate({0, 0, 1}), place = step.world_from_camera->translation_m;
    const Eigen::Vector3d f(forward.x, forward.y, forward.z), p(place.x, place.y, place.z);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - f * f.transpose();
    a += across, b += across * p, mean += p + 0.5 * f, count += 1;
  }
  if (count == 0) return {};
  a += w * count * Eigen::Matrix3d::Identity(), b += w * mean;
  const Eigen::Vector3d x = linear::solve_ldlt(a, b);
  return {x[0], x[1], x[2]};
}

Vec3 looked_at(const PlanStep& step, Vec3 target_m) {
  const Vec3 place = step.world_from_camera->translation_m, forward = step.world_from_camera->rotate({0, 0, 1});
  const double along = dot(target_m - place, forward);
  return place + forward * (along > 0.01 ? along : 0.5);
}

}  // namespace gonio::acquisition
