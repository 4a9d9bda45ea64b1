// Cells unlike their class (contrast/measure/defects.h).
#include "contrast/measure/defects.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "contrast/measure/cell_classes.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "stats/intervals.h"

namespace gonio::contrast {
namespace {

constexpr double clip = 3;

// The correlation between views, of z clipped, shrunk towards none; z has a row for each cell. Schaefer & Strimmer
// 2005, "A shrinkage approach to large-scale covariance matrix estimation", equation 8: the weight of "none" is the sum
// of the variances of the correlations over the sum of their squares.
Eigen::MatrixXd correlation(const Eigen::MatrixXd& z) {
  const auto n = static_cast<double>(z.rows());
  Eigen::MatrixXd u = z.cwiseMax(-clip).cwiseMin(clip);
  for (Eigen::Index v = 0; v < u.cols(); ++v) {
    u.col(v).array() -= u.col(v).mean();
    u.col(v) /= std::max(std::sqrt(u.col(v).squaredNorm() / (n - 1)), 1e-12);
  }
  Eigen::MatrixXd r = u.transpose() * u / (n - 1);
  const Eigen::MatrixXd squares = u.array().square().matrix();
  const Eigen::MatrixXd fourth = squares.transpose() * squares;
  double variance = 0, size = 0;
  for (Eigen::Index a = 0; a < r.cols(); ++a)
    for (Eigen::Index b = 0; b < r.cols(); ++b) {
      if (a == b) continue;
      const double mean = r(a, b) * (n - 1) / n;
      variance += n / std::pow(n - 1, 3) * (fourth(a, b) - n * mean * mean);
      size += r(a, b) * r(a, b);
    }
  const double weight = size > 0 ? std::clamp(variance / size, 0.05, 1.0) : 1.0;
  r *= 1 - weight;
  r.diagonal().setOnes();
  return r;
}

// Along the eigenvectors of the correlation, each over its variance, but no variance below that of an independent view.
Eigen::VectorXd distances2(const Eigen::MatrixXd& z, const Eigen::MatrixXd& r) {
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(r);
  const Eigen::MatrixXd along = z * eigen.eigenvectors();
  return along.array().square().matrix() * eigen.eigenvalues().cwiseMax(1).cwiseInverse() /
         static_cast<double>(z.cols());
}

// Of the bulk of the cells: where the middle lies, and the upper sixth begins.
constexpr std::array<double, 2> bulk{0.5, 0.85};

double quantile_of(const Eigen::VectorXd& values, double share) {
  return stats::quantile({values.data(), static_cast<std::size_t>(values.size())}, share);
}

// Normal z with correlation r as sound cells would have it: through the same robust fit in every view.
class Null {
 public:
  Null(const CellPattern& pattern, const std::vector<std::size_t>& cells, const Eigen::MatrixXd& r)
      : shape_(pattern, cells), root_(linear::Llt(r).lower()) {}
  Eigen::VectorXd draw(Random& random) const {
    Eigen::MatrixXd z(shape_.cells(), root_.rows());
    for (Eigen::Index i = 0; i < z.rows(); ++i)
      for (Eigen::Index v = 0; v < z.cols(); ++v) z(i, v) = random.normal();
    z *= root_.transpose();
    for (Eigen::Index v = 0; v < z.cols(); ++v) z.col(v) = shape_.deviations(z.col(v));
    return distances2(z, correlation(z));
  }

