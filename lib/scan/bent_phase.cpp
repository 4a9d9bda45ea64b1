// See bent_phase.h.
#include "scan/bent_phase.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geom/vector.h"

namespace gonio::scan {
namespace {

constexpr std::size_t places = 720, tiles = 64, harmonics = 60;
constexpr double of_lens = 0.07, fewest_pixels = 1000;
// Of gamma - 1: harmonics beyond the second that shifts cannot tell from it, four of them most.
constexpr double step_rad = 0.02, least_slope = 0.05;  // of the found phase over the true one
constexpr double of_four = 0.03, of_more = 0.005, least_sigma = 0.001;

double at(const std::vector<double>& off, double theta) {
  const double turns = theta / (2 * pi), place = (turns - std::floor(turns)) * places;
  const std::size_t k = std::min(static_cast<std::size_t>(place), places - 1);
  const double beyond = place - static_cast<double>(k);
  return off[k] * (1 - beyond) + off[(k + 1) % places] * beyond;
}

// By the phase of the cosine that is sent: what the tone makes of it and lenses leave, over what they leave of it.
std::vector<double> blurred(const ProjectorTone& tone, double left) {
  std::vector<double> light(places), seen(places), cosines(places);
  for (std::size_t k = 0; k < places; ++k) cosines[k] = std::cos(2 * pi * static_cast<double>(k) / places);
  for (std::size_t k = 0; k < places; ++k) light[k] = tone.light(0.5 + 0.5 * cosines[k]);
  for (std::size_t h = 1; h <= harmonics; ++h) {
    double amplitude = 0;
    for (std::size_t k = 0; k < places; ++k) amplitude += 2.0 / places * light[k] * cosines[h * k % places];
    amplitude *= std::pow(left, static_cast<double>(h * h - 1));
    for (std::size_t k = 0; k < places; ++k) seen[k] += amplitude * cosines[h * k % places];
  }
  return seen;
}

std::vector<double> errors_of_phase(const ProjectorTone& tone, std::span<const double> shifts, const Mat3& solve,
                                    double left) {
  std::vector<double> off(places);
  const std::vector<double> light = blurred(tone, left);
  for (std::size_t k = 0; k < places; ++k) {
    const double theta = 2 * pi * static_cast<double>(k) / places;
    Vec3 sums;
    for (const double s : shifts) {
      const double v = at(light, theta - s);
      sums += Vec3{v, v * std::cos(s), v * std::sin(s)};
    }
    const Vec3 fit = solve * sums;
    off[k] = std::remainder(std::atan2(fit.z, fit.y) - theta, 2 * pi);
  }
  return off;
}

}  // namespace

bool in_equal_steps(std::span<const double> shifts) {
  double c = 0, s = 0, c2 = 0, s2 = 0;
  for (const double t : shifts) c += std::cos(t), s += std::sin(t), c2 += std::cos(2 * t), s2 += std::sin(2 * t);
  const double n = static_cast<double>(shifts.size());
  return shifts.size() >= 3 && std::hypot(c, s) < 1e-3 * n && std::hypot(c2, s2) < 1e-3 * n;
}

std::optional<ProjectorGamma> gamma_of(const SecondHarmonic& seen) {
  if (seen.shifts < 4) return std::nullopt;
  // Four shifts see its cosine alone, twice as large.
  const bool four = seen.shifts == 4;
  const double unit = (four ? 1.0 : 2.0) / static_cast<double>(seen.shifts);
  std::array<double, tiles> products{}, squares{};
  double count = 0;
  const std::size_t pixels = seen.phase.size(), width = static_cast<std::size_t>(seen.width), height = pixels / width;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double theta = seen.phase[i], b = seen.amplitude[i];
    if (!std::isfinite(theta)) continue;
    const double c = std::cos(2 * theta), s = four ? 0 : std::sin(2 * theta);
    const std::size_t tile = i / width * 8 / height * 8 + i % width * 8 / width;
    products[tile] += b * unit * (c * seen.with_cos[i] + s * seen.with_sin[i]),
        squares[tile] += b * b * (c * c + s * s);
    ++count;
  }
  double product = 0, square = 0;
  for (std::size_t t = 0; t < tiles; ++t) product += products[t], square += squares[t];
  if (count < fewest_pixels || !(square > 0)) return std::nullopt;
  const double r = product / square;
  double scatter = 0, used = 0;
  for (std::size_t t = 0; t < tiles; ++t) {
    if (!(squares[t] > 0)) continue;
    scatter += (products[t] - r * squares[t]) * (products[t] - r * squares[t]), ++used;
  }
  if (used < 4 || r >= 0.9) return std::nullopt;
  const double sigma = std::sqrt(scatter * used / (used - 1)) / square;
  const double gamma = (1 + 2 * r) / (1 - r), chance = 3 * sigma / ((1 - r) * (1 - r));
  return ProjectorGamma{gamma, std::hypot(chance, least_sigma, (four ? of_four : of_more) * (gamma - 1))};
}

BentPhase::BentPhase(const ProjectorTone& tone, std::span<const double> shifts, const Mat3& solve, double left)
    : unknown_(places) {
  for (const ProjectorTone& other : tone.varied()) {
    const std::vector<double> off = errors_of_phase(other, shifts, solve, left);
    if (off_.empty()) off_ = off;
    for (std::size_t k = 0; k < places; ++k) unknown_[k] = std::hypot(unknown_[k], off[k] - off_[k]);
  }
  double squares = 0;
  for (const double off : off_) squares += off * off;
  of_lens_ = of_lens * std::sqrt(squares / places);
}

BentPhase::True BentPhase::straightened(double found, double sigma) const {
  double theta = found;
  for (int step = 0; step < 12; ++step) {  // Newton; least squares never turn back
    const double slope = 1 + (at(off_, theta + step_rad) - at(off_, theta - step_rad)) / (2 * step_rad);
    theta -= (theta + at(off_, theta) - found) / std::max(least_slope, slope);
  }
  const double slope = 1 + (at(off_, theta + step_rad) - at(off_, theta - step_rad)) / (2 * step_rad),
               stretch = 1 / std::max(least_slope, slope), unknown = at(unknown_, theta);
  return {theta, stretch * std::hypot(sigma, unknown, of_lens_)};
}

}  // namespace gonio::scan
