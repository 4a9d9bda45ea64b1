// See sight.h.
#include "explain/prints/sight.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "print/mechanisms/print_shrinkage.h"

namespace gonio::explain::prints {
namespace {

// The integral of a box of this width about 0 under a Gaussian, from the far left to x.
double boxed(double x, double width, double sigma) {
  const auto ramp = [sigma](double u) {
    if (sigma < 1e-4) return std::max(0.0, u);
    const double z = u / sigma;
    return u * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
           sigma * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  };
  return (ramp(x + width / 2) - ramp(x - width / 2)) / width;
}

// Between knots: the cell that a place is in, the knot before it, and how far it is to the next.
struct AtKnots {
  int cell = 0, knot = 0;
  double part = 0;
};
AtKnots at_knots(double place_cells, int cells) {
  const double in_knots = std::clamp(place_cells * knots_per_cell, 0.0, cells * knots_per_cell - 1e-6);
  const int knot = static_cast<int>(in_knots);
  return {knot / knots_per_cell, knot % knots_per_cell, in_knots - knot};
}

// visit(cell, weight) for all cells that a place sees; what lies outside is as high as the rim.
template <class Visit>
void each_cell(const Weights& weights, double place_cells, int cells, const Visit& visit) {
  const AtKnots at = at_knots(place_cells, cells);
  const bool next = at.knot + 1 == knots_per_cell;
  const auto k = static_cast<std::size_t>(at.knot), n = next ? 0 : k + 1;
  for (int c = -weights.reach; c <= weights.reach + (next ? 1 : 0); ++c) {
    const auto of = [&](std::size_t knot, int from) {
      const int i = c - from + weights.reach;
      return i < 0 || i > 2 * weights.reach ? 0.0 : weights.of[knot][static_cast<std::size_t>(i)];
    };
    visit(std::clamp(at.cell + c, 0, cells - 1), (1 - at.part) * of(k, 0) + at.part * of(n, next ? 1 : 0));
  }
}

constexpr double beside = 0.5 / knots_per_cell;  // slopes by places are those over a knot's distance
constexpr double wider_by = 0.02;                // cells; slopes by the resolution

// Weights of neighbouring cells, summed over a list of places, and their slopes.
struct Taps {
  int first = 0;
  std::vector<double> weight, by_place, by_resolution;
  void trim() {
    constexpr double least = 1e-9;
    const auto counts = [&](std::size_t k) {
      return std::abs(weight[k]) > least ||
             (!by_place.empty() && std::abs(by_place[k]) + std::abs(by_resolution[k]) > least);
    };
    std::size_t begin = 0, end = weight.size();
    while (begin + 1 < end && !counts(begin)) ++begin;
    while (end > begin + 1 && !counts(end - 1)) --end;
    for (std::vector<double>* v : {&weight, &by_place, &by_resolution})
      if (!v->empty())
        *v = std::vector<double>(v->begin() + static_cast<std::ptrdiff_t>(begin),
                                 v->begin() + static_cast<std::ptrdiff_t>(end));
    first += static_cast<int>(begin);
  }
};

class Axis {
 public:
  Weights weights, wider, narrower;
  double step = 0;  // of the resolution, from narrower to wider
  int cells = 0;
  Axis(double width, double resolution, int count)
      : weights(width, resolution),
        wider(width, resolution + wider_by),
        narrower(width, std::max(0.0, resolution - wider_by)),
        step(resolution + wider_by - std::max(0.0, resolution - wider_by)),
        cells(count) {}
  Taps taps(const std::vector<double>& places, double place_slope, bool slopes) const {
    const int reach = std::max(weights.reach, wider.reach) + 1;
    Taps t;
    const auto [least, most] = std::ranges::minmax(places);
    t.first = std::clamp(static_cast<int>(std::floor(least - beside)) - reach, 0, cells - 1);
    const int last = std::clamp(static_cast<int>(std::floor(most + beside)) + reach + 1, 0, cells - 1);
    const auto size = static_cast<std::size_t>(last - t.first + 1);
    t.weight.assign(size, 0.0);
    for (const double place : places) add(t.weight, t.first, weights, place, 1);
    if (slopes) add_slopes(places, place_slope, t);
    t.trim();
    return t;
  }

