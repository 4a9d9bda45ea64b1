#include "acquisition/plan/candidates.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "acquisition/plan/postures.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/model.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {
namespace {

// Kept of each arm alone; pairs that are tried.
constexpr std::size_t most_camera_postures = 16, most_lamp_postures = 24, most_tries = 384;
constexpr double roll_step_rad = pi / 18;
constexpr double same_place_m = 1e-6, same_turn_rad = 1e-6;
constexpr int lamp_rolls = 36, bare_lamp_rolls = 8;

using WorldTool = Rigid<frame::World, frame::Tool>;

const manifest::Laboratory& section(const manifest::Document& document) {
  if (document.laboratory.entry.empty())
    throw Error(Exit::data, manifest::place(document, "/laboratory"), "there is no laboratory", "describe it first");
  return document.laboratory.entry.front();
}

// Does the lamp's light shine in a direction, or all round?
bool has_direction(const manifest::Document& document, const std::string& lamp, const manifest::LaboratoryLamp& entry) {
  const auto light = document.lights.find(entry.light.empty() ? lamp : entry.light);
  if (light == document.lights.end()) return false;
  const manifest::ModelInfo* model = manifest::find_model(manifest::Family::light, light->second.model);
  return model != nullptr &&
         std::ranges::any_of(model->parameters, [](const manifest::ParameterInfo& p) { return p.name == "direction"; });
}

WorldTool aimed(Vec3 place, Vec3 in_tool, Vec3 axis, double roll) {
  const Basis basis(axis);
  const Vec3 x = basis.t * std::cos(roll) + basis.b * std::sin(roll), y = cross(axis, x);
  Mat3 rotation;
  for (int k = 0; k < 3; ++k) rotation(k, 0) = x[k], rotation(k, 1) = y[k], rotation(k, 2) = axis[k];
  return {quaternion_of(rotation), place - rotation * in_tool};
}

// Tools that put a lamp at a place: its tool's z towards the target, turned about it; a lamp that shines all round also
// with that axis tilted by up to 60 degrees. (The section says where a lamp is in the tool, not where it shines: along
// the tool's z, away from the flange.)
std::vector<WorldTool> lamp_tools(Vec3 place, Vec3 in_tool, Vec3 target, bool directed) {
  const Vec3 towards = norm(target - place) > 1e-9 ? normalized(target - place) : Vec3{0, 0, -1};
  std::vector<WorldTool> tools;
  if (directed) {
    for (int k = 0; k < lamp_rolls; ++k) tools.push_back(aimed(place, in_tool, towards, 2 * pi * k / lamp_rolls));
    return tools;
  }
  const Basis about(towards);
  for (const double tilt : {0.0, pi / 6, pi / 3})
    for (int a = 0; a < (tilt > 0 ? 4 : 1); ++a) {
      const double s = std::sin(tilt), azimuth = a * pi / 2;
      const Vec3 axis = about.to_world({s * std::cos(azimuth), s * std::sin(azimuth), std::cos(tilt)});
      for (int k = 0; k < bare_lamp_rolls; ++k)
        tools.push_back(aimed(place, in_tool, normalized(axis), 2 * pi * k / bare_lamp_rolls));
    }
  return tools;
}

// Tools that hold the camera where it is asked, turned about its axis as far as it may be.
std::vector<WorldTool> camera_tools(const manifest::PlanStep& step, const Rigid<frame::Tool, frame::Camera>& mount) {
  std::vector<WorldTool> tools{*step.world_from_camera * inverse(mount)};
  const double most = step.roll_rad.value_or(0);
  if (!(most > 0)) return tools;
  const int each = std::max(1, static_cast<int>(std::ceil(most / roll_step_rad - 1e-9)));
  for (int k = -each; k <= each; ++k) {
    if (k == 0 || (k == each && most > pi - 1e-9)) continue;  // the same as the other half turn
    const Rigid<frame::Camera, frame::Camera> roll{quaternion_of_rotation_vector({0, 0, most * k / each}), {}};
    tools.push_back(*step.world_from_camera * roll * inverse(mount));
  }
  return tools;
}

std::string key_of(const std::string& arm, const std::vector<double>& numbers) {
  std::string key = arm;
  for (const double v : numbers) key += format(":%.17g", v);
  return key;
}
std::vector<double> numbers_of(const Rigid<frame::World, frame::Camera>& p) {
  return {p.rotation.w,      p.rotation.x,      p.rotation.y,     p.rotation.z,
          p.translation_m.x, p.translation_m.y, p.translation_m.z};
}

}  // namespace

