// See clouds_parameters.h.
#include "explain/clouds/clouds_parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "camera/intrinsics.h"

namespace gonio::mechanism {
const Mechanism& projector_gamma();
const Mechanism& structured_light_defocus();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using Part = CloudRole::Part;
constexpr double misplaced = 10;  // times a freedom's size: 1 cm, 10 mrad
constexpr double infinity = std::numeric_limits<double>::infinity();

std::string rate_of(const mechanism::Parameter& p) {
  const std::size_t slash = p.unit.find('/');
  return slash == std::string::npos ? "" : p.unit.substr(slash);
}

// By the parameter's name without what it is counted by.
CloudRole role_of(const mechanism::Parameter& p, std::size_t device) {
  CloudRole role;
  role.device = device;
  const std::string rate = rate_of(p);
  role.by_time = rate == "/s";
  const std::string name = rate.empty() ? p.name : p.name.substr(0, p.name.rfind("_per_"));
  constexpr std::array<const char*, 6> pose = {"x_m", "y_m", "z_m", "turn_x_rad", "turn_y_rad", "turn_z_rad"};
  constexpr std::array<const char*, 3> thermal = {"focal", "x_px", "y_px"};
  const auto place = [&name](const auto& names) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - std::begin(names));
  };
  if ((role.index = place(pose)) < pose.size())
    role.part = rate.empty() ? Part::pose : Part::drift;
  else if (!rate.empty() && (role.index = place(thermal)) < thermal.size())
    role.part = Part::thermal;
  else if (name == "x_px" || name == "y_px")
    role.part = Part::principal, role.index = name == "y_px";
  else if (name == "relative")
    role.part = Part::focal;
  else if (name == "gamma")
    role.part = Part::gamma;
  else if (name == "depth_m")
    role.part = Part::depth;
  else if (name == "along_m")
    role.part = Part::along;
  else if (name == "albedo")
    role.part = Part::albedo;
  else if (name == "spread_px2")
    role.part = Part::spread;
  else if (name == "spot_px2")
    role.part = Part::spot;
  else if (name == "exit_depth_m")
    role.part = Part::exit_depth;
  else if (name == "spread_m")
    role.part = Part::scatter;
  else
    role.part = Part::lens, role.index = camera::distortion_index(name, "explain");
  return role;
}

double size_of(const mechanism::Parameter& p) {
  return p.typical > 0 ? size_of_usual * p.typical : 0.01;
}

class CloudDeclaration {
 public:
  CloudDeclaration(const CloudsInput& input, const CloudModel& model) : input_(input), model_(model) {
    for (std::size_t v = 0; v < input_.views.size(); ++v) declare_shape(v);
    for (const mechanism::Mechanism* m : mechanism::all_mechanisms())
      if (std::ranges::find(m->domains, "clouds") != m->domains.end()) declare(*m);
  }
  CloudParameters result;

 private:
  std::size_t add(Parameter parameter, const CloudRole& role) {
    result.parameters.push_back(std::move(parameter));
    result.roles.push_back(role);
    return result.parameters.size() - 1;
  }

  void declare_shape(std::size_t v) {
    const auto freedoms = input_.views[v].shape.freedoms();
    for (std::size_t i = 0; i < freedoms.size(); ++i) {
      CloudRole role;
      role.part = Part::shape, role.index = i, role.group = v;
      Parameter place{input_.views[v].name + "/" + freedoms[i].name,
                      freedoms[i].unit,
                      0,
                      0,
                      -infinity,
                      infinity,
                      freedoms[i].size,
                      {},
                      {v}};
      // Clouds were placed, if not well; turns of a ball are hardly held by another cloud of it, and would take up
      // noise.
      if (!input_.against.empty()) place.prior_sigma = misplaced * freedoms[i].size;
      result.base.push_back(add(std::move(place), role));
    }
  }

  // Devices that a mechanism can be of: a projector's own, a camera's (each of two is a hypothesis of its own), or what
  // lies between the two.
  std::vector<std::size_t> devices_of(const mechanism::Mechanism& m) const {
    if (m.target != mechanism::Target::camera || m.id.starts_with("rig.")) return {1};
    if (m.id.starts_with("projector."))
      return input_.projector ? std::vector<std::size_t>{1} : std::vector<std::size_t>{};
    if (role_of(m.parameters[0], 0).part == Part::pose)  // of the two cameras one defines the frame
      return input_.projector ? std::vector<std::size_t>{} : std::vector<std::size_t>{1};
    return input_.projector ? std::vector<std::size_t>{0} : std::vector<std::size_t>{0, 1};
  }
  const std::string& device_name(std::size_t device) const { return device == 0 ? input_.first : input_.second; }

