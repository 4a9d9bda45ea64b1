// place(): the pieces one after the other, the surest first, each on the points that the others leave; then everything
// together.
#include "reassembly/place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "linear/geom_matrices.h"
#include "reassembly/bundle_fate.h"
#include "reassembly/place_adjust.h"
#include "reassembly/place_judge.h"
#include "stats/distributions.h"

namespace gonio::reassembly {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vec3 plain_vec(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Rigid<frame::World, frame::Object> pose_of(const Matrix3d& rotation, const Vector3d& place) {
  return {quaternion_of(linear::mat3_of(rotation)), plain_vec(place)};
}

class Placing {
 public:
  Placing(std::span<const View> views, const Bundles& bundles, std::span<const Piece> pieces, const PlaceWish& wish)
      : views_(views),
        bundles_(bundles),
        pieces_(pieces),
        wish_(wish),
        points_(points_of(bundles.found)),
        judged_(pieces.size()) {
    for (const View& v : views) covariances_.push_back(Eigen::Map<const Matrix6>(v.covariance.data()));
  }

  Placement all() {
    judge_all();
    for (;;) {  // a piece whose pairs do not stand the adjustment goes, and the others are adjusted without it
      set_up();
      settle();
      if (!drop_fallen()) break;
    }
    Placement out;
    for (std::size_t p = 0; p < pieces_.size(); ++p) out.pieces.push_back(placed(p));
    out.scale = wish_.free_scale ? all_.scale : 1;
    out.sigma_scale = all_.sigma_scale;
    finish(out);
    return out;
  }

 private:
  void judge_all() {
    std::vector<bool> done(pieces_.size());
    for (;;) {
      std::optional<std::size_t> surest;
      for (std::size_t p = 0; p < pieces_.size(); ++p) {
        if (done[p]) continue;
        judged_[p] = as_meant(judged(pieces_[p], points_, wish_), pieces_[p]);
        if (judged_[p].verdict == Verdict::placed &&
            (!surest || judged_[p].fits[0].score > judged_[*surest].fits[0].score))
          surest = p;
      }
      if (!surest) return;
      done[*surest] = true;
      for (const Pairing& pair : judged_[*surest].fits[0].pairs) take(pair[1]);
    }
  }
  // Of several fits the one that somebody else knows to be true: its markers lie nearest to theirs under that pose.
  Judged as_meant(Judged judged, const Piece& piece) const {
    const auto known = std::ranges::find(wish_.meant, piece.object, [](const auto& m) { return m.first; });
    if (judged.verdict != Verdict::ambiguous || known == wish_.meant.end()) return judged;
    const auto apart = [&](const Match& match) {
      double sum = 0;
      for (const PieceMarker& marker : piece.markers) {
        const Vector3d there =
            match.fit.rotation * (match.fit.scale * linear::as_eigen(marker.centre_m)) + match.fit.place;
        sum += (there - linear::as_eigen(known->second * marker.centre_m)).squaredNorm();
      }
      return sum;
    };
    judged.fits = {*std::ranges::min_element(judged.fits, {}, apart)};
    judged.verdict = Verdict::placed;
    judged.why.clear();
    return judged;
  }
  void take(std::size_t bundle) {
    points_.open[bundle] = false;
    for (const std::size_t rival : points_.rivals[bundle]) points_.open[rival] = false;
  }

  void set_up() {
    all_ = {};
    all_.free_scale = wish_.free_scale;
    markers_.clear();
    pairs_.clear();
    double log_scale = 0;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      if (judged_[p].verdict != Verdict::placed) continue;
      const PointFit& f = judged_[p].fits[0].fit;
      log_scale += std::log(f.scale * judged_[p].scale);
      for (const Pairing& pair : judged_[p].fits[0].pairs) add_marker(p, all_.pieces.size(), pair);
      index_of_.resize(pieces_.size());
      index_of_[p] = all_.pieces.size();
      all_.pieces.push_back({f.rotation, f.place, Vector3d::Zero(), Matrix6::Zero()});
    }
    if (wish_.free_scale && !all_.pieces.empty())
      all_.scale = std::exp(log_scale / static_cast<double>(all_.pieces.size()));
  }
  void add_marker(std::size_t piece, std::size_t index, const Pairing& pair) {
    const PieceMarker& known = pieces_[piece].markers[pair[0]];
    const Bundle& bundle = bundles_.found[pair[1]];
    AdjustedMarker m;
    m.piece = index;
    m.prior = linear::as_eigen(known.centre_m);
    const Matrix3d covariance = linear::as_eigen(known.covariance_m2);
    m.root = covariance.isZero(0) ? Matrix3d::Zero() : lower_root(covariance);
    if (known.radius_m > 0)
      m.radius = known.radius_m;
    else
      m.radius = wish_.radius_m;
    m.start_radius = bundle.radius_m.value_or(0);
    for (const Sighting& s : bundle.sightings) {
      AdjustedSight seen;
      seen.view = s.view;
      seen.sight = sight_of(views_[s.view], views_[s.view].outlines[s.outline], views_[s.view].image);
      seen.sighting = s;
      m.sights.push_back(std::move(seen));
    }
    if (bundle.sightings.empty()) {
      m.point = linear::as_eigen(bundle.centre_m);
      m.point_white = lower_inverse(lower_root(linear::as_eigen(bundle.covariance_m2)));
    }
    all_.markers.push_back(std::move(m));
    markers_.push_back(pair[0]);
    pairs_.push_back(pair[1]);
  }

  // Adjusts; takes out the sighting or the marker that contradicts the rest most; again.
  void settle() {
    if (all_.pieces.empty()) return;
    std::size_t sights = 0;
    for (const AdjustedMarker& m : all_.markers) sights += m.sights.size() + 1;
    const double gate = stats::chi2_quantile(1 - 1e-3 / static_cast<double>(sights), 2);
    const double marker_gate = stats::chi2_quantile(1 - 1e-3 / static_cast<double>(sights), 3);
    for (std::size_t round = 0; round <= sights; ++round) {
      set_anchors();
      adjust(all_, covariances_);
      double worst = 1;
      AdjustedSight* sight = nullptr;
      AdjustedMarker* marker = nullptr;
      for (AdjustedMarker& m : all_.markers) {
        if (!m.used) continue;
        if (const double off = m.y.squaredNorm() / marker_gate; off > worst) worst = off, marker = &m, sight = nullptr;
        for (AdjustedSight& s : m.sights)
          if (s.used && s.square / gate > worst) worst = s.square / gate, sight = &s, marker = &m;
      }
      if (!marker) return;
      if (sight) sight->used = false;
      const auto left = std::ranges::count_if(marker->sights, [](const AdjustedSight& s) { return s.used; });
      if (!sight || left < 2) marker->used = false;
    }
  }
  void set_anchors() {
    for (std::size_t p = 0; p < all_.pieces.size(); ++p) {
      Vector3d sum = Vector3d::Zero();
      double count = 0;
      for (const AdjustedMarker& m : all_.markers)
        if (m.used && m.piece == p) sum += m.prior, ++count;
      if (count > 0) all_.pieces[p].anchor = sum / count;
    }
  }

  bool drop_fallen() {
    bool dropped = false;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      if (judged_[p].verdict != Verdict::placed) continue;
      std::size_t left = 0, held = 0;
      for (const AdjustedMarker& m : all_.markers)
        if (m.piece == index_of_[p]) left += m.used, ++held;
      // What is left must still be more than chance: half of what was paired, and enough to hold the piece.
      if (left >= static_cast<std::size_t>(std::max(3, wish_.fewest_markers)) && 2 * left > held) continue;
      judged_[p].why = format("%zu of %zu pairs contradict the rest once all is adjusted together", held - left, held);
      judged_[p].verdict = Verdict::lost;
      dropped = true;
    }
    return dropped;
  }

