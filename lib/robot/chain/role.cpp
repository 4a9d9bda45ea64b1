// See role.h.
#include "robot/chain/role.h"

#include <algorithm>
#include <array>

namespace gonio::robot {
namespace {

using Part = ChainRole::Part;

std::optional<std::size_t> numbered(const std::string& name, const std::string& before, const std::string& behind) {
  if (name.size() != before.size() + 1 + behind.size() || !name.starts_with(before) || !name.ends_with(behind))
    return {};
  const char digit = name[before.size()];
  return digit >= '1' && digit <= '6' ? std::optional<std::size_t>(static_cast<std::size_t>(digit - '1'))
                                      : std::nullopt;
}

}  // namespace

std::optional<ChainRole> role_of(const std::string& name) {
  struct Numbered {
    Part part;
    const char *before, *behind;
  };
  constexpr std::array<Numbered, 4> numbered_parts = {{{Part::joint, "joint_", "_rad"},
                                                       {Part::a, "a_", "_m"},
                                                       {Part::d, "d_", "_m"},
                                                       {Part::backlash, "backlash_", "_rad"}}};
  for (const Numbered& n : numbered_parts)
    if (const auto index = numbered(name, n.before, n.behind)) return ChainRole{n.part, *index};
  struct Single {
    const char* name;
    ChainRole role;
  };
  constexpr std::array<Single, 9> singles = {{{"joint_2_rad_per_m", {Part::sag, 0}},
                                              {"joint_3_rad_per_m", {Part::sag, 1}},
                                              {"sag_x_m", {Part::warp, 0}},
                                              {"sag_y_m", {Part::warp, 1}},
                                              {"scale_x", {Part::scale, 0}},
                                              {"scale_y", {Part::scale, 1}},
                                              {"growth_per_K", {Part::growth, 0}},
                                              {"growth_per_s", {Part::growth, 1}},
                                              {"lag_s", {Part::lag, 0}}}};
  for (const Single& s : singles)
    if (name == s.name) return s.role;
  const auto term = std::find(camera::distortion_names.begin(), camera::distortion_names.end(), name);
  if (term == camera::distortion_names.end()) return {};
  return ChainRole{Part::distortion, static_cast<std::size_t>(term - camera::distortion_names.begin())};
}

void set(ChainState& s, const ChainRole& role, double v) {
  const std::size_t i = role.index;
  switch (role.part) {
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
    case Part::backlash: s.backlash_rad[i] = v; break;
    case Part::growth: (i == 0 ? s.growth_per_K : s.growth_per_s) = v; break;
    case Part::lag: s.lag_s = v; break;
  }
}

}  // namespace gonio::robot