std::string camera_arm(const manifest::Document& document, const manifest::PlanStep& step) {
  const auto& cameras = section(document).cameras;
  const auto at = cameras.find(step.camera);
  if (at != cameras.end()) return at->second.robot;
  std::string names;
  for (const auto& [name, camera] : cameras) names += (names.empty() ? "" : ", ") + name;
  throw Error(Exit::data, manifest::place(document, "/laboratory/cameras"),
              "no camera \"" + step.camera + "\", which " + step.image + " asks for",
              names.empty() ? "that section is empty" : "there is " + names);
}

std::string held_lamp(const manifest::Document& document, const manifest::PlanStep& step) {
  const auto& lamps = section(document).lamps;
  for (const std::string& lamp : step.lamps) {
    const auto at = lamps.find(lamp);
    if (at == lamps.end())
      throw Error(Exit::data, manifest::place(document, "/laboratory/lamps"),
                  "no lamp \"" + lamp + "\", which " + step.image + " asks for", "name one of the laboratory's");
    if (!at->second.robot.empty()) return lamp;
  }
  return {};
}

void set_joints(manifest::PlanStep& step, const State& state, const std::string& robot) {
  step.robot = state.contains(robot) ? robot : "";
  step.joints_rad.clear(), step.other_arms.clear();
  for (const auto& [name, joints] : state) (name == step.robot ? step.joints_rad : step.other_arms[name]) = joints;
}

struct CandidateSearch::Parts {
  const manifest::Document& document;
  const Laboratory& laboratory;
  const Surroundings& surroundings;
  Vec3 target_m;
  Configurations configurations;
  std::map<std::string, PostureSearch> arms;

  // What one step asks of the arms; `why` where that cannot be, whatever they do.
  struct Request {
    std::string camera_key, lamp_key, camera_arm, lamp_arm, why;
    std::vector<WorldTool> camera_tools, lamp_tools;
  };
  Request request(const manifest::PlanStep& step) const;
  void request_lamp(const manifest::PlanStep& step, Request& r) const;
  Candidates pairs(const Request& r, const Postures* camera, const Postures* lamp, std::size_t most) const;
};

void CandidateSearch::Parts::request_lamp(const manifest::PlanStep& step, Request& r) const {
  const std::string lamp = held_lamp(document, step);
  if (lamp.empty()) {
    r.why = "a place of the lamp is asked, and no arm holds one of its lamps";
    return;
  }
  const manifest::LaboratoryLamp& entry = section(document).lamps.at(lamp);
  const Vec3 place{step.light_m.at(0), step.light_m.at(1), step.light_m.at(2)};
  const Vec3 in_tool =
      entry.in_tool_m.size() == 3 ? Vec3{entry.in_tool_m[0], entry.in_tool_m[1], entry.in_tool_m[2]} : Vec3{};
  if (entry.robot == r.camera_arm && !r.camera_tools.empty()) {
    r.camera_tools.resize(1);  // turned, it would take the lamp along
    const double off = norm(r.camera_tools[0] * in_tool - place);
    if (off > same_place_m)
      r.why = format("camera and lamp sit on one arm: with the camera there the lamp is %.3g m off its place", off);
    return;
  }
  r.lamp_arm = entry.robot;
  r.lamp_key = key_of(lamp, step.light_m);
  r.lamp_tools = lamp_tools(place, in_tool, target_m, has_direction(document, lamp, entry));
}

CandidateSearch::Parts::Request CandidateSearch::Parts::request(const manifest::PlanStep& step) const {
  Request r;
  const std::string arm = step.camera.empty() ? "" : acquisition::camera_arm(document, step);
  if (step.world_from_camera && !step.camera.empty()) {
    const manifest::LaboratoryCamera& camera = section(document).cameras.at(step.camera);
    if (arm.empty()) {
      const Rigid<frame::World, frame::Camera> there =
          camera.world_from_camera.value_or(manifest::Pose<frame::World, frame::Camera>{});
      const double off = norm(there.translation_m - step.world_from_camera->translation_m);
      const double turned = norm(rotation_vector_of(there.rotation * conjugate(step.world_from_camera->rotation)));
      if (off > same_place_m || turned > same_turn_rad)
        r.why = format("no arm holds the camera, which stands %.3g m and %.3g deg off", off, turned / degree);
    } else {
      const Rigid<frame::Tool, frame::Camera> mount =
          tool_from_camera(document, step.camera).value_or(Rigid<frame::Tool, frame::Camera>{});
      r.camera_arm = arm;
      r.camera_tools = camera_tools(step, mount);
      std::vector<double> numbers = numbers_of(*step.world_from_camera);
      numbers.push_back(step.roll_rad.value_or(0));
      r.camera_key = key_of(step.camera, numbers);
    }
  }
  if (r.why.empty() && !step.light_m.empty()) request_lamp(step, r);
  return r;
}

