// Which mistake explains loops that do not close: each link is mended in each way that people get them wrong, and what
// lets all loops close is named. Mistakes that one loop cannot tell apart (two axes of a frame flipped in the link
// before it or in the one behind) are all named.
#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "base/text.h"
#include "manifest/frame_graph.h"
#include "stats/distributions.h"

namespace gonio::manifest {
namespace {

Vec3 mirrored_vector(Vec3 v, char axis) {
  return {axis == 'x' ? -v.x : v.x, axis == 'y' ? -v.y : v.y, axis == 'z' ? -v.z : v.z};
}
Motion half_turn(char axis) {
  return {{0, axis == 'x' ? 1.0 : 0.0, axis == 'y' ? 1.0 : 0.0, axis == 'z' ? 1.0 : 0.0}, {}};
}

class Diagnosis {
 public:
  Diagnosis(std::span<const FrameEdge> edges, const LoopCheck& check, double limit_p)
      : edges_(edges.begin(), edges.end()), check_(check), limit_p_(limit_p), loops_of_(edges.size()) {
    for (std::size_t l = 0; l < check.loops.size(); ++l)
      for (const std::size_t e : members(check.loops[l])) loops_of_[e].push_back(l);
    for (const std::size_t l : check.broken)
      for (const std::size_t e : members(check.loops[l])) ++broken_with_[e];
  }

  std::vector<FrameFault> faults() {
    constexpr std::size_t most_links = 400;  // whose pairs are tried
    for (const auto& [edge, in_broken] : broken_with_)
      if (in_broken == check_.broken.size()) try_alone(edge);
    if (broken_with_.size() <= most_links)
      for (auto a = broken_with_.begin(); a != broken_with_.end(); ++a)
        for (auto b = std::next(a); b != broken_with_.end(); ++b) try_exchange(a->first, b->first);
    std::ranges::stable_sort(found_, {}, &FrameFault::chi_square);
    return std::move(found_);
  }

  // The links that most broken loops have in common.
  std::vector<std::size_t> suspects() const {
    std::size_t most = 0;
    for (const auto& [edge, n] : broken_with_) most = std::max(most, n);
    std::vector<std::size_t> all;
    for (const auto& [edge, n] : broken_with_)
      if (n == most) all.push_back(edge);
    return all;
  }

 private:
  static std::vector<std::size_t> members(const FrameLoop& loop) {
    std::vector<std::size_t> all{loop.closing};
    for (const Stride& s : loop.way) all.push_back(s.edge);
    return all;
  }
  // With `edges_` as they are: infinite where one of the loops through these links does not close.
  std::optional<double> chi_square_through(std::span<const std::size_t> links) const {
    std::set<std::size_t> loops;
    for (const std::size_t e : links) loops.insert(loops_of_[e].begin(), loops_of_[e].end());
    for (const std::size_t l : check_.broken)
      if (!loops.contains(l)) return {};
    double sum = 0;
    for (const std::size_t l : loops) {
      const double square = closure_of(edges_, check_.loops[l]).chi_square();
      if (!(stats::chi2_upper(square, 6) >= limit_p_)) return {};
      sum += square;
    }
    return sum;
  }
  void try_alone(std::size_t edge) {
    const Motion said = edges_[edge].to_from;
    const auto attempt = [&](FrameMistake mistake, char axis) {
      edges_[edge].to_from = mended(said, mistake, axis);
      if (const auto square = chi_square_through(std::array{edge}))
        found_.push_back({mistake, edge, edge, axis, *square});
      edges_[edge].to_from = said;
    };
    for (const FrameMistake m : {FrameMistake::inverted, FrameMistake::rotation_inverted, FrameMistake::millimetres,
                                 FrameMistake::metres, FrameMistake::scalar_last})
      attempt(m, ' ');
    for (const FrameMistake m : {FrameMistake::mirrored, FrameMistake::flipped_from, FrameMistake::flipped_to})
      for (const char axis : {'x', 'y', 'z'}) attempt(m, axis);
  }
  // Links that share the frame that they lead to, or from: what one says of left, the other says of right.
  void try_exchange(std::size_t a, std::size_t b) {
    FrameEdge &one = edges_[a], &other = edges_[b];
    if ((one.to == other.to) == (one.from == other.from)) return;
    std::swap(one.to_from, other.to_from);
    std::swap(one.covariance, other.covariance);
    if (const auto square = chi_square_through(std::array{a, b}))
      found_.push_back({FrameMistake::exchanged, a, b, ' ', *square});
    std::swap(one.to_from, other.to_from);
    std::swap(one.covariance, other.covariance);
  }

