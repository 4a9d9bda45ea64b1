// Circles of all sizes by the votes of edges: every edge votes for centres on both sides of it along its gradient
// (Kimme, Ballard & Sklansky, "Finding circles by an array of accumulators", CACM 18(2), 1975), at every level of a
// pyramid for one octave of radii, so that a vote is as sharp at every size.
//
// The votes are cast in a stereographic picture of the sphere of directions, about the picture's middle: it maps every
// circular cone to a circle exactly, whatever the lens does to it in pixels and however far from the axis.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "linear/positive.h"
#include "reassembly/detect_parts.h"

namespace gonio::reassembly {

namespace {

class Stereographic {
 public:
  explicit Stereographic(const camera::CameraModel& camera);
  // Place (full pixels of the stereographic picture) and unit normal of an edge with the gradient `g` at `pixel`.
  void map(Vec2 pixel, Vec2 g, Vec2& place, Vec2& normal) const;
  Vec3 ray(Vec2 place) const {
    const double x = place.x / (2 * focal_), y = place.y / (2 * focal_), q = x * x + y * y;
    return basis_.to_world(Vec3{2 * x, 2 * y, 1 - q} / (1 + q));
  }
  Vec2 lower() const { return lower_; }
  Vec2 upper() const { return upper_; }
  double least_scale() const { return least_; }  // its pixels per pixel of the picture
  double most_scale() const { return most_; }

