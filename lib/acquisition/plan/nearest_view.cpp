#include "acquisition/plan/nearest_view.h"

#include <algorithm>
#include <cmath>

#include "acquisition/plan/stations.h"
#include "geom/angle.h"

namespace gonio::acquisition {
namespace {

struct Shift {
  Quaternion turn;   // about what is looked at
  double scale = 1;  // of the distance
  double far = 0;    // in units of the distance
};

// Turns in eight directions across `axis`, by far.
std::vector<Shift> shifts(Vec3 axis) {
  const Basis basis(axis);
  std::vector<Shift> all;
  for (const double angle : {0.0, 2.5, 5.0, 7.5, 10.0, 15.0, 20.0, 30.0, 45.0})
    for (int k = 0; k < (angle > 0 ? 8 : 1); ++k) {
      const Vec3 about = basis.t * std::cos(k * pi / 4) + basis.b * std::sin(k * pi / 4);
      for (const double scale : {1.0, 0.95, 1.05, 0.9, 1.1, 0.8, 1.2, 0.67, 1.33}) {
        if (angle == 0 && scale == 1) continue;
        const double a = angle * degree;
        all.push_back(
            {quaternion_of_rotation_vector(about * a), scale, std::sqrt(1 + scale * scale - 2 * scale * std::cos(a))});
      }
    }
  std::ranges::stable_sort(all, {}, &Shift::far);
  return all;
}

manifest::PlanStep shifted(const manifest::PlanStep& step, const Shift& shift, Vec3 target_m, bool lamp) {
  manifest::PlanStep moved = step;
  const auto place = [&](Vec3 p) { return target_m + shift.scale * (matrix_of(shift.turn) * (p - target_m)); };
  if (lamp) {
    const Vec3 p = place({step.light_m[0], step.light_m[1], step.light_m[2]});
    moved.light_m = {p.x, p.y, p.z};
    return moved;
  }
  moved.world_from_camera->rotation = normalized(shift.turn * step.world_from_camera->rotation);
  moved.world_from_camera->translation_m = place(step.world_from_camera->translation_m);
  return moved;
}

}  // namespace

std::optional<manifest::PlanStep> nearest_reachable(const CandidateSearch& search, const Configurations& configurations,
                                                    const manifest::PlanStep& step, const std::string& why,
                                                    Vec3 target_m, const std::string& robot) {
  constexpr std::size_t at_once = 16;
  const bool lamp = !step.light_m.empty() && (why.starts_with("lamp: ") || !step.world_from_camera);
  if (!lamp && !step.world_from_camera) return {};
  const Vec3 centre = lamp || !step.world_from_camera ? target_m : looked_at(step, target_m);
  const Vec3 place =
      lamp ? Vec3{step.light_m[0], step.light_m[1], step.light_m[2]} : step.world_from_camera->translation_m;
  if (!(norm(place - centre) > 1e-6)) return {};
  const std::vector<Shift> all = shifts(normalized(place - centre));
  for (std::size_t first = 0; first < all.size(); first += at_once) {
    std::vector<manifest::PlanStep> tried;
    for (std::size_t k = first; k < std::min(first + at_once, all.size()); ++k)
      tried.push_back(shifted(step, all[k], centre, lamp));
    std::vector<const manifest::PlanStep*> steps;
    for (const manifest::PlanStep& s : tried) steps.push_back(&s);
    const std::vector<Candidates> found = search.find(steps, 1);
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (found[k].all.empty()) continue;
      set_joints(tried[k], configurations.state(found[k].all.front()), robot);
      return tried[k];
    }
  }
  return {};
}

}  // namespace gonio::acquisition
