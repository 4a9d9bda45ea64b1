// scripts/proofs/explain-residual-test: how often explain's null test sees physics that was left out, and how often it
// sees some where nothing was. Cases come from tests/explain/boards/board_world.cpp, which shares no code with the
// library; every run has a camera of 1 to 5 megapixels, a board of 9 x 6 to 14 x 9 corners and 20 views of its own,
// with 0.1 px noise.
#include <cstdio>
#include <cstdlib>

#include "explain/boards/residual_cases.h"
#include "stats/intervals.h"

namespace gonio::prove {
namespace {

bool print_power(const LeftOut& what, int runs, double level, double required, bool at_most) {
  int found = 0;
  for (int run = 0; run < runs; ++run) found += residual_p(what, static_cast<std::uint64_t>(run)) <= level;
  const double share = static_cast<double>(found) / runs;
  const stats::Interval interval = stats::share_interval(found, runs);
  // False alarms: the claim fails where the interval lies above the limit; power: where the share itself is below.
  const bool met = at_most ? interval.lower <= required : share >= required;
  std::printf(
      "explain-residual-test %s, level %g: measured %d of %d (%.1f %%, 95 %% interval %.1f to %.1f %%) required %s "
      "%.0f %%%s\n",
      what.name.c_str(), level, found, runs, 100 * share, 100 * interval.lower, 100 * interval.upper,
      at_most ? "<=" : ">=", 100 * required, met ? "" : "  NOT MET");
  std::fflush(stdout);
  return met;
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  using namespace gonio::prove;
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 200;
  bool met = true;
  for (const LeftOut& what : left_out_cases())
    if (argc < 3 || what.name.starts_with(argv[2]))
      met &= print_power(what, runs, 0.05, what.present ? what.power : 0.05, !what.present);
  return met ? 0 : 1;
}
