// See patch_candidates.h.
#include "colour/patch_candidates.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <opencv2/imgproc.hpp>

namespace gonio::colour {
namespace {

constexpr double least_side = 6, most_share = 0.3;  // of a patch, px and of the picture's shorter side

bool quad_of(const std::vector<cv::Point>& contour, double most_side, Quad& quad) {
  const double area = std::abs(cv::contourArea(contour));
  if (area < least_side * least_side || area > most_side * most_side) return false;
  std::vector<cv::Point> hull, corners;
  cv::convexHull(contour, hull);
  const double full = cv::contourArea(hull);
  if (area < 0.85 * full) return false;
  const double around = cv::arcLength(hull, true);
  for (double tolerance = 0.03; tolerance < 0.13 && corners.size() != 4; tolerance += 0.02)
    cv::approxPolyDP(hull, corners, tolerance * around, true);
  if (corners.size() != 4 || cv::contourArea(corners) < 0.8 * full) return false;
  double shortest = HUGE_VAL, longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    quad.corners[i] = {static_cast<double>(corners[i].x), static_cast<double>(corners[i].y)};
    const double side = std::hypot(corners[i].x - corners[(i + 1) % 4].x, corners[i].y - corners[(i + 1) % 4].y);
    shortest = std::min(shortest, side), longest = std::max(longest, side);
  }
  if (longest > 4 * shortest) return false;
  const auto& c = quad.corners;
  if ((c[1].x - c[0].x) * (c[2].y - c[1].y) < (c[1].y - c[0].y) * (c[2].x - c[1].x))
    std::swap(quad.corners[1], quad.corners[3]);
  const cv::Moments m = cv::moments(hull);
  quad.centre = {m.m10 / m.m00, m.m01 / m.m00};
  quad.side = std::sqrt(full);
  return true;
}

void add_quads(const cv::Mat& binary, double most_side, std::vector<Quad>& quads) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(binary, contours, cv::RETR_LIST, cv::CHAIN_APPROX_SIMPLE);
  for (const auto& contour : contours) {
    Quad quad;
    if (contour.size() >= 4 && quad_of(contour, most_side, quad)) quads.push_back(quad);
  }
}

// One of each: quads of about one centre and size are one patch seen by several thresholds.
std::vector<Quad> distinct(std::vector<Quad> quads) {
  std::ranges::stable_sort(quads, [](const Quad& a, const Quad& b) { return a.side > b.side; });
  std::vector<Quad> kept;
  for (const Quad& quad : quads)
    if (std::ranges::none_of(kept, [&](const Quad& other) {
          return norm(other.centre - quad.centre) < 0.25 * quad.side && other.side < 1.35 * quad.side;
        }))
      kept.push_back(quad);
  return kept;
}

// A quad's sides from corner to corner, both pairs averaged: across and down, turned by `turn` quarters.
std::array<Vec2, 2> axes_of(const Quad& quad, int turn) {
  const auto corner = [&](int i) { return quad.corners[static_cast<std::size_t>((i + turn) % 4)]; };
  return {(corner(1) - corner(0) + corner(2) - corner(3)) * 0.5, (corner(3) - corner(0) + corner(2) - corner(1)) * 0.5};
}

class Growing {
 public:
  Growing(const std::vector<Quad>& quads, double share) : quads_(quads), share_(share), used_(quads.size()) {}
  Lattice from(std::size_t seed) {
    Lattice lattice;
    if (used_[seed]) return lattice;
    std::map<std::pair<int, int>, std::size_t> cells;
    struct Open {
      LatticeCell cell;
      std::array<Vec2, 2> step;  // to the next column, to the next row
    };
    std::deque<Open> open;
    const auto add = [&](LatticeCell cell, std::array<Vec2, 2> step) {
      used_[cell.quad] = true, cells[{cell.column, cell.row}] = cell.quad;
      lattice.push_back(cell), open.push_back({cell, step});
    };
    const auto axes = axes_of(quads_[seed], 0);
    add({seed, 0, 0}, {axes[0] * (1 / share_), axes[1] * (1 / share_)});
    for (; !open.empty(); open.pop_front()) {
      const Open at = open.front();
      for (int direction = 0; direction < 4; ++direction) {
        const auto along = static_cast<std::size_t>(direction % 2);
        const int sign = direction < 2 ? 1 : -1;
        LatticeCell next{0, at.cell.column + (along == 0 ? sign : 0), at.cell.row + (along == 1 ? sign : 0)};
        if (cells.contains({next.column, next.row})) continue;
        const Vec2 here = quads_[at.cell.quad].centre;
        if (!nearest(here + at.step[along] * sign, at, next.quad)) continue;
        // The step that was found, and across it this neighbour's own side.
        std::array<Vec2, 2> step = like(quads_[next.quad], at.step);
        step[along] = (quads_[next.quad].centre - here) * sign;
        add(next, step);
      }
    }
    return lattice;
  }

