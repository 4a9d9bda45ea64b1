// See robot_parameters.h.
#include "explain/robot/robot_parameters.h"

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace gonio::explain {
namespace {

using Part = RobotRole::Part;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::array<const char*, 6> pose_names = {"rotation_x_rad",  "rotation_y_rad",  "rotation_z_rad",
                                                   "translation_x_m", "translation_y_m", "translation_z_m"};

std::array<double, 4> pinhole(const camera::Intrinsics& k) {
  return {k.fx_px, k.fy_px, k.cx_px, k.cy_px};
}

class Declaration {
 public:
  Declaration(const ChainInput& input, RobotParameters& result) : input_(input), result_(result) {}

  void mounting(const std::string& name, Part part) {
    for (std::size_t i = 0; i < 6; ++i)
      result_.base.push_back(add({input_.mounting + "/" + name + "/" + pose_names[i],
                                  i < 3 ? "rad" : "m",
                                  0,
                                  0,
                                  -infinity,
                                  infinity,
                                  1e-2,
                                  {},
                                  {}},
                                 {part, i}));
  }

  void camera() {
    const std::array<double, 4> start = pinhole(input_.intrinsics);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::optional<double>& sigma = input_.pinhole_sigma_px[i];
      if (!sigma || !(*sigma > 0)) continue;
      result_.base.push_back(add({"cameras/" + input_.camera + "/" + std::string(camera::pinhole_names[i]),
                                  "px",
                                  start[i],
                                  start[i],
                                  -infinity,
                                  infinity,
                                  1,
                                  sigma,
                                  {}},
                                 {Part::pinhole, i}));
    }
  }

  // One candidate, or one for each unit in which a drift is stated (per kelvin, per second): those are alternatives.
  void mechanism(const mechanism::Mechanism& m) {
    std::vector<std::string> rates;
    for (const mechanism::Parameter& p : m.parameters)
      if (std::find(rates.begin(), rates.end(), rate_of(p)) == rates.end()) rates.push_back(rate_of(p));
    const bool drifts = rates.size() > 1 && m.parameters.size() == rates.size();
    for (const std::string& rate : drifts ? rates : std::vector<std::string>{""}) {
      Candidate c{&m, {}, {}, drifts ? m.id : ""};
      for (const mechanism::Parameter& p : m.parameters) {
        if (drifts && rate_of(p) != rate) continue;
        const std::optional<RobotRole> role = role_of(p.name);
        if (!role)
          throw Error(Exit::internal, "explain", "mechanism " + m.id + " has no term " + p.name + " for robots");
        if (!moves_something(*role)) continue;
        c.parameters.push_back(
            add({m.id + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, size_of(*role), {}, {}}, *role));
      }
      if (!c.parameters.empty()) result_.candidates.push_back(std::move(c));
    }
  }

 private:
  static std::string rate_of(const mechanism::Parameter& p) {
    const std::size_t slash = p.unit.find('/');
    return slash == std::string::npos ? "" : p.unit.substr(slash);
  }
  static double size_of(const RobotRole& role) {
    switch (role.part) {
      case Part::joint: return 3e-3;
      case Part::a:
      case Part::d:
      case Part::sag: return 2e-3;
      case Part::warp: return 1e-3;
      case Part::backlash: return 5e-4;
      case Part::growth: return role.index == 0 ? 2e-5 : 1e-7;
      default: return 1e-2;
    }
  }
  template <class Condition>
  bool any_view(Condition condition) const {
    return std::any_of(input_.views.begin(), input_.views.end(), condition);
  }

  // Could these recordings show it, and does the base model lack it?
  bool moves_something(const RobotRole& role) const {
    using View = ChainInput::View;
    const bool corners = !input_.views[0].corners.empty();
    const bool joints = !input_.links.empty() && !input_.views[0].joints_rad.empty();
    switch (role.part) {
      case Part::joint:
      case Part::a:
      case Part::d: return joints && role.index < input_.links.size();
      case Part::sag: return joints && role.index + 1 < input_.links.size();
      case Part::backlash:
        return joints && role.index < input_.links.size() &&
               any_view([&](const View& v) { return v.approach[role.index] > 0; }) &&
               any_view([&](const View& v) { return v.approach[role.index] < 0; });
      case Part::growth:
        return any_view([&](const View& v) { return (role.index == 0 ? v.warmer_K : v.later_s) != 0; });
      case Part::lag: return any_view([](const View& v) { return v.passes; });
      case Part::warp: return corners && !input_.warped;
      case Part::distortion:
        return corners && std::find(input_.terms.begin(), input_.terms.end(), role.index) == input_.terms.end();
      default: return corners;
    }
  }

  std::size_t add(Parameter parameter, RobotRole role) {
    result_.parameters.push_back(std::move(parameter));
    result_.roles.push_back(role);
    return result_.parameters.size() - 1;
  }
  const ChainInput& input_;
  RobotParameters& result_;
};

// "joint_3_rad" is number 3 between these; nothing for other names.

}  // namespace

bool moves_camera_or_board(Part part) {
  return part == Part::pinhole || part == Part::distortion || part == Part::warp || part == Part::scale;
}

Eigen::Index slope_column(const RobotRole& role) {
  const std::size_t first = role.part == Part::distortion ? slope_distortion
                            : role.part == Part::warp     ? slope_warp
                            : role.part == Part::scale    ? slope_scale
                                                          : 0;
  return static_cast<Eigen::Index>(first + role.index);
}

RobotParameters robot_parameters(const ChainInput& input) {
  RobotParameters result;
  Declaration declare(input, result);
  declare.mounting(input.eye_to_hand ? "tool_from_board" : "tool_from_camera", Part::hand);
  declare.mounting(input.eye_to_hand ? "base_from_camera" : "base_from_board", Part::fixed);
  if (!input.views[0].corners.empty()) declare.camera();
  for (const mechanism::Mechanism* m : mechanism::all_mechanisms())
    if (std::find(m->domains.begin(), m->domains.end(), "robot") != m->domains.end()) declare.mechanism(*m);
  return result;
}

ChainState state_of(const ChainInput& input, const RobotParameters& p, std::span<const double> values) {
  ChainState s;
  s.intrinsics = input.intrinsics;
  s.warp = input.warp;
  for (std::size_t k = 0; k < p.roles.size(); ++k) robot::set(s, p.roles[k], values[k]);
  return s;
}

}  // namespace gonio::explain
