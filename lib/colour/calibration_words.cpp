// What is said of a calibration on standard error (colour_document.h).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "colour/colour_document.h"

namespace gonio::colour {
namespace {

constexpr std::size_t shown = 4;  // patches that disagree most

std::string share(Rgb value, Rgb sigma, Rgb white) {
  std::string text;
  for (int c = 0; c < 3; ++c)
    text += format("%s%.2f(%.0f)", c == 0 ? "" : ", ", 100 * value[c] / white[c], 1e4 * sigma[c] / white[c]);
  return text + " % of white";
}

// In what a colour is off most.
std::string way_of(optics::Lab wanted, optics::Lab found) {
  const double chroma = std::hypot(wanted.y, wanted.z), other = std::hypot(found.y, found.z);
  const double l = found.x - wanted.x, c = other - chroma;
  const double h = std::sqrt(std::max(0.0, std::pow(found.y - wanted.y, 2) + std::pow(found.z - wanted.z, 2) - c * c));
  if (std::abs(l) >= std::max(std::abs(c), h)) return l > 0 ? "too bright" : "too dark";
  if (std::abs(c) >= h) return c > 0 ? "too vivid" : "too grey";
  return "hue";
}

}  // namespace

std::vector<std::string> words_of(const Chart& chart, const Calibration& c) {
  std::vector<std::string> lines;
  const auto light = [&](double chance, bool taken) {
    return format(", %s (chance %.2g)", taken ? "taken off" : "left as it is", chance);
  };
  if (c.found.offset_sigma != Rgb{})
    lines.push_back("offset (glare, or black that was left) " + share(c.found.offset, c.found.offset_sigma, c.white) +
                    light(c.found.offset_chance, c.taken.offset_sigma != Rgb{}));
  if (c.found.gradient_sigma.x > 0)
    lines.push_back(format("light changes by %.1f(%.0f) %% across and %.1f(%.0f) %% down the chart",
                           100 * c.found.gradient.x, 1e3 * c.found.gradient_sigma.x, 100 * c.found.gradient.y,
                           1e3 * c.found.gradient_sigma.y) +
                    light(c.found.gradient_chance, c.taken.gradient_sigma.x > 0));
  if (c.taken.curve_sigma.x > 0)
    lines.push_back(format("light curves, as that of a near lamp: second order %.2f(%.0f), %.2f(%.0f), %.2f(%.0f)",
                           c.found.curve.x, 100 * c.found.curve_sigma.x, c.found.curve.y, 100 * c.found.curve_sigma.y,
                           c.found.curve.z, 100 * c.found.curve_sigma.z) +
                    light(c.found.curve_chance, true));
  if (c.tried.size() > 1)
    for (const Tried& tried : c.tried)
      lines.push_back(tried.refused.empty() ? format("%-18s fitted %.2f, held out %.2f dE00",
                                                     name_of(tried.model).c_str(), tried.fitted, tried.held_out)
                                            : name_of(tried.model) + ": " + tried.refused);
  const Correction& best = c.correction;
  lines.push_back(format("%s: fitted %.2f +- %.2f dE00 (most %.1f, %s), held out %.2f +- %.2f (most %.1f, %s)",
                         name_of(best.model()).c_str(), c.fitted.mean, c.fitted.deviation, c.fitted.most,
                         chart.patches[c.fitted.worst].name.c_str(), c.held_out.mean, c.held_out.deviation,
                         c.held_out.most, chart.patches[c.held_out.worst].name.c_str()));
  lines.push_back(format("exposures of 0.1 to 10 times move colours by %.2f dE00; noise is amplified %.2f times",
                         c.exposure_de00, c.noise_gain));
  std::vector<std::size_t> order(chart.patches.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t p) { return !c.patches[p].held_out; });
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return c.patches[a].held_out > c.patches[b].held_out; });
  std::string worst;
  for (std::size_t k = 0; k < std::min(shown, order.size()); ++k) {
    const Patch& patch = chart.patches[order[k]];
    worst += format("%s%s %.1f (%s)", k == 0 ? "" : ", ", patch.name.c_str(), *c.patches[order[k]].held_out,
                    way_of(patch.lab, best.lab(c.patches[order[k]].evened)).c_str());
  }
  lines.push_back("disagree most: " + worst);
  return lines;
}

}  // namespace gonio::colour