 private:
  template <class Open>
  bool nearest(Vec2 expected, const Open& at, std::size_t& found) const {
    const Quad& from = quads_[at.cell.quad];
    double least = 0.3 * std::min(norm(at.step[0]), norm(at.step[1]));
    bool any = false;
    for (std::size_t i = 0; i < quads_.size(); ++i) {
      const double off = norm(quads_[i].centre - expected);
      if (used_[i] || off > least || quads_[i].side > 1.6 * from.side || quads_[i].side < 0.6 * from.side) continue;
      least = off, found = i, any = true;
    }
    return any;
  }
  std::array<Vec2, 2> like(const Quad& quad, const std::array<Vec2, 2>& step) const {
    std::array<Vec2, 2> best{};
    double least = HUGE_VAL;
    for (int turn = 0; turn < 4; ++turn) {
      auto axes = axes_of(quad, turn);
      axes = {axes[0] * (1 / share_), axes[1] * (1 / share_)};
      const double off = norm(axes[0] - step[0]) + norm(axes[1] - step[1]);
      if (off < least) least = off, best = axes;
    }
    return best;
  }
  const std::vector<Quad>& quads_;
  double share_;
  std::vector<bool> used_;
};

}  // namespace

cv::Mat lightness_picture(const io::Image& picture, double shrink) {
  const std::size_t channels = picture.channels.size();
  cv::Mat linear(picture.height, picture.width, CV_32FC3);
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float> values;
    values.reserve(picture.pixels());
    for (std::size_t i = 0; i < picture.pixels(); ++i)
      if (const float v = picture.data[i * channels + c]; std::isfinite(v)) values.push_back(v);
    float bright = 0;
    if (!values.empty()) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
      std::nth_element(values.begin(), at, values.end());
      bright = *at;
    }
    const float over = bright > 0 ? 1 / bright : 0;
    float* out = linear.ptr<float>();
    for (std::size_t i = 0; i < picture.pixels(); ++i) {
      const float v = picture.data[i * channels + c] * over;
      out[3 * i + c] = std::isfinite(v) ? std::clamp(v, 0.0f, 1.0f) : 0;
    }
  }
  cv::Mat small = linear, codes;
  if (shrink > 1) cv::resize(linear, small, {}, 1 / shrink, 1 / shrink, cv::INTER_AREA);
  cv::pow(small, 1.0 / 3, small);
  small.convertTo(codes, CV_8UC3, 255);
  return codes;
}

std::vector<Quad> patch_candidates(const cv::Mat& picture) {
  std::vector<cv::Mat> planes;
  cv::split(picture, planes);
  cv::Mat brightest;
  cv::max(planes[0], planes[1], brightest);
  cv::max(brightest, planes[2], brightest);
  planes.push_back(brightest);
  const int shorter = std::min(picture.rows, picture.cols);
  std::vector<Quad> quads;
  cv::Mat smooth, binary;
  for (std::size_t p = 0; p < planes.size(); ++p) {
    cv::medianBlur(planes[p], smooth, 3);
    for (const int width : {shorter / 40, shorter / 16, shorter / 7}) {
      if (width < 5) continue;
      for (const double below : {-4.0, -12.0}) {
        cv::adaptiveThreshold(smooth, binary, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY, width | 1, below);
        add_quads(binary, most_share * shorter, quads);
        cv::erode(binary, binary, {});
        add_quads(binary, most_share * shorter, quads);
      }
    }
  }
  return distinct(std::move(quads));
}

std::vector<Lattice> lattices(const std::vector<Quad>& quads, double share, std::size_t least) {
  std::vector<Lattice> all;
  Growing growing(quads, share);
  for (std::size_t seed = 0; seed < quads.size(); ++seed) {
    Lattice lattice = growing.from(seed);
    if (lattice.size() >= least) all.push_back(std::move(lattice));
  }
  std::ranges::stable_sort(all, [](const Lattice& a, const Lattice& b) { return a.size() > b.size(); });
  return all;
}

}  // namespace gonio::colour
