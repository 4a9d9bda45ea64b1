#include "mesh/register/register_words.h"

#include <algorithm>
#include <cmath>

#include "base/progress.h"
#include "base/text.h"

namespace gonio::mesh {
namespace {

constexpr double sure = 0.001;  // p below which motions are called real

// Of the length of a vector whose entries have these variances, along it.
double sigma_along(Vec3 v, const std::array<double, 36>& c, std::size_t first) {
  const double length = norm(v);
  const Vec3 u = length > 0 ? v / length : Vec3{1, 0, 0};
  double variance = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      variance += u[i] * u[j] * c[6 * (first + static_cast<std::size_t>(i)) + first + static_cast<std::size_t>(j)];
  return std::sqrt(std::max(0.0, variance));
}

std::string with_error(double value, double sigma) {
  return format("%.2g +- %.1g", value, sigma);
}

}  // namespace

std::string consistency_sentence(const Consistency& c) {
  const bool moved = c.rigid_p<sure, bold = c.rest> 1 + 3 * c.rest_sigma && c.rest > 1.1;
  std::string whose = "as the points state";
  if (moved && bold)
    whose = "poses and points are at fault";
  else if (moved)
    whose = "the poses are at fault, not the points";
  else if (bold)
    whose = "the points are at fault: they err by more than they state";
  return format(
      "views lie apart by %.3g +- %.2g times what is stated (half of the points within %.3g times what they should); "
      "motions of whole views would leave %.3g +- %.2g: %s",
      c.value, c.sigma, c.typical, c.rest, c.rest_sigma, whose.c_str());
}

std::string shift_words(const ViewShift& shift) {
  constexpr double degrees = 180 / pi;
  return with_error(1e3 * norm(shift.shift_m), 1e3 * sigma_along(shift.shift_m, shift.covariance, 3)) + " mm, " +
         with_error(degrees * norm(shift.turn_rad), degrees * sigma_along(shift.turn_rad, shift.covariance, 0)) +
         " deg";
}

void log_registration(const Registration& found, const std::vector<std::string>& names, const RegisterWish& wish) {
  for (const PairFigures& p : found.pairs)
    log(LogLevel::info,
        format(
            "%s and %s: %.0f %% and %.0f %% of their points overlap, %.3g mm apart (rms), %.3g +- %.2g times what is "
            "stated; a motion of %.2g mm and %.2g deg would leave %.3g +- %.2g (by chance: p = %.2g)",
            names[p.first].c_str(), names[p.second].c_str(), 100 * p.overlap[0], 100 * p.overlap[1], 1e3 * p.rms_m,
            p.consistency, p.sigma, 1e3 * p.shift_m, 180 / pi * p.turn_rad, p.rest, p.rest_sigma, p.rigid_p));
  if (found.pairs.empty()) return;
  log(LogLevel::info, consistency_sentence(found.after));
  if (!wish.refine) return;
  if (found.refused.empty())
    for (std::size_t v = 0; v < names.size(); ++v) {
      if (v == wish.fixed) continue;
      const ViewShift& view = found.views[v];
      log(LogLevel::info, format("view %s moved by %s%s", names[v].c_str(), shift_words(view).c_str(),
                                 view.prior ? ", with its stated pose as prior" : ""));
      for (const std::string& open : view.open)
        log(LogLevel::warning, format("view %s: %s is left as stated: overlaps do not hold it to %.2g mm",
                                      names[v].c_str(), open.c_str(), 1e3 * wish.limit_m));
    }
  else if (found.slides)
    for (std::size_t v = 0; v < names.size(); ++v)
      for (const std::string& open : found.views[v].open)
        log(LogLevel::error, format("view %s: overlaps do not hold %s to %.2g mm; nothing was moved: --hold moves what "
                                    "is held, poses with sigma or more views hold the rest",
                                    names[v].c_str(), open.c_str(), 1e3 * wish.limit_m));
  else
    log(LogLevel::error, "nothing was moved: " + found.refused);
}

}  // namespace gonio::mesh
