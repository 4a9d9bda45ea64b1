#include "acquisition/plan/view_steps.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "geom/view_path.h"
#include "render/looking_at.h"

namespace gonio::acquisition {
namespace {

// The pole's frame: for up = z the world's own axes.
Vec3 turned(const PatternScene& scene, Vec3 local) {
  return Basis(normalized(scene.up)).to_world(local);
}

}  // namespace

Vec3 place_at(const PatternScene& scene, Direction d, double distance_m) {
  const double s = std::sin(d.zenith_rad);
  return scene.target_m +
         distance_m * turned(scene, {s * std::cos(d.azimuth_rad), s * std::sin(d.azimuth_rad), std::cos(d.zenith_rad)});
}

manifest::Pose<frame::World, frame::Camera> camera_at(const PatternScene& scene, Direction d, double distance_m) {
  const Vec3 right = turned(scene, {-std::sin(d.azimuth_rad), std::cos(d.azimuth_rad), 0});
  manifest::Pose<frame::World, frame::Camera> pose;
  static_cast<Rigid<frame::World, frame::Camera>&>(pose) =
      render::looking_at(place_at(scene, d, distance_m), scene.target_m, scene.up, right);
  return pose;
}

manifest::Pose<frame::World, frame::Camera> camera_looking(const PatternScene& scene, Vec3 position_m) {
  manifest::Pose<frame::World, frame::Camera> pose;
  static_cast<Rigid<frame::World, frame::Camera>&>(pose) =
      render::looking_at(position_m, scene.target_m, scene.up, turned(scene, {0, 1, 0}));
  return pose;
}

std::vector<double> stepped(double first, double last, double step) {
  std::vector<double> values;
  const double count = std::floor(std::abs(last - first) / step + 1e-9);
  for (double k = 0; k <= count; ++k) values.push_back(first + std::copysign(k * step, last - first));
  return values;
}

std::vector<Direction> directions(const SphereGrid& grid) {
  std::vector<Direction> all;
  const double span = grid.last_azimuth_rad - grid.first_azimuth_rad;
  const bool full = span > 2 * pi - 1e-9;
  for (const double zenith : stepped(grid.first_zenith_rad, grid.last_zenith_rad, grid.step_rad)) {
    const double sine = std::sin(zenith);
    if (sine < 1e-9) {
      all.push_back({zenith, grid.first_azimuth_rad});
      continue;
    }
    if (grid.even) {
      // Whole gaps along the ring's arc, each at least a step long.
      const double gaps = std::max(1.0, std::floor(span * sine / grid.step_rad + 1e-9));
      for (double k = 0; k < gaps + (full ? 0 : 1); ++k)
        all.push_back({zenith, grid.first_azimuth_rad + span * k / gaps});
      continue;
    }
    for (const double azimuth : stepped(grid.first_azimuth_rad, grid.last_azimuth_rad, grid.step_rad))
      if (!full || azimuth - grid.first_azimuth_rad < 2 * pi - 1e-9) all.push_back({zenith, azimuth});
  }
  return all;
}

std::vector<double> bracket(double shortest_s, double longest_s, double stops) {
  std::vector<double> exposures;
  const double count = std::floor(std::log2(longest_s / shortest_s) / stops + 1e-9);
  for (double k = 0; k <= count; ++k) exposures.push_back(shortest_s * std::exp2(k * stops));
  return exposures;
}

std::string image_name(const std::string& pattern, std::size_t index) {
  return format("%s-%04zu", pattern.c_str(), index + 1);
}

manifest::PlanStep view_step(const PatternScene& scene, const std::string& image) {
  manifest::PlanStep step;
  step.image = image, step.camera = scene.camera, step.purpose = "view";
  step.lamps = scene.lamps, step.exposures_s = scene.exposures_s;
  return step;
}

void need_lamps(const PatternScene& scene, const std::string& pattern, std::size_t least) {
  if (scene.lamps.size() >= least) return;
  throw Error(Exit::usage, pattern,
              format("needs at least %zu lamp%s, and %zu are named", least, least == 1 ? "" : "s", scene.lamps.size()),
              "name the laboratory's lamps that take turns");
}

std::vector<manifest::PlanStep> path_steps(const std::string& path, const PatternScene& scene,
                                           const PatternNumbers& numbers) {
  const auto frames = static_cast<std::size_t>(numbers.at("views"));
  const double distance = numbers.at("distance"), size = numbers.at("spread"), turn = numbers.at("turn");
  if (turn != 0 && scene.turntable.empty())
    throw Error(Exit::usage, path, "turn is given, and no turntable is named", "name one of the laboratory's");
  const Vec3 middle = view_path(path, 0.5);  // about which the way is made smaller, still looking at the target
  std::vector<manifest::PlanStep> steps;
  for (std::size_t f = 0; f < frames; ++f) {
    const double s = frames > 1 ? static_cast<double>(f) / static_cast<double>(frames - 1) : 0;
    const Vec3 place = middle + size * (view_path(path, s) - middle);
    manifest::PlanStep step = view_step(scene, image_name(path, f));
    step.world_from_camera = camera_looking(scene, scene.target_m + distance * turned(scene, place));
    if (turn != 0) step.turntable_rad[scene.turntable] = s * turn;
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<PatternParameter> path_parameters() {
  return {{"distance", "m", 0.5, 0.01, 100, "of the camera from the target, in the mean"},
          {"views", "1", 60, 1, 100000, "photographs along the way"},
          {"spread", "1", 1, 0.01, 1, "of the way about its middle; below 1 it is that much smaller"},
          {"turn", "rad", 0, -1000, 1000, "of the turntable from the first photograph to the last; 0: it stands"}};
}

std::vector<manifest::PlanStep> grid_steps(const std::string& pattern, const PatternScene& scene,
                                           const PatternNumbers& n, double first_azimuth_rad, double span_rad) {
  const std::vector<Direction> views =
      directions({n.at("step"), pi / 2 - n.at("highest"), pi / 2 - n.at("lowest"), first_azimuth_rad,
                  first_azimuth_rad + span_rad, n.at("even") > 0.5});
  std::vector<std::vector<double>> places{{}};
  if (n.at("lamp-radius") > 0) {
    need_lamps(scene, pattern);
    places.clear();
    const double first = n.at("lamp-azimuth");
    for (const Direction d :
         directions({n.at("lamp-step"), 0, pi / 2 - n.at("lamp-lowest"), first, first + n.at("lamp-span"), true})) {
      const Vec3 p = place_at(scene, d, n.at("lamp-radius"));
      places.push_back({p.x, p.y, p.z});
    }
  }
  std::vector<manifest::PlanStep> steps;
  for (const std::vector<double>& place : places)
    for (const Direction view : views) {
      manifest::PlanStep step = view_step(scene, image_name(pattern, steps.size()));
      step.world_from_camera = camera_at(scene, view, n.at("radius"));
      if (n.at("roll") > 0) step.roll_rad = n.at("roll");
      step.light_m = place;
      steps.push_back(std::move(step));
    }
  return steps;
}

std::vector<PatternParameter> grid_parameters() {
  return {{"radius", "m", 0.5, 0.01, 100, "of the camera from the target"},
          {"step", "rad", 10 * degree, 0.1 * degree, 90 * degree, "between neighbouring directions"},
          {"lowest", "rad", 10 * degree, 0, 90 * degree, "elevation over the plane across the pole"},
          {"highest", "rad", 90 * degree, 0, 90 * degree, "elevation at which the grid begins"},
          {"even", "1", 0, 0, 1, "1: rings near the pole have fewer views, so that all lie about equally dense"},
          {"roll", "rad", 0, 0, pi,
           "the camera may be turned about its axis by up to this, to either side, where that saves time"},
          {"lamp-radius", "m", 0, 0, 100, "of the first lamp from the target; 0: the lamp is not moved"},
          {"lamp-step", "rad", 30 * degree, degree, 90 * degree, "between the lamp's directions, about evenly"},
          {"lamp-lowest", "rad", 30 * degree, 0, 90 * degree, "the lamp's lowest elevation"},
          {"lamp-azimuth", "rad", 0, -2 * pi, 2 * pi, "at which the lamp's places begin"},
          {"lamp-span", "rad", 2 * pi, 0, 2 * pi, "of the lamp's azimuths"}};
}

PatternNumbers pattern_numbers(const ViewPattern& pattern, const PatternNumbers& given, const std::string& place) {
  PatternNumbers numbers;
  for (const PatternParameter& p : pattern.parameters) numbers[p.name] = p.preset;
  for (const auto& [name, value] : given) {
    const auto p = std::ranges::find(pattern.parameters, name, &PatternParameter::name);
    if (p == pattern.parameters.end()) {
      std::string names;
      for (const PatternParameter& q : pattern.parameters) names += (names.empty() ? "" : ", ") + q.name;
      throw Error(Exit::usage, place, "pattern " + pattern.name + " has no number \"" + name + "\"",
                  names.empty() ? "it has none" : "it has " + names);
    }
    if (!(value >= p->lower && value <= p->upper))
      throw Error(Exit::usage, place,
                  pattern.name + ": " + name + " is " + shortest_text(value) + (p->unit == "1" ? "" : " " + p->unit),
                  "between " + shortest_text(p->lower) + " and " + shortest_text(p->upper));
    numbers[name] = value;
  }
  return numbers;
}

const ViewPattern& find_view_pattern(const std::string& name, const std::string& place) {
  std::string names;
  for (const ViewPattern* p : all_view_patterns()) {
    if (p->name == name) return *p;
    names += (names.empty() ? "" : ", ") + p->name;
  }
  throw Error(Exit::usage, place, "no pattern \"" + name + "\"", "one of " + names);
}

}  // namespace gonio::acquisition
