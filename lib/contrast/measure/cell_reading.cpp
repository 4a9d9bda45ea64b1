// Two kinds of cells told apart (contrast/measure/cell_reading.h).
#include "contrast/measure/cell_reading.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "linear/solve.h"
#include "linear/svd.h"

namespace gonio::contrast {
namespace {

constexpr double clip = 3, least = 0.7;  // a normal cloud cut at its middle explains 2 / pi = 0.64

// Less the plane through all cells, by least squares: a robust fit could take one of the two kinds for the outliers.
Eigen::VectorXd standardised(const CellPattern& pattern, const CellMeans& means) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(pattern.cells()));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const auto row = [&](std::size_t cell) { return Eigen::Vector3d(1, pattern.place(cell).x, pattern.place(cell).y); };
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    if (!std::isfinite(means.mean[cell])) continue;
    normal += row(cell) * row(cell).transpose();
    right += row(cell) * means.mean[cell];
  }
  if (normal(0, 0) < 6) return z;
  const Eigen::Vector3d plane = linear::solve_ldlt(normal, right);
  double square = 0;
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    if (!std::isfinite(means.mean[cell])) continue;
    z(static_cast<Eigen::Index>(cell)) = means.mean[cell] - row(cell).dot(plane);
    square += std::pow(z(static_cast<Eigen::Index>(cell)), 2) / normal(0, 0);
  }
  if (square > 0) z = (z / std::sqrt(square)).cwiseMax(-clip).cwiseMin(clip);
  return z;
}

struct Cut {
  double at = 0, explained = 0;  // share of the variance that lies between the two parts
};

Cut best_cut(const Eigen::VectorXd& score) {
  std::vector<double> sorted(score.data(), score.data() + score.size());
  std::ranges::sort(sorted);
  const double n = static_cast<double>(sorted.size()), total = std::accumulate(sorted.begin(), sorted.end(), 0.0);
  double variance = 0, low = 0;
  for (const double s : sorted) variance += (s - total / n) * (s - total / n);
  Cut cut;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    low += sorted[i - 1];
    const double k = static_cast<double>(i), gap = low / k - (total - low) / (n - k);
    const double explained = variance > 0 ? k * (n - k) / n * gap * gap / variance : 0;
    if (explained > cut.explained) cut = {(sorted[i - 1] + sorted[i]) / 2, explained};
  }
  return cut;
}

}  // namespace

std::vector<std::uint8_t> split_cells(const CellPattern& pattern, const std::vector<const CellMeans*>& views,
                                      const std::vector<int>& placement) {
  Eigen::MatrixXd z(static_cast<Eigen::Index>(pattern.cells()), static_cast<Eigen::Index>(views.size()));
  for (std::size_t v = 0; v < views.size(); ++v) z.col(static_cast<Eigen::Index>(v)) = standardised(pattern, *views[v]);
  const linear::JacobiSvd<Eigen::MatrixXd> svd(z, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd score = svd.matrixU().col(0), loading = svd.matrixV().col(0);
  const Cut cut = best_cut(score);
  if (cut.explained < least) return {};
  double first = 0;
  for (std::size_t v = 0; v < views.size(); ++v)
    if (placement[v] == 0) first += loading(static_cast<Eigen::Index>(v));
  std::vector<std::uint8_t> bits(pattern.cells());
  for (std::size_t cell = 0; cell < bits.size(); ++cell)
    bits[cell] = (score(static_cast<Eigen::Index>(cell)) > cut.at) == (first >= 0);
  return bits;
}

}  // namespace gonio::contrast
