// See cosine_decoder.h.
#include "scan/cosine_decoder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "photograph/noise_variance.h"
#include "scan/bent_phase.h"
#include "scan/frame_noise.h"
#include "scan/shift_fit.h"

namespace gonio::scan {
namespace {

using What = Shown::What;

constexpr double least_of_noise = 6;    // amplitude, over that of its noise
constexpr double own_error_rad = 0.03;  // of any phase, whatever the noise: gamma, rounding, light from elsewhere
constexpr double most_contradicting = 25,
                 least_ahead = 12;  // chi-square, for each further number of periods; of the next
// Light from other parts of the scene adds to coarse cosines, by a share of what they have more than the finest, and
// turns their phases by a share of that, unless phases agree all the same; and it makes fine ones disagree.
constexpr double turned_by_indirect = 0.05, agreeing = 8, disagreeing = 0.5;
constexpr std::size_t pixels_at_once = 1 << 14, most_sampled = 20000;
constexpr std::size_t tone_pixels = 4000, tone_shifts = 5;
constexpr double tone_period_px = 24;  // at least: what lenses blur shows no levels

// Sums over the shifts of one number of periods.
struct ShiftSums {
  double periods = 1;
  std::vector<double> shifts_rad;
  std::vector<float> of_all, with_cos, with_sin;
  std::vector<std::uint8_t> spoiled;
  ToneReadings tone{};                            // of some pixels, where shifts tell the projector's levels
  std::vector<float> with_cos_2{}, with_sin_2{};  // of twice the shifts, where these tell the projector's exponent
};

struct Phase {
  double theta = 0, sigma = 0, mean = 0, amplitude = 0, amplitude_sigma = 0;
};

Phase phase_of(const Mat3& solve, double sum, double with_cos, double with_sin, const manifest::Noise& noise) {
  const Vec3 fit = solve * Vec3{sum, with_cos, with_sin};
  Phase p;
  p.mean = fit.x, p.amplitude = std::hypot(fit.y, fit.z), p.theta = std::atan2(fit.z, fit.y);
  const double variance = photograph::noise_variance(noise, std::max(0.0, p.mean)), c = std::cos(p.theta),
               s = std::sin(p.theta);
  // Along (c, s) lies the amplitude, across it the phase.
  const double along = c * c * solve(1, 1) + 2 * c * s * solve(1, 2) + s * s * solve(2, 2),
               across = s * s * solve(1, 1) - 2 * c * s * solve(1, 2) + c * c * solve(2, 2);
  p.amplitude_sigma = std::sqrt(variance * std::max(0.0, along));
  p.sigma = p.amplitude > 0 ? std::sqrt(variance * std::max(0.0, across)) / p.amplitude : pi;
  return p;
}

double wrapped(double angle) {
  return angle - 2 * pi * std::round(angle / (2 * pi));
}

class CosineDecoder {
 public:
  CosineDecoder(const DecodeRequest& r, const FrameReader& read, Codes& codes) : r_(r), read_(read), codes_(codes) {}

  void run() {
    for (const Axis axis : {Axis::column, Axis::row}) {
      std::vector<ShiftSums> all = sums(axis);
      if (all.empty()) continue;
      std::ranges::sort(all, {}, &ShiftSums::periods);
      if (!noise_known_) find_noise(all);
      find_gamma(all);
      find_levels(all);
      places(axis, all);
      if (in_equal_steps(all.back().shifts_rad)) keep_means(all);
    }
  }

 private:
  void keep_means(const std::vector<ShiftSums>& all) {
    const ShiftSums& finest = all.back();
    const std::vector<float>& sums = finest.of_all;
    shifts_of_means_ = static_cast<double>(finest.shifts_rad.size());
    means_.resize(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) means_[i] = sums[i] / static_cast<float>(shifts_of_means_);
  }

