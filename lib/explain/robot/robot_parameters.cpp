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
constexpr std::array<const char*, 4> pinhole_names = {"fx_px", "fy_px", "cx_px", "cy_px"};

std::array<double, 4> pinhole(const camera::Intrinsics& k) {
  return {k.fx_px, k.fy_px, k.cx_px, k.cy_px};
}

class Declaration {
 public:
  Declaration(const RobotInput& input, RobotParameters& result) : input_(input), result_(result) {}

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
      result_.base.push_back(add({"cameras/" + input_.camera + "/" + pinhole_names[i],
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

  // `roles`: one for each parameter of the mechanism; those that are not `wanted` are left out.
  template <class Wanted>
  void candidate(const char* id, const std::vector<RobotRole>& roles, double size, Wanted wanted) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr || m->parameters.size() != roles.size())
      throw Error(Exit::internal, "explain",
                  std::string("mechanism ") + id + " is not registered as the domain knows it");
    Candidate c{m, {}, {}, {}};
    for (std::size_t k = 0; k < roles.size(); ++k) {
      const mechanism::Parameter& p = m->parameters[k];
      if (!wanted(roles[k])) continue;
      c.parameters.push_back(
          add({std::string(id) + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, size, {}, {}}, roles[k]));
    }
    if (!c.parameters.empty()) result_.candidates.push_back(std::move(c));
  }

  void lens(const char* id) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr) return;
    std::vector<RobotRole> roles;
    for (const mechanism::Parameter& p : m->parameters) {
      const auto name = std::find(camera::distortion_names.begin(), camera::distortion_names.end(), p.name);
      roles.push_back({Part::distortion, static_cast<std::size_t>(name - camera::distortion_names.begin())});
    }
    const auto lacking = [&](const RobotRole& r) {
      return r.index < camera::distortion_names.size() &&
             std::find(input_.terms.begin(), input_.terms.end(), r.index) == input_.terms.end();
    };
    candidate(id, roles, 0.01, lacking);
  }

 private:
  std::size_t add(Parameter parameter, RobotRole role) {
    result_.parameters.push_back(std::move(parameter));
    result_.roles.push_back(role);
    return result_.parameters.size() - 1;
  }
  const RobotInput& input_;
  RobotParameters& result_;
};

std::vector<RobotRole> roles_of(Part part, std::size_t count) {
  std::vector<RobotRole> roles;
  for (std::size_t i = 0; i < count; ++i) roles.push_back({part, i});
  return roles;
}

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

RobotParameters robot_parameters(const RobotInput& input) {
  RobotParameters result;
  Declaration declare(input, result);
  declare.mounting(input.eye_to_hand ? "tool_from_board" : "tool_from_camera", Part::hand);
  declare.mounting(input.eye_to_hand ? "base_from_camera" : "base_from_board", Part::fixed);
  const bool corners = !input.views[0].corners.empty(),
             joints = !input.links.empty() && !input.views[0].joints_rad.empty();
  if (corners) declare.camera();
  if (joints) {
    const auto has_link = [&](const RobotRole& r) { return r.index < input.links.size(); };
    declare.candidate("robot.joint-offset", roles_of(Part::joint, 6), 3e-3, has_link);
    std::vector<RobotRole> lengths = roles_of(Part::a, 6);
    const std::vector<RobotRole> offsets = roles_of(Part::d, 6);
    lengths.insert(lengths.end(), offsets.begin(), offsets.end());
    declare.candidate("robot.link-length", lengths, 2e-3, has_link);
    declare.candidate("robot.sag", roles_of(Part::sag, 2), 2e-3,
                      [&](const RobotRole& r) { return r.index + 1 < input.links.size(); });
  }
  if (corners) {
    const auto all = [](const RobotRole&) { return true; };
    if (!input.warped) declare.candidate("board.warp", roles_of(Part::warp, 2), 1e-3, all);
    declare.candidate("board.scale", roles_of(Part::scale, 2), 1e-2, all);
    for (const char* id : {"lens.radial", "lens.tangential", "lens.thin-prism"}) declare.lens(id);
  }
  return result;
}

RobotState state_of(const RobotInput& input, const RobotParameters& p, std::span<const double> values) {
  RobotState s;
  s.intrinsics = input.intrinsics;
  s.warp = input.warp;
  for (std::size_t k = 0; k < p.roles.size(); ++k) {
    const std::size_t i = p.roles[k].index;
    const double v = values[k];
    switch (p.roles[k].part) {
      case Part::hand: s.hand[i] = v; break;
      case Part::fixed: s.fixed[i] = v; break;
      case Part::pinhole:
        (i == 0   ? s.intrinsics.fx_px
         : i == 1 ? s.intrinsics.fy_px
         : i == 2 ? s.intrinsics.cx_px
                  : s.intrinsics.cy_px) = v;
        break;
      case Part::distortion: s.intrinsics.distortion[i] = v; break;
      case Part::joint: s.joint_rad[i] = v; break;
      case Part::a: s.a_m[i] = v; break;
      case Part::d: s.d_m[i] = v; break;
      case Part::sag: s.sag_rad_per_m[i] = v; break;
      case Part::warp: (i == 0 ? s.warp.sag_x_m : s.warp.sag_y_m) = v; break;
      case Part::scale: s.scale[i] = v; break;
    }
  }
  return s;
}

}  // namespace gonio::explain
