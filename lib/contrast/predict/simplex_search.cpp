// Search over a box (simplex_search.h). Coordinates of the search lie in [0, 1].
#include "contrast/predict/simplex_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace gonio::contrast {
namespace {

using Point = std::vector<double>;
constexpr int starts = 8, rounds = 400;
constexpr double done = 1e-9;  // size of a simplex

struct Corner {
  Point at;
  double value = 0;
};

class Simplex {
 public:
  Simplex(const Point& start, const std::function<double(const Point&)>& f) : f_(f) {
    corners_.push_back({start, value(start)});
    for (std::size_t i = 0; i < start.size(); ++i) {
      Point p = start;
      p[i] += p[i] < 0.5 ? 0.08 : -0.08;
      corners_.push_back({p, value(p)});
    }
  }
  Corner climb() {
    for (int i = 0; i < rounds && size() > done; ++i) step();
    order();
    return corners_.front();
  }
  int evaluations() const { return evaluations_; }

 private:
  double value(const Point& p) {
    ++evaluations_;
    return f_(p);
  }
  void order() { std::ranges::stable_sort(corners_, std::greater{}, &Corner::value); }
  double size() const {
    double most = 0;
    for (const Corner& c : corners_)
      for (std::size_t k = 0; k < c.at.size(); ++k) most = std::max(most, std::abs(c.at[k] - corners_.front().at[k]));
    return most;
  }
  // The worst corner moved through the centre of the others by `factor`, kept in the box.
  Corner moved(const Point& centre, double factor) {
    Corner c{centre, 0};
    for (std::size_t k = 0; k < centre.size(); ++k)
      c.at[k] = std::clamp(centre[k] + factor * (centre[k] - corners_.back().at[k]), 0.0, 1.0);
    c.value = value(c.at);
    return c;
  }
  void step() {
    order();
    Point centre(corners_.front().at.size());
    for (std::size_t i = 0; i + 1 < corners_.size(); ++i)
      for (std::size_t k = 0; k < centre.size(); ++k)
        centre[k] += corners_[i].at[k] / static_cast<double>(corners_.size() - 1);
    const Corner mirrored = moved(centre, 1);
    const double second_worst = corners_[corners_.size() - 2].value;
    if (mirrored.value > corners_.front().value) {
      const Corner further = moved(centre, 2);
      corners_.back() = further.value > mirrored.value ? further : mirrored;
    } else if (mirrored.value > second_worst) {
      corners_.back() = mirrored;
    } else if (const Corner nearer = moved(centre, mirrored.value > corners_.back().value ? 0.5 : -0.5);
               nearer.value > std::max(mirrored.value, corners_.back().value)) {
      corners_.back() = nearer;
    } else {
      shrink();
    }
  }
  void shrink() {
    for (std::size_t i = 1; i < corners_.size(); ++i) {
      for (std::size_t k = 0; k < corners_[i].at.size(); ++k)
        corners_[i].at[k] = (corners_[i].at[k] + corners_.front().at[k]) / 2;
      corners_[i].value = value(corners_[i].at);
    }
  }

  const std::function<double(const Point&)>& f_;
  std::vector<Corner> corners_;
  int evaluations_ = 0;
};

std::vector<Corner> first_set(std::size_t dimensions, int points, const std::function<double(const Point&)>& f) {
  double root = 1.5;
  for (int i = 0; i < 60; ++i) root = std::pow(1 + root, 1 / (static_cast<double>(dimensions) + 1));
  std::vector<Corner> all(static_cast<std::size_t>(points));
  parallel_for(
      0, all.size(),
      [&](std::size_t i) {
        all[i].at.resize(dimensions);
        for (std::size_t k = 0; k < dimensions; ++k) {
          const double x = 0.5 + static_cast<double>(i + 1) * std::pow(root, -static_cast<double>(k + 1));
          all[i].at[k] = x - std::floor(x);
        }
        all[i].value = f(all[i].at);
      },
      16);
  std::ranges::stable_sort(all, std::greater{}, &Corner::value);
  return all;
}

double distance(const Point& a, const Point& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

}  // namespace

Found greatest(const Box& box, int points, const std::function<double(const std::vector<double>&)>& function) {
  const auto placed = [&box](const Point& unit) {
    Point p(unit.size());
    for (std::size_t k = 0; k < p.size(); ++k) p[k] = box.lower[k] + unit[k] * (box.upper[k] - box.lower[k]);
    return p;
  };
  const std::function<double(const Point&)> f = [&](const Point& unit) { return function(placed(unit)); };
  const std::vector<Corner> first = first_set(box.lower.size(), points, f);
  Found found{.at = {}, .evaluations = points};
  std::vector<Point> begun;
  Corner best = first.front();
  for (const Corner& c : first) {
    if (begun.size() == starts) break;
    if (std::ranges::any_of(begun, [&](const Point& p) { return distance(p, c.at) < 0.15; })) continue;
    begun.push_back(c.at);
    Simplex simplex(c.at, f);
    Corner top = simplex.climb();
    Simplex again(top.at, f);  // a simplex that fell flat against a wall of the box gets its width back
    top = again.climb();
    found.evaluations += simplex.evaluations() + again.evaluations();
    if (top.value > best.value) best = top;
  }
  found.at = placed(best.at);
  found.value = best.value;
  return found;
}

}  // namespace gonio::contrast