  std::vector<ShiftSums> sums(Axis axis) const {
    std::map<double, std::vector<std::size_t>> frames;
    for (std::size_t f = 0; f < r_.sequence.frames.size(); ++f) {
      const Shown& s = r_.sequence.frames[f];
      if (s.what == What::cosine && s.axis == axis) frames[s.periods].push_back(f);
    }
    std::vector<ShiftSums> all;
    // Coarse cosines tell the projector's exponent and levels: a lens takes least from their harmonics.
    bool told = false, tone_told = tone_known_ || !r_.levels;
    for (const auto& [periods, own] : frames) {
      const bool tells = !told && own.size() >= 4, tells_tone = !tone_told && own.size() >= tone_shifts &&
                                                                r_.sequence.size(axis) >= tone_period_px * periods;
      all.push_back(sums_of(periods, own, tells, tells_tone));
      told = told || tells, tone_told = tone_told || tells_tone;
    }
    return all;
  }

  ShiftSums sums_of(double periods, const std::vector<std::size_t>& frames, bool harmonics, bool tone) const {
    const std::size_t pixels = codes_.refusal.size();
    ShiftSums s;
    s.periods = periods;
    s.of_all.resize(pixels), s.with_cos.resize(pixels), s.with_sin.resize(pixels), s.spoiled.resize(pixels);
    if (harmonics) s.with_cos_2.resize(pixels), s.with_sin_2.resize(pixels);
    for (const std::size_t f : frames) {
      const double shift = r_.sequence.frames[f].shift_rad;
      s.shifts_rad.push_back(shift);
      const CameraFrame frame = read_(f);
      const auto c = static_cast<float>(std::cos(shift)), sine = static_cast<float>(std::sin(shift));
      for (std::size_t i = 0; i < pixels; ++i) {
        const float v = frame.at(i);
        s.of_all[i] += v, s.with_cos[i] += c * v, s.with_sin[i] += sine * v;
        s.spoiled[i] = static_cast<std::uint8_t>(s.spoiled[i] | (frame.full(i) ? 1 : 0));
      }
      for (std::size_t i = tone_first(); tone && i < pixels; i += tone_stride()) s.tone.readings.push_back(frame.at(i));
      const auto c2 = static_cast<float>(std::cos(2 * shift)), s2 = static_cast<float>(std::sin(2 * shift));
      for (std::size_t i = 0; harmonics && i < pixels; ++i)
        s.with_cos_2[i] += c2 * frame.at(i), s.with_sin_2[i] += s2 * frame.at(i);
    }
    return s;
  }

  std::size_t tone_stride() const { return 1 + codes_.refusal.size() / tone_pixels; }
  std::size_t tone_first() const { return tone_stride() / 2; }

  // Readings came frame by frame, of pixels that may be dark.
  ToneReadings tone_of(const ShiftSums& s) const {
    const std::size_t pixels = codes_.refusal.size(), shifts = s.shifts_rad.size(),
                      all = s.tone.readings.size() / shifts, width = static_cast<std::size_t>(codes_.width);
    const Mat3 solve = shift_fit(s.shifts_rad);
    ToneReadings seen{.shifts_rad = s.shifts_rad, .readings = {}, .sigmas = {}, .tiles = {}};
    for (std::size_t n = 0, i = tone_first(); n < all; ++n, i += tone_stride()) {
      const Phase p = phase_of(solve, s.of_all[i], s.with_cos[i], s.with_sin[i], codes_.noise);
      if (!codes_.told(i) || s.spoiled[i] != 0 || p.amplitude <= least_of_noise * p.amplitude_sigma) continue;
      for (std::size_t k = 0; k < shifts; ++k) seen.readings.push_back(s.tone.readings[k * all + n]);
      const double variance = photograph::noise_variance(codes_.noise, std::max(0.0, p.mean));
      seen.sigmas.push_back(static_cast<float>(std::sqrt(std::max(1e-12, variance))));
      seen.tiles.push_back(static_cast<std::uint32_t>(i * 8 / pixels * 8 + i % width * 8 / width));
    }
    return seen;
  }