  std::vector<FrameEdge> edges_;
  const LoopCheck& check_;
  double limit_p_;
  std::vector<std::vector<std::size_t>> loops_of_;
  std::map<std::size_t, std::size_t> broken_with_;  // link: how many broken loops go through it
  std::vector<FrameFault> found_;
};

std::string link_words(const FrameEdge& e) {
  return "\"" + e.to + "\" from \"" + e.from + "\"" + (e.place.empty() ? "" : " (" + e.place + ")");
}

std::string fault_words(std::span<const FrameEdge> edges, const FrameFault& f) {
  const FrameEdge& e = edges[f.edge];
  const std::string link = link_words(e);
  switch (f.mistake) {
    case FrameMistake::inverted: return link + " is inverted, or the names of its two frames are swapped";
    case FrameMistake::rotation_inverted: return link + " has its rotation inverted, but not its translation";
    case FrameMistake::mirrored: return link + format(" is left-handed: %c counts the other way", f.axis);
    case FrameMistake::flipped_from:
      return link + format(" has axes of \"%s\" flipped: half a turn about %c", e.from.c_str(), f.axis);
    case FrameMistake::flipped_to:
      return link + format(" has axes of \"%s\" flipped: half a turn about %c", e.to.c_str(), f.axis);
    case FrameMistake::millimetres: return link + " has its translation in millimetres, not metres";
    case FrameMistake::metres: return link + " has a translation a thousand times too small";
    case FrameMistake::scalar_last: return link + " has its quaternion written x, y, z, w, not w, x, y, z";
    case FrameMistake::exchanged: break;
  }
  return link + " and " + link_words(edges[f.other]) + " are exchanged: left for right";
}

std::string sentence_of(std::span<const FrameEdge> edges, const LoopCheck& check,
                        const std::vector<std::size_t>& suspects) {
  const std::size_t worst = *std::ranges::min_element(check.broken, {}, [&](std::size_t l) { return check.p[l]; });
  std::string sentence =
      format("%zu of %zu loops of frames do%s not close (worst: off by %.4g mm and %.4g degrees, p = %.2g): ",
             check.broken.size(), check.loops.size(), check.broken.size() == 1 ? "es" : "", 1e3 * check.shift_m[worst],
             180 / pi * check.turn_rad[worst], check.p[worst]);
  constexpr std::size_t most_named = 4;
  if (check.faults.empty()) {
    sentence += "no single mistake explains it; ";
    for (std::size_t k = 0; k < std::min(suspects.size(), most_named); ++k)
      sentence += (k > 0 ? ", or " : "look at ") + link_words(edges[suspects[k]]);
    return sentence +
           (suspects.size() > most_named ? format(", or one of %zu more", suspects.size() - most_named) : "");
  }
  for (std::size_t k = 0; k < std::min(check.faults.size(), most_named); ++k)
    sentence += (k > 0 ? "; or " : "") + fault_words(edges, check.faults[k]);
  return sentence;
}

}  // namespace

Motion mended(const Motion& m, FrameMistake mistake, char axis) {
  const Quaternion& q = m.rotation;
  switch (mistake) {
    case FrameMistake::inverted: return inverse(m);
    case FrameMistake::rotation_inverted: return {conjugate(q), m.translation_m};
    case FrameMistake::mirrored: {  // S R S, S t: the axis of the turn is mirrored and its sense with it
      const Vec3 v = -mirrored_vector({q.x, q.y, q.z}, axis);
      return {{q.w, v.x, v.y, v.z}, mirrored_vector(m.translation_m, axis)};
    }
    case FrameMistake::flipped_from: return m * half_turn(axis);
    case FrameMistake::flipped_to: return half_turn(axis) * m;
    case FrameMistake::millimetres: return {q, m.translation_m * 1e-3};
    case FrameMistake::metres: return {q, m.translation_m * 1e3};
    case FrameMistake::scalar_last:  // read as w, x, y, z was x, y, z, w
      return {{q.z, q.w, q.x, q.y}, m.translation_m};
    case FrameMistake::exchanged: break;
  }
  return m;
}

LoopCheck check_loops(std::span<const FrameEdge> edges, double false_alarm) {
  LoopCheck check;
  check.loops = fundamental_loops(edges);
  if (check.loops.empty()) {
    check.remark = format("the frames make no loop: nothing checks their %zu links", edges.size());
    return check;
  }
  const double limit_p = false_alarm / static_cast<double>(check.loops.size());
  for (std::size_t l = 0; l < check.loops.size(); ++l) {
    const Closure closure = closure_of(edges, check.loops[l]);
    check.turn_rad.push_back(norm(closure.turn_rad));
    check.shift_m.push_back(norm(closure.shift_m));
    check.p.push_back(stats::chi2_upper(closure.chi_square(), 6));
    if (!(check.p.back() >= limit_p)) check.broken.push_back(l);
  }
  if (check.broken.empty()) return check;
  Diagnosis diagnosis(edges, check, limit_p);
  check.faults = diagnosis.faults();
  check.sentence = sentence_of(edges, check, diagnosis.suspects());
  return check;
}

}  // namespace gonio::manifest
