// See start.h.
#include "goniometry/fit/start.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "stats/intervals.h"
#include "surface/microfacet.h"

namespace gonio::goniometry {
namespace {

struct Seen {  // one row: slope of the half vector, and the mean over bands
  std::size_t row;
  double slope, f, around;  // around: 4 ci co
};

double mean_of_bands(const Problem& problem, std::size_t row) {
  double sum = 0;
  int count = 0;
  for (std::size_t b = 0; b < problem.bands(); ++b)
    if (problem.used(row, b)) sum += problem.samples().f[row * problem.bands() + b], ++count;
  return count > 0 ? sum / count : 0;
}

std::vector<Seen> by_slope(const Problem& problem) {
  std::vector<Seen> seen;
  const Samples& s = problem.samples();
  for (const std::uint32_t r : problem.rows()) {
    const Vec3 h = surface::half_vector(s.wo[r], s.wi[r]);
    seen.push_back(
        {r, std::hypot(h.x, h.y) / std::max(1e-6, h.z), mean_of_bands(problem, r), 4 * s.wi[r].z * s.wo[r].z});
  }
  std::ranges::sort(seen, {}, [](const Seen& a) { return std::pair(a.slope, a.row); });
  return seen;
}

// Median of g over seen[first, first + count).
double median_gloss(const std::vector<Seen>& seen, std::size_t first, std::size_t count, double floor) {
  std::vector<double> g;
  for (std::size_t i = first; i < std::min(first + count, seen.size()); ++i)
    g.push_back((seen[i].f - floor) * seen[i].around);
  return stats::median(g);
}

double floor_of(const std::vector<Seen>& seen, const std::vector<double>& f) {
  std::vector<double> far;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i].slope > std::tan(0.5) && seen[i].around > 0.3) far.push_back(f[i]);
  return std::max(1e-6, far.size() >= 5 ? stats::median(far) : stats::quantile(f, 0.1));
}

// Number by name. `turn`: of an azimuth. Names are those of the registry's models.
double start_of(const std::string& name, const manifest::ParameterInfo& info, const Guess& guess, double f0,
                double floor, double alpha, double turn, bool metal) {
  if (name == "albedo" || name == "rho_d") return std::clamp(pi * floor, 0.01, 0.95);
  if (name == "f0") return std::clamp(f0, info.lower + 0.02 * (info.upper - info.lower), 0.9 * info.upper);
  const double r = std::sqrt(std::clamp(f0, 0.01, 0.9));
  if (name == "eta") return metal && f0 > 0.3 ? 1.0 : std::clamp((1 + r) / (1 - r), 1.05, 2.5);
  if (name == "k") return metal && f0 > 0.3 ? 2 * r / std::sqrt(1 - r * r) : 0.1;
  if (name == "second_alpha") return std::min(0.9, 4 * alpha);
  if (name == "second_share") return 0.3;
  if (name == "retro") return 0.05;
  if (name == "retro_alpha") return 0.3;
  if (name == "retro_falloff") return 1;
  if (name.starts_with("alpha")) return alpha;
  if (name == "anisotropy") return 0.4;
  if (name == "anisotropy_0") return 0.3 * std::cos(2 * turn);
  if (name == "anisotropy_45") return 0.3 * std::sin(2 * turn);
  if (name == "azimuth_rad") return turn;
  if (name == "sigma_rad") return 0.3;
  if (name == "ridge_rad") return std::max(0.05, guess.tilt_rad);
  if (name == "walls") return 0.5;
  if (name == "amplitude_m") return std::tan(std::max(0.1, guess.tilt_rad)) * 1e-4 / (2 * pi);
  if (name.starts_with("wavelength")) return 1e-4;
  return info.preset.value_or(std::isfinite(info.lower + info.upper) ? (info.lower + info.upper) / 2 : 1);
}