 private:
  ClassShape shape_;
  Eigen::MatrixXd root_;
};

struct ClassResult {
  std::vector<std::size_t> cells;
  Eigen::VectorXd distance2;
  std::vector<double> largest;  // of each draw, sorted
  double widening = 1;
};

ClassResult judge(const CellPattern& pattern, const std::vector<std::size_t>& cells,
                  const std::vector<std::vector<double>>& deviation, int draws, std::uint64_t seed) {
  ClassResult result{cells, {}, std::vector<double>(static_cast<std::size_t>(draws)), 1};
  Eigen::MatrixXd z(static_cast<Eigen::Index>(cells.size()), static_cast<Eigen::Index>(deviation.size()));
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t v = 0; v < deviation.size(); ++v) {
      const double d = deviation[v][cells[i]];
      z(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(v)) = std::isfinite(d) ? d : 0;
    }
  const Eigen::MatrixXd r = correlation(z);
  result.distance2 = distances2(z, r);
  const Null null(pattern, cells, r);
  std::array<std::vector<double>, 2> usual;
  usual.fill(std::vector<double>(result.largest.size()));
  parallel_for(
      0, result.largest.size(),
      [&](std::size_t draw) {
        Random random(seed, draw);
        const Eigen::VectorXd d2 = null.draw(random);
        result.largest[draw] = d2.maxCoeff();
        for (std::size_t k = 0; k < bulk.size(); ++k) usual[k][draw] = quantile_of(d2, bulk[k]);
      },
      8);
  for (std::size_t k = 0; k < bulk.size(); ++k)
    result.widening = std::max(result.widening, quantile_of(result.distance2, bulk[k]) / stats::median(usual[k]));
  for (double& d2 : result.largest) d2 *= result.widening;
  std::ranges::sort(result.largest);
  return result;
}

CellDefect described(std::size_t cell, const std::vector<std::vector<double>>& deviation) {
  CellDefect defect;
  defect.cell = cell;
  for (std::size_t v = 0; v < deviation.size(); ++v) {
    const double d = deviation[v][cell];
    if (!std::isfinite(d)) continue;
    defect.brighter += d > 3;
    defect.darker += d < -3;
    if (std::abs(d) > std::abs(defect.deviation)) {
      defect.deviation = d;
      defect.view = v;
    }
  }
  return defect;
}

bool seen_enough(const std::vector<std::vector<double>>& deviation, std::size_t cell) {
  std::size_t seen = 0;
  for (const auto& view : deviation) seen += std::isfinite(view[cell]);
  return 2 * seen >= deviation.size() && seen > 0;
}

}  // namespace

Defects find_defects(const CellPattern& pattern, const std::vector<std::vector<double>>& deviation, double alarm_rate,
                     std::uint64_t seed) {
  Defects result;
  result.alarm_rate = alarm_rate;
  // A p of a tenth of the alarm rate needs this many draws; the tail of the largest beyond the last draw is 1 / draws.
  result.draws = static_cast<int>(std::clamp(20 / alarm_rate, 200.0, 2000.0)) - 1;
  result.distance.assign(pattern.cells(), std::nan(""));
  result.p.assign(pattern.cells(), std::nan(""));
  for (std::uint8_t bit = 0; bit < 2; ++bit) {
    std::vector<std::size_t> cells;
    for (std::size_t cell = 0; cell < pattern.cells(); ++cell)
      if (pattern.bits[cell] == bit && seen_enough(deviation, cell)) cells.push_back(cell);
    if (cells.size() < 6) continue;  // too few to say what is usual
    const ClassResult judged = judge(pattern, cells, deviation, result.draws, split_mix(seed + bit));
    result.widening[bit] = judged.widening;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double d2 = judged.distance2(static_cast<Eigen::Index>(i));
      const auto above = judged.largest.end() - std::ranges::lower_bound(judged.largest, d2);
      result.distance[cells[i]] = std::sqrt(d2);
      result.p[cells[i]] = stats::sidak((static_cast<double>(above) + 1) / (result.draws + 1), 2);
    }
    const auto rank = static_cast<std::size_t>(std::floor((1 - std::sqrt(1 - alarm_rate)) * (result.draws + 1)));
    result.limit =
        std::max(result.limit, std::sqrt(judged.largest[judged.largest.size() - std::max<std::size_t>(rank, 1)]));
  }
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    if (!(result.p[cell] <= alarm_rate)) continue;
    CellDefect defect = described(cell, deviation);
    defect.distance = result.distance[cell];
    defect.p = result.p[cell];
    result.found.push_back(defect);
  }
  std::ranges::sort(result.found, std::greater<>(), &CellDefect::distance);
  return result;
}

}  // namespace gonio::contrast