  Placed placed(std::size_t p) const {
    const Judged& j = judged_[p];
    Placed out;
    out.object = pieces_[p].object;
    out.verdict = j.verdict;
    out.why = j.why;
    if (j.verdict == Verdict::placed) {
      fill(p, out);
    } else if (!j.fits.empty()) {
      const Match& best = j.fits[0];
      out.world_from_object = pose_of(best.fit.rotation, best.fit.place);
      out.scale = j.scale * best.fit.scale;
      out.chi_square = best.fit.chi_square;
      out.degrees = best.degrees;
      if (j.verdict == Verdict::ambiguous || j.verdict == Verdict::poor)
        for (const Match& m : j.fits)
          out.candidates.push_back({pose_of(m.fit.rotation, m.fit.place), m.pairs, m.fit.chi_square, m.degrees});
    }
    std::set<std::size_t> seen;
    for (const Pair& pair : out.pairs) seen.insert(pair.marker);
    for (std::size_t i = 0; i < pieces_[p].markers.size(); ++i)
      if (!seen.contains(i) && j.verdict == Verdict::placed) out.unseen.push_back(i);
    return out;
  }

  void fill(std::size_t p, Placed& out) const {
    const std::size_t index = index_of_[p];
    const AdjustedPiece& piece = all_.pieces[index];
    out.world_from_object = pose_of(piece.rotation, piece.place);
    out.scale = all_.scale;
    const Vector3d centroid = piece.rotation * (all_.scale * piece.anchor) + piece.place;
    out.centroid_m = plain_vec(centroid);
    std::vector<Vector3d> arms;
    std::vector<Pairing> kept;
    for (std::size_t k = 0; k < all_.markers.size(); ++k) {
      const AdjustedMarker& m = all_.markers[k];
      if (m.piece != index || !m.used) continue;
      arms.push_back(piece.rotation * (all_.scale * (m.prior - piece.anchor)));
      kept.push_back({markers_[k], pairs_[k]});
      out.chi_square += m.chi_square;
      out.degrees += m.degrees;
    }
    out.degrees -= 6;
    Matrix6 covariance = piece.covariance;
    // More scatter than the stated uncertainties allow widens the answer (Birge 1932).
    if (out.degrees > 0 && stats::chi2_upper(out.chi_square, out.degrees) < 1e-3)
      covariance *= out.chi_square / out.degrees;
    Eigen::Map<Matrix6>(out.covariance.data()) = covariance;
    const auto spots = spots_of(pieces_[p]);
    const auto fit = fit_points(spots, points_.spots, kept, wish_.free_scale);
    for (std::size_t k = 0; k < all_.markers.size(); ++k)
      if (all_.markers[k].piece == index && all_.markers[k].used) out.pairs.push_back(pair_of(k, spots, fit, arms));
    std::ranges::sort(out.pairs, {}, &Pair::marker);
  }

