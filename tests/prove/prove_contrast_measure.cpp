// scripts/proofs/contrast-measure: data matrices of micro-ridges, rendered at nine camera angles before and after the
// turn, with noise, a robot's errors and planted defects. Do the intervals cover the contrast of the surfaces, are the
// planted cells found and no others, is the code read without knowing it? With a folder as second argument, one such
// session is written there for trying the program by hand.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "contrast_measure/sample_world.h"
#include "data.h"
#include "stats/distributions.h"

namespace gonio::prove {
namespace {

bool claim(const char* name, double measured, double lower, double upper) {
  const bool passed = measured >= lower && measured <= upper;
  std::printf("%s: measured %.4f required %.4f .. %.4f%s\n", name, measured, lower, upper, passed ? "" : "  FAILED");
  return passed;
}

struct Tally {
  int runs = 0, views = 0, covered = 0, planted = 0, found = 0, alarmed_runs = 0, sound_runs = 0, read = 0, signs = 0;
  double z2 = 0, place = 0;
};

void run_one(std::uint64_t seed, bool with_defects, bool refine, Tally& tally) {
  const tests::ScratchFolder folder;
  const tests::SampleWorld world = tests::data_matrix_world("DTU " + std::to_string(seed), with_defects ? 5 : 0, seed);
  const manifest::Document document = tests::photographed(world, folder.path(), false);
  contrast::MeasureOptions options;
  options.refine = refine;
  options.seed = seed;
  const contrast::Measured m = contrast::measure(document, "", {}, options);
  for (const contrast::MeasuredView& view : m.views) {
    const auto tilt = static_cast<std::size_t>(std::stoi(view.image.substr(view.image.rfind('-') + 1)));
    const double error = view.michelson.value - tests::true_michelson(world, view.placement, tilt);
    tally.covered += std::abs(error) <= stats::student_quantile(0.975, view.degrees) * view.michelson.sigma;
    tally.z2 += error * error / (view.michelson.sigma * view.michelson.sigma);
    tally.place += view.place_px;
    ++tally.views;
  }
  int alarms = 0;
  for (const contrast::CellDefect& defect : m.defects.found) {
    const bool planted = std::ranges::find(world.defects, defect.cell) != world.defects.end();
    planted ? ++tally.found : ++alarms;
  }
  tally.planted += static_cast<int>(world.defects.size());
  tally.sound_runs += !with_defects;
  tally.alarmed_runs += !with_defects && alarms > 0;
  if (with_defects && alarms > 0)
    std::printf("  seed %llu: %d sound cells found beside the planted ones\n", static_cast<unsigned long long>(seed),
                alarms);
  tally.read += m.code && m.code->text == "DTU " + std::to_string(seed);
  tally.signs += m.mean_michelson(0).value > 0 && m.mean_michelson(1).value < 0;
  ++tally.runs;
}

bool series(const char* name, int runs, bool refine, std::uint64_t first_seed) {
  Tally t;
  for (int run = 0; run < runs; ++run) run_one(first_seed + static_cast<std::uint64_t>(run), run % 2 == 0, refine, t);
  std::printf("%s: %d sessions of 18 pictures; error over sigma: rms %.3f; sigma of the place %.2g px\n", name, t.runs,
              std::sqrt(t.z2 / t.views), t.place / t.views);
  bool passed = claim("  contrasts within their 95 % intervals", double(t.covered) / t.views, 0.90, 0.98);
  passed = claim("  planted defects found", double(t.found) / t.planted, 0.95, 1) && passed;
  // A rate of 5 % is stated: as many alarms or more must not be rarer than one in a thousand under it.
  std::printf("  sessions without defects with a false alarm: %d of %d\n", t.alarmed_runs, t.sound_runs);
  passed = claim("  chance of so many at the stated rate of 5 %",
                 stats::binomial_upper(t.alarmed_runs, t.sound_runs, 0.05), 0.001, 1) &&
           passed;
  passed = claim("  codes read, pattern not stated", double(t.read) / t.runs, 1, 1) && passed;
  return claim("  contrast turned its sign", double(t.signs) / t.runs, 1, 1) && passed;
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int runs = argc > 1 ? std::atoi(argv[1]) : 60;
  if (argc > 2) {
    const std::filesystem::path folder = argv[2];
    std::filesystem::create_directories(folder);
    gonio::tests::SampleWorld world = gonio::tests::data_matrix_world("DTU", 4, 5);
    world.side_px = 300;
    world.focal_px = 4800;
    const auto document = gonio::tests::photographed(world, folder, false);
    std::ofstream(folder / "session.json") << gonio::manifest::print_document(document, folder);
    return 0;
  }
  const bool refined = gonio::prove::series("views laid onto the pattern", runs, true, 71000);
  const bool plain = gonio::prove::series("poses as stated", runs, false, 83000);
  return plain && refined ? 0 : 1;
}