 private:
  static constexpr int step = 16;
  Vec2 place(Vec3 ray) const {
    const Vec3 v = basis_.to_local(ray);
    const double k = 2 * focal_ / std::max(1 + v.z, 1e-3);
    return {k * v.x, k * v.y};
  }
  Basis basis_;
  double focal_ = 1, least_ = 1e30, most_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<Vec2> nodes_;
  Vec2 lower_{1e30, 1e30}, upper_{-1e30, -1e30};
};

Stereographic::Stereographic(const camera::CameraModel& camera)
    : basis_(camera.ray({(camera.width_px() - 1) / 2.0, (camera.height_px() - 1) / 2.0}).direction) {
  const Vec2 middle{(camera.width_px() - 1) / 2.0, (camera.height_px() - 1) / 2.0};
  focal_ = 1 / norm(camera.ray(middle + Vec2{0.5, 0}).direction - camera.ray(middle - Vec2{0.5, 0}).direction);
  columns_ = camera.width_px() / step + 3;
  rows_ = camera.height_px() / step + 3;
  nodes_.reserve(static_cast<std::size_t>(columns_) * rows_);
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x)
      nodes_.push_back(place(camera.ray({double((x - 1) * step), double((y - 1) * step)}).direction));
  for (int y = 1; y + 1 < rows_; ++y)
    for (int x = 1; x + 1 < columns_; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * columns_ + x;
      const Vec2 p = nodes_[i], dx = nodes_[i + 1] - p, dy = nodes_[i + columns_] - p;
      const double scale = std::sqrt(std::abs(dx.x * dy.y - dx.y * dy.x)) / step;
      least_ = std::min(least_, scale), most_ = std::max(most_, scale);
      lower_ = {std::min(lower_.x, p.x), std::min(lower_.y, p.y)};
      upper_ = {std::max(upper_.x, p.x), std::max(upper_.y, p.y)};
    }
}

void Stereographic::map(Vec2 pixel, Vec2 g, Vec2& place, Vec2& normal) const {
  const double u = pixel.x / step + 1, v = pixel.y / step + 1;
  const int x = std::clamp(static_cast<int>(u), 0, columns_ - 2), y = std::clamp(static_cast<int>(v), 0, rows_ - 2);
  const double a = u - x, b = v - y;
  const Vec2* node = &nodes_[static_cast<std::size_t>(y) * columns_ + x];
  const Vec2 p00 = node[0], p10 = node[1], p01 = node[columns_], p11 = node[columns_ + 1];
  const Vec2 top = p00 + (p10 - p00) * a, bottom = p01 + (p11 - p01) * a;
  place = top + (bottom - top) * b;
  const Vec2 dx = (p10 - p00) * (1 - b) + (p11 - p01) * b, dy = bottom - top;
  // Gradients go by the inverse transpose of the map's Jacobian [dx dy], up to its determinant.
  const Vec2 n{dy.y * g.x - dx.y * g.y, -dy.x * g.x + dx.x * g.y};
  normal = n * ((dx.x * dy.y - dx.y * dy.x > 0 ? 1 : -1) / std::max(norm(n), 1e-30));
}

struct VotingEdge {
  float x, y, nx, ny;  // pixels of the level in the stereographic picture, unit normal towards the brighter side
};

// Edges: maxima of the gradient along its direction, below the pixel by a parabola. The 5 x 5 Sobel operator smooths
// like a Gaussian of one pixel; a ramp of slope 1 answers 128.
std::vector<VotingEdge> voting_edges(const PictureLevel& level, double least_gradient, const Stereographic& plane) {
  cv::Mat dx, dy;
  cv::Sobel(level.bytes, dx, CV_16S, 1, 0, 5);
  cv::Sobel(level.bytes, dy, CV_16S, 0, 1, 5);
  const double least = 128 * least_gradient;
  const float least2 = static_cast<float>(least * least);
  std::vector<VotingEdge> edges;
  for (int y = 2; y + 2 < dx.rows; ++y) {
    const std::int16_t* gx[3] = {dx.ptr<std::int16_t>(y - 1), dx.ptr<std::int16_t>(y), dx.ptr<std::int16_t>(y + 1)};
    const std::int16_t* gy[3] = {dy.ptr<std::int16_t>(y - 1), dy.ptr<std::int16_t>(y), dy.ptr<std::int16_t>(y + 1)};
    const unsigned char* usable = level.usable.empty() ? nullptr : level.usable.ptr<unsigned char>(y);
    const auto square = [&](int row, int column) {
      const float a = gx[row][column], b = gy[row][column];
      return a * a + b * b;
    };
    for (int x = 2; x + 2 < dx.cols; ++x) {
      const float m = square(1, x);
      if (m < least2 || (usable != nullptr && usable[x] == 0)) continue;
      const float a = gx[1][x], b = gy[1][x];
      const bool flat = std::abs(a) >= std::abs(b);
      const float slope = flat ? b / a : a / b, share = std::abs(slope);
      const int s = slope < 0 ? -1 : 1;
      float before, after;
      if (flat) {
        after = (1 - share) * square(1, x + 1) + share * square(1 + s, x + 1);
        before = (1 - share) * square(1, x - 1) + share * square(1 - s, x - 1);
      } else {
        after = (1 - share) * square(2, x) + share * square(2, x + s);
        before = (1 - share) * square(0, x) + share * square(0, x - s);
      }
      if (!(m > before && m >= after)) continue;
      const double bend = before - 2.0 * m + after, by = bend < 0 ? 0.5 * (before - after) / bend : 0;
      const Vec2 at = flat ? Vec2{x + by, y + slope * by} : Vec2{x + slope * by, y + by};
      Vec2 place, normal;
      plane.map(level.to_full(at), {a, b}, place, normal);
      edges.push_back({static_cast<float>(place.x / level.scale), static_cast<float>(place.y / level.scale),
                       static_cast<float>(normal.x), static_cast<float>(normal.y)});
    }
  }
  return edges;
}

// The edges of a level, sorted into cells.
struct EdgeCells {
  static constexpr int cell = 8;
  int columns = 0, rows = 0;
  double x0 = 0, y0 = 0;
  std::vector<VotingEdge> edges;
  std::vector<std::uint32_t> first;
};

EdgeCells into_cells(const std::vector<VotingEdge>& edges, Vec2 lower, Vec2 upper) {
  EdgeCells cells;
  cells.x0 = lower.x, cells.y0 = lower.y;
  cells.columns = static_cast<int>((upper.x - lower.x) / EdgeCells::cell) + 2;
  cells.rows = static_cast<int>((upper.y - lower.y) / EdgeCells::cell) + 2;
  cells.first.assign(static_cast<std::size_t>(cells.columns) * cells.rows + 1, 0);
  const auto index = [&](const VotingEdge& e) {
    const int x = std::clamp(static_cast<int>((e.x - lower.x) / EdgeCells::cell), 0, cells.columns - 1);
    const int y = std::clamp(static_cast<int>((e.y - lower.y) / EdgeCells::cell), 0, cells.rows - 1);
    return static_cast<std::size_t>(y) * cells.columns + x;
  };
  for (const VotingEdge& e : edges) ++cells.first[index(e) + 1];
  for (std::size_t i = 1; i < cells.first.size(); ++i) cells.first[i] += cells.first[i - 1];
  std::vector<std::uint32_t> next(cells.first.begin(), cells.first.end() - 1);
  cells.edges.resize(edges.size());
  for (const VotingEdge& e : edges) cells.edges[next[index(e)]++] = e;
  return cells;
}

struct PlaneCircle {
  Vec2 centre;
  double radius = 0, cover = 0;
};

// Circles about one peak of the votes. Edges that point to the centre or away from it are counted by radius and by
// sector; the radius with most sectors wins, and a circle through its edges (Kasa, 1976) corrects the centre.
class PeakJudge {
 public:
  PeakJudge(const EdgeCells& cells, int sign) : cells_(cells), sign_(sign) {}
  PlaneCircle judge(Vec2 centre, double from, double to) {
    PlaneCircle circle{centre, 0, 0};
    gather(centre, to + 3);
    if (!by_radius(circle, from - 1, to + 1)) return circle;
    for (int round = 0; round < 3; ++round)
      if (!correct(circle, std::max(1.0, (round == 0 ? 0.2 : 0.12) * circle.radius))) return circle;
    return circle;
  }

