// Verdicts. An answer must be improbable by chance, must have no rival, and the piece's mirror image must not fit the
// same points better; where nothing of its size fits, another size may.
#include "reassembly/place_judge.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/text.h"
#include "linear/geom_matrices.h"

namespace gonio::reassembly {
namespace {

constexpr double near_scale = 0.1;   // a tomograph's scale that is free lies so near to 1
constexpr double scale_bin = 0.025;  // tolerance about a scale that was voted for
constexpr std::size_t most_scales = 6;
constexpr std::size_t most_weak = 16;  // candidates that are shown of what may be chance

const Match* strongest(const std::vector<Match>& all, double log_limit) {
  for (const Match& m : all)
    if (m.log_alarm < log_limit) return &m;
  return nullptr;
}

struct SizedFits {
  std::vector<Match> proper, mirror;
  double scale = 1;
  std::size_t complete = 0;  // of proper
};
std::vector<Spot> scaled_spots(std::vector<Spot> spots, double by) {
  for (Spot& s : spots) s.at *= by, s.covariance *= by * by;
  return spots;
}
SizedFits fits_at(const std::vector<Spot>& spots, const Points& points, std::size_t fewest, double scale,
                  double loose) {
  const auto sized = scaled_spots(spots, scale);
  Matches proper = matches(sized, points, fewest, loose);
  return {std::move(proper.all), matches(mirrored(sized), points, fewest, loose).all, scale, proper.complete};
}

// Pairs that contradict the model are weighed by how far the best answer itself is off.
double inflation_of(const Match& m) {
  return m.degrees > 0 ? std::max(1.0, m.fit.chi_square / m.degrees) : 1;
}

// Whether they compete: half of the smaller one's points, at least, are the other's too.
bool shares_points(const Match& a, const Match& b) {
  std::size_t shared = 0;
  for (const Pairing& p : a.pairs)
    shared += std::ranges::any_of(b.pairs, [&](const Pairing& q) { return q[1] == p[1]; });
  return 2 * shared >= std::min(a.pairs.size(), b.pairs.size());
}

class PieceJudge {
 public:
  PieceJudge(const Piece& piece, const Points& points, const PlaceWish& wish)
      : piece_(piece),
        points_(points),
        spots_(spots_of(piece)),
        fewest_(static_cast<std::size_t>(std::max(3, wish.fewest_markers))),
        limit_(std::log(wish.false_alarm)),
        free_scale_(wish.free_scale) {}

  Judged verdict() {
    if (spots_.size() < fewest_) return poor(format("carries %zu markers (at least %zu)", spots_.size(), fewest_));
    if (on_a_line()) return poor(format("its %zu markers lie on a line: the turn about it stays open", spots_.size()));
    if (points_.count() < static_cast<double>(fewest_))
      return poor(
          format("%.0f points are there for its %zu markers (at least %zu)", points_.count(), spots_.size(), fewest_));
    SizedFits fits = free_scale_ ? best_scale(true) : fits_at(spots_, points_, fewest_, 1, 0);
    const Match *proper = strongest(fits.proper, limit_), *mirror = strongest(fits.mirror, limit_);
    if (proper && (!mirror || !prefers(*mirror, *proper))) return answer(fits, *proper);
    if (mirror) return handed(*mirror, fits.scale);
    SizedFits other = best_scale(false);
    proper = strongest(other.proper, limit_ - std::log(most_scales)),
    mirror = strongest(other.mirror, limit_ - std::log(most_scales));
    if (proper && (!mirror || !prefers(*mirror, *proper))) return sized(*proper, other.scale);
    if (mirror) return handed(*mirror, other.scale);
    if (!fits.proper.empty()) {
      const Match& best = *std::ranges::min_element(fits.proper, {}, &Match::log_alarm);
      Judged weak =
          poor(format("%zu of its %zu markers fit, which chance alone does %.2g times in such a scene (limit %.2g)",
                      best.pairs.size(), spots_.size(), std::exp(best.log_alarm), std::exp(limit_)));
      weak.fits = std::move(fits.proper);
      std::ranges::stable_sort(weak.fits, std::greater{}, [](const Match& m) { return m.pairs.size(); });
      weak.fits.resize(std::min(weak.fits.size(), most_weak));
      const auto others = exchanged(weak.fits[0], scaled_spots(spots_, fits.scale));
      weak.fits.insert(weak.fits.begin() + 1, others.begin(), others.end());
      return weak;
    }
    return {Verdict::lost,
            format("no %zu of its %zu markers fit any of %.0f points", fewest_, spots_.size(), points_.count()),
            {},
            1};
  }

 private:
  bool on_a_line() const {
    std::vector<Pairing> own;
    for (std::size_t i = 0; i < spots_.size(); ++i) own.push_back({i, i});
    std::vector<Spot> firm = spots_;  // against itself
    for (Spot& s : firm) s.covariance += 1e-18 * Eigen::Matrix3d::Identity();
    return !fit_points(firm, firm, own, false);
  }
  Judged poor(std::string why) const { return {Verdict::poor, std::move(why), {}, 1}; }

  bool prefers(const Match& mirror, const Match& proper) const {
    return shares_points(mirror, proper) && mirror.score - proper.score > -limit_ * inflation_of(mirror);
  }

