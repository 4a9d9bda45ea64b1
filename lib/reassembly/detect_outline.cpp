// Which sectors of an outline are to be believed, and what the outline is known to.
#include <algorithm>
#include <cmath>

#include "reassembly/detect_fine.h"
#include "stats/intervals.h"

namespace gonio::reassembly {

namespace {

// The sectors in which the coarse outline agreed.
void start_sectors(FineFit& fit, const CoarseOutline& coarse, double noise) {
  auto& sectors = fit.sectors();
  std::vector<int> seen(sectors.size(), 0), agreeing(sectors.size(), 0);
  const double count = static_cast<double>(sectors.size());
  for (const EdgePoint& p : coarse.points) {
    const std::size_t s = static_cast<std::size_t>(std::lround(p.turn / (2 * pi) * count)) % sectors.size();
    ++seen[s];
    agreeing[s] += p.agrees;
  }
  for (std::size_t s = 0; s < sectors.size(); ++s) {
    sectors[s].active = 2 * agreeing[s] > seen[s] && sectors[s].pixels.size() > 8;
    sectors[s].variance = noise * noise;
  }
}

double freedom(const FineSector& sector) {
  double weight = 0;
  for (const FinePixel& p : sector.pixels) weight += p.weight;
  return std::max(1.0, weight - local_terms / 2.0);
}

// A sector's own scatter, steadied by what the sectors have in common.
void weigh(FineFit& fit) {
  std::vector<double> each;
  for (const FineSector& s : fit.sectors())
    if (s.active) each.push_back(s.squares / freedom(s));
  const double common = std::max(stats::median(each), 1e-3);
  constexpr double steadied = 20;
  for (FineSector& s : fit.sectors()) s.variance = (steadied * common + s.squares) / (steadied + freedom(s));
}

// Agrees: shows an edge, and shows it where the outline is. What agrees beside what does not may be partly hidden and
// is left out of the fit as long as enough remains. True where the choice has changed.
bool choose(FineFit& fit, double radius_px) {
  auto& sectors = fit.sectors();
  std::vector<double> moves, sigmas;
  for (const FineSector& s : sectors)
    if (s.active && s.move_sigma_px < 1) moves.push_back(std::abs(s.move_px)), sigmas.push_back(s.move_sigma_px);
  const double scatter = moves.empty() ? 0 : stats::sigma_of_median * stats::median(moves);
  const double expected = sigmas.empty() ? 0 : stats::median(sigmas);
  const double more = std::sqrt(std::max(0.0, scatter * scatter - expected * expected));
  const double farthest = std::max(0.5, 0.02 * radius_px);
  for (FineSector& s : sectors) {
    const double tolerance = std::max(0.05, 3.5 * std::hypot(s.move_sigma_px, more));
    s.agrees = s.move_sigma_px < 0.4 && std::abs(s.move_px) < std::min(tolerance, farthest);
  }
  // Small outlines show one sign: of both, checks have plenty.
  const std::size_t n = sectors.size();
  if (radius_px < large_px) {
    const auto bright =
        std::count_if(sectors.begin(), sectors.end(), [](const auto& s) { return s.agrees && s.contrast > 0; });
    const auto dark =
        std::count_if(sectors.begin(), sectors.end(), [](const auto& s) { return s.agrees && s.contrast < 0; });
    for (FineSector& s : sectors) s.agrees = s.agrees && (bright >= dark ? s.contrast > 0 : s.contrast < 0);
  }
  std::vector<bool> whole(n);
  std::size_t agreeing = 0, inner = 0;
  for (std::size_t i = 0; i < n; ++i) {
    whole[i] = sectors[i].agrees && sectors[(i + 1) % n].agrees && sectors[(i + n - 1) % n].agrees;
    agreeing += sectors[i].agrees, inner += whole[i];
  }
  const bool eroded = inner >= 6 && 10 * inner >= 6 * agreeing;
  bool changed = false;
  for (std::size_t i = 0; i < n; ++i) {
    const bool active = eroded ? whole[i] : sectors[i].agrees;
    changed = changed || active != sectors[i].active;
    sectors[i].active = active;
  }
  return changed;
}

// By how much the sectors scatter more than their pixels' noise says, and how far neighbours lean the same way: both
// enlarge the covariance. What is known of three numbers by runs of neighbours grows with the correlation's sum.
double excess(const std::vector<FineSector>& sectors) {
  double square = 0, count = 0;
  std::array<double, 3> product{};
  const std::size_t n = sectors.size();
  const auto z = [&](std::size_t i) { return sectors[i].move_px / sectors[i].move_sigma_px; };
  for (std::size_t i = 0; i < n; ++i) {
    if (!sectors[i].active) continue;
    square += z(i) * z(i), count += 1;
    for (std::size_t lag = 1; lag <= 3; ++lag)
      if (sectors[(i + lag) % n].active) product[lag - 1] += z(i) * z((i + lag) % n);
  }
  if (count < 5 || !(square > 0)) return 1;
  double correlation = 0;
  for (const double p : product) {
    if (!(p > 0)) break;
    correlation += p / square;
  }
  const double scatter = square / (count - 3.5);
  return std::max(1.0, scatter * (1 + 2 * correlation));
}

}  // namespace

std::optional<Outline> fine_outline(const Pyramid& pyramid, const camera::CameraModel& camera, double least_cover,
                                    const CoarseOutline& coarse) {
  FineFit fit(pyramid, camera, coarse.cone, coarse.level, coarse.blur_px);
  if (!fit.gather()) return std::nullopt;
  start_sectors(fit, coarse, pyramid.noise);
  constexpr int most_rounds = 5;
  for (int round = 0; round < most_rounds; ++round) {
    const auto active =
        std::count_if(fit.sectors().begin(), fit.sectors().end(), [](const auto& s) { return s.active; });
    if (active < 5 || !fit.descend_all(round == 0 ? 4 : 8)) return std::nullopt;
    weigh(fit);
    fit.learn_slopes();
    fit.judge_sectors();
    const bool last = round + 1 == most_rounds;
    if (!last && !choose(fit, coarse.radius_px / fit.scale()) && round > 0) break;
    if (round == 0) {
      const auto agreeing =
          std::count_if(fit.sectors().begin(), fit.sectors().end(), [](const auto& s) { return s.agrees; });
      if (static_cast<double>(agreeing) < 0.6 * least_cover * static_cast<double>(fit.sectors().size()))
        return std::nullopt;
      std::vector<double> contrasts;
      for (const FineSector& s : fit.sectors())
        if (s.active) contrasts.push_back(std::abs(s.contrast));
      fit.expect_contrast(contrasts.empty() ? 0 : stats::median(contrasts));
      if (!fit.gather()) return std::nullopt;
    }
  }
  Outline outline;
  outline.axis = fit.cone().axis;
  outline.half_angle_rad = fit.cone().half_angle_rad;
  if (!fit.covariance(outline.covariance_rad2)) return std::nullopt;
  const double factor = excess(fit.sectors());
  for (double& c : outline.covariance_rad2.m) c *= factor;
  const auto centre = camera.project(outline.axis);
  if (!centre) return std::nullopt;
  outline.centre_px = *centre;
  outline.radius_px = outline_radius_px(camera, fit.cone());
  std::vector<double> contrasts;
  double squares = 0, agreeing = 0;
  for (const FineSector& s : fit.sectors()) {
    if (!s.agrees) continue;
    squares += s.move_px * s.move_px, agreeing += 1;
    contrasts.push_back(std::abs(s.contrast));
  }
  if (contrasts.empty()) return std::nullopt;
  outline.cover = agreeing / static_cast<double>(fit.sectors().size());
  outline.rms_px = std::sqrt(squares / agreeing) * fit.scale();
  outline.contrast = stats::median(contrasts) / pyramid.noise;
  return outline;
}

}  // namespace gonio::reassembly
