// Outlines of samples and the order of their corners (contrast/measure/sample_outline.h).
#include "contrast/measure/sample_outline.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "contrast/measure/cell_reading.h"
#include "contrast/measure/matrix_code.h"
#include "contrast/measure/view_map.h"
#include "linear/solve.h"
#include "stats/intervals.h"

namespace gonio::contrast {
namespace {

constexpr double stands_out = 6, least_level = 0.01;     // rim's scatters; share of the brightest deviation
constexpr double grid_px = 0.03;                         // what the grid of pixels may leave of an edge's place
constexpr double least_fill = 0.8, most_widening = 1.1;  // of the four-sided figure by the piece, over its hull
constexpr double least_side_px = 12, least_inliers = 0.6;

struct Rim {
  double level = 0, scatter = 0;
};
Rim rim_of(const GreyView& view) {
  std::vector<double> values;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      if (std::min({x, y, view.width - 1 - x, view.height - 1 - y}) < 2)
        if (const float v = view.value[static_cast<std::size_t>(y * view.width + x)]; std::isfinite(v))
          values.push_back(v);
  return {stats::median(values), stats::robust_sigma(values)};
}

// The hull of the largest piece, and its pixels; empty hull: nothing stands out.
struct Piece {
  std::vector<cv::Point> hull;
  double pixels = 0;
};
Piece largest_piece(const GreyView& view, const Rim& rim) {
  cv::Mat deviation(view.height, view.width, CV_32F);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const float v = view.value[static_cast<std::size_t>(y * view.width + x)];
      deviation.at<float>(y, x) = std::isfinite(v) ? v - static_cast<float>(rim.level) : 0;
    }
  cv::blur(deviation, deviation, {3, 3});
  deviation = cv::abs(deviation);
  double most = 0;
  cv::minMaxLoc(deviation, nullptr, &most);
  const cv::Mat mask = deviation > std::max(stands_out / 3 * rim.scatter, least_level * most);  // of 9 pixels' mean
  cv::Mat labels, boxes, middles;
  const int pieces = cv::connectedComponentsWithStats(mask, labels, boxes, middles, 8);
  Piece best;
  double area = 0;
  for (int k = 1; k < pieces; ++k) {
    const auto box = [&](int what) { return boxes.at<int>(k, what); };
    const int left = box(cv::CC_STAT_LEFT), top = box(cv::CC_STAT_TOP);
    if (left == 0 || top == 0 || left + box(cv::CC_STAT_WIDTH) == view.width ||
        top + box(cv::CC_STAT_HEIGHT) == view.height || box(cv::CC_STAT_AREA) < area)
      continue;
    std::vector<cv::Point> points;
    cv::findNonZero(labels == k, points);
    Piece piece{{}, double(points.size())};
    cv::convexHull(points, piece.hull);
    if (const double hull = cv::contourArea(piece.hull); hull > area) {
      area = hull;
      best = piece;
    }
  }
  return best;
}

double area_of(const std::vector<Vec2>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

std::optional<Vec2> meeting(Vec2 a, Vec2 along_a, Vec2 b, Vec2 along_b) {
  const double across = along_a.x * along_b.y - along_a.y * along_b.x;
  if (std::abs(across) < 1e-9 * norm(along_a) * norm(along_b)) return std::nullopt;
  const Vec2 d = b - a;
  return a + along_a * ((d.x * along_b.y - d.y * along_b.x) / across);
}

// The polygon without its side i to i + 1, whose neighbours run on until they meet; nothing where they part.
std::optional<std::vector<Vec2>> without_side(const std::vector<Vec2>& p, std::size_t i) {
  const std::size_t n = p.size();
  const Vec2 before = p[(i + n - 1) % n], a = p[i], b = p[(i + 1) % n], after = p[(i + 2) % n];
  const auto at = meeting(before, a - before, after, b - after);
  if (!at || dot(*at - a, a - before) < 0 || dot(*at - b, b - after) < 0) return std::nullopt;
  std::vector<Vec2> rest;
  for (std::size_t k = 0; k < n; ++k) {
    if (k == i) rest.push_back(*at);
    if (k != i && k != (i + 1) % n) rest.push_back(p[k]);
  }
  return rest;
}

std::vector<Vec2> four_sided(std::vector<Vec2> polygon) {
  while (polygon.size() > 4) {
    std::vector<Vec2> best;
    for (std::size_t i = 0; i < polygon.size(); ++i)
      if (const auto rest = without_side(polygon, i); rest && (best.empty() || area_of(*rest) < area_of(best)))
        best = *rest;
    if (best.empty()) return {};
    polygon = best;
  }
  return polygon;
}

double value_at(const GreyView& view, Vec2 p) {  // bilinear; NaN outside
  const double fx = std::floor(p.x), fy = std::floor(p.y), s = p.x - fx, t = p.y - fy;
  const int x = static_cast<int>(fx), y = static_cast<int>(fy);
  if (x < 0 || y < 0 || x + 1 >= view.width || y + 1 >= view.height) return std::nan("");
  const auto v = [&](int dx, int dy) {
    return double{view.value[static_cast<std::size_t>((y + dy) * view.width + x + dx)]};
  };
  return (1 - t) * ((1 - s) * v(0, 0) + s * v(1, 0)) + t * ((1 - s) * v(0, 1) + s * v(1, 1));
}

// Along `outward` from -reach to reach px: how far the edge lies from the middle. As far from the inner end as the
// brightness between both ends' levels, integrated, says: pixels keep integrals, so that it does not matter where on
// the edge their borders fall, as it does (by up to 0.09 px) for the passage through the level half way.
std::optional<double> edge_near(const GreyView& view, Vec2 middle, Vec2 outward, double reach, double least_step) {
  constexpr double pace = 0.25;
  const int half = static_cast<int>(std::lround(reach / pace)), third = std::max(1, half / 3);
  std::vector<double> v;
  for (int k = -half; k <= half; ++k) v.push_back(value_at(view, middle + outward * (k * pace)));
  double inside = 0, outside = 0;
  for (int k = 0; k < third; ++k) {
    inside += v[static_cast<std::size_t>(k)] / third;
    outside += v[v.size() - 1 - static_cast<std::size_t>(k)] / third;
  }
  if (!(std::abs(inside - outside) > least_step)) return std::nullopt;
  double covered = 0;
  for (std::size_t k = 0; k + 1 < v.size(); ++k)
    covered += ((v[k] + v[k + 1]) / 2 - outside) / (inside - outside) * pace;
  return std::isfinite(covered) ? std::optional(covered - half * pace) : std::nullopt;
}

struct Line {  // at + direction * t; offset's covariance as a function of t
  Vec2 at, direction;
  double v00 = 0, v01 = 0, v11 = 0;
  double variance(Vec2 p) const {
    const double t = dot(p - at, direction);
    return v00 + 2 * v01 * t + v11 * t * t;
  }
};

// Through points about a chord: offset = a + b t, robustly. Neighbours share pixels: each counts half.
std::optional<Line> line_through(const std::vector<Vec2>& points, Vec2 from, Vec2 to) {
  const Vec2 along = (to - from) * (1 / norm(to - from)), normal{-along.y, along.x}, middle = (from + to) * 0.5;
  std::vector<double> weight(points.size(), 1), size(points.size());
  Eigen::Vector2d line = Eigen::Vector2d::Zero();
  Eigen::Matrix2d sums;
  double scatter = 0;
  for (int round = 0; round < 20; ++round) {
    sums.setZero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d row(1, dot(points[i] - middle, along));
      sums += weight[i] * row * row.transpose();
      right += weight[i] * row * dot(points[i] - middle, normal);
    }
    if (!(sums.determinant() > 0)) return std::nullopt;
    line = linear::solve_ldlt(sums, right);
    const auto residual = [&](std::size_t i) {
      return dot(points[i] - middle, normal) - line(0) - line(1) * dot(points[i] - middle, along);
    };
    for (std::size_t i = 0; i < points.size(); ++i) size[i] = std::abs(residual(i));
    scatter = std::max(stats::sigma_of_median * stats::median(size), 1e-3);
    for (std::size_t i = 0; i < points.size(); ++i)
      weight[i] = std::pow(std::max(0.0, 1 - std::pow(size[i] / (4.685 * scatter), 2)), 2);
  }
  const auto inliers = std::ranges::count_if(size, [&](double r) { return r < 4.685 * scatter; });
  if (static_cast<double>(inliers) < least_inliers * static_cast<double>(points.size()) || scatter > 1)
    return std::nullopt;
  const Eigen::Matrix2d covariance = 2 * scatter * scatter * sums.inverse();
  const Vec2 direction = along + normal * line(1);
  return Line{middle + normal * line(0), direction * (1 / norm(direction)), covariance(0, 0), covariance(0, 1),
              covariance(1, 1)};
}

// Pixels to where a straight line stays straight, in units of a pixel: rays of the camera, or the picture itself.
struct Straight {
  const std::optional<camera::CameraModel>& camera;
  double scale = 1;
  Straight(const std::optional<camera::CameraModel>& c, Vec2 a, Vec2 b) : camera(c) {
    if (const double size = central() ? norm(ray(a) - ray(b)) : 0; size > 0) scale = norm(a - b) / size;
  }
  bool central() const { return camera && !camera->orthographic(); }
  Vec2 ray(Vec2 pixel) const {
    const Vec3 d = camera->ray(pixel).direction;
    return {d.x / d.z, d.y / d.z};
  }
  Vec2 of(Vec2 pixel) const { return central() ? ray(pixel) * scale : pixel; }
  std::optional<Vec2> pixel(Vec2 q) const {
    if (!central()) return q;
    return camera->project({q.x / scale, q.y / scale, 1});
  }
};

// Twice: about the hull's side, which lies beside the edge by the blur, and then about the edge.
std::optional<Line> side_line(const GreyView& view, const Straight& straight, Vec2 from, Vec2 to, double reach,
                              double least_step) {
  const double length = norm(to - from);
  const Vec2 along = (to - from) * (1 / length), outward{along.y, -along.x};  // clockwise as seen: outside is left
  std::vector<Vec2> points;
  double beside = 0;
  for (const bool again : {false, true}) {
    points.clear();
    std::vector<double> offsets;
    int looked = 0;
    for (double t = 0.05 * length; t <= 0.95 * length; t += 1, ++looked) {
      const Vec2 middle = from + along * t + outward * beside;
      const auto edge = edge_near(view, middle, outward, reach, least_step);
      if (!edge) continue;
      offsets.push_back(*edge);
      points.push_back(straight.of(middle + outward * *edge));
    }
    if (static_cast<double>(points.size()) < least_inliers * looked || points.size() < 6) return std::nullopt;
    if (!again) beside = stats::median(offsets);
  }
  return line_through(points, straight.of(from), straight.of(to));
}

std::optional<OutlineCorners> corners_of(const std::array<Line, 4>& sides, const Straight& straight) {
  OutlineCorners corners;
  for (std::size_t k = 0; k < 4; ++k) {  // where the side before meets the side from k on
    const Line &a = sides[(k + 3) % 4], &b = sides[k];
    const auto at = meeting(a.at, a.direction, b.at, b.direction);
    const auto pixel = at ? straight.pixel(*at) : std::nullopt;
    if (!pixel) return std::nullopt;
    const double sine = a.direction.x * b.direction.y - a.direction.y * b.direction.x;
    corners.pixel[k] = *pixel;
    corners.sigma_px[k] = std::sqrt((a.variance(*at) + b.variance(*at)) / (2 * sine * sine) + grid_px * grid_px);
  }
  return corners;
}

// How well the pattern goes together with the cells: the size of the correlation with its bits, or the share of the
// finder that is seen, whichever of its two kinds is the brighter.
double agreement(const CellPattern& pattern, const CellMeans& means, bool data_matrix) {
  if (!pattern.known()) {
    CellPattern read = pattern;
    read.bits = split_cells(pattern, {&means}, {0});
    if (!read.known() || !data_matrix) return 0;
    Bits bits{read.rows, read.columns, read.bits};
    const double as_seen = finder_share(bits);
    for (std::uint8_t& bit : bits.bits) bit ^= 1;
    return std::max(as_seen, finder_share(bits));
  }
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  double n = 0;
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    if (!std::isfinite(means.mean[cell])) continue;
    const Eigen::Vector2d row(means.mean[cell], pattern.bits[cell]);
    sum += row;
    squares += row * row.transpose();
    ++n;
  }
  const Eigen::Matrix2d spread = squares - sum * sum.transpose() / n;
  const double both = spread(0, 0) * spread(1, 1);
  return both > 0 ? std::abs(spread(0, 1)) / std::sqrt(both) : 0;
}

}  // namespace

