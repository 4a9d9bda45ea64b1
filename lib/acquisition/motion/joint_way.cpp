// See way.h. The space that is searched holds the joints that move, each times how far it carries solids (reach.h): a
// distance there is a distance in metres. The search is OMPL's, in a module.
#include <algorithm>
#include <cmath>

#include "acquisition/motion/joint_way_module.h"
#include "acquisition/motion/line.h"
#include "acquisition/motion/reach.h"
#include "acquisition/motion/way.h"
#include "base/loaded_library.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

constexpr int shortcuts = 80;

struct MovingJoint {
  const LaboratoryArm* arm;
  std::size_t joint;
  double metres_per_rad;
  double lower_rad, upper_rad;  // of the search
};

class SearchSpace : public SearchedSpace {
 public:
  SearchSpace(const Laboratory& laboratory, const Surroundings& surroundings, const State& from, const State& to)
      : laboratory_(laboratory), surroundings_(surroundings), rest_(between(laboratory, from, from, 0)) {
    for (const auto& [name, arm] : laboratory.arms) {
      const Joints &a = joints_of(arm, from), &b = joints_of(arm, to);
      if (a == b) continue;
      std::vector<double> reach(a.size(), 0.01);  // the last joint carries little
      for (const std::vector<double>& of_solid : reaches(arm))
        for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = std::max(reach[i], of_solid[i]);
      for (std::size_t i = 0; i < a.size(); ++i)  // half a turn beyond both ends leads round anything
        joints_.push_back({&arm, i, reach[i], std::max(arm.limits[i].lower_rad, std::min(a[i], b[i]) - pi),
                           std::min(arm.limits[i].upper_rad, std::max(a[i], b[i]) + pi)});
    }
  }
  const std::vector<MovingJoint>& joints() const { return joints_; }

  State state_of(const double* values) const {
    State state = rest_;
    for (std::size_t k = 0; k < joints_.size(); ++k)
      state[joints_[k].arm->name][joints_[k].joint] = values[k] / joints_[k].metres_per_rad;
    return state;
  }
  std::vector<double> values_of(const State& state) const {
    std::vector<double> values;
    for (const MovingJoint& j : joints_) values.push_back(joints_of(*j.arm, state)[j.joint] * j.metres_per_rad);
    return values;
  }
  unsigned dimensions() const override { return static_cast<unsigned>(joints_.size()); }
  double lower(unsigned k) const override { return joints_[k].lower_rad * joints_[k].metres_per_rad; }
  double upper(unsigned k) const override { return joints_[k].upper_rad * joints_[k].metres_per_rad; }
  double drawn(unsigned k, Random& random) const override {
    return random.uniform(joints_[k].lower_rad, joints_[k].upper_rad) * joints_[k].metres_per_rad;
  }
  bool open(const double* at) const override { return open(state_of(at)); }
  bool open(const double* from, const double* to) const override { return open(state_of(from), state_of(to)); }
  bool open(const State& state) const {
    return broken_at(laboratory_, state, smallest_singular(laboratory_, state)).empty() &&
           surroundings_.free(state, laboratory_.margin_m);
  }
  bool open(const State& from, const State& to) const { return open_line(laboratory_, surroundings_, from, to); }
  const Laboratory& laboratory() const { return laboratory_; }

 private:
  const Laboratory& laboratory_;
  const Surroundings& surroundings_;
  State rest_;
  std::vector<MovingJoint> joints_;
};

std::optional<Way> searched(const SearchSpace& search, const State& from, const State& to, std::uint64_t seed,
                            int tries) {
  static const auto search_way = loaded_from_module<decltype(gonio_joint_way)>("joint_way", "gonio_joint_way");
  std::vector<std::vector<double>> places;
  if (!search_way(search, search.values_of(from), search.values_of(to), seed, tries, places)) return std::nullopt;
  Way way;
  for (const std::vector<double>& place : places) way.push_back(search.state_of(place.data()));
  way.front() = from;
  way.back() = to;
  return way;
}

// Straight lines across, between random places of the way, where that saves time.
Way shortened(const SearchSpace& search, Way way, std::uint64_t seed) {
  const Laboratory& laboratory = search.laboratory();
  Random random(seed, 22);
  double time = way_time(laboratory, way);
  for (int k = 0; k < shortcuts && way.size() > 2; ++k) {
    double a = random.uniform(0, static_cast<double>(way.size() - 1));
    double b = random.uniform(0, static_cast<double>(way.size() - 1));
    if (k % 2 == 0) a = std::floor(a), b = std::ceil(b);  // whole corners as often as places between them
    if (a > b) std::swap(a, b);
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(std::ceil(b));
    if (j < i + 2) continue;
    const State from = between(laboratory, way[i], way[i + 1], a - static_cast<double>(i));
    const State to = between(laboratory, way[j - 1], way[j], b - static_cast<double>(j - 1));
    Way across(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    if (a > static_cast<double>(i)) across.push_back(from);
    if (b < static_cast<double>(j)) across.push_back(to);
    across.insert(across.end(), way.begin() + static_cast<std::ptrdiff_t>(j), way.end());
    const double shorter = way_time(laboratory, across);
    if (shorter >= time || !search.open(from, to)) continue;
    way = std::move(across);
    time = shorter;
  }
  return way;
}

}  // namespace

std::optional<Way> joint_way(const Laboratory& laboratory, const Surroundings& surroundings, const State& from,
                             const State& to, std::uint64_t seed, int tries) {
  const State begin = between(laboratory, from, from, 0), end = between(laboratory, to, to, 0);
  const SearchSpace search(laboratory, surroundings, begin, end);
  if (search.joints().empty() || open_line(laboratory, surroundings, begin, end)) {
    Way line{begin, end};
    if (judge(laboratory, surroundings, line).fault.empty()) return line;
    return std::nullopt;
  }
  if (!search.open(begin) || !search.open(end)) return std::nullopt;
  std::optional<Way> way = searched(search, begin, end, seed, tries);
  if (!way) return std::nullopt;
  way = shortened(search, std::move(*way), seed);
  if (!judge(laboratory, surroundings, *way).fault.empty()) return std::nullopt;
  return way;
}

}  // namespace gonio::acquisition
