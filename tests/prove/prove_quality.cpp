// scripts/proofs/calib-quality: 95 % intervals of projection and focal length over 500 calibrations, and how often
// halves of views of a right model are called apart at 5 %.
#include <cstdio>
#include <cstdlib>

#include "camera/quality/coverage_runs.h"
#include "stats/intervals.h"

int main(int argc, char** argv) {
  using namespace gonio;
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 500;
  const camera::tests::Covered c = camera::tests::covered(runs, true);
  bool met = true;
  const auto claim = [&](const char* name, int inside, int all) {
    const double share = static_cast<double>(inside) / all;
    const bool good = share >= 0.93 && share <= 0.97;
    std::printf("calib-quality %s: measured %.1f %% of %d in %d runs, required 93 to 97 %%%s\n", name, 100 * share, all,
                c.runs, good ? "" : "  NOT MET");
    met &= good;
  };
  claim("95 % ellipses of the projection hold the truth", c.ellipse, c.points);
  claim("95 % circles of the projection hold the truth", c.circle, c.points);
  claim("95 % intervals of the focal lengths hold the truth", c.focal, c.focals);
  const stats::Interval apart = stats::share_interval(c.apart, c.halved);
  std::printf(
      "calib-quality halves of a right model called apart at 5 %%: measured %d of %d (95 %% interval %.1f to %.1f %%) "
      "required <= 5 %%%s\n",
      c.apart, c.halved, 100 * apart.lower, 100 * apart.upper, apart.lower > 0.05 ? "  NOT MET" : "");
  met &= apart.lower <= 0.05;
  return met ? 0 : 1;
}