  // The scale whose best match is the most improbable by chance.
  SizedFits best_scale(bool near_one) const {
    std::vector<double> scales = likely_scales(spots_, points_, near_one ? 1000 : most_scales);
    if (near_one) {
      std::erase_if(scales, [](double s) { return std::abs(std::log(s)) > near_scale; });
      if (scales.size() > most_scales) scales.resize(most_scales);
    }
    SizedFits best;
    double least = HUGE_VAL;
    for (const double scale : scales) {
      SizedFits f = fits_at(spots_, points_, fewest_, scale, scale_bin);
      for (const auto* side : {&f.proper, &f.mirror})
        if (!side->empty() && side->front().log_alarm < least) {
          least = side->front().log_alarm;
          best = f;
        }
    }
    return best;
  }

  // The same with two markers exchanged, where that fits about as well: they lie nearer to each other than the noise.
  std::vector<Match> exchanged(const Match& best, const std::vector<Spot>& sized) const {
    std::vector<Match> out;
    for (std::size_t a = 0; a < best.pairs.size(); ++a)
      for (std::size_t b = a + 1; b < best.pairs.size(); ++b) {
        Match other = best;
        std::swap(other.pairs[a][1], other.pairs[b][1]);
        const auto fit = fit_points(sized, points_.spots, other.pairs, free_scale_);
        if (!fit) continue;
        other.fit = *fit;
        other.score -= (fit->chi_square - best.fit.chi_square) / 2;
        if ((best.score - other.score) / inflation_of(best) < -limit_) out.push_back(std::move(other));
      }
    return out;
  }

  Judged answer(const SizedFits& fits, const Match& best) const {
    if (best.pairs.size() == 3 && spots_.size() > 4) {
      Judged few =
          poor(format("3 of its %zu markers fit, and on 3 a mirror image fits as well (at least 4)", spots_.size()));
      few.fits = {best};
      return few;
    }
    if (fits.complete > best.pairs.size() - 2) {
      Judged vague =
          poor(format("%zu of its %zu markers fit, but so do too many others to try them all: the %.0f points "
                      "are too uncertain",
                      best.pairs.size(), spots_.size(), points_.count()));
      vague.fits = {best};
      return vague;
    }
    const auto sized = scaled_spots(spots_, fits.scale);
    Judged out{Verdict::placed, "", {best}, fits.scale};
    for (Match& m : exchanged(best, sized)) out.fits.push_back(std::move(m));
    bool second = false;
    for (const Match& m : fits.proper) {
      // A set of other points that fits by itself: glass shows the piece a second time, and larger need not be truer.
      const bool apart = m.pairs.size() > 3 && 2 * m.pairs.size() >= best.pairs.size() && m.log_alarm < limit_ &&
                         !shares_points(m, best) && !in_mirror(fits, m);
      if (!apart && (best.score - m.score) / inflation_of(best) > -limit_) continue;
      const bool known = std::ranges::any_of(out.fits, [&](const Match& f) {
        return same_place(f, m, sized, points_) || same_place(m, f, sized, points_);
      });
      if (known) continue;
      second = second || apart;
      out.fits.push_back(m);
    }
    if (out.fits.size() == 1) return out;
    out.verdict = Verdict::ambiguous;
    const Match &a = out.fits[0], &b = out.fits[1];
    out.why = format(
        "%zu poses explain the points as well: the best pairs %zu markers with chi-square %.1f, the next %zu "
        "with %.1f",
        out.fits.size(), a.pairs.size(), a.fit.chi_square, b.pairs.size(), b.fit.chi_square);
    if (second) out.why += "; on other points: glass shows it twice, or there are two";
    return out;
  }
  // Points of a mirror image, of which a few that lie near a plane fit unmirrored too.
  static bool in_mirror(const SizedFits& fits, const Match& m) {
    return std::ranges::any_of(fits.mirror,
                               [&](const Match& other) { return other.score > m.score && shares_points(other, m); });
  }
  Judged handed(const Match& m, double scale) const {
    Judged out{Verdict::mirrored,
               format("only its mirror image fits (%zu of %zu markers): handedness of the volume, or left for right",
                      m.pairs.size(), spots_.size()),
               {m},
               scale};
    if (std::abs(std::log(scale * m.fit.scale)) > 3 * scale_bin)
      out.why += format("; and its lengths times %.4g", scale * m.fit.scale);
    return out;
  }
  Judged sized(const Match& m, double scale) const {
    const double factor = scale * m.fit.scale;
    std::string why =
        format("%zu of %zu markers fit once its lengths are multiplied by %.5g", m.pairs.size(), spots_.size(), factor);
    if (std::abs(factor / 1e-3 - 1) < 0.1) why += ": mm for m";
    if (std::abs(factor / 1e3 - 1) < 0.1) why += ": m for mm";
    if (std::abs(factor / 25.4e-3 - 1) < 0.02) why += ": inches for metres";
    return {Verdict::scaled, std::move(why), {m}, scale};
  }

  const Piece& piece_;
  const Points& points_;
  std::vector<Spot> spots_;
  std::size_t fewest_;
  double limit_;
  bool free_scale_;
};

}  // namespace

std::vector<Spot> spots_of(const Piece& piece) {
  std::vector<Spot> out;
  for (const PieceMarker& m : piece.markers)
    out.push_back({linear::as_eigen(m.centre_m), linear::as_eigen(m.covariance_m2)});
  return out;
}

std::vector<Spot> mirrored(std::vector<Spot> spots) {
  for (Spot& s : spots) s.at = -s.at;  // any reflection will do: poses differ by a rotation
  return spots;
}

Judged judged(const Piece& piece, const Points& points, const PlaceWish& wish) {
  return PieceJudge(piece, points, wish).verdict();
}

}  // namespace gonio::reassembly