OutlineFound find_outline(const GreyView& view, const std::optional<camera::CameraModel>& camera, int cells) {
  const Rim rim = rim_of(view);
  const Piece piece = largest_piece(view, rim);
  if (piece.hull.size() < 4)
    return {std::nullopt, "the sample's outline does not stand out from the picture's rim, or reaches it"};
  std::vector<Vec2> hull;
  for (const cv::Point p : piece.hull) hull.push_back({double(p.x), double(p.y)});
  if (area_of(hull) < 0) std::ranges::reverse(hull);
  const double area = area_of(hull);
  const std::vector<Vec2> four = four_sided(hull);
  if (four.size() != 4 || area_of(four) > most_widening * area || piece.pixels < least_fill * area_of(four))
    return {std::nullopt, "what stands out from the picture's rim has not four sides"};
  double shortest = 1e9;
  for (std::size_t k = 0; k < 4; ++k) shortest = std::min(shortest, norm(four[(k + 1) % 4] - four[k]));
  if (shortest < least_side_px) return {std::nullopt, format("the sample's outline has a side of %.3g px", shortest)};
  const double reach = std::clamp(shortest / cells / 3, 2.5, 6.0);
  const Straight straight(camera, four[0], four[2]);
  std::array<Line, 4> sides;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto line = side_line(view, straight, four[k], four[(k + 1) % 4], reach, 4 * rim.scatter);
    if (!line) return {std::nullopt, "a side of the sample's outline is not straight, or too faint"};
    sides[k] = *line;
  }
  return {corners_of(sides, straight), "the sides of the sample's outline do not meet in the picture"};
}

