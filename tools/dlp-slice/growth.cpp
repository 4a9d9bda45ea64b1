// The growth of voxels, from height maps of a printed calibration sample.
#include "base/assignment.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/height_map.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {
namespace {

print::MapPlace place_of(const cli::Invocation& call, std::size_t k, std::size_t maps) {
  const auto one = [&](const char* option) -> std::string {
    const std::vector<std::string>& all = call.texts(option);
    if (!all.empty() && all.size() != maps)
      throw Error(Exit::usage, std::string("--") + option,
                  "is given " + std::to_string(all.size()) + " times for " + std::to_string(maps) + " maps",
                  "give it once for each");
    return all.empty() ? "" : all[k];
  };
  print::MapPlace place;
  const std::string at = one("map-at"), turn = one("map-turn");
  if (at.empty())
    throw Error(Exit::usage, "--map-at", "is missing",
                "say where the map's first point lies on the platform, to within --search");
  const std::vector<double> xy = lengths_of(at, 2, "--map-at");
  place.at_m = {xy[0], xy[1]};
  if (!turn.empty()) place.turn_rad = parse_quantity(turn, Dimension::angle, "--map-turn");
  return place;
}

}  // namespace

void fit_growth(Work& work) {
  cli::Invocation& call = work.call;
  print::SampleWish wish;
  wish.slab_layers = static_cast<std::size_t>(call.integer("slab-layers"));
  wish.greys = static_cast<int>(call.integer("greys")),
  wish.repetitions = static_cast<int>(call.integer("repetitions"));
  const std::vector<std::string>& maps = call.texts("growth-from");
  std::vector<print::MapPlace> places;
  for (std::size_t k = 0; k < maps.size(); ++k) places.push_back(place_of(call, k, maps.size()));
  work.sample = print::calibration_sample(work.printer, wish);
  print::PrintedGradient all;
  const std::string place = maps.size() == 1 ? maps[0] : "--growth-from";
  for (std::size_t k = 0; k < maps.size(); ++k) {
    call.note_input(maps[k]);
    const double step = call.given("map-step") ? call.number("map-step") : 0;
    const io::HeightMap map = io::read_height_map(maps[k], {.step_x_m = step, .step_y_m = step});
    const print::SampleReading reading =
        print::read_gradients(map, *work.sample, work.printer, places[k], call.number("search"), maps[k]);
    work.notes.push_back(
        format("%s: %zu whole repetitions, %d in part; its first point lies at %.4f, %.4f mm; correlation with "
               "what was sent %.3f",
               maps[k].c_str(), reading.gradient.repetitions_m.size(), reading.incomplete, reading.place.at_m.x * 1e3,
               reading.place.at_m.y * 1e3, reading.likeness));
    log(LogLevel::info, work.notes.back());
    all.greys = reading.gradient.greys;
    all.repetitions_m.insert(all.repetitions_m.end(), reading.gradient.repetitions_m.begin(),
                             reading.gradient.repetitions_m.end());
  }
  work.growth = print::fit_growth(all, place.c_str());
  work.entry().growth = print::growth_entry(*work.growth);
}

}  // namespace gonio::tools::dlp_slice
