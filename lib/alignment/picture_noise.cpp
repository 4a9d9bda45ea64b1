// See picture_noise.h.
#include "alignment/picture_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "stats/intervals.h"

namespace gonio::alignment {
namespace {

constexpr double bin_px = 2;
constexpr std::size_t bins = 30;
constexpr std::size_t least_values = 12;

// [image * surfaces + surface]: rows.
std::vector<std::vector<std::size_t>> groups_of(const PictureModel& model) {
  std::vector<std::vector<std::size_t>> groups(model.images().size() * model.surfaces().size());
  for (std::size_t r = 0; r < model.rows().size(); ++r) {
    const PictureRow& row = model.rows()[r];
    groups[row.image * model.surfaces().size() + row.surface].push_back(r);
  }
  return groups;
}

double distance(const PictureRow& a, const PictureRow& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

// The share of what is shown by which it errs beside the noise, so that the middle half of what is left is as wide as
// that of normal numbers.
double relative_error(const PictureModel& model, const std::vector<std::size_t>& rows,
                      const std::vector<double>& residual, const std::vector<double>& shown) {
  double low = 0, high = 1;
  const auto spread = [&](double relative) {
    std::vector<double> z;
    for (const std::size_t r : rows)
      for (std::size_t c = 0; c < 3; ++c) {
        const double own = relative * shown[3 * r + c];
        z.push_back(std::abs(residual[3 * r + c]) /
                    std::sqrt(model.rows()[r].variance[static_cast<int>(c)] + own * own));
      }
    return stats::quantile(z, 0.5) * stats::sigma_of_median;
  };
  if (rows.size() < least_values) return 0.1;
  if (spread(0) <= 1) return 0;
  for (int i = 0; i < 30; ++i) {
    const double middle = (low + high) / 2;
    (spread(middle) > 1 ? low : high) = middle;
  }
  return high;
}

// Mean products of pairs of rows of one group, by distance, and how many there are.
struct Products {
  std::array<double, bins> sum{}, pairs{}, place_px{};
};
Products products_of(const PictureModel& model, const std::vector<double>& z) {
  const auto groups = groups_of(model);
  std::vector<Products> parts(groups.size());
  parallel_for(0, groups.size(), [&](std::size_t g) {
    Products& p = parts[g];
    for (std::size_t i = 0; i < groups[g].size(); ++i)
      for (std::size_t k = i + 1; k < groups[g].size(); ++k) {
        const std::size_t a = groups[g][i], b = groups[g][k];
        const double d = distance(model.rows()[a], model.rows()[b]);
        const auto bin = static_cast<std::size_t>(d / bin_px);
        if (bin >= bins) continue;
        p.sum[bin] += (z[3 * a] * z[3 * b] + z[3 * a + 1] * z[3 * b + 1] + z[3 * a + 2] * z[3 * b + 2]) / 3;
        p.pairs[bin] += 1, p.place_px[bin] += d;
      }
  });
  Products all;
  for (const Products& p : parts)
    for (std::size_t b = 0; b < bins; ++b)
      all.sum[b] += p.sum[b], all.pairs[b] += p.pairs[b], all.place_px[b] += p.place_px[b];
  return all;
}

// How alike photographs from one place are at the same pixel: the factor on the variance of their mean.
double repetition_of(const PictureModel& model, const std::vector<double>& z, double square) {
  std::map<std::pair<std::size_t, std::uint32_t>, std::vector<std::size_t>> same;
  for (std::size_t r = 0; r < model.rows().size(); ++r)
    same[{model.rows()[r].view, model.rows()[r].pixel}].push_back(r);
  double sum = 0, pairs = 0;
  for (const auto& [place, rows] : same)
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t k = i + 1; k < rows.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c) sum += z[3 * rows[i] + c] * z[3 * rows[k] + c] / 3, pairs += 1.0 / 3;
  if (pairs < least_values) return 1;
  const double like = std::max(0.0, sum / pairs / square);
  return 1 + like * 2 * pairs / static_cast<double>(model.rows().size());
}

void find_likeness(const PictureModel& model, const std::vector<double>& z, double fitted, PictureNoise& noise) {
  const auto count = static_cast<double>(model.rows().size());
  double square = 0, cross = 0;
  for (std::size_t r = 0; r < model.rows().size(); ++r) {
    const double a = z[3 * r], b = z[3 * r + 1], c = z[3 * r + 2];
    square += (a * a + b * b + c * c) / 3 / count, cross += (a * b + a * c + b * c) / 3 / count;
  }
  if (!(square > 0)) return;
  noise.colours = std::clamp(cross / square, 0.0, 1.0);
  noise.repeated = repetition_of(model, z, square);
  const Products products = products_of(model, z);
  // What was fitted took a mode each out of what is left, with the power of as many rows as are one error.
  double space = 1;
  for (int round = 0; round < 5; ++round) {
    const double taken = std::min(0.5, fitted * space / std::max(1.0, count));
    double sum = 1, area = 0, first = 0;
    for (std::size_t b = 0; b < bins; ++b) {
      if (!(products.pairs[b] > 0)) continue;
      const double value = (1 - taken) * products.sum[b] / products.pairs[b] / square + taken;
      if (value < std::max(0.02, 2 / std::sqrt(products.pairs[b])) + taken) break;
      if (first == 0) first = std::min(1.0, value);
      sum += 2 * products.pairs[b] * value / count;
      area += value * 2 * pi * (products.place_px[b] / products.pairs[b]) * bin_px;
    }
    space = sum, noise.nugget = first;
    noise.reach_px = first > 0 ? std::sqrt(area / (2 * pi * first)) : 1;
    noise.correlation_px = std::sqrt(1 + area);
  }
  noise.inflation = space * (1 + 2 * noise.colours) * noise.repeated;
}

}  // namespace

std::vector<double> sigmas_of(const PictureModel& model, const std::vector<double>& relative,
                              const std::vector<double>& shown) {
  std::vector<double> sigma(shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const PictureRow& row = model.rows()[i / 3];
    const double own = relative[row.image * model.surfaces().size() + row.surface] * shown[i];
    sigma[i] = std::sqrt(row.variance[static_cast<int>(i % 3)] + own * own);
  }
  return sigma;
}

PictureNoise noise_of(const PictureModel& model, const std::vector<double>& residual, const std::vector<double>& shown,
                      double fitted) {
  PictureNoise noise;
  for (const auto& rows : groups_of(model)) noise.relative.push_back(relative_error(model, rows, residual, shown));
  const std::vector<double> sigma = sigmas_of(model, noise.relative, shown);
  std::vector<double> z(residual.size());
  const Loss loss = picture_loss();
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double white = residual[i] / sigma[i];
    z[i] = loss.weight(white) * white;
  }
  find_likeness(model, z, fitted, noise);
  return noise;
}