std::vector<double> start_at(const Candidate& c, const Guess& guess, std::size_t bands, double alpha, double turn) {
  std::vector<double> x;
  const bool metal = c.model->info().id.ends_with("conductor");
  const double f0 = std::accumulate(guess.f0.begin(), guess.f0.end(), 0.0) / static_cast<double>(bands);
  const double scale = alpha * alpha / (guess.alpha * guess.alpha);  // the peak keeps its height
  const auto number = [&](const Slot& slot, double r, double floor) {
    const auto& info = c.model->info().parameters[slot.parameter];
    x.push_back(
        std::clamp(start_of(info.name, info, guess, r * scale, floor, alpha, turn, metal), slot.lower, slot.upper));
  };
  for (const Slot& slot : c.shared) number(slot, f0, guess.floor[0]);
  for (std::size_t b = 0; b < bands; ++b)
    for (const Slot& slot : c.colours) number(slot, guess.f0[b], guess.floor[b]);
  return x;
}

void disturb(const Candidate& c, std::vector<double>& x, Random& random) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Slot& slot = slot_of(c, i);
    if (slot.periodic)
      x[i] = random.uniform(slot.lower, slot.upper);
    else if (slot.lower < 0)
      x[i] += 0.2 * random.normal();
    else
      x[i] *= std::exp((i < c.shared.size() ? 0.8 : 0.2) * random.normal());
    x[i] = std::clamp(x[i], slot.lower, slot.upper);
  }
}

}  // namespace

Guess guess_of(const Problem& problem) {
  const std::vector<Seen> seen = by_slope(problem);
  const std::size_t window = std::max<std::size_t>(3, seen.size() / 50), bands = problem.bands();
  std::vector<double> f(seen.size());
  std::ranges::transform(seen, f.begin(), [](const Seen& s) { return s.f; });
  const double floor = floor_of(seen, f);
  Guess guess;
  const double peak = std::max(1e-9, median_gloss(seen, 0, 3, floor));
  guess.alpha = 0.5;
  for (std::size_t i = 1; i < seen.size(); ++i) {
    if (median_gloss(seen, i, std::min(window, i + 1), floor) > peak / 4) continue;
    guess.alpha = std::clamp(seen[i].slope, 0.003, 0.8);
    break;
  }
  double brightest = 0;
  for (const Seen& s : seen) {
    if ((s.f - floor) * s.around <= brightest || s.around < 0.5) continue;
    brightest = (s.f - floor) * s.around;
    const Vec3 h = surface::half_vector(problem.samples().wo[s.row], problem.samples().wi[s.row]);
    guess.tilt_rad = std::atan(s.slope), guess.azimuth_rad = std::atan2(h.y, h.x);
  }
  for (std::size_t b = 0; b < bands; ++b) {
    std::vector<double> own(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double value = problem.samples().f[seen[i].row * bands + b];
      own[i] = problem.used(seen[i].row, b) ? value : seen[i].f;
    }
    guess.floor.push_back(floor_of(seen, own));
    std::vector<double> top;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, seen.size()); ++i)
      top.push_back((own[i] - guess.floor.back()) * seen[i].around);
    guess.f0.push_back(std::clamp(stats::median(top) * pi * guess.alpha * guess.alpha, 1e-3, 0.95));
  }
  return guess;
}

std::vector<std::vector<double>> starts(const Candidate& candidate, const Guess& guess, std::size_t bands,
                                        int random_starts, std::uint64_t seed) {
  bool turns = false, leans = false;
  for (const Slot& slot : candidate.shared) {
    const std::string& name = candidate.name(slot);
    turns = turns || slot.periodic || name == "anisotropy_45";
    leans = leans || name == "ridge_rad";
  }
  std::vector<double> azimuths{0};
  if (turns) azimuths = {0, pi / 4, pi / 2, -pi / 4};
  if (leans) {  // the facets' normal is turned by 90 degrees from the ridges
    azimuths.clear();
    for (int i = 0; i < 6; ++i) azimuths.push_back(std::remainder(guess.azimuth_rad - pi / 2 + i * pi / 3, 2 * pi));
  }
  std::vector<std::vector<double>> all;
  for (const double factor : {1.0, 0.4, 2.5})
    for (const double turn : azimuths)
      all.push_back(start_at(candidate, guess, bands, std::clamp(guess.alpha * factor, 1e-3, 1.0), turn));
  Random random(seed, 7);
  for (int i = 0; i < random_starts; ++i) {
    all.push_back(all[static_cast<std::size_t>(i) % all.size()]);
    disturb(candidate, all.back(), random);
  }
  return all;
}

