// When a picture has enough samples, and how its noise is told.
//
// Relative error of a picture: over all values Y of the channels R, G, B that are not zero (pixels that no light
// reached say nothing),
//   e = sqrt(mean of  v / (Y^2 + f^2)),     f = 1 % of the median of |Y|,
// v the estimated variance of Y. It estimates what the root of the relative mean square error against a perfect
// rendering would be; f keeps what is black but for stray light from deciding.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "render/integrator.h"
#include "render/passes.h"

namespace gonio::render {

// Not a number with fewer than two passes; 0 for a picture without light.
double relative_error(const PassSums& sums);

struct Goal {  // whichever is reached first ends the work
  std::uint32_t end_pass = 2;
  std::optional<double> time_s;  // ends with the pass during which it runs out, after two passes at the earliest
  std::optional<double> relative_error;  // judged after every pass from the fourth on
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