Eigen::MatrixXd scattered(const PictureModel& model, const PictureNoise& noise, const Eigen::MatrixXd& slopes) {
  const auto groups = groups_of(model);
  std::vector<Eigen::MatrixXd> parts(groups.size());
  parallel_for(0, groups.size(), [&](std::size_t g) {
    Eigen::MatrixXd& part = parts[g];
    part = Eigen::MatrixXd::Zero(slopes.cols(), slopes.cols());
    // Colour by colour with what is not alike in them, and their sum with what is.
    for (int c = 0; c < 4; ++c) {
      const double share = c < 3 ? 1 - noise.colours : noise.colours;
      const auto slope = [&](std::size_t r) -> Eigen::VectorXd {
        const auto first = static_cast<Eigen::Index>(3 * r);
        if (c < 3) return slopes.row(first + c).transpose();
        return (slopes.row(first) + slopes.row(first + 1) + slopes.row(first + 2)).transpose();
      };
      for (std::size_t i = 0; i < groups[g].size(); ++i) {
        Eigen::VectorXd near = 0.5 * slope(groups[g][i]);
        for (std::size_t k = i + 1; k < groups[g].size() && noise.nugget > 0; ++k) {
          const double d = distance(model.rows()[groups[g][i]], model.rows()[groups[g][k]]);
          if (d < 6 * noise.reach_px) near += noise.nugget * std::exp(-d / noise.reach_px) * slope(groups[g][k]);
        }
        const Eigen::VectorXd own = slope(groups[g][i]);
        part += share * (own * near.transpose() + near * own.transpose());
      }
    }
  });
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(slopes.cols(), slopes.cols());
  for (const Eigen::MatrixXd& part : parts) all += part;
  return noise.repeated * all;
}

}  // namespace gonio::alignment
