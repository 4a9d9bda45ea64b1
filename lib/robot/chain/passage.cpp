// How the arm came to each pose: the order of the images by their times, else as they are listed. Velocity and
// acceleration are those of the parabola through a pose and its two neighbours, in the chart (rotation vector, shift)
// about it: with xi_b at -b and xi_a at a,
//   velocity = (b^2 xi_a - a^2 xi_b) / (a b (a + b)),   acceleration = 2 (b xi_a + a xi_b) / (a b (a + b)).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "robot/chain/input.h"

namespace gonio::robot {
namespace {

using View = ChainInput::View;
constexpr double least_turn_rad = 1e-5;  // below it a joint stands
constexpr double longest_gap_s = 1;      // beyond it nobody knows what the arm did between two images

bool all_state(const std::vector<View>& views, std::optional<double> View::*quantity) {
  return std::all_of(views.begin(), views.end(), [&](const View& v) { return (v.*quantity).has_value(); });
}

void settle_drift(std::vector<View>& views, std::optional<double> View::*stated, double View::*difference) {
  if (views.empty() || !all_state(views, stated)) return;
  double sum = 0;
  for (const View& v : views) sum += *(v.*stated);
  for (View& v : views) v.*difference = *(v.*stated) - sum / static_cast<double>(views.size());
}

std::array<double, 6> change(const View& from, const View& to) {
  const auto xi = inverse(from.base_from_tool) * to.base_from_tool;
  const Vec3 w = rotation_vector_of(xi.rotation), t = xi.translation_m;
  return {w.x, w.y, w.z, t.x, t.y, t.z};
}

void find_motion(const View& before, View& view, const View& after) {
  const double b = *view.time_s - *before.time_s, a = *after.time_s - *view.time_s;
  if (!(a > 0 && b > 0 && a <= longest_gap_s && b <= longest_gap_s)) return;
  const std::array<double, 6> from = change(view, before), to = change(view, after);
  const double scale = 1 / (a * b * (a + b));
  for (std::size_t i = 0; i < 6; ++i) {
    view.velocity[i] = (b * b * to[i] - a * a * from[i]) * scale;
    view.acceleration[i] = 2 * (b * to[i] + a * from[i]) * scale;
    view.passes = view.passes || view.velocity[i] != 0;
  }
}

}  // namespace

void find_passage(ChainInput& input) {
  std::vector<View>& views = input.views;
  settle_drift(views, &View::temperature_K, &View::warmer_K);
  settle_drift(views, &View::time_s, &View::later_s);
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const bool timed = all_state(views, &View::time_s);
  if (timed)
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return *views[a].time_s < *views[b].time_s; });
  for (std::size_t k = 1; k < order.size(); ++k) {
    const View& before = views[order[k - 1]];
    View& view = views[order[k]];
    for (std::size_t j = 0; j < std::min<std::size_t>({6, view.joints_rad.size(), before.joints_rad.size()}); ++j) {
      const double turn = view.joints_rad[j] - before.joints_rad[j];
      view.approach[j] = std::abs(turn) > least_turn_rad ? (turn > 0 ? 1 : -1) : before.approach[j];
    }
    if (timed && k + 1 < order.size()) find_motion(before, view, views[order[k + 1]]);
  }
}

}  // namespace gonio::robot
