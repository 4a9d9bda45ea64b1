// scripts/proofs/contrast-measure: data matrices of micro-ridges, rendered at nine camera angles before and after the
// turn, with noise, a robot's errors and planted defects. Do the intervals cover the contrast of the surfaces, are the
// planted cells found and no others, is the code read without knowing it? With a folder as second argument, one such
// session is written there for trying the program by hand. Third: the first seed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "contrast/measure/sample_world.h"
#include "data.h"
#include "manifest/document.h"
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

bool series(const char* name, int runs, bool refine, std::uint64_t first_seed, Tally& pooled) {
  Tally t;
  for (int run = 0; run < runs; ++run) run_one(first_seed + static_cast<std::uint64_t>(run), run % 2 == 0, refine, t);
  std::printf("%s: %d sessions of 18 pictures; error over sigma: rms %.3f; sigma of the place %.2g px\n", name, t.runs,
              std::sqrt(t.z2 / t.views), t.place / t.views);
  bool passed = claim("  contrasts within their 95 % intervals", double(t.covered) / t.views, 0.90, 0.98);
  passed = claim("  planted defects found", double(t.found) / t.planted, 0.95, 1) && passed;
  std::printf("  sessions without defects with a false alarm: %d of %d\n", t.alarmed_runs, t.sound_runs);
  pooled.alarmed_runs += t.alarmed_runs;
  pooled.sound_runs += t.sound_runs;
  passed = claim("  codes read, pattern not stated", double(t.read) / t.runs, 1, 1) && passed;
  return claim("  contrast turned its sign", double(t.signs) / t.runs, 1, 1) && passed;
}

// A rate of 5 % is stated: as many alarms or more, as few or fewer, must not be rarer than one in two hundred each.
bool alarms(const Tally& pooled) {
  std::printf("both series: %d of %d sessions without defects have a false alarm\n", pooled.alarmed_runs,
              pooled.sound_runs);
  const bool few = claim("  chance of so many or more at the stated rate of 5 %",
                         stats::binomial_upper(pooled.alarmed_runs, pooled.sound_runs, 0.05), 0.005, 1);
  return claim("  chance of so few or fewer",
               1 - stats::binomial_upper(pooled.alarmed_runs + 1, pooled.sound_runs, 0.05), 0.005, 1) &&
         few;
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int runs = argc > 1 ? std::atoi(argv[1]) : 60;
  const std::uint64_t first = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 414000;
  if (argc > 2 && *argv[2] != 0) {
    const std::filesystem::path folder = argv[2];
    std::filesystem::create_directories(folder);
    gonio::tests::SampleWorld world = gonio::tests::data_matrix_world("DTU", 4, 5);
    world.side_px = 300;
    world.focal_px = 4800;
    const auto document = gonio::tests::photographed(world, folder, false);
    std::ofstream(folder / "session.json") << gonio::manifest::print_document(document, folder);
    return 0;
  }
  gonio::prove::Tally pooled;
  const bool refined = gonio::prove::series("views laid onto the pattern", runs, true, first, pooled);
  const bool plain = gonio::prove::series("poses as stated", runs, false, first + 12000, pooled);
  return gonio::prove::alarms(pooled) && plain && refined ? 0 : 1;
}
