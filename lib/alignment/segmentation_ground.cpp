// The lit ground of one picture as a smooth function of the pixel: see segmentation_field.h.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "alignment/segmentation_field.h"
#include "base/error.h"
#include "linear/solve.h"

namespace gonio::alignment {
namespace {

constexpr int most_terms = 15;  // of degree 4

int terms_of(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}

// Monomials of u and v in [-1, 1].
void monomials(double u, double v, int degree, double* out) {
  int n = 0;
  double pu = 1;
  for (int i = 0; i <= degree; ++i, pu *= u) {
    double p = pu;
    for (int j = 0; i + j <= degree; ++j, p *= v) out[n++] = p;
  }
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// A weighted fit by least squares, repeated with weights that the residuals give.
class Fit {
 public:
  Fit(const Field& field, std::size_t k, std::span<const std::uint8_t> lit, std::span<const float> base)
      : field_(field), picture_(field.pictures[k]), base_(base), channels_(field.channels) {
    const std::size_t step = std::max<std::size_t>(1, field.pixels() / 60000);
    for (std::size_t p = 0; p < field.pixels(); p += step)
      if ((lit.empty() || lit[p]) && usable(p)) at_.push_back(p);
    weight_.assign(at_.size(), 1);
  }
  std::size_t count() const { return at_.size(); }
  // log(value / base) of a pixel's channel
  double target(std::size_t p, int c) const {
    const std::size_t i = p * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(c);
    return std::log(static_cast<double>(picture_.value[i]) / (base_.empty() ? 1.0 : static_cast<double>(base_[i])));
  }
  double relative_sigma(std::size_t p, int c) const {
    const std::size_t i = p * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(c);
    return static_cast<double>(picture_.sigma[i]) / static_cast<double>(picture_.value[i]);
  }
  void solve(int degree) {
    degree_ = degree;
    const int n = terms_of(degree);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n), right = Eigen::MatrixXd::Zero(n, channels_);
    Eigen::VectorXd t(n);
    for (std::size_t i = 0; i < at_.size(); ++i) {
      if (!(weight_[i] > 0)) continue;
      place(at_[i], t.data());
      normal.selfadjointView<Eigen::Lower>().rankUpdate(t, weight_[i]);
      for (int c = 0; c < channels_; ++c) right.col(c) += weight_[i] * target(at_[i], c) * t;
    }
    normal.diagonal().array() += 1e-9 * normal(0, 0);
    solution_ = linear::solve_ldlt(normal, right);
  }
  double model(std::size_t p, int c) const {
    std::array<double, most_terms> t;
    place(p, t.data());
    double sum = 0;
    for (int i = 0; i < terms_of(degree_); ++i) sum += solution_(i, c) * t[static_cast<std::size_t>(i)];
    return sum;
  }
  // Root mean square over the channels of what is left at pixel i of those that are fitted.
  double left(std::size_t i) const {
    double sum = 0;
    for (int c = 0; c < channels_; ++c) {
      const double d = target(at_[i], c) - model(at_[i], c);
      sum += d * d;
    }
    return std::sqrt(sum / channels_);
  }
  void absolute() {  // least absolute deviations: half of the pixels may be anything
    for (std::size_t i = 0; i < at_.size(); ++i) weight_[i] = 1 / std::max(left(i), 0.005);
  }
  double biweight(double widths, double least) {
    std::vector<double> all(at_.size());
    for (std::size_t i = 0; i < at_.size(); ++i) all[i] = left(i);
    std::vector<double> sorted = all;
    const double scale = std::max(least, 1.1 * median(sorted)), reach = widths * scale;
    for (std::size_t i = 0; i < at_.size(); ++i) {
      const double s = all[i] / reach;
      weight_[i] = s < 1 ? (1 - s * s) * (1 - s * s) : 0;
    }
    return scale;
  }

 private:
  bool usable(std::size_t p) const {
    for (int c = 0; c < channels_; ++c) {
      const std::size_t i = p * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(c);
      if (!(picture_.value[i] > 8 * picture_.sigma[i])) return false;
      if (!base_.empty() && !(base_[i] > 8 * picture_.sigma[i])) return false;
    }
    return true;
  }
  void place(std::size_t p, double* t) const {
    const auto w = static_cast<std::size_t>(field_.width);
    monomials(2 * static_cast<double>(p % w) / (field_.width - 1) - 1,
              2 * static_cast<double>(p / w) / (field_.height - 1) - 1, degree_, t);
  }
  const Field& field_;
  const LampPicture& picture_;
  std::span<const float> base_;
  int channels_, degree_ = 0;
  std::vector<std::size_t> at_;
  std::vector<double> weight_;
  Eigen::MatrixXd solution_;
};

// What lit ground scatters about its model beyond the noise: of the median pixel, per channel.
double model_error(const Fit& fit, const Field& field, const LampPicture& picture) {
  std::vector<double> excess;
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    if (!(std::abs(picture.brightness[p]) < 0.15f)) continue;
    double noise = 0;
    for (int c = 0; c < field.channels; ++c) noise += fit.relative_sigma(p, c) * fit.relative_sigma(p, c);
    const double b = static_cast<double>(picture.brightness[p]);
    excess.push_back(b * b / 0.455 - noise / (field.channels * field.channels));  // 0.455: median of chi squared
  }
  if (excess.empty()) return 0.01;
  return std::clamp(std::sqrt(std::max(0.0, median(excess))), 0.006, 0.1);
}

}  // namespace

void fit_ground(Field& field, std::size_t k, int degree, std::span<const std::uint8_t> lit,
                std::span<const float> base) {
  LampPicture& picture = field.pictures[k];
  Fit fit(field, k, lit, base);
  if (fit.count() < static_cast<std::size_t>(4 * most_terms))
    throw Error(Exit::data, "picture " + std::to_string(k + 1), "shows no lit ground",
                "expose longer, or frame the picture so that the ground fills more than half of it");
  fit.solve(std::min(1, degree));
  if (lit.empty()) {
    for (int i = 0; i < 12; ++i) fit.absolute(), fit.solve(i < 4 ? std::min(1, degree) : std::min(2, degree));
    for (int i = 0; i < 6; ++i) fit.biweight(5, 0.01), fit.solve(std::min(2, degree));
  } else {
    fit.solve(degree);
  }
  for (int i = 0; i < 8; ++i) fit.biweight(4, 0.01), fit.solve(degree);
  const auto channels = static_cast<std::size_t>(field.channels);
  picture.ground.resize(field.pixels() * channels);
  picture.brightness.resize(field.pixels()), picture.spread.resize(field.pixels());
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    double sum = 0, noise = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t i = p * channels + c;
      const double ground =
          std::exp(fit.model(p, static_cast<int>(c))) * (base.empty() ? 1.0 : static_cast<double>(base[i]));
      picture.ground[i] = static_cast<float>(ground);
      const double value = static_cast<double>(std::max(picture.value[i], picture.sigma[i]));
      const double sigma = static_cast<double>(picture.sigma[i]) / value;
      sum += std::log(value / std::max(ground, 1e-30)), noise += sigma * sigma;
    }
    picture.brightness[p] = static_cast<float>(sum / field.channels);
    picture.spread[p] = static_cast<float>(std::sqrt(noise) / field.channels);
  }
  picture.model_error = model_error(fit, field, picture);
  for (float& s : picture.spread) s = static_cast<float>(std::hypot(static_cast<double>(s), picture.model_error));
}

}  // namespace gonio::alignment