Candidates CandidateSearch::Parts::pairs(const Request& r, const Postures* camera, const Postures* lamp,
                                         std::size_t most) const {
  Candidates found;
  if (!r.why.empty()) return {{}, r.why};
  if (camera != nullptr && camera->all.empty()) return {{}, "camera: " + camera->why};
  if (lamp != nullptr && lamp->all.empty()) return {{}, "lamp: " + lamp->why};
  const std::size_t cameras = camera != nullptr ? camera->all.size() : 1,
                    lamps = lamp != nullptr ? lamp->all.size() : 1;
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (std::size_t i = 0; i < cameras; ++i)
    for (std::size_t j = 0; j < lamps; ++j) order.emplace_back(i, j);
  // What stands early in both lists first.
  std::ranges::stable_sort(order, {}, [](const auto& p) { return p.first + p.second; });
  std::optional<Configuration> stopped;
  for (std::size_t k = 0; k < std::min(order.size(), most_tries) && found.all.size() < most; ++k) {
    Configuration joints = configurations.home();
    if (camera != nullptr) configurations.put(joints, r.camera_arm, camera->all[order[k].first]);
    if (lamp != nullptr) configurations.put(joints, r.lamp_arm, lamp->all[order[k].second]);
    if (surroundings.free(configurations.state(joints), laboratory.margin_m))
      found.all.push_back(joints);
    else if (!stopped)
      stopped = joints;
  }
  if (found.all.empty()) {
    const Clearance c = surroundings.clearance(configurations.state(*stopped), laboratory.margin_m + 1e-6);
    found.why = format("%s comes within %.3g m of %s, limit %.3g m", c.first.c_str(), c.distance_m, c.second.c_str(),
                       laboratory.margin_m);
  }
  return found;
}

CandidateSearch::CandidateSearch(const manifest::Document& document, const Laboratory& laboratory,
                                 const Surroundings& surroundings, Vec3 target_m) {
  auto parts =
      std::unique_ptr<Parts>(new Parts{document, laboratory, surroundings, target_m, Configurations(laboratory), {}});
  for (const auto& [name, arm] : laboratory.arms) parts->arms.try_emplace(name, laboratory, name);
  parts_ = std::move(parts);
}
CandidateSearch::~CandidateSearch() = default;

std::vector<Candidates> CandidateSearch::find(const std::vector<const manifest::PlanStep*>& steps,
                                              std::size_t most) const {
  const Parts& p = *parts_;
  std::vector<Parts::Request> requests;
  struct Job {
    const std::string* arm;
    const std::vector<WorldTool>* tools;
    std::size_t most;
    Postures* to;
  };
  requests.reserve(steps.size());
  std::map<std::string, Postures> postures;  // by key
  std::vector<Job> jobs;
  for (const manifest::PlanStep* step : steps) {
    const Parts::Request& r = requests.emplace_back(p.request(*step));
    for (const bool lamp : {false, true}) {
      const std::string& key = lamp ? r.lamp_key : r.camera_key;
      const std::string& arm = lamp ? r.lamp_arm : r.camera_arm;
      if (key.empty() || !r.why.empty()) continue;
      if (!p.arms.contains(arm))
        throw Error(Exit::data, manifest::place(p.document, "/laboratory/robots"), "no robot \"" + arm + "\"");
      const auto [at, added] = postures.try_emplace(key);
      if (!added) continue;
      jobs.push_back({&arm, lamp ? &r.lamp_tools : &r.camera_tools, lamp ? most_lamp_postures : most_camera_postures,
                      &at->second});
    }
  }
  parallel_for(0, jobs.size(),
               [&](std::size_t k) { *jobs[k].to = p.arms.at(*jobs[k].arm).find(*jobs[k].tools, jobs[k].most); });
  std::vector<Candidates> found(steps.size());
  parallel_for(0, steps.size(), [&](std::size_t k) {
    const auto of = [&](const std::string& key) { return key.empty() ? nullptr : &postures.at(key); };
    const bool asked = requests[k].why.empty();
    found[k] = p.pairs(requests[k], asked ? of(requests[k].camera_key) : nullptr,
                       asked ? of(requests[k].lamp_key) : nullptr, most);
  });
  return found;
}

}  // namespace gonio::acquisition
