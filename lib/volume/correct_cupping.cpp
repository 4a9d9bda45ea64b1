// The cup in one material: a polynomial through what the material's cells are, over what they should be.
//
// Cells of the coarse grid that lie deep enough below the surface to be clear of its smear, down-weighted where they
// miss the polynomial by much (Tukey's biweight): a speck is no cup. A slight ridge keeps what a thin shell leaves open
// (x^2 + y^2 hardly varies over a tube) from growing without bound.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "linear/solve.h"
#include "stats/intervals.h"
#include "volume/correct.h"
#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

constexpr std::size_t most_cells_fitted = 200'000, fewest_cells_fitted = 200;

struct CupCell {
  Vec3 index;
  double share;  // (value - air) / (object - air)
};

Vec3 unit_place(const std::array<std::size_t, 3>& size, Vec3 index) {
  const auto along = [](double x, std::size_t n) { return n > 1 ? 2 * x / (static_cast<double>(n) - 1) - 1 : 0.0; };
  return {along(index.x, size[0]), along(index.y, size[1]), along(index.z, size[2])};
}

// x^a y^b z^c with a + b + c <= degree, c fastest.
Eigen::VectorXd monomials(int degree, Vec3 p) {
  Eigen::VectorXd m((degree + 1) * (degree + 2) * (degree + 3) / 6);
  Eigen::Index n = 0;
  double x = 1;
  for (int a = 0; a <= degree; ++a, x *= p.x) {
    double y = x;
    for (int b = 0; a + b <= degree; ++b, y *= p.y) {
      double z = y;
      for (int c = 0; a + b + c <= degree; ++c, z *= p.z) m[n++] = z;
    }
  }
  return m;
}

std::vector<CupCell> cells_of(const CoarseField& field, double air, double object) {
  double deepest = 0;
  for (const float d : field.depth) deepest = std::max<double>(deepest, d);
  const double least = std::min(2.5, 0.6 * deepest);  // thin walls have nothing deeper
  std::vector<std::size_t> inside;
  for (std::size_t c = 0; c < field.depth.size(); ++c)
    if (field.depth[c] > 0 && field.depth[c] >= least) inside.push_back(c);
  const std::size_t every = inside.size() / most_cells_fitted + 1;
  std::vector<CupCell> cells;
  for (std::size_t k = 0; k < inside.size(); k += every)
    cells.push_back({field.centre_index(inside[k]), (field.mean[inside[k]] - air) / (object - air)});
  return cells;
}

// Iteratively reweighted least squares; the coefficients.
Eigen::VectorXd polynomial_through(const std::vector<CupCell>& cells, const std::array<std::size_t, 3>& size,
                                   int degree) {
  const Eigen::Index terms = monomials(degree, {}).size();
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(terms);
  double bar = HUGE_VAL;  // of the biweight: 6 median deviations
  for (int round = 0; round < 4; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
    for (const CupCell& cell : cells) {
      const Eigen::VectorXd m = monomials(degree, unit_place(size, cell.index));
      const double part = (cell.share - m.dot(solution)) / bar;
      const double weight = round == 0 ? 1 : std::abs(part) < 1 ? std::pow(1 - part * part, 2) : 0;
      if (weight == 0) continue;
      normal.selfadjointView<Eigen::Lower>().rankUpdate(m, weight);
      right += (weight * cell.share) * m;
    }
    normal.diagonal().array() += 1e-7 * normal(0, 0);
    solution = linear::solve_ldlt(normal, right);
    std::vector<double> rests;
    for (const CupCell& cell : cells)
      rests.push_back(std::abs(cell.share - monomials(degree, unit_place(size, cell.index)).dot(solution)));
    bar = std::max(1e-9, 6 * stats::median(rests));
  }
  return solution;
}

// sd of means over cubes of a sixteenth of the volume: noise does not show in them.
double slow_sd(const std::vector<CupCell>& cells, const std::array<std::size_t, 3>& size,
               const std::vector<double>& shares) {
  std::vector<double> sum(4096), count(4096);
  const auto block = [](double x, std::size_t n) {
    return std::min<std::size_t>(15, static_cast<std::size_t>(16 * x / static_cast<double>(n)));
  };
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Vec3 p = cells[k].index;
    const std::size_t b = (block(p.z, size[2]) * 16 + block(p.y, size[1])) * 16 + block(p.x, size[0]);
    sum[b] += shares[k], ++count[b];
  }
  double n = 0, first = 0, second = 0;
  for (std::size_t b = 0; b < sum.size(); ++b)
    if (count[b] >= 8) n += count[b], first += sum[b], second += sum[b] * sum[b] / count[b];
  return n > 0 ? std::sqrt(std::max(0.0, second / n - first * first / n / n)) : 0;
}

}  // namespace

double CuppingField::at(const std::array<std::size_t, 3>& size, double i, double j, double k) const {
  if (coefficients.empty()) return 1;
  const Eigen::VectorXd m = monomials(degree, unit_place(size, {i, j, k}));
  double value = 0;
  for (Eigen::Index c = 0; c < m.size(); ++c) value += coefficients[static_cast<std::size_t>(c)] * m[c];
  return std::clamp(value, lowest, highest);
}

CuppingField fit_cupping(io::VolumeSource& source, double air, double object, int degree) {
  if (!(object > air) || degree < 0 || degree > 8)
    throw Error(Exit::usage, "cupping", "a material denser than air and a degree of 0 to 8 are asked for");
  const auto& size = source.head().size;
  const std::vector<CupCell> cells = cells_of(coarse_field(source, {air, object}), air, object);
  if (cells.size() < fewest_cells_fitted)
    throw Error(Exit::data, "cupping",
                std::to_string(cells.size()) + " cells lie within the material (limit " +
                    std::to_string(fewest_cells_fitted) + ")",
                "walls are too thin to show a cup, or the material's value is another");
  CuppingField field;
  field.degree = degree, field.air = air, field.object = object;
  const Eigen::VectorXd solution = polynomial_through(cells, size, degree);
  std::vector<double> before, fits;
  for (const CupCell& cell : cells) {
    before.push_back(cell.share);
    fits.push_back(monomials(degree, unit_place(size, cell.index)).dot(solution));
  }
  const double middle = stats::median(fits);  // the material keeps its value
  std::vector<double> after;
  field.lowest = HUGE_VAL, field.highest = -HUGE_VAL;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const double g = fits[k] / middle;
    field.lowest = std::min(field.lowest, g), field.highest = std::max(field.highest, g);
    after.push_back(before[k] / g);
  }
  for (Eigen::Index c = 0; c < solution.size(); ++c) field.coefficients.push_back(solution[c] / middle);
  field.before = slow_sd(cells, size, before), field.after = slow_sd(cells, size, after);
  return field;
}

}  // namespace gonio::volume