  // Of one device; one for each unit in which a drift is stated (per kelvin, per second), and of a pose that drifts one
  // for each number: those are alternatives. A rig bends where it is weakest, and clouds at a few moments tell no more.
  void declare(const mechanism::Mechanism& m) {
    std::vector<std::string> kinds;
    const auto kind_of = [&m](const mechanism::Parameter& p) {
      const std::string rate = rate_of(p);
      return role_of(p, 0).part == Part::drift ? p.name : rate;
    };
    for (const mechanism::Parameter& p : m.parameters)
      if (std::ranges::find(kinds, kind_of(p)) == kinds.end()) kinds.push_back(kind_of(p));
    const std::vector<std::size_t> devices = devices_of(m);
    for (const std::size_t device : devices)
      for (const std::string& kind : kinds) {
        Candidate c{&m, {}, {}, ""};
        if (m.target == mechanism::Target::camera) c.on = {device_name(device)};
        if (kinds.size() > 1) c.family = m.id + " " + device_name(device);
        const std::string prefix = devices.size() > 1 ? "cameras/" + device_name(device) + "/" : m.id + ".";
        for (const mechanism::Parameter& p : m.parameters)
          if (kind_of(p) == kind) add_to(c, p, role_of(p, device), prefix);
        join(std::move(c));
      }
  }

  bool is_given(const std::string& id) const { return std::ranges::find(input_.given, id) != input_.given.end(); }

  void join(Candidate c) {
    if (c.parameters.empty()) return;
    // Spots show in bent cosines alone: beside a bend that is asked they are what is not known of it, beside one that
    // is known they can be asked.
    if (c.mechanism == &mechanism::structured_light_defocus() && !is_given(mechanism::projector_gamma().id)) {
      for (const std::size_t p : c.parameters) {
        Parameter& spot = result.parameters[p];
        spot.prior_sigma = c.mechanism->parameters[0].typical, spot.neutral = spot.start;
        result.base.push_back(p);
      }
      return;
    }
    if (!is_given(c.id())) {
      result.candidates.push_back(std::move(c));
      return;
    }
    for (const std::size_t p : c.parameters) {
      Parameter& parameter = result.parameters[p];
      for (const auto& [name, value] : input_.given_values)
        if (name == parameter.name) parameter.start = parameter.neutral = value;
      result.base.push_back(p);
    }
  }

  void add_to(Candidate& c, const mechanism::Parameter& p, CloudRole role, const std::string& prefix) {
    if (!could_show(role)) return;
    if (role.part != Part::along) {
      c.parameters.push_back(
          add({prefix + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, size_of(p), {}, {}}, role));
      return;
    }
    for (std::size_t c_own = 0; c_own < input_.clouds.size(); ++c_own) {  // every cloud has a motion of its own
      std::vector<std::size_t> groups;
      for (std::size_t g = 0; g < input_.views.size(); ++g)
        if (input_.views[g].cloud == c_own || (!input_.against.empty() && input_.against[g].cloud == c_own))
          groups.push_back(g);
      if (groups.empty()) continue;
      role.index = c_own;
      c.on.push_back(input_.clouds[c_own]);
      c.parameters.push_back(add(
          {input_.clouds[c_own] + "/" + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, size_of(p), {}, groups},
          role));
    }
  }

  bool could_show(const CloudRole& role) const {
    const auto varies = [this](double CloudView::*of) {
      return std::ranges::any_of(input_.views, [&](const CloudView& v) { return v.*of != 0; });
    };
    const bool cosines = model_.told_place(scan::Axis::column).any() || model_.told_place(scan::Axis::row).any();
    switch (role.part) {
      case Part::drift:
      case Part::thermal: return varies(role.by_time ? &CloudView::later_s : &CloudView::warmer_K);
      case Part::spread: return std::ranges::any_of(input_.views, [](const CloudView& v) { return !v.bright.empty(); });
      case Part::albedo:
        for (std::size_t v = 0; v < input_.views.size(); ++v)
          if (model_.indirect(v).any()) return true;
        return false;
      case Part::scatter:
        if (!cosines) return false;
        for (std::size_t v = 0; v < input_.views.size(); ++v)
          for (const CloudRow& row : model_.rows(v))
            if (row.lit.x != 0 || row.lit.y != 0) return true;
        return false;
      case Part::gamma:
      case Part::spot:
      case Part::along: return input_.projector && cosines;  // codes of two cameras are bent alike
      case Part::lens: {
        const camera::Intrinsics& lens = input_.stations[role.device].lens.intrinsics();
        return lens.distortion[role.index] == 0 || input_.projector;
      }
      default: return true;
    }
  }

  const CloudsInput& input_;
  const CloudModel& model_;
};

}  // namespace

std::string name_of(const Parameter& parameter) {
  const std::string& full = parameter.name;
  return full.substr(full.find_last_of("./") + 1);
}

CloudParameters cloud_parameters(const CloudsInput& input, const CloudModel& model) {
  return std::move(CloudDeclaration(input, model).result);
}

}  // namespace gonio::explain
