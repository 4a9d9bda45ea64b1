// See chart_light.h.
#include "colour/chart_light.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "colour/correction.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "optim/least_squares.h"
#include "stats/distributions.h"

namespace gonio::colour {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// One standard deviation of a reading about the model, in proportion to it and, over white, beside that.
constexpr double grey_misfit = 0.012, grey_floor = 0.001, colour_misfit = 0.06, colour_floor = 0.008;
constexpr double least_range = 5;  // of the greys' Y, brightest over darkest
constexpr std::size_t least_greys = 4;

struct Row {
  Rgb reference, read, sigma;  // all over white
  Vec2 place;                  // chart's coordinates
};

Vec3 three(const VectorXd& x, Index at) {
  return {x[at], x[at + 1], x[at + 2]};
}

// x: A row by row, then gradient, curve and offset, of which only those that are fitted.
class LightModel final : public optim::Model {
 public:
  LightModel(std::vector<Row> rows, const LightRequest& request)
      : rows_(std::move(rows)),
        request_(request),
        gradient_at_(9),
        curve_at_(gradient_at_ + (request.gradient ? 2 : 0)),
        offset_at_(curve_at_ + (request.curve ? 3 : 0)) {}
  Index size() const { return offset_at_ + (request_.offset ? 3 : 0); }
  Index gradient_at() const { return gradient_at_; }
  Index curve_at() const { return curve_at_; }
  Index offset_at() const { return offset_at_; }
  // Without sigmas; the offset over white.
  ChartLight light(const VectorXd& x) const {
    ChartLight light;
    if (request_.gradient) light.gradient = {x[gradient_at_], x[gradient_at_ + 1]};
    if (request_.curve) light.curve = three(x, curve_at_);
    if (request_.offset) light.offset = three(x, offset_at_);
    return light;
  }
  bool residuals(const VectorXd& x, VectorXd& r) const override {
    r.resize(static_cast<Index>(3 * rows_.size()));
    const ChartLight at = light(x);
    Index k = 0;
    for (const Row& row : rows_) {
      const double share = at.relative_light(row.place);
      for (int c = 0; c < 3; ++c, ++k) {
        const double seen =
            x[3 * c] * row.reference.x + x[3 * c + 1] * row.reference.y + x[3 * c + 2] * row.reference.z;
        r[k] = (share * seen + at.offset[c] - row.read[c]) / row.sigma[c];
      }
    }
    return true;
  }
  double difference(const VectorXd&, Index) const override { return 1e-5; }  // everything is of order one, or zero

 private:
  std::vector<Row> rows_;
  LightRequest request_;
  Index gradient_at_, curve_at_, offset_at_;
};

std::vector<Row> rows_of(const Chart& chart, std::span<const PatchReading> readings, Rgb white,
                         std::optional<std::size_t> without) {
  const Mat3 reference = from_xyz_d50(Target::cie_rgb);
  std::vector<Row> rows;
  for (std::size_t p = 0; p < readings.size(); ++p) {
    const PatchReading& reading = readings[p];
    if (!reading.left_out.empty() || p == without) continue;
    const Patch& patch = chart.patches[p];
    const Rgb read{reading.rgb.x / white.x, reading.rgb.y / white.y, reading.rgb.z / white.z};
    const double misfit = patch.neutral ? grey_misfit : colour_misfit,
                 floor = patch.neutral ? grey_floor : colour_floor;
    std::array<double, 3> sigma{};
    for (int c = 0; c < 3; ++c)
      sigma[static_cast<std::size_t>(c)] =
          std::hypot(misfit * read[c], floor, std::sqrt(reading.covariance(c, c)) / white[c]);
    rows.push_back({reference * patch.xyz, read, {sigma[0], sigma[1], sigma[2]}, patch.centre});
  }
  return rows;
}

bool greys_tell(const Chart& chart, std::span<const PatchReading> readings, std::optional<std::size_t> without) {
  double least = HUGE_VAL, most = 0;
  std::size_t greys = 0;
  for (std::size_t p = 0; p < readings.size(); ++p)
    if (chart.patches[p].neutral && readings[p].left_out.empty() && p != without)
      ++greys, least = std::min(least, chart.patches[p].xyz.y), most = std::max(most, chart.patches[p].xyz.y);
  return greys >= least_greys && most > least_range * least;
}

// Chance of so large a statistic where all `count` numbers are zero.
double chance_of(const VectorXd& value, const Eigen::MatrixXd& covariance, double degrees) {
  const double f = value.dot(linear::solve_ldlt(covariance, value)) / static_cast<double>(value.size());
  const double count = static_cast<double>(value.size());
  return stats::beta_regularised(degrees / (degrees + count * std::max(f, 0.0)), degrees / 2, count / 2);
}

}  // namespace

