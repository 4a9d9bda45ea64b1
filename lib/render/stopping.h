// When a picture has enough samples, and how its noise is told.
//
// Relative error of a picture: over all values Y of the channels R, G, B that are not zero (pixels that no light
// reached say nothing),
//   e = sqrt(mean of  v / (Y^2 + f^2)),     f = 1 % of the median of |Y|,
// v the estimated variance of Y. It estimates what the root of the relative mean square error against a perfect
// rendering would be; f keeps what is black but for stray light from deciding.
//
// Where rare paths carry much light, a pixel that one of them hit is far too bright, and v / Y^2 is near 1 however
// wrong it is. So a value whose own relative error exceeds a third is held against at most twice the median of its lit
// 3 x 3 neighbours in place of Y. And few samples miss such paths and promise too much; the scatter over the pixels
// tells: with T the sum of a pixel's terms and n their number, e^2 = sum T / sum n is a ratio whose standard error is
//   s = sqrt(N / (N - 1) sum (T - e^2 n)^2) / sum n                (N pixels; Cochran 1977, Sampling Techniques, 6.4)
// and a goal counts as reached once sqrt(e^2 + 2 s) is below it.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "render/integrator.h"
#include "render/passes.h"

namespace gonio::render {

struct ErrorEstimate {
  double relative = 0;  // e
  double bound = 0;     // sqrt(e^2 + 2 s)
};
// Not a number with fewer than two passes; 0 for a picture without light.
ErrorEstimate estimate_error(const PassSums& sums);
double relative_error(const PassSums& sums);

struct Goal {  // whichever is reached first ends the work
  std::uint32_t end_pass = 2;
  std::optional<double> time_s;  // ends with the pass during which it runs out, after two passes at the earliest
  std::optional<double> relative_error;  // of the estimate's bound, after every pass from the fourth on
};
enum class Reached { samples, time, noise };

struct Watch {
  // Seconds since any fixed moment; the steady clock where empty. Tests bring their own.
  std::function<double()> clock;
  double spent_s = 0;  // by earlier calls that this one continues
  // After every round of passes, with the seconds spent so far.
  std::function<void(const PassSums&, double)> on_round;
};

// Adds passes to `sums` until `goal` is reached. The outcome does not depend on how the work was cut into calls, but
// for a goal in time.
Reached render_until(const Integrator& integrator, PassSums& sums, const Goal& goal, Watch watch = {});

}  // namespace gonio::render
