// See way.h.
#include <algorithm>
#include <cmath>

#include "acquisition/motion/line.h"
#include "acquisition/motion/way.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

constexpr double look_every_rad = 0.03;  // for singular values and the workspace
constexpr double slack = 0.02;           // of the margin: what two walks of one line may differ by

std::string close_together(const Clearance& clearance, double margin_m) {
  if (clearance.distance_m <= 0) return clearance.first + " and " + clearance.second + " meet";
  return clearance.first + " and " + clearance.second +
         format(" are %.1f mm apart, limit %.1f mm", 1e3 * clearance.distance_m, 1e3 * margin_m);
}

class Walk {
 public:
  Walk(const Laboratory& laboratory, const Surroundings& surroundings, double step_m, WayFigures& figures)
      : laboratory_(laboratory), surroundings_(surroundings), figures_(figures) {
    allowance_m_ = laboratory.margin_m > 0 ? std::min(step_m, laboratory.margin_m / 2) : step_m;
  }

  void begin(const State& state) {
    const Clearance first = surroundings_.clearance(state);
    figures_.clearance_m = first.distance_m;
    figures_.smallest_singular_m = smallest_singular(laboratory_, state);
    look(state, figures_.smallest_singular_m, 0);
    judge_clearance(first, 0);
  }

  // From state `index` of the way to the next.
  void line(const State& from, const State& to, std::size_t index) {
    const auto place = static_cast<double>(index);
    const double turn = largest_turn(laboratory_, from, to);
    figures_.largest_turn_rad = std::max(figures_.largest_turn_rad, turn);
    const int looks = std::max(1, static_cast<int>(std::ceil(turn / look_every_rad)));
    for (int i = 1; i <= looks && figures_.fault.empty(); ++i) {
      const double t = static_cast<double>(i) / looks;
      const State state = between(laboratory_, from, to, t);
      const double singular = smallest_singular(laboratory_, state);
      figures_.smallest_singular_m = std::min(figures_.smallest_singular_m, singular);
      look(state, singular, place + t);
    }
    if (!figures_.fault.empty()) return;
    judge_clearance(surroundings_.clearance(to, figures_.clearance_m), place + 1);
    if (!figures_.fault.empty()) return;
    const auto [nearest, at] = surroundings_.nearest_between(from, to, figures_.clearance_m, least_m(), allowance_m_);
    judge_clearance(nearest, place + at);
  }

 private:
  void look(const State& state, double singular_m, double at) {
    const std::string broken = broken_at(laboratory_, state, singular_m);
    if (!broken.empty()) fault(broken, at);
  }
  double least_m() const { return (1 - slack) * laboratory_.margin_m; }
  void judge_clearance(const Clearance& clearance, double at) {
    figures_.clearance_m = std::min(figures_.clearance_m, clearance.distance_m);
    if (clearance.distance_m < least_m() || clearance.distance_m <= 0)
      fault(close_together(clearance, laboratory_.margin_m), at);
  }
  void fault(const std::string& words, double at) {
    if (figures_.fault.empty()) figures_.fault = format("state %.2f of the way: ", at) + words;
  }

  const Laboratory& laboratory_;
  const Surroundings& surroundings_;
  WayFigures& figures_;
  double allowance_m_ = 0;
};

}  // namespace

WayFigures judge(const Laboratory& laboratory, const Surroundings& surroundings, const Way& way, double step_m) {
  WayFigures figures;
  if (way.empty()) return figures;
  Walk walk(laboratory, surroundings, step_m, figures);
  walk.begin(way.front());
  for (std::size_t i = 0; i + 1 < way.size() && figures.fault.empty(); ++i) walk.line(way[i], way[i + 1], i);
  figures.duration_s = way_time(laboratory, way);
  return figures;
}

bool open_line(const Laboratory& laboratory, const Surroundings& surroundings, const State& from, const State& to) {
  const double margin = laboratory.margin_m;
  if (!surroundings.free(from, margin) || !surroundings.free(to, margin)) return false;
  const int looks = std::max(1, static_cast<int>(std::ceil(largest_turn(laboratory, from, to) / look_every_rad)));
  for (int i = 0; i <= looks; ++i) {
    const State state = between(laboratory, from, to, static_cast<double>(i) / looks);
    if (!broken_at(laboratory, state, smallest_singular(laboratory, state)).empty()) return false;
  }
  // Nowhere nearer than `judge` allows: below the margin by half of the slack at most, or it is found.
  const double enough = std::max((1 - slack / 2) * margin, 1e-9);
  const auto nearest = surroundings.nearest_between(from, to, enough, enough, slack / 2 * margin);
  return nearest.clearance.distance_m >= enough;
}

}  // namespace gonio::acquisition