  // As find_gamma(), and after it: with levels, an exponent is another.
  void find_levels(std::vector<ShiftSums>& all) {
    const auto s = std::ranges::find_if(all, [](const ShiftSums& own) { return !own.tone.readings.empty(); });
    if (s == all.end()) return;
    tone_known_ = true;
    const bool stated = r_.gamma > 0;
    const auto found =
        flat_tone(tone_of(*s), stated ? std::optional(FlatLevel{codes_.gamma, codes_.gamma_sigma}) : std::nullopt);
    if (found) {
      codes_.below = found->below, codes_.above = found->above;
      codes_.gamma = found->gamma, codes_.gamma_sigma = found->gamma_sigma;
    }
    s->tone = {};
  }

  // Means of two numbers of periods must be equal.
  void find_noise(const std::vector<ShiftSums>& all) {
    noise_known_ = true;
    if (r_.noise) {
      codes_.noise = *r_.noise;
      return;
    }
    if (codes_.whole) return;  // the Gray code's
    const ShiftSums &a = all.front(), &b = all.back();
    const auto na = static_cast<float>(a.shifts_rad.size()), nb = static_cast<float>(b.shifts_rad.size());
    const bool several = all.size() > 1;
    const auto mean = [&](std::size_t i) { return a.of_all[i] / na; };
    const auto left = [&](std::size_t i) {
      if (a.spoiled[i] != 0 || b.spoiled[i] != 0) return std::numeric_limits<float>::quiet_NaN();
      return several ? mean(i) - b.of_all[i] / nb : mean(i);
    };
    const double unit = std::sqrt(1 / na + (several ? 1 / nb : 0));
    std::vector<Contradiction> found = between_neighbours(left, unit, mean, codes_.width, codes_.height);
    codes_.noise = noise_of(std::move(found));
  }

  // The first axis tells it for both.
  void find_gamma(std::vector<ShiftSums>& all) {
    const auto s = std::ranges::find_if(all, [](const ShiftSums& own) { return !own.with_cos_2.empty(); });
    if (s == all.end()) return;
    if (codes_.gamma_sigma == 0 && in_equal_steps(s->shifts_rad)) {
      const Mat3 solve = shift_fit(s->shifts_rad);
      std::vector<float> phase(s->of_all.size()), amplitude(phase.size());
      for (std::size_t i = 0; i < phase.size(); ++i) {
        const Phase p = phase_of(solve, s->of_all[i], s->with_cos[i], s->with_sin[i], codes_.noise);
        const bool counts = codes_.told(i) && s->spoiled[i] == 0 && p.amplitude > least_of_noise * p.amplitude_sigma;
        phase[i] = counts ? static_cast<float>(p.theta) : std::numeric_limits<float>::quiet_NaN();
        amplitude[i] = static_cast<float>(p.amplitude);
      }
      if (const auto found =
              gamma_of({s->shifts_rad.size(), s->with_cos_2, s->with_sin_2, phase, amplitude, codes_.width}))
        codes_.gamma = found->gamma, codes_.gamma_sigma = found->sigma;
    }
    s->with_cos_2 = {}, s->with_sin_2 = {};
  }

  void places(Axis axis, const std::vector<ShiftSums>& all) {
    const auto a = static_cast<std::size_t>(axis);
    const std::size_t pixels = codes_.refusal.size();
    std::vector<float>&place = codes_.place[a], &sigma = codes_.sigma[a];
    const std::vector<float> stripe = place, stripe_sigma = sigma;  // of a Gray code, which tells the period, too
    place.assign(pixels, 0), sigma.assign(pixels, 0);
    if (codes_.reflected.empty()) codes_.reflected.assign(pixels, 0);
    std::vector<Mat3> inverses;
    bent_.clear();
    const ProjectorTone tone{codes_.gamma, codes_.gamma_sigma, codes_.below, codes_.above};
    for (const ShiftSums& s : all) inverses.push_back(shift_fit(s.shifts_rad));
    for (std::size_t f = 0; tone.bends() && f < all.size(); ++f)
      bent_.emplace_back(tone, all[f].shifts_rad, inverses[f], usual_amplitude(all, inverses, f));
    usual_share_ = usual_share(all, inverses);
    parallel_for(0, (pixels + pixels_at_once - 1) / pixels_at_once, [&](std::size_t n) {
      std::vector<Phase> phases(all.size());
      for (std::size_t i = n * pixels_at_once; i < std::min(pixels, (n + 1) * pixels_at_once); ++i) {
        if (!codes_.told(i)) continue;
        const Stripe known = stripe.empty() ? Stripe{} : Stripe{stripe[i], stripe_sigma[i]};
        codes_.refusal[i] = place_of(axis, all, inverses, i, known, phases, place[i], sigma[i]);
      }
    });
  }

