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
  Vec2 place;                  // from the middle of the chart
};

// x: A row by row, then gradient, then offset, of which only those that are fitted.
class LightModel final : public optim::Model {
 public:
  LightModel(std::vector<Row> rows, const LightRequest& request) : rows_(std::move(rows)), request_(request) {}
  Index size() const { return 9 + (request_.gradient ? 2 : 0) + (request_.offset ? 3 : 0); }
  Vec2 gradient(const VectorXd& x) const { return request_.gradient ? Vec2{x[9], x[10]} : Vec2{}; }
  Rgb offset(const VectorXd& x) const {
    const Index at = request_.gradient ? 11 : 9;
    return request_.offset ? Rgb{x[at], x[at + 1], x[at + 2]} : Rgb{};
  }
  bool residuals(const VectorXd& x, VectorXd& r) const override {
    r.resize(static_cast<Index>(3 * rows_.size()));
    const Vec2 g = gradient(x);
    const Rgb o = offset(x);
    Index k = 0;
    for (const Row& row : rows_) {
      const double light = 1 + dot(g, row.place);
      for (int c = 0; c < 3; ++c, ++k) {
        const double seen =
            x[3 * c] * row.reference.x + x[3 * c + 1] * row.reference.y + x[3 * c + 2] * row.reference.z;
        r[k] = (light * seen + o[c] - row.read[c]) / row.sigma[c];
      }
    }
    return true;
  }
  double difference(const VectorXd&, Index) const override { return 1e-5; }  // everything is of order one, or zero

 private:
  std::vector<Row> rows_;
  LightRequest request_;
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
    rows.push_back({reference * patch.xyz, read, {sigma[0], sigma[1], sigma[2]}, patch.centre - Vec2{0.5, 0.5}});
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

double ChartLight::relative_light(Vec2 place) const {
  return 1 + dot(gradient, place - Vec2{0.5, 0.5});
}

ChartLight chart_light(const Chart& chart, std::span<const PatchReading> readings, Rgb white,
                       const LightRequest& wanted, const std::string& place, std::optional<std::size_t> without) {
  LightRequest request = wanted;
  request.offset = request.offset && greys_tell(chart, readings, without);
  ChartLight light;
  if (!request.offset && !request.gradient) return light;
  const auto rows = rows_of(chart, readings, white, without);
  const LightModel model(rows, request);
  VectorXd start = VectorXd::Zero(model.size());
  start[0] = start[4] = start[8] = 1;
  optim::Terms terms;
  terms.loss = optim::Loss::huber, terms.width = 2;
  const double degrees = static_cast<double>(3 * rows.size()) - static_cast<double>(model.size());
  if (degrees < 3) return light;
  const optim::Fit fit = optim::fit(model, start, terms);
  const Eigen::MatrixXd covariance = fit.covariance * std::max(1.0, fit.cost / degrees);
  if (!fit.determined) return light;
  if (request.gradient) {
    light.gradient = model.gradient(fit.x);
    light.gradient_sigma = {std::sqrt(covariance(9, 9)), std::sqrt(covariance(10, 10))};
    light.gradient_chance = chance_of(fit.x.segment<2>(9), covariance.block<2, 2>(9, 9), degrees);
  }
  if (request.offset) {
    const Index at = model.size() - 3;
    light.offset = model.offset(fit.x) * white;
    light.offset_sigma = white * Rgb{std::sqrt(covariance(at, at)), std::sqrt(covariance(at + 1, at + 1)),
                                     std::sqrt(covariance(at + 2, at + 2))};
    light.offset_chance = chance_of(fit.x.segment<3>(at), covariance.block<3, 3>(at, at), degrees);
  }
  for (const Vec2 corner : {Vec2{0, 0}, {1, 0}, {0, 1}, {1, 1}})
    if (!(light.relative_light(corner) > 0.2))
      throw Error(Exit::data, place,
                  format("light falls to %.0f %% of the chart's middle within the chart, limit 20 %%",
                         100 * light.relative_light(corner)),
                  "light it evenly");
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