 private:
  void gather(Vec2 c, double reach);
  bool by_radius(PlaneCircle& circle, double from, double to) const;
  bool correct(PlaneCircle& circle, double tolerance) const;
  static int sectors(double radius) { return std::clamp(static_cast<int>(2 * pi * radius / 1.6), 14, 64); }
  const EdgeCells& cells_;
  int sign_;
  std::vector<VotingEdge> near_;
};

void PeakJudge::gather(Vec2 c, double reach) {
  near_.clear();
  const auto column = [&](double x) {
    return std::clamp(static_cast<int>((x - cells_.x0) / EdgeCells::cell), 0, cells_.columns - 1);
  };
  const auto row = [&](double y) {
    return std::clamp(static_cast<int>((y - cells_.y0) / EdgeCells::cell), 0, cells_.rows - 1);
  };
  for (int y = row(c.y - reach); y <= row(c.y + reach); ++y) {
    const std::size_t start = static_cast<std::size_t>(y) * cells_.columns;
    const std::uint32_t first = cells_.first[start + column(c.x - reach)];
    const std::uint32_t last = cells_.first[start + column(c.x + reach) + 1];
    for (std::uint32_t i = first; i < last; ++i) {
      const VotingEdge& e = cells_.edges[i];
      const double x = c.x - e.x, y2 = c.y - e.y, towards = sign_ * (x * e.nx + y2 * e.ny), d2 = x * x + y2 * y2;
      if (d2 < reach * reach && towards > 0 && towards * towards > 0.64 * d2) near_.push_back(e);
    }
  }
}

bool PeakJudge::by_radius(PlaneCircle& circle, double from, double to) const {
  constexpr double width = 0.5;
  std::array<std::uint64_t, 64> seen{};
  const int count = std::min(64, static_cast<int>((to - from) / width) + 1), parts = sectors((from + to) / 2);
  for (const VotingEdge& e : near_) {
    const double x = e.x - circle.centre.x, y = e.y - circle.centre.y;
    const int bin = static_cast<int>(std::floor((std::sqrt(x * x + y * y) - from) / width));
    if (bin < 0 || bin >= count) continue;
    const int part = static_cast<int>((std::atan2(y, x) / (2 * pi) + 0.5) * parts) % parts;
    seen[static_cast<std::size_t>(bin)] |= std::uint64_t{1} << part;
  }
  int best = 0;
  for (int i = 0; i < count; ++i) {
    std::uint64_t sum = seen[i];
    for (int j = std::max(0, i - 2); j <= std::min(count - 1, i + 2); ++j) sum |= seen[j];
    if (std::popcount(sum) <= best) continue;
    best = std::popcount(sum);
    circle.radius = from + (i + 0.5) * width;
  }
  return best >= 4;
}

bool PeakJudge::correct(PlaneCircle& circle, double tolerance) const {
  std::array<double, 9> h{}, inverse{};
  std::array<double, 3> g{};
  std::uint64_t seen = 0;
  const int parts = sectors(circle.radius);
  for (const VotingEdge& e : near_) {
    const double x = e.x - circle.centre.x, y = e.y - circle.centre.y, d = std::sqrt(x * x + y * y);
    if (std::abs(d - circle.radius) > tolerance || -sign_ * (x * e.nx + y * e.ny) < 0.9 * d) continue;
    seen |= std::uint64_t{1} << (static_cast<int>((std::atan2(y, x) / (2 * pi) + 0.5) * parts) % parts);
    const std::array<double, 3> row{2 * x, 2 * y, 1};
    for (std::size_t i = 0; i < 3; ++i) {
      g[i] += row[i] * (x * x + y * y);
      for (std::size_t j = 0; j < 3; ++j) h[3 * i + j] += row[i] * row[j];
    }
  }
  circle.cover = double(std::popcount(seen)) / parts;
  if (std::popcount(seen) < 4 || !linear::positive_inverse<3>(h, inverse)) return circle.cover = 0, false;
  std::array<double, 3> s{};
  for (std::size_t i = 0; i < 3; ++i)
    s[i] = inverse[3 * i] * g[0] + inverse[3 * i + 1] * g[1] + inverse[3 * i + 2] * g[2];
  const double square = s[2] + s[0] * s[0] + s[1] * s[1];
  const Vec2 step{s[0], s[1]};
  if (!(square > 0) || norm(step) > 0.7 * circle.radius) return circle.cover = 0, false;
  circle.centre = circle.centre + step;
  circle.radius = std::sqrt(square);
  return true;
}

struct Band {
  double from, to;
};

// One band of radii and one sign: votes, their peaks, and what the peaks are.
class Votes {
 public:
  Votes(const EdgeCells& cells, Vec2 lower, Vec2 upper)
      : cells_(cells),
        x0_(lower.x),
        y0_(lower.y),
        count_(static_cast<int>(upper.y - lower.y) + 3, static_cast<int>(upper.x - lower.x) + 3, CV_8U) {}
  std::vector<PlaneCircle> circles(Band band, int sign, double least_cover);

