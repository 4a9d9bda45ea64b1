// From a map as measured to the surface whose roughness is asked for (areal.h): levelling and filters.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "linear/solve.h"
#include "relief/areal.h"

namespace gonio::relief {
namespace {

// 1, u, v, u^2, u v, v^2 with u and v in [-1, 1]
Eigen::VectorXd terms(double u, double v, int count) {
  Eigen::VectorXd t(count);
  const double all[] = {1, u, v, u * u, u * v, v * v};
  for (int i = 0; i < count; ++i) t[i] = all[i];
  return t;
}

double unit_place(std::size_t i, std::size_t n) {
  return 2 * static_cast<double>(i) / static_cast<double>(n - 1) - 1;
}

Eigen::VectorXd level(io::HeightMap& map, int count) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x) {
      const double z = map.at(x, y);
      if (!std::isfinite(z)) continue;
      const Eigen::VectorXd t = terms(unit_place(x, map.width), unit_place(y, map.height), count);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(t);
      right += t * z;
    }
  const Eigen::VectorXd c = linear::solve_ldlt(normal, right);
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x)
      map.z_m[y * map.width + x] -= c.dot(terms(unit_place(x, map.width), unit_place(y, map.height), count));
  return c;
}

std::vector<double> kernel(double nesting_m, double step_m) {
  const double width = std::sqrt(std::log(2.0) / 3.14159265358979323846) * nesting_m / step_m;
  std::vector<double> k;
  for (int i = 0; i <= static_cast<int>(std::ceil(1.6 * width)); ++i)  // down to exp(-8)
    k.push_back(std::exp(-3.14159265358979323846 * i * i / (width * width)));
  return k;
}

// Along one axis, weighted by what there is: numerators and weights are filtered alike.
void smooth(std::vector<double>& field, const std::vector<double>& k, std::size_t lines, std::size_t points,
            std::size_t line_step, std::size_t step) {
  parallel_for(0, lines, [&](std::size_t line) {
    std::vector<double> out(points);
    const auto n = static_cast<std::ptrdiff_t>(points), reach = static_cast<std::ptrdiff_t>(k.size()) - 1;
    for (std::ptrdiff_t i = 0; i < n; ++i)
      for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - reach); j <= std::min(n - 1, i + reach); ++j)
        out[static_cast<std::size_t>(i)] +=
            k[static_cast<std::size_t>(std::abs(i - j))] * field[line * line_step + static_cast<std::size_t>(j) * step];
    for (std::size_t i = 0; i < points; ++i) field[line * line_step + i * step] = out[i];
  });
}

std::vector<double> low_pass(const io::HeightMap& map, double nesting_m) {
  std::vector<double> sum(map.z_m), weight(map.z_m.size(), 1.0);
  for (std::size_t i = 0; i < sum.size(); ++i)
    if (!std::isfinite(sum[i])) sum[i] = weight[i] = 0;
  const auto along = kernel(nesting_m, map.step_x_m), down = kernel(nesting_m, map.step_y_m);
  for (std::vector<double>* field : {&sum, &weight}) {
    smooth(*field, along, map.height, map.width, map.width, 1);
    smooth(*field, down, map.width, map.height, 1, map.width);
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = weight[i] > 0 ? sum[i] / weight[i] : 0;
  return sum;
}

}  // namespace

const std::vector<std::string>& levelling_names() {
  static const std::vector<std::string> names{"none", "plane", "quadratic"};
  return names;
}

Treated treated(const io::HeightMap& map, const Treatment& treatment, const std::string& place) {
  Treated result{map, 0, 0, 0};
  io::HeightMap& m = result.map;
  result.missing =
      static_cast<std::size_t>(std::count_if(m.z_m.begin(), m.z_m.end(), [](double z) { return !std::isfinite(z); }));
  if (2 * result.missing > m.z_m.size())
    throw Error(Exit::data, place,
                std::to_string(result.missing) + " of " + std::to_string(m.z_m.size()) + " points have no height",
                "at most half may be missing");
  const int count = treatment.levelling == Levelling::none ? 1 : treatment.levelling == Levelling::plane ? 3 : 6;
  const Eigen::VectorXd c = level(m, count);
  if (count > 1) {
    result.tilt_x = 2 * c[1] / (static_cast<double>(m.width - 1) * m.step_x_m);
    result.tilt_y = -2 * c[2] / (static_cast<double>(m.height - 1) * m.step_y_m);
  }
  if (treatment.s_filter_m > 0) {
    const std::vector<double> smoothed = low_pass(m, treatment.s_filter_m);
    for (std::size_t i = 0; i < smoothed.size(); ++i)
      if (std::isfinite(m.z_m[i])) m.z_m[i] = smoothed[i];
  }
  if (treatment.l_filter_m > 0) {
    const std::vector<double> waves = low_pass(m, treatment.l_filter_m);
    for (std::size_t i = 0; i < waves.size(); ++i) m.z_m[i] -= waves[i];
  }
  if (treatment.s_filter_m > 0 || treatment.l_filter_m > 0) level(m, 1);
  return result;
}

}  // namespace gonio::relief
