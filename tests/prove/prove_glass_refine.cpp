// Physics against a network's answer about transparent objects of glass-make's families: mean angles of the normals of
// front and back, by stage of the refinement.
//
//   prove-glass-refine FOLDER [--form NAME]... [--seeds A B] [--objects N] [--views N] [--size PX] [--spp N]
//     [--front DEG] [--back DEG] [--shake PX] [--as-made]
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
  double answer_front = 0, answer_back = 0;
};

void measure(const WorldWish& wish, const std::filesystem::path& folder, double front_deg, double back_deg,
             double shake_px, Sums& sums) {
  World world = make_world(wish, folder);
  add_stand_in(world, front_deg, back_deg, 10, wish.seed * 100 + wish.object);
  if (shake_px > 0) shake_masks(world, shake_px, wish.seed * 100 + wish.object);
  const std::size_t held = world.views.size() - 1;
  RefineWish refine_wish;
  refine_wish.held_out = held;
  refine_wish.hull.floor_m = 0;
  refine_wish.draws = 0;
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
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) return 64;
  const std::filesystem::path folder = argv[1];
  WorldWish wish;
  std::vector<std::string> forms;
  std::uint64_t first = 1, last = 1;
  std::size_t objects = 1;
  double front = 22, back = 32, shake = 0;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    const auto next = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string("0"); };
    if (word == "--form") forms.push_back(next());
    if (word == "--seeds") first = std::stoull(next()), last = std::stoull(next());
    if (word == "--objects") objects = std::stoul(next());
    if (word == "--views") wish.views = std::stoul(next());
    if (word == "--size") wish.size_px = std::stoi(next());
    if (word == "--spp") wish.spp = std::stoi(next());
    if (word == "--front") front = std::stod(next());
    if (word == "--back") back = std::stod(next());
    if (word == "--shake") shake = std::stod(next());
    if (word == "--as-made") wish.clear = false;
  }
  if (forms.empty()) forms = {"blend", "blown", "bottle", "lathe", "solid"};
  Sums all;
  for (const std::string& form : forms) {
    Sums sums;
    for (std::uint64_t seed = first; seed <= last; ++seed)
      for (std::size_t object = 0; object < objects; ++object) {
        wish.form = form, wish.seed = seed, wish.object = object;
        measure(wish, folder / (form + "-" + std::to_string(seed)), front, back, shake, sums);
      }
    std::printf("%s: network %.1f %.1f", form.c_str(), sums.network_front / sums.count, sums.network_back / sums.count);
    for (const char* stage : {"hull", "outline", "normals", "light-2"})
      std::printf("  %s %.1f %.1f", stage, sums.stages[stage].first / sums.count,
                  sums.stages[stage].second / sums.count);
    std::printf("  answer %.1f %.1f\n", sums.answer_front / sums.count, sums.answer_back / sums.count);
    all.network_front += sums.network_front, all.network_back += sums.network_back, all.count += sums.count;
    all.answer_front += sums.answer_front, all.answer_back += sums.answer_back;
  }
  std::printf("all: network %.1f %.1f  answer %.1f %.1f  factor %.2f %.2f\n", all.network_front / all.count,
              all.network_back / all.count, all.answer_front / all.count, all.answer_back / all.count,
              all.network_front / all.answer_front, all.network_back / all.answer_back);
} catch (const gonio::Error& error) {
  std::fprintf(stderr, "prove-glass-refine: %s\n", error.what());
  return static_cast<int>(error.code());
}