 private:
  void cast(Band band, int sign);
  const EdgeCells& cells_;
  double x0_, y0_;
  cv::Mat count_, sum_;
};

void Votes::cast(Band band, int sign) {
  count_.setTo(0);
  const int steps = static_cast<int>(std::ceil((band.to - band.from) / 0.8));
  const float step = static_cast<float>((band.to - band.from) / steps);
  const float x0 = static_cast<float>(x0_) - 1.5f, y0 = static_cast<float>(y0_) - 1.5f;
  const unsigned columns = static_cast<unsigned>(count_.cols), rows = static_cast<unsigned>(count_.rows);
  unsigned char* const data = count_.data;
  for (const VotingEdge& e : cells_.edges) {
    const float side = sign > 0 ? 1.0f : -1.0f, dx = side * e.nx, dy = side * e.ny,
                first = static_cast<float>(band.from) + step / 2;
    float x = e.x - x0 + first * dx, y = e.y - y0 + first * dy;
    for (int i = 0; i < steps; ++i, x += step * dx, y += step * dy) {
      const unsigned column = static_cast<unsigned>(static_cast<int>(x)),
                     row = static_cast<unsigned>(static_cast<int>(y));
      if (column >= columns || row >= rows) continue;
      unsigned char& c = data[static_cast<std::size_t>(row) * columns + column];
      c = static_cast<unsigned char>(c + (c < 255));
    }
  }
}

std::vector<PlaneCircle> Votes::circles(Band band, int sign, double least_cover) {
  cast(band, sign);
  cv::boxFilter(count_, sum_, CV_16U, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  // A whole circle gives 2 pi r votes, of which three in four fall within a pixel of its centre.
  const int least = std::max(5, static_cast<int>(0.75 * least_cover * 2 * pi * band.from));
  PeakJudge judge(cells_, sign);
  std::vector<PlaneCircle> circles;
  for (int y = 1; y + 1 < sum_.rows; ++y) {
    const std::uint16_t* row[3] = {sum_.ptr<std::uint16_t>(y - 1), sum_.ptr<std::uint16_t>(y),
                                   sum_.ptr<std::uint16_t>(y + 1)};
    for (int x = 1; x + 1 < sum_.cols; ++x) {
      const int c = row[1][x];
      if (c < least || row[1][x - 1] >= c || row[1][x + 1] > c || row[0][x] >= c || row[0][x - 1] >= c ||
          row[0][x + 1] >= c || row[2][x] > c || row[2][x - 1] > c || row[2][x + 1] > c)
        continue;
      const PlaneCircle circle = judge.judge({x + x0_ - 1, y + y0_ - 1}, band.from, band.to);
      if (circle.cover >= least_cover && circle.radius > 0.85 * band.from && circle.radius < 1.2 * band.to)
        circles.push_back(circle);
    }
  }
  return circles;
}

// Three points of the circle are three generators of the cone.
Cone cone_of(const PlaneCircle& circle, double scale, const Stereographic& plane) {
  std::array<Vec3, 3> ray;
  for (std::size_t i = 0; i < 3; ++i) {
    const double turn = 2 * pi * static_cast<double>(i) / 3;
    ray[i] = plane.ray((circle.centre + Vec2{std::cos(turn), std::sin(turn)} * circle.radius) * scale);
  }
  Vec3 axis = normalized(cross(ray[1] - ray[0], ray[2] - ray[0]));
  if (dot(axis, plane.ray(circle.centre * scale)) < 0) axis = -axis;
  return {axis, ConeFrame(axis).angle(ray[0])};
}

bool same_cone(const Cone& a, const Cone& b) {
  const double size = std::min(a.half_angle_rad, b.half_angle_rad);
  return norm(a.axis - b.axis) < 0.3 * size && std::abs(a.half_angle_rad - b.half_angle_rad) < 0.25 * size;
}

std::vector<OutlineCandidate> without_repeats(std::vector<OutlineCandidate> all) {
  std::sort(all.begin(), all.end(), [](const OutlineCandidate& a, const OutlineCandidate& b) {
    if (a.cover != b.cover) return a.cover > b.cover;
    if (a.level != b.level) return a.level < b.level;
    return a.cone.axis.x != b.cone.axis.x ? a.cone.axis.x < b.cone.axis.x : a.cone.axis.y < b.cone.axis.y;
  });
  std::vector<OutlineCandidate> kept;
  for (const OutlineCandidate& c : all) {
    bool known = false;
    for (const OutlineCandidate& k : kept) known = known || (k.sign == c.sign && same_cone(k.cone, c.cone));
    if (!known) kept.push_back(c);
  }
  return kept;
}

}  // namespace

std::vector<OutlineCandidate> circle_candidates(const Pyramid& pyramid, const camera::CameraModel& camera,
                                                const DetectWish& wish) {
  const Stereographic plane(camera);
  const double smallest = 0.8 * wish.smallest_px * plane.least_scale();
  const double largest = 1.25 * wish.largest_px * plane.most_scale();
  // An edge of the least contrast, blurred by one pixel and smoothed by another: C / (sqrt(2) sqrt(2 pi)).
  const double least_gradient = 0.6 * 0.28 * wish.least_contrast * pyramid.noise;
  std::vector<OutlineCandidate> all;
  for (std::size_t l = 0; l < pyramid.levels.size(); ++l) {
    const PictureLevel& level = pyramid.levels[l];
    std::vector<Band> bands{{6.1, 7.7}, {7.7, 9.7}, {9.7, 12.3}};
    if (l == 0) bands.insert(bands.begin(), {{2.6, 3.5}, {3.5, 4.6}, {4.6, 6.1}});
    std::erase_if(bands, [&](Band b) { return b.to * level.scale < smallest || b.from * level.scale > largest; });
    if (bands.empty()) continue;
    const Vec2 lower = plane.lower() * (1 / level.scale), upper = plane.upper() * (1 / level.scale);
    const EdgeCells cells = into_cells(voting_edges(level, least_gradient, plane), lower, upper);
    Votes votes(cells, lower, upper);
    // A large outline may be brighter than one thing behind it and darker than another: half of it may have the other
    // sign, which the fine fit finds again. Small ones are too many for that.
    for (const Band& band : bands)
      for (const int sign : {1, -1}) {
        if (wish.contrast == (sign > 0 ? Contrast::dark : Contrast::bright)) continue;
        for (const PlaneCircle& c : votes.circles(band, sign, (l == 0 ? 1.2 : l < 3 ? 0.9 : 0.6) * wish.least_cover))
          all.push_back({cone_of(c, level.scale, plane), sign, static_cast<int>(l), c.cover});
      }
  }
  return without_repeats(std::move(all));
}

}  // namespace gonio::reassembly
