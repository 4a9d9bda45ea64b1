// See rim.h.
#include "alignment/rim.h"

#include <algorithm>
#include <cmath>

namespace gonio::alignment {
namespace {

double cross_of(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}

// Segments by the square cells of a grid that they touch (their boxes', cut into stretches along the longer side).
class Cells {
 public:
  Cells(std::span<const Segment> segments) : segments_(segments) {
    double length = 0;
    lower_ = {HUGE_VAL, HUGE_VAL}, upper_ = {-HUGE_VAL, -HUGE_VAL};
    for (const Segment& s : segments) {
      length += norm(s.to - s.from);
      for (const Vec2 p : {s.from, s.to}) {
        lower_ = {std::min(lower_.x, p.x), std::min(lower_.y, p.y)};
        upper_ = {std::max(upper_.x, p.x), std::max(upper_.y, p.y)};
      }
    }
    const double mean = length / static_cast<double>(segments.size());
    const double extent = std::max({upper_.x - lower_.x, upper_.y - lower_.y, 1e-300});
    size_ = std::clamp(2 * mean, extent / 512, extent);
    columns_ = 1 + static_cast<int>((upper_.x - lower_.x) / size_),
    rows_ = 1 + static_cast<int>((upper_.y - lower_.y) / size_);
    fill();
  }
  // Of every pair of segments that share a cell, once per cell.
  template <class Visit>
  void pairs(const Visit& visit) const {
    for (std::size_t c = 0; c + 1 < starts_.size(); ++c)
      for (std::uint32_t i = starts_[c]; i < starts_[c + 1]; ++i)
        for (std::uint32_t k = i + 1; k < starts_[c + 1]; ++k) visit(members_[i], members_[k]);
  }

 private:
  template <class Visit>
  void cells_of(const Segment& s, const Visit& visit) const {
    const Vec2 way = s.to - s.from;
    const int parts = 1 + static_cast<int>(std::max(std::abs(way.x), std::abs(way.y)) / size_);
    const double slack = 1e-9 * size_;
    int seen_x0 = -1, seen_x1 = -1, seen_y0 = -1, seen_y1 = -1;
    for (int p = 0; p < parts; ++p) {
      const Vec2 a = s.from + way * (static_cast<double>(p) / parts),
                 b = s.from + way * (static_cast<double>(p + 1) / parts);
      const int x0 = column(std::min(a.x, b.x) - slack), x1 = column(std::max(a.x, b.x) + slack);
      const int y0 = row(std::min(a.y, b.y) - slack), y1 = row(std::max(a.y, b.y) + slack);
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x)
          if (!(x >= seen_x0 && x <= seen_x1 && y >= seen_y0 && y <= seen_y1))
            visit(static_cast<std::size_t>(y) * columns_ + x);
      seen_x0 = x0, seen_x1 = x1, seen_y0 = y0, seen_y1 = y1;
    }
  }
  int column(double x) const { return std::clamp(static_cast<int>((x - lower_.x) / size_), 0, columns_ - 1); }
  int row(double y) const { return std::clamp(static_cast<int>((y - lower_.y) / size_), 0, rows_ - 1); }
  void fill() {
    starts_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (const Segment& s : segments_) cells_of(s, [&](std::size_t c) { ++starts_[c + 1]; });
    for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    members_.resize(starts_.back());
    std::vector<std::uint32_t> at(starts_.begin(), starts_.end() - 1);
    for (std::uint32_t i = 0; i < segments_.size(); ++i)
      cells_of(segments_[i], [&](std::size_t c) { members_[at[c]++] = i; });
  }

  std::span<const Segment> segments_;
  Vec2 lower_, upper_;
  double size_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> starts_, members_;
};

// Segments by the strips along one axis that they reach into, for lines from far away: `along` 0 lines of constant y,
// which come from small x; 1 of constant x, from small y.
class Strips {
 public:
  Strips(std::span<const Segment> segments, int along) : segments_(segments), along_(along) {
    lower_ = HUGE_VAL;
    double upper = -HUGE_VAL;
    for (const Segment& s : segments)
      for (const Vec2 p : {s.from, s.to}) lower_ = std::min(lower_, level(p)), upper = std::max(upper, level(p));
    tie_ = 1e-11 * (std::abs(lower_) + std::abs(upper) + 1);
    const double count = std::clamp(static_cast<double>(segments.size()), 1.0, 4096.0);
    size_ = std::max((upper - lower_) / count, 1e-300);
    strips_ = 1 + static_cast<std::size_t>((upper - lower_) / size_);
    starts_.assign(strips_ + 1, 0);
    for (const Segment& s : segments) each(s, [&](std::size_t c) { ++starts_[c + 1]; });
    for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    members_.resize(starts_.back());
    std::vector<std::uint32_t> at(starts_.begin(), starts_.end() - 1);
    for (std::uint32_t i = 0; i < segments.size(); ++i)
      each(segments[i], [&](std::size_t c) { members_[at[c]++] = i; });
  }
  // How often the place just before `p` on its line is covered; the segment `own`, on which it lies, does not count. Of
  // segments that lie on each other, as far as rounding tells, those with smaller numbers come first.
  int before(Vec2 p, std::uint32_t own) const {
    const double at = level(p), reach = along_ == 0 ? p.x : p.y;
    const std::size_t strip = strip_of(at);
    int covered = 0;
    for (std::uint32_t i = starts_[strip]; i < starts_[strip + 1]; ++i) {
      if (members_[i] == own) continue;
      const Segment& s = segments_[members_[i]];
      const double from = level(s.from), to = level(s.to);
      if ((from > at) == (to > at)) continue;
      const double share = (at - from) / (to - from);
      const double where =
          along_ == 0 ? s.from.x + share * (s.to.x - s.from.x) : s.from.y + share * (s.to.y - s.from.y);
      if (std::abs(where - reach) < tie_ ? members_[i] < own : where < reach) covered += enters(s) ? s.jump : -s.jump;
    }
    return covered;
  }
  // Does a line that comes from far away go over `s` from its right to its left?
  bool enters(const Segment& s) const { return along_ == 0 ? s.to.y < s.from.y : s.to.x > s.from.x; }

