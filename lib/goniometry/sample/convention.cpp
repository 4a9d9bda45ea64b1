// See convention.h.
#include "goniometry/sample/convention.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/error.h"
#include "base/text.h"

namespace gonio::goniometry {
namespace {

constexpr double window_rad = 20 * pi / 180;  // about either direction
constexpr double least_zenith_rad = 12 * pi / 180;
constexpr double telling_ratio = 1.5, telling_share = 2.0 / 3;

double mean_over_bands(const Samples& s, std::size_t row) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t b = 0; b < s.bands(); ++b)
    if (const double f = s.f[row * s.bands() + b]; std::isfinite(f)) sum += f, ++n;
  return n == 0 ? std::nan("") : sum / static_cast<double>(n);
}

struct Side {
  double sum = 0, weight = 0;
  void add(double f, double cosine) {
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    if (!(angle < window_rad) || !std::isfinite(f)) return;
    const double w = 1 - angle / window_rad;
    sum += w * f, weight += w;
  }
  bool seen() const { return weight > 0 && sum > 0; }
  double mean() const { return sum / weight; }
};

using Incidence = std::pair<long, long>;

// log of brightness about phi_i + pi over brightness about phi_i, of every incidence that has both.
std::vector<double> log_ratios(const Samples& s) {
  std::map<Incidence, std::pair<Side, Side>> sides;
  for (std::size_t r = 0; r < s.rows(); ++r) {
    const Vec3 wi = s.wi[r], wo = s.wo[r];
    if (std::acos(std::min(1.0, wi.z)) < least_zenith_rad) continue;
    auto& [far, near] = sides[{std::lround(wi.x * 500), std::lround(wi.y * 500)}];
    const double f = mean_over_bands(s, r), level = wi.z * wo.z, across = wi.x * wo.x + wi.y * wo.y;
    far.add(f, level - across);
    near.add(f, level + across);
  }
  std::vector<double> ratios;
  for (const auto& [incidence, pair] : sides)
    if (pair.first.seen() && pair.second.seen()) ratios.push_back(std::log(pair.first.mean() / pair.second.mean()));
  std::ranges::sort(ratios);
  return ratios;
}

bool turning_matters(const Samples& s) {
  return std::ranges::any_of(s.wi, [](Vec3 w) { return w.z < std::cos(0.5 * pi / 180); });
}

std::string words(Mirror mirror) {
  return mirror == Mirror::opposite ? "phi_o = phi_i + 180 deg" : "phi_o = phi_i";
}

}  // namespace

Convention find_convention(const Samples& samples, Mirror wanted, Mirror preset, const std::string& place) {
  Convention found;
  const std::vector<double> ratios = log_ratios(samples);
  found.incidences = ratios.size();
  const double middle = ratios.empty() ? 0 : 0.5 * (ratios[ratios.size() / 2] + ratios[(ratios.size() - 1) / 2]);
  if (!ratios.empty()) found.brightness_ratio = std::exp(middle);
  const auto agree = std::ranges::count_if(ratios, [middle](double r) { return r * middle > 0; });
  const bool tells = std::abs(middle) > std::log(telling_ratio) &&
                     static_cast<double>(agree) >= telling_share * static_cast<double>(ratios.size());
  const Mirror seen = !tells ? Mirror::automatic : middle > 0 ? Mirror::opposite : Mirror::same;
  const std::string evidence =
      ratios.empty() ? "no incidence has samples about both phi_i and phi_i + 180 deg"
                     : format(
                           "samples about phi_i + 180 deg are %.3g times as bright as those about phi_i, median over "
                           "%zu incidence%s",
                           found.brightness_ratio, ratios.size(), ratios.size() == 1 ? "" : "s");
  if (wanted != Mirror::automatic) {
    found.mirror = wanted, found.from = Convention::From::user;
  } else if (seen != Mirror::automatic) {
    found.mirror = seen;
  } else if (preset != Mirror::automatic) {
    found.mirror = preset, found.from = Convention::From::format;
  } else if (!turning_matters(samples)) {
    found.from = Convention::From::indifferent;
    found.sentence = "Light comes along the normal, so that the convention of azimuths makes no difference.";
    return found;
  } else {
    throw Error(Exit::data, place, "does not tell where its mirror direction is: " + evidence,
                "say it: --mirror 180 where phi_o = phi_i + 180 deg is the mirror direction, --mirror 0 where "
                "phi_o = phi_i is");
  }
  found.contradicted = seen != Mirror::automatic && seen != found.mirror;
  const std::string source = found.from == Convention::From::user     ? " as stated"
                             : found.from == Convention::From::format ? " as the format says"
                                                                      : " as the samples show";
  found.sentence = "The mirror direction is at " + words(found.mirror) + "," + source + ": " + evidence + "." +
                   (found.contradicted ? " That looks like the other convention, or like a retro-reflector." : "");
  return found;
}

void turn_exitance(Samples& samples) {
  for (Vec3& w : samples.wo) w = {-w.x, -w.y, w.z};
}

}  // namespace gonio::goniometry