  // A bundle's point without the sightings that were dropped from it.
  static Spot left_of(const AdjustedMarker& m, const Spot& whole) {
    std::vector<const Sight*> left;
    for (const AdjustedSight& s : m.sights)
      if (s.used) left.push_back(&s.sight);
    if (left.size() < 2 || left.size() == m.sights.size()) return whole;
    const auto meeting = meet(left, m.radius);
    return meeting ? Spot{meeting->centre, meeting->covariance} : whole;
  }

  Pair pair_of(std::size_t k, const std::vector<Spot>& spots, const std::optional<PointFit>& fit,
               const std::vector<Vector3d>& arms) const {
    const AdjustedMarker& m = all_.markers[k];
    const AdjustedPiece& piece = all_.pieces[m.piece];
    const Spot &own = spots[markers_[k]], seen = left_of(m, points_.spots[pairs_[k]]);
    const Vector3d there = piece.rotation * (all_.scale * m.prior) + piece.place;
    Pair out{markers_[k], pairs_[k], (there - seen.at).norm(), 0, 0, 0, {}};
    // Of what both are off, the pose has taken its share: Sigma - A (sum A' Sigma^-1 A)^-1 A'.
    double expected = all_.scale * all_.scale * own.covariance.trace() + seen.covariance.trace();
    if (fit) {
      const Vector3d from = fit->rotation * (fit->scale * own.at) + fit->place - fit->centroid;
      Eigen::Matrix<double, 3, 7> a;
      a << -linear::cross_matrix(from), Matrix3d::Identity(), from;
      expected = std::max(0.0, expected - (a * fit->covariance * a.transpose()).trace());
    }
    out.expected_m = std::sqrt(expected);
    double squares = 0, count = 0;
    for (const AdjustedSight& s : m.sights) {
      if (!s.used) out.dropped.push_back(s.sighting);
      if (s.used && s.seen_px) squares += s.miss_px * s.miss_px, ++count;
    }
    if (count > 0) out.residual_px = std::sqrt(squares / count);
    double moves = 0;
    for (const Vector3d& other : arms)
      moves += (linear::cross_matrix(m.without.head<3>()) * other + m.without.tail<3>()).squaredNorm() /
               static_cast<double>(arms.size());
    out.moves_m = m.needed ? std::numeric_limits<double>::infinity() : std::sqrt(moves);
    return out;
  }