 private:
  double level(Vec2 p) const { return along_ == 0 ? p.y : p.x; }
  std::size_t strip_of(double at) const {
    return std::min(strips_ - 1, static_cast<std::size_t>(std::max(0.0, (at - lower_) / size_)));
  }
  template <class Visit>
  void each(const Segment& s, const Visit& visit) const {
    const double a = level(s.from), b = level(s.to);
    for (std::size_t c = strip_of(std::min(a, b)); c <= strip_of(std::max(a, b)); ++c) visit(c);
  }

  std::span<const Segment> segments_;
  int along_;
  double lower_, size_, tie_ = 0;
  std::size_t strips_;
  std::vector<std::uint32_t> starts_, members_;
};

// Shares at which segments cross, by segment: pairs of both numbers are added.
void cross_at(const Segment& a, const Segment& b, std::uint32_t i, std::uint32_t k,
              std::vector<std::pair<std::uint32_t, double>>& cuts) {
  const Vec2 u = a.to - a.from, v = b.to - b.from, w = b.from - a.from;
  const double det = cross_of(u, v);
  if (det == 0) return;
  const double s = cross_of(w, v) / det, t = cross_of(w, u) / det;
  if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return;
  if (s > 0 && s < 1) cuts.push_back({i, s});
  if (t > 0 && t < 1) cuts.push_back({k, t});
}

}  // namespace

std::vector<RimPiece> rim_of(std::span<const Segment> segments) {
  std::vector<RimPiece> rim;
  if (segments.empty()) return rim;
  std::vector<std::pair<std::uint32_t, double>> cuts;
  Cells(segments).pairs([&](std::uint32_t i, std::uint32_t k) { cross_at(segments[i], segments[k], i, k, cuts); });
  std::sort(cuts.begin(), cuts.end());
  const Strips level(segments, 0), upright(segments, 1);
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    const Segment& s = segments[i];
    const Vec2 way = s.to - s.from;
    const double length = norm(way);
    if (!(length > 0)) {
      while (next < cuts.size() && cuts[next].first == i) ++next;
      continue;
    }
    const Strips& lines = std::abs(way.y) >= std::abs(way.x) ? level : upright;
    const bool enters = lines.enters(s);
    for (double start = 0; start < 1;) {
      double end = 1;
      if (next < cuts.size() && cuts[next].first == i) end = cuts[next++].second;
      if ((end - start) * length > 1e-9) {
        const int covered = lines.before(s.from + way * (0.5 * (start + end)), i);
        const int right = enters ? covered : covered - s.jump;
        if (right <= 0) {
          const RimPiece piece{i, start, end, s.from + way * start, s.from + way * end};
          if (!rim.empty() && rim.back().segment == i && rim.back().end == start)
            rim.back().end = end, rim.back().to = piece.to;
          else
            rim.push_back(piece);
        }
        start = end;
      } else if (end == 1) {
        break;
      } else {
        start = end;
      }
    }
  }
  return rim;
}

Moments moments_of(std::span<const RimPiece> pieces, Vec2 origin) {
  // The region is a sum of triangles from the origin to each piece; of one with corners 0, a, b and twice its area D,
  // int x^p y^q follows from its corners (Steger 1996, On the calculation of arbitrary moments of polygons).
  Moments m;
  for (const RimPiece& piece : pieces) {
    const Vec2 a = piece.from - origin, b = piece.to - origin;
    const double d = cross_of(a, b);
    m.m00 += d / 2;
    m.m10 += d * (a.x + b.x) / 6, m.m01 += d * (a.y + b.y) / 6;
    m.m20 += d * (a.x * a.x + a.x * b.x + b.x * b.x) / 12;
    m.m02 += d * (a.y * a.y + a.y * b.y + b.y * b.y) / 12;
    m.m11 += d * (2 * a.x * a.y + a.x * b.y + b.x * a.y + 2 * b.x * b.y) / 24;
    m.m30 += d * (a.x + b.x) * (a.x * a.x + b.x * b.x) / 20;
    m.m03 += d * (a.y + b.y) * (a.y * a.y + b.y * b.y) / 20;
    m.m21 += d * (a.x * a.x * (3 * a.y + b.y) + 2 * a.x * b.x * (a.y + b.y) + b.x * b.x * (a.y + 3 * b.y)) / 60;
    m.m12 += d * (a.y * a.y * (3 * a.x + b.x) + 2 * a.y * b.y * (a.x + b.x) + b.y * b.y * (a.x + 3 * b.x)) / 60;
  }
  return m;
}

}  // namespace gonio::alignment