  struct Stripe {
    double place = 0, sigma = 0;  // 0: no Gray code
  };
  Refusal place_of(Axis axis, const std::vector<ShiftSums>& all, const std::vector<Mat3>& inverses, std::size_t i,
                   const Stripe& stripe, std::vector<Phase>& phases, float& place, float& sigma) {
    double reflected = 0;
    for (std::size_t f = 0; f < all.size(); ++f) {
      if (all[f].spoiled[i] != 0) return Refusal::saturated;
      phases[f] = phase_of(inverses[f], all[f].of_all[i], all[f].with_cos[i], all[f].with_sin[i], codes_.noise);
      if (2 * phases[f].amplitude < r_.least_reflected ||
          phases[f].amplitude <= least_of_noise * phases[f].amplitude_sigma)
        return Refusal::dark;
      reflected = std::max(reflected, 2 * phases[f].amplitude);
      if (bent_.empty()) continue;
      const BentPhase::True straight = bent_[f].straightened(phases[f].theta, phases[f].sigma);
      phases[f].theta = straight.theta, phases[f].sigma = straight.sigma;
    }
    if (r_.motion && moved(i, phases, all, reflected)) return Refusal::motion;
    codes_.reflected[i] = static_cast<float>(reflected);
    if (share_of_finest(phases) < r_.least_direct * usual_share_) return Refusal::subsurface;
    const double size = r_.sequence.size(axis);
    const std::size_t finest = all.size() - 1;
    const double period = size / all[finest].periods;
    double best = 0, least = -1, next = -1, fine_least = 0;  // of fine ones: chi-square times (periods / finest)^2
    for (int k = 0; k < static_cast<int>(std::ceil(all[finest].periods - 1e-9)); ++k) {
      const double turn = phases[finest].theta / (2 * pi), u = (turn - std::floor(turn) + k) * period - 0.5;
      if (u > size) break;
      double chi_square = stripe.sigma > 0 ? std::pow((u - stripe.place) / stripe.sigma, 2) : 0, fine = 0;
      for (std::size_t f = 0; f < finest; ++f) {
        const double ratio = all[f].periods / all[finest].periods,
                     variance = phases[f].sigma * phases[f].sigma +
                                ratio * ratio * phases[finest].sigma * phases[finest].sigma +
                                own_error_rad * own_error_rad,
                     off = wrapped(phases[f].theta - 2 * pi * all[f].periods * (u + 0.5) / size);
        chi_square += off * off / variance, fine += ratio * ratio * off * off / variance;
      }
      if (least < 0 || chi_square < least)
        next = least, least = chi_square, best = u, fine_least = fine;
      else if (next < 0 || chi_square < next)
        next = chi_square;
    }
    const double further = std::max<double>(1, static_cast<double>(finest));
    const double wider = r_.indirect ? widened_by_indirect(phases, least / further) : 1;
    if (r_.contradictions &&
        (least > most_contradicting * further * wider || (next >= 0 && next - least < least_ahead)))
      return Refusal::contradictory;
    if (r_.indirect && next >= 0 && next - least < least_ahead * (wider + disagreeing * fine_least / further))
      return Refusal::interreflection;
    double sum = 0, weights = 0;
    for (std::size_t f = 0; f <= finest; ++f) {
      const double px_per_rad = size / (2 * pi * all[f].periods),
                   own = best + px_per_rad * wrapped(phases[f].theta - 2 * pi * all[f].periods * (best + 0.5) / size),
                   s = px_per_rad * phases[f].sigma, weight = 1 / std::max(1e-12, s * s);
      sum += weight * own, weights += weight;
    }
    place = static_cast<float>(sum / weights), sigma = static_cast<float>(std::sqrt(1 / weights));
    return Refusal::none;
  }

