// Physics against a network's answer about transparent objects of glass-make's families: mean angles of the normals of
// front and back, by stage of the refinement.
//
//   prove-glass-refine FOLDER [--form NAME]... [--seeds A B] [--objects N] [--views N] [--size PX] [--spp N]
//     [--front DEG] [--back DEG] [--shake PX] [--as-made]
//     [--weights DIR [--network-masks]]   glass-net(1) with these instead of the stand-in
#include <cstdio>
#include <cstdlib>
#include <map>

#include "base/error.h"
#include "glass/refine_world.h"

namespace {

using namespace gonio;
using namespace gonio::glass;

struct Sums {
  double network_front = 0, network_back = 0, count = 0;
  std::map<std::string, std::pair<double, double>> stages;
  double answer_front = 0, answer_back = 0, maps_front = 0, maps_back = 0;
  double hull_front = 0, hull_back = 0, within = 0, within_two = 0, beyond = 0;
};

struct Said {  // of the views, before physics
  double front_deg = 22, back_deg = 32, shake_px = 0;
  std::filesystem::path weights{};  // none: a stand-in
  bool network_masks = false;
};

void measure(const WorldWish& wish, const std::filesystem::path& folder, const Said& said, Sums& sums) {
  World world = make_world(wish, folder);
  if (said.weights.empty())
    add_stand_in(world, said.front_deg, said.back_deg, 10, wish.seed * 100 + wish.object);
  else
    ask_network(world, said.weights, said.network_masks, folder);
  if (said.shake_px > 0) shake_masks(world, said.shake_px, wish.seed * 100 + wish.object);
  const std::size_t held = world.views.size() - 1;
  RefineWish refine_wish;
  refine_wish.held_out = held;
  refine_wish.hull.floor_m = 0;
  refine_wish.draws = 6;
  const Refined refined = refine(world.views, refine_wish);
  const Angles network = angles_of_network(world, held);
  std::printf("%s seed %llu object %zu (%s, index %.3f)\n  network              %5.1f %5.1f\n", wish.form.c_str(),
              static_cast<unsigned long long>(wish.seed), wish.object, world.glass.c_str(), world.index, network.front,
              network.back);
  sums.network_front += network.front, sums.network_back += network.back, ++sums.count;
  for (std::size_t s = 0; s < refined.stages.size(); ++s) {
    const Stage& stage = refined.stages[s];
    const Angles a = angles_of(world, stage, held);
    std::printf(
        "  %-10s %c         %5.1f %5.1f  held out %5.1f %5.1f  unexplained %.3f, held out %.3f  index %.3f  %s\n",
        stage.name.c_str(), s == refined.answer ? '*' : ' ', a.front, a.back, a.held_front, a.held_back,
        stage.unexplained, stage.unexplained_held_out, stage.glass.index, stage.how.c_str());
    sums.stages[stage.name].first += a.front, sums.stages[stage.name].second += a.back;
    if (s == refined.answer) sums.answer_front += a.front, sums.answer_back += a.back;
  }
  const MapsJudged maps = judge_maps(world, refined, held);
  std::printf(
      "  maps                 %5.1f %5.1f  within 1, 2 deviations %.2f %.2f, beyond 3 %.3f; index %.3f +- %.3f\n",
      maps.front, maps.back, maps.within, maps.within_two, maps.beyond_three, refined.best().glass.index,
      refined.index_sigma);
  sums.maps_front += maps.front, sums.maps_back += maps.back;
  sums.within += maps.within, sums.within_two += maps.within_two, sums.beyond += maps.beyond_three;
  std::fflush(stdout);
}

bool claim(const char* what, double measured, double low, double high) {
  const bool met = measured >= low && measured <= high;
  std::printf("glass-refine %s: measured %.3g required %.3g to %.3g%s\n", what, measured, low, high,
              met ? "" : "  NOT MET");
  return met;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) return 64;
  const std::filesystem::path folder = argv[1];
  WorldWish wish;
  std::vector<std::string> forms;
  std::uint64_t first = 1, last = 1;
  std::size_t objects = 1;
  Said said;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    const auto next = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string("0"); };
    if (word == "--form") forms.push_back(next());
    if (word == "--seeds") first = std::stoull(next()), last = std::stoull(next());
    if (word == "--objects") objects = std::stoul(next());
    if (word == "--views") wish.views = std::stoul(next());
    if (word == "--size") wish.size_px = std::stoi(next());
    if (word == "--spp") wish.spp = std::stoi(next());
    if (word == "--front") said.front_deg = std::stod(next());
    if (word == "--back") said.back_deg = std::stod(next());
    if (word == "--shake") said.shake_px = std::stod(next());
    if (word == "--weights") said.weights = next();
    if (word == "--network-masks") said.network_masks = true;
    if (word == "--as-made") wish.clear = false;
  }
  if (forms.empty()) forms = {"blend", "blown", "bottle", "lathe", "solid"};
  Sums all;
  for (const std::string& form : forms) {
    Sums sums;
    for (std::uint64_t seed = first; seed <= last; ++seed)
      for (std::size_t object = 0; object < objects; ++object) {
        wish.form = form, wish.seed = seed, wish.object = object;
        measure(wish, folder / (form + "-" + std::to_string(seed)), said, sums);
      }
    std::printf("%s: network %.1f %.1f", form.c_str(), sums.network_front / sums.count, sums.network_back / sums.count);
    for (const char* stage : {"hull", "outline", "normals", "light-2"})
      std::printf("  %s %.1f %.1f", stage, sums.stages[stage].first / sums.count,
                  sums.stages[stage].second / sums.count);
    std::printf("  answer %.1f %.1f  maps %.1f %.1f  within %.2f %.2f beyond %.3f\n", sums.answer_front / sums.count,
                sums.answer_back / sums.count, sums.maps_front / sums.count, sums.maps_back / sums.count,
                sums.within / sums.count, sums.within_two / sums.count, sums.beyond / sums.count);
    all.network_front += sums.network_front, all.network_back += sums.network_back, all.count += sums.count;
    all.answer_front += sums.answer_front, all.answer_back += sums.answer_back;
    all.maps_front += sums.maps_front, all.maps_back += sums.maps_back;
    all.within += sums.within, all.within_two += sums.within_two, all.beyond += sums.beyond;
    all.hull_front += sums.stages["hull"].first, all.hull_back += sums.stages["hull"].second;
  }
  const double n = all.count;
  std::printf("all: network %.1f %.1f  hull %.1f %.1f  body %.1f %.1f  maps %.1f %.1f  within %.2f %.2f beyond %.3f\n",
              all.network_front / n, all.network_back / n, all.hull_front / n, all.hull_back / n, all.answer_front / n,
              all.answer_back / n, all.maps_front / n, all.maps_back / n, all.within / n, all.within_two / n,
              all.beyond / n);
  // With trained weights the factor is theirs as much as the refinement's: it is told, and must be above one.
  const bool real = !said.weights.empty();
  // Beside it, of another data set and by another method: a published 16.7 degrees of glass normals by polarization.
  bool met = claim("front, times better than the network", all.network_front / all.maps_front, real ? 1 : 2.5, 100);
  met &= claim("back, times better than the network", all.network_back / all.maps_back, real ? 1 : 3, 100);
  met &= claim("share within the stated uncertainty of 68.3 %", all.within / n, 0.55, 0.92);
  met &= claim("share beyond three of them", all.beyond / n, 0, 0.06);
  return met ? 0 : 1;
} catch (const gonio::Error& error) {
  std::fprintf(stderr, "prove-glass-refine: %s\n", error.what());
  return static_cast<int>(error.code());
}