bool grows(const Candidate& from, const Candidate& to) {
  const auto names = [](const Candidate& c, const std::vector<Slot>& slots) {
    std::vector<std::string> all;
    for (const Slot& slot : slots) all.push_back(c.name(slot));
    return all;
  };
  const auto has = [](const std::vector<std::string>& all, const std::string& name) {
    return std::ranges::find(all, name) != all.end();
  };
  const auto before = names(from, from.shared), after = names(to, to.shared);
  if (names(from, from.colours) != names(to, to.colours) || before.size() >= after.size()) return false;
  const auto added = [](const std::string& name) {
    return name.starts_with("second_") || name.starts_with("retro") || name.starts_with("anisotropy") ||
           name == "azimuth_rad" || name == "sigma_rad";
  };
  return std::ranges::all_of(before, [&](const std::string& name) { return has(after, name); }) &&
         std::ranges::all_of(after, [&](const std::string& name) { return has(before, name) || added(name); });
}

std::vector<std::vector<double>> grown(const Candidate& from, const std::vector<double>& x, const Candidate& to,
                                       const Guess& guess) {
  const auto old = [&](const std::string& name) -> const double* {
    for (std::size_t i = 0; i < from.shared.size(); ++i)
      if (from.name(from.shared[i]) == name) return &x[i];
    return nullptr;
  };
  const double alpha = old("alpha") != nullptr ? *old("alpha") : guess.alpha;
  std::vector<std::vector<double>> all;
  for (const double wider : {4.0, 0.25}) {
    std::vector<double> start;
    bool second = false;
    for (const Slot& slot : to.shared) {
      const auto& info = to.model->info().parameters[slot.parameter];
      const double* known = old(info.name);
      second = second || (known == nullptr && info.name == "second_alpha");
      const double begins = known != nullptr              ? *known
                            : info.name == "second_alpha" ? wider * alpha
                            : info.name == "second_share" ? 0.1
                                                          : start_of(info.name, info, guess, 0, 0, alpha, 0, false);
      start.push_back(std::clamp(begins, slot.lower, slot.upper));
    }
    start.insert(start.end(), x.begin() + static_cast<std::ptrdiff_t>(from.shared.size()), x.end());
    all.push_back(std::move(start));
    if (!second) break;
  }
  return all;
}

Samples chosen_rows(const Samples& samples, const Rows& rows, const std::vector<std::size_t>& bands) {
  Samples out;
  out.name = samples.name;
  for (const std::size_t b : bands) {
    out.band_name.push_back(samples.band_name[b]);
    if (!samples.band_m.empty()) out.band_m.push_back(samples.band_m[b]);
  }
  for (const std::uint32_t r : rows) {
    out.wi.push_back(samples.wi[r]), out.wo.push_back(samples.wo[r]);
    if (!samples.series.empty()) out.series.push_back(samples.series[r]);
    if (!samples.place.empty()) out.place.push_back(samples.place[r]);
    for (const std::size_t b : bands) {
      out.f.push_back(samples.f[r * samples.bands() + b]);
      if (!samples.sigma.empty()) out.sigma.push_back(samples.sigma[r * samples.bands() + b]);
    }
  }
  return out;
}

Samples few_of(const Problem& problem, std::vector<std::size_t>& bands) {
  constexpr std::size_t near = 250, far = 250;
  const std::size_t b = problem.bands();
  bands = {0};
  if (b > 2) bands.push_back(b / 2);
  if (b > 1) bands.push_back(b - 1);
  const std::vector<Seen> seen = by_slope(problem);
  Rows rows;
  for (std::size_t i = 0; i < std::min(near, seen.size()); ++i) rows.push_back(static_cast<std::uint32_t>(seen[i].row));
  const std::size_t rest = seen.size() - rows.size(), count = std::min(far, rest);
  for (std::size_t i = 0; i < count; ++i) rows.push_back(static_cast<std::uint32_t>(seen[near + i * rest / count].row));
  return chosen_rows(problem.samples(), rows, bands);
}

}  // namespace gonio::goniometry