 private:
  void add(std::vector<double>& to, int first, const Weights& of, double place, double factor) const {
    each_cell(of, place, cells, [&](int cell, double w) { to[static_cast<std::size_t>(cell - first)] += factor * w; });
  }
  void add_slopes(const std::vector<double>& places, double place_slope, Taps& t) const {
    t.by_place.assign(t.weight.size(), 0.0), t.by_resolution.assign(t.weight.size(), 0.0);
    for (const double place : places) {
      add(t.by_place, t.first, weights, place + beside, place_slope / (2 * beside));
      add(t.by_place, t.first, weights, place - beside, -place_slope / (2 * beside));
      add(t.by_resolution, t.first, wider, place, 1 / step);
      add(t.by_resolution, t.first, narrower, place, -1 / step);
    }
  }
};

std::uint32_t number_of(std::map<std::vector<double>, std::uint32_t>& known, std::vector<std::vector<double>>& lists,
                        const std::vector<double>& list) {
  const auto [at, fresh] = known.try_emplace(list, static_cast<std::uint32_t>(lists.size()));
  if (fresh) lists.push_back(list);
  return at->second;
}

}  // namespace

Weights::Weights(double width, double sigma) : reach(static_cast<int>(std::ceil(width / 2 + 4 * sigma)) + 1) {
  for (int k = 0; k < knots_per_cell; ++k) {
    const double at = static_cast<double>(k) / knots_per_cell;  // in the cell from 0 to 1
    std::vector<double>& weights = of[static_cast<std::size_t>(k)];
    for (int c = -reach; c <= reach; ++c)
      weights.push_back(boxed(c + 1 - at, width, sigma) - boxed(c - at, width, sigma));
    double all = 0;
    for (const double w : weights) all += w;
    for (double& w : weights) w /= all;
  }
}

double Seen::at(double x, double y) const {
  double sum = 0;
  each_cell(down_, y, field_.height, [&](int j, double down) {
    if (down == 0) return;
    const double* row = &field_.top_m[static_cast<std::size_t>(j) * static_cast<std::size_t>(field_.width)];
    each_cell(along_, x, field_.width, [&](int i, double along) { sum += down * along * row[i]; });
  });
  return sum;
}

Sight::Sight(const Sent& sent, std::span<const Vec2> points, std::span<const std::uint32_t> count)
    : corner_m_(sent.corner_m), centre_m_(sent.centre_m) {
  std::map<List, std::uint32_t> known_columns, known_rows;
  std::size_t next = 0;
  for (const std::uint32_t n : count) {
    std::map<double, List> in_row;  // y -> x
    for (const Vec2 p : points.subspan(next, n)) in_row[p.y].push_back(p.x);
    next += n;
    std::map<List, List> rows_of;  // x -> y
    for (auto& [y, xs] : in_row) {
      std::ranges::sort(xs);
      rows_of[xs].push_back(y);
    }
    first_.push_back(static_cast<std::uint32_t>(blocks_.size()));
    points_.push_back(n);
    for (const auto& [xs, ys] : rows_of)
      blocks_.push_back({number_of(known_columns, columns_, xs), number_of(known_rows, rows_, ys)});
  }
  first_.push_back(static_cast<std::uint32_t>(blocks_.size()));
}

void Sight::heights(const Field& field, const View& view, std::vector<double>& mean_m,
                    std::vector<Slopes>* slopes) const {
  const Vec2 cell = field.cell_m, sigma{view.resolution_m / cell.x, view.resolution_m / cell.y};
  const Axis along(view.point_m.x / cell.x, sigma.x, field.width), down(view.point_m.y / cell.y, sigma.y, field.height);
  const Vec2 stretch = equation::print_shrinkage_undone({1, 1}, view.shrinkage.x, view.shrinkage.y);
  const auto taps_of = [&](const std::vector<List>& lists, const Axis& axis, double shift, double centre, double corner,
                           double by, double size) {
    std::vector<Taps> all;
    List places;
    for (const List& list : lists) {
      places.clear();
      for (const double p : list) places.push_back(((p - shift - centre) * by + centre - corner) / size);
      all.push_back(axis.taps(places, -by / size, slopes != nullptr));
    }
    return all;
  };
  const std::vector<Taps> columns =
      taps_of(columns_, along, view.shift_m.x, centre_m_.x, corner_m_.x, stretch.x, cell.x);
  const std::vector<Taps> rows = taps_of(rows_, down, view.shift_m.y, centre_m_.y, corner_m_.y, stretch.y, cell.y);
  mean_m.assign(points_.size(), 0.0);
  if (slopes != nullptr) slopes->assign(points_.size(), {});
  for (std::size_t r = 0; r < points_.size(); ++r)
    for (std::uint32_t b = first_[r]; b < first_[r + 1]; ++b) {
      const Taps &x = columns[blocks_[b].columns], &y = rows[blocks_[b].rows];
      const double share = 1 / points_[r];
      for (std::size_t j = 0; j < y.weight.size(); ++j) {
        const std::size_t row = static_cast<std::size_t>(y.first) + j;
        if (y.weight[j] == 0 && slopes == nullptr) continue;
        const double* z = &field.top_m[row * static_cast<std::size_t>(field.width) + static_cast<std::size_t>(x.first)];
        double sum = 0, by_x = 0, by_resolution = 0;
        for (std::size_t i = 0; i < x.weight.size(); ++i) sum += x.weight[i] * z[i];
        mean_m[r] += share * y.weight[j] * sum;
        if (slopes == nullptr) continue;
        for (std::size_t i = 0; i < x.weight.size(); ++i)
          by_x += x.by_place[i] * z[i], by_resolution += x.by_resolution[i] * z[i];
        Slopes& s = (*slopes)[r];
        s.shift_x += share * y.weight[j] * by_x;
        s.shift_y += share * y.by_place[j] * sum;
        s.resolution += share * (y.weight[j] * by_resolution / cell.x + y.by_resolution[j] * sum / cell.y);
      }
    }
}

}  // namespace gonio::explain::prints