  // What belongs to no piece, what a mirror showed, and what glass displaced.
  void finish(Placement& out) {
    out.fate = bundles_.fate;
    out.fate.resize(views_.size());
    for (std::size_t v = 0; v < views_.size(); ++v) out.fate[v].resize(views_[v].outlines.size(), Fate::alone);
    points_.open.assign(bundles_.found.size(), true);
    std::set<Sighting, decltype([](const Sighting& a, const Sighting& b) {
               return a.view != b.view ? a.view < b.view : a.outline < b.outline;
             })>
        used;
    for (const Placed& p : out.pieces)
      for (const Pair& pair : p.pairs) {
        take(pair.bundle);
        for (const Sighting& s : bundles_.found[pair.bundle].sightings)
          if (std::ranges::count(pair.dropped, s) == 0) used.insert(s);
        for (const Sighting& s : pair.dropped) out.fate[s.view][s.outline] = Fate::refracted;
      }
    find_reflected(out);
    for (std::size_t b = 0; b < points_.open.size(); ++b)
      if (points_.open[b]) out.left_over.push_back(b);
    for (std::size_t v = 0; v < views_.size(); ++v)
      for (std::size_t i = 0; i < views_[v].outlines.size(); ++i)
        if (!used.contains({v, i}) && out.fate[v][i] != Fate::reflected && behind_glass(out, v, i, used))
          out.fate[v][i] = Fate::refracted;
  }
  void find_reflected(Placement& out) {
    for (const Placed& p : out.pieces) {
      if (p.verdict != Verdict::placed) continue;
      auto spots = mirrored(spots_of(pieces_[static_cast<std::size_t>(&p - out.pieces.data())]));
      for (Spot& s : spots) s.at *= p.scale, s.covariance *= p.scale * p.scale;
      const auto found = matches(spots, points_, static_cast<std::size_t>(wish_.fewest_markers), 0).all;
      if (found.empty() || found[0].log_alarm > std::log(wish_.false_alarm)) continue;
      for (const Pairing& pair : found[0].pairs) {
        out.reflected.push_back(pair[1]);
        take(pair[1]);
        for (const Sighting& s : bundles_.found[pair[1]].sightings) out.fate[s.view][s.outline] = Fate::reflected;
      }
    }
    std::ranges::sort(out.reflected);
  }
  template <class Used>
  bool behind_glass(const Placement& out, std::size_t v, std::size_t i, const Used& used) const {
    const Sight sight = sight_of(views_[v], views_[v].outlines[i], views_[v].image);
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      const Placed& placed = out.pieces[p];
      if (placed.verdict != Verdict::placed) continue;
      for (std::size_t k = 0; k < pieces_[p].markers.size(); ++k) {
        const auto pair = std::ranges::find(placed.pairs, k, &Pair::marker);
        const bool shown = pair != placed.pairs.end() &&
                           std::ranges::any_of(bundles_.found[pair->bundle].sightings,
                                               [&](const Sighting& s) { return s.view == v && used.contains(s); });
        const PieceMarker& m = pieces_[p].markers[k];
        const double radius = m.radius_m > 0 ? m.radius_m : wish_.radius_m.value_or(0);
        if (!shown && displaced(sight, linear::as_eigen(placed.world_from_object * (m.centre_m * placed.scale)),
                                radius > 0 ? std::optional(radius) : std::nullopt))
          return true;
      }
    }
    return false;
  }

  std::span<const View> views_;
  const Bundles& bundles_;
  std::span<const Piece> pieces_;
  const PlaceWish& wish_;
  Points points_;
  std::vector<Judged> judged_;
  std::vector<Matrix6> covariances_;
  Adjusted all_;
  std::vector<std::size_t> markers_, pairs_, index_of_;  // of all_.markers; of pieces
};

}  // namespace

Placement place(std::span<const View> views, const Bundles& bundles, std::span<const Piece> pieces,
                const PlaceWish& wish) {
  if (pieces.empty()) throw Error(Exit::data, "pieces", "there is none", "name at least one with its markers");
  if (views.empty() && bundles.found.empty())
    throw Error(Exit::data, "views", "there is none", "give calibrated photographs with their poses");
  return Placing(views, bundles, pieces, wish).all();
}

}  // namespace gonio::reassembly