OutlineFound number_corners(const GreyView& view, const CellPattern& pattern, bool data_matrix,
                            const OutlineCorners& corners) {
  constexpr double inner = 0.6, clear = 0.1;
  std::array<double, 4> how_well{};
  std::array<OutlineCorners, 4> turned;
  for (std::size_t turn = 0; turn < 4; ++turn) {
    std::array<Vec2, 4> plane;
    for (std::size_t k = 0; k < 4; ++k) {
      plane[k] = pattern.corner_m(static_cast<int>(k));
      turned[turn].pixel[k] = corners.pixel[(k + turn) % 4];
      turned[turn].sigma_px[k] = corners.sigma_px[(k + turn) % 4];
    }
    const ViewMap map(homography(plane, turned[turn].pixel));
    how_well[turn] = agreement(pattern, cell_means(view, pattern, map, inner), data_matrix);
  }
  const auto best = static_cast<std::size_t>(std::ranges::max_element(how_well) - how_well.begin());
  std::array<double, 4> sorted = how_well;
  std::ranges::sort(sorted);
  const double least = pattern.known() ? 0.5 : 0.9;
  if (sorted[3] < least || sorted[3] - sorted[2] < clear)
    return {std::nullopt,
            format("the sample's outline was found, but not which of its corners is corner 0: of the four "
                   "ways the two best agree by %.2f and %.2f with the pattern",
                   sorted[3], sorted[2])};
  return {turned[best], ""};
}

}  // namespace gonio::contrast