Rgb ChartLight::evened(Rgb read, Vec2 place) const {
  return (read - offset) / relative_light(place);
}

double ChartLight::evenness() const {
  double least = HUGE_VAL, most = 0;
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 4; ++j) {
      const double light = relative_light({i / 4.0, j / 4.0});
      least = std::min(least, light), most = std::max(most, light);
    }
  return least / most;
}

double ChartLight::relative_light(Vec2 place) const {
  const Vec2 d = place - Vec2{0.5, 0.5};
  return 1 + dot(gradient, d) + dot(curve, {d.x * d.x, d.x * d.y, d.y * d.y});
}

ChartLight chart_light(const Chart& chart, std::span<const PatchReading> readings, Rgb white,
                       const LightRequest& wanted, std::optional<std::size_t> without) {
  LightRequest request = wanted;
  request.offset = request.offset && greys_tell(chart, readings, without);
  if (!request.offset && !request.gradient && !request.curve) return {};
  const auto rows = rows_of(chart, readings, white, without);
  const LightModel model(rows, request);
  VectorXd start = VectorXd::Zero(model.size());
  start[0] = start[4] = start[8] = 1;
  optim::Terms terms;
  terms.loss = optim::Loss::huber, terms.width = 2;
  const double degrees = static_cast<double>(3 * rows.size()) - static_cast<double>(model.size());
  if (degrees < 3) return {};
  const optim::Fit fit = optim::fit(model, start, terms);
  if (!fit.determined) return {};
  const Eigen::MatrixXd covariance = fit.covariance * std::max(1.0, fit.cost / degrees);
  const VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const auto chance = [&](Index at, Index count) {
    return chance_of(fit.x.segment(at, count), covariance.block(at, at, count, count), degrees);
  };
  ChartLight light = model.light(fit.x);
  light.offset *= white;
  if (request.gradient) {
    light.gradient_sigma = {sigma[model.gradient_at()], sigma[model.gradient_at() + 1]};
    light.gradient_chance = chance(model.gradient_at(), 2);
  }
  if (request.curve)
    light.curve_sigma = three(sigma, model.curve_at()), light.curve_chance = chance(model.curve_at(), 3);
  if (request.offset) {
    light.offset_sigma = white * three(sigma, model.offset_at());
    light.offset_chance = chance(model.offset_at(), 3);
  }
  return light;
}

Rgb white_of(const Chart& chart, std::span<const PatchReading> readings, const std::string& place) {
  for (const bool greys : {true, false}) {
    Rgb above;
    double below = 0;
    std::size_t count = 0;
    for (std::size_t p = 0; p < readings.size(); ++p) {
      if (!readings[p].left_out.empty() || (greys && !chart.patches[p].neutral)) continue;
      const double y = chart.patches[p].xyz.y;
      above += readings[p].rgb * y, below += y * y, ++count;
    }
    const Rgb white = above / below;
    if (count >= (greys ? 2u : 1u) && is_finite(white) && white.x > 0 && white.y > 0 && white.z > 0) return white;
  }
  throw Error(Exit::data, place, "shows no patch that can be used: all are clipped, masked or dark",
              "expose so that white stays below full scale");
}

}  // namespace gonio::colour