  // Of amplitudes; 1 where there is one number of periods.
  static double share_of_finest(const std::vector<Phase>& phases) {
    double largest = 0;
    for (const Phase& p : phases) largest = std::max(largest, p.amplitude);
    return phases.back().amplitude / largest;
  }

  // of(phases) of some pixels, ascending.
  template <class Of>
  std::vector<double> sampled(const std::vector<ShiftSums>& all, const std::vector<Mat3>& inverses,
                              const Of& of) const {
    std::vector<double> values;
    std::vector<Phase> phases(all.size());
    const std::size_t pixels = codes_.refusal.size(), stride = 1 + pixels / most_sampled;
    for (std::size_t i = 0; i < pixels; i += stride) {
      bool counts = codes_.told(i);
      for (std::size_t f = 0; counts && f < all.size(); ++f) {
        phases[f] = phase_of(inverses[f], all[f].of_all[i], all[f].with_cos[i], all[f].with_sin[i], codes_.noise);
        counts = all[f].spoiled[i] == 0 && phases[f].amplitude > least_of_noise * phases[f].amplitude_sigma;
      }
      if (counts) values.push_back(of(phases));
    }
    std::ranges::sort(values);
    return values;
  }

  // What the best tenth of the picture has.
  double usual_share(const std::vector<ShiftSums>& all, const std::vector<Mat3>& inverses) const {
    const std::vector<double> shares = sampled(all, inverses, share_of_finest);
    return shares.empty() ? 0 : shares[shares.size() * 9 / 10];
  }

  // Over that of the fewest periods, by the median.
  double usual_amplitude(const std::vector<ShiftSums>& all, const std::vector<Mat3>& inverses, std::size_t f) const {
    const std::vector<double> ratios =
        sampled(all, inverses, [f](const std::vector<Phase>& p) { return p[f].amplitude / p[0].amplitude; });
    return ratios.empty() ? 1 : std::min(1.0, ratios[ratios.size() / 2]);
  }

  // Means over shifts that differ, from each other and from those of the axis before.
  bool moved(std::size_t i, const std::vector<Phase>& phases, const std::vector<ShiftSums>& all,
             double reflected) const {
    const auto variance = [&](double mean, double shifts) {
      return photograph::noise_variance(codes_.noise, std::max(0.0, mean)) / shifts;
    };
    const double here = phases.back().mean, own = variance(here, static_cast<double>(all.back().shifts_rad.size()));
    const auto differs = [&](double mean, double shifts) {
      const double off = std::abs(mean - here);
      return off > moved_least * reflected && off * off > moved_sigmas * moved_sigmas * (variance(mean, shifts) + own);
    };
    for (std::size_t f = 0; f + 1 < all.size(); ++f)
      if (differs(phases[f].mean, static_cast<double>(all[f].shifts_rad.size()))) return true;
    return !means_.empty() && differs(means_[i], shifts_of_means_);
  }

  // By how much variances of phases are larger than own_error_rad has it.
  static double widened_by_indirect(const std::vector<Phase>& phases, double chi_square) {
    double largest = 0;
    for (const Phase& p : phases) largest = std::max(largest, p.amplitude);
    const double turned = turned_by_indirect * (largest / phases.back().amplitude - 1) / own_error_rad;
    return 1 + std::min(turned * turned, agreeing * chi_square);
  }

  const DecodeRequest& r_;
  const FrameReader& read_;
  Codes& codes_;
  bool noise_known_ = false, tone_known_ = false;  // tone: that its levels were looked for
  double usual_share_ = 0;
  std::vector<float> means_;  // over the shifts of the axis before, in equal steps
  double shifts_of_means_ = 0;
  std::vector<BentPhase> bent_;  // by number of periods; none: the projector is linear
};

}  // namespace

void decode_cosines(const DecodeRequest& request, const FrameReader& read, Codes& codes) {
  CosineDecoder(request, read, codes).run();
  codes.whole = false;
}

}  // namespace gonio::scan
