// The fit of corner_refinement.h.
#include "camera/corner_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "optim/damped.h"
#include "optim/descent.h"

namespace gonio::camera {
namespace {

constexpr double reach_share = 0.42;  // of a square, along each edge its own side
constexpr double least_reach_px = 2.5, largest_reach_px = 12;
constexpr double least_band_px = 1.5, largest_band_px = 4.5;  // across the edges, to either side
constexpr double reach_blurs = 4, band_blurs = 2.5;           // both are at least so many blurs, where squares allow
constexpr double print_blur_px = 0.5;                         // that other ink may come nearer by
constexpr double largest_move = 0.25;                         // of a square
constexpr double largest_turn = 0.35;                         // rad, of an edge against its prediction
constexpr double largest_blur = 0.3;                          // of a square
// What the fit leaves, rms over the contrast: the most, and that beyond which it must not be this many times the
// picture's median.
constexpr double largest_misfit = 0.35, doubtful_misfit = 0.08, doubtful_times = 2.5;
constexpr double largest_sigma_px = 0.5;
constexpr double start_blur_px = 0.9, least_blur_px = 0.3;
constexpr int most_steps = 15;
constexpr double small_step_px = 2e-3;  // the last one; what is left after it is far less
constexpr int parameters = 10;
enum Parameter { x, y, turn1, turn2, blur1, blur2, level, slope_x, slope_y, contrast };

using Vector = Eigen::Matrix<double, parameters, 1>;
using Matrix = Eigen::Matrix<double, parameters, parameters>;

// erf(z / sqrt 2) and its derivative, tabulated: linear interpolation errs by less than 1e-6.
class Edge {
 public:
  Edge() {
    for (int i = 0; i <= count; ++i) {
      const double z = i * step - limit;
      table_[static_cast<std::size_t>(i)] = {std::erf(z * std::sqrt(0.5)),
                                             std::sqrt(2 / CV_PI) * std::exp(-0.5 * z * z)};
    }
  }
  std::array<double, 2> operator()(double z) const {
    if (z <= -limit) return {-1, 0};
    if (z >= limit) return {1, 0};
    const double at = (z + limit) / step;
    const auto i = static_cast<std::size_t>(at);
    const double f = at - static_cast<double>(i);
    const auto &a = table_[i], &b = table_[i + 1];
    return {a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])};
  }

 private:
  static constexpr int count = 4096;
  static constexpr double limit = 6, step = 2 * limit / count;
  std::array<std::array<double, 2>, count + 2> table_{};
};

struct Sample {
  double x, y, value;  // pixels from the window's middle; grey
};

struct Window {  // what the fit looks at
  cv::Point2d middle;
  std::vector<Sample> samples;
};

// A parallelogram of samples along both edges. Its two sides follow the board's own: a tilted board's squares are
// several times as long as they are high, and what their short sides allow would leave the long edges unread.
struct Extent {
  double sine = 1;                                     // between the edges
  double reach_columns = 0, reach_rows = 0;            // along the edges, px
  double inked_columns = 0, inked_rows = 0, bare = 0;  // across the edges, px; bare: towards no other ink
};

Extent extent_of(const Prediction& p, double clear_share, double blur_px, const DetectionOptions& options) {
  const double u_px = cv::norm(p.along_columns), v_px = cv::norm(p.along_rows);
  Extent e;
  e.sine = std::abs(p.along_columns.cross(p.along_rows)) / (u_px * v_px);
  const double most = std::max(largest_reach_px, reach_blurs * blur_px);
  const auto reach = [&](double side) {
    return options.window_px > 0 ? options.window_px : std::clamp(reach_share * side, least_reach_px, most);
  };
  e.reach_columns = reach(u_px);
  e.reach_rows = reach(v_px);
  e.bare = std::max(largest_band_px, band_blurs * blur_px);
  const auto inked = [&](double side) {
    return std::clamp(clear_share * side * e.sine - print_blur_px, least_band_px, e.bare);
  };
  e.inked_columns = inked(v_px);
  e.inked_rows = inked(u_px);
  return e;
}

template <class Value>
void collect(const cv::Mat& values, const Prediction& p, const Extent& e, Window& window) {
  window.samples.clear();
  const cv::Point2d &u = p.along_columns, &v = p.along_rows;
  const double area = u.cross(v), u_px = cv::norm(u), v_px = cv::norm(v);
  const int left = static_cast<int>(std::lround(window.middle.x)), top = static_cast<int>(std::lround(window.middle.y));
  const auto half = [&](double ux, double vx) {  // of the parallelogram's bounding box
    return static_cast<int>(std::ceil(e.reach_columns * std::abs(ux) / u_px + e.reach_rows * std::abs(vx) / v_px)) + 1;
  };
  const int half_x = half(u.x, v.x), half_y = half(u.y, v.y);
  for (int row = std::max(0, top - half_y); row <= std::min(values.rows - 1, top + half_y); ++row) {
    const Value* line = values.ptr<Value>(row);
    for (int column = std::max(0, left - half_x); column <= std::min(values.cols - 1, left + half_x); ++column) {
      const cv::Point2d d(column - window.middle.x, row - window.middle.y);
      const double s = d.cross(v) / area * u_px, t = u.cross(d) / area * v_px;  // oblique, in pixels along the edges
      const bool inked = p.bare * s * t < 0;
      const double off_columns = std::abs(t) * e.sine, off_rows = std::abs(s) * e.sine;
      if (std::abs(s) > e.reach_columns || std::abs(t) > e.reach_rows ||
          (off_columns > (inked ? e.inked_columns : e.bare) && off_rows > (inked ? e.inked_rows : e.bare)))
        continue;
      window.samples.push_back({d.x, d.y, static_cast<double>(line[column])});
    }
  }
}

class Saddle final : public optim::Descent {
 public:
  Saddle(const Window& window, const Prediction& p) : window_(window) {
    q_.setZero();
    q_[turn1] = std::atan2(p.along_columns.y, p.along_columns.x);
    q_[turn2] = std::atan2(p.along_rows.y, p.along_rows.x);
    q_[blur1] = q_[blur2] = start_blur_px;
    solve_linear();
  }

  // False where the samples do not determine the corner.
  bool fit() {
    next_ = q_;
    const double cost = evaluate();
    accept();
    optim::Limits limits;
    limits.most_trials = most_steps;
    limits.least_damping = 1e-9;
    limits.small_fall = {};
    limits.small_step = small_step_px;
    return finish(optim::descend(*this, cost, limits).cost);
  }
  const Vector& parameters_found() const { return q_; }
  double sigma_px() const { return sigma_px_; }
  double misfit() const { return misfit_; }

 private:
  // Level, slopes and contrast for the edges as predicted.
  void solve_linear() {
    Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    for (const Sample& s : window_.samples) {
      const double d1 = std::cos(q_[turn1]) * s.y - std::sin(q_[turn1]) * s.x;
      const double d2 = std::cos(q_[turn2]) * s.y - std::sin(q_[turn2]) * s.x;
      const Eigen::Vector4d j(1, s.x, s.y, edge(d1 / q_[blur1])[0] * edge(d2 / q_[blur2])[0]);
      a += j * j.transpose();
      b += s.value * j;
    }
    q_.tail<4>() = a.ldlt().solve(b);
  }

  void linearise() override {}  // evaluate() has
  optim::Proposal propose(double damping) override {
    const auto step = optim::damped_step(normal_, gradient_, damping);
    next_ = q_ + step.change;
    for (const int k : {blur1, blur2}) next_[k] = std::clamp(next_[k], least_blur_px, 2 * std::max(1.0, q_[k]));
    return {step.promised, std::hypot(step.change[x], step.change[y])};
  }
  double evaluate() override {
    const Vector& q = next_;
    next_normal_.setZero();
    next_gradient_.setZero();
    const double c1 = std::cos(q[turn1]), s1 = std::sin(q[turn1]), c2 = std::cos(q[turn2]), s2 = std::sin(q[turn2]);
    double cost = 0;
    for (const Sample& s : window_.samples) {
      const double dx = s.x - q[x], dy = s.y - q[y];
      const double d1 = c1 * dy - s1 * dx, d2 = c2 * dy - s2 * dx, a1 = c1 * dx + s1 * dy, a2 = c2 * dx + s2 * dy;
      const auto [e1, g1] = edge(d1 / q[blur1]);
      const auto [e2, g2] = edge(d2 / q[blur2]);
      const double k1 = q[contrast] * e2 * g1 / q[blur1], k2 = q[contrast] * e1 * g2 / q[blur2];
      const double residual = s.value - q[level] - q[slope_x] * s.x - q[slope_y] * s.y - q[contrast] * e1 * e2;
      Vector j;
      j << k1 * s1 + k2 * s2, -k1 * c1 - k2 * c2, -k1 * a1, -k2 * a2, -k1 * d1 / q[blur1], -k2 * d2 / q[blur2], 1, s.x,
          s.y, e1 * e2;
      next_normal_.noalias() += j * j.transpose();
      next_gradient_ += residual * j;
      cost += residual * residual;
    }
    return cost;
  }
  void accept() override {
    q_ = next_;
    normal_ = next_normal_;
    gradient_ = next_gradient_;
  }

  bool finish(double cost) {
    const double free = static_cast<double>(window_.samples.size()) - parameters;
    const Matrix inverse = normal_.inverse();
    sigma_px_ = std::sqrt(0.5 * (inverse(x, x) + inverse(y, y)) * cost / free);
    misfit_ = std::sqrt(cost / free) / std::abs(q_[contrast]);
    return std::isfinite(sigma_px_) && sigma_px_ < largest_sigma_px;
  }

  static std::array<double, 2> edge(double z) {
    static const Edge table;
    return table(z);
  }
  const Window& window_;
  Vector q_, next_, gradient_, next_gradient_;
  Matrix normal_, next_normal_;
  double sigma_px_ = 0, misfit_ = 0;
};

double turn_between(double a, double b) {  // of directions of lines
  return std::abs(std::remainder(a - b, CV_PI));
}

cv::Point2d rough_place(const cv::Mat& values, const cv::Point2d& at, double reach) {
  const int window = std::max(2, static_cast<int>(std::lround(0.75 * reach)));
  std::vector<cv::Point2f> point{cv::Point2f(at)};
  cv::cornerSubPix(values, point, cv::Size(window, window), cv::Size(-1, -1),
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 4, 0.1});
  return point[0];
}

struct Refined {
  Corner corner;
  double misfit = 0;
};

void collect_any(const cv::Mat& values, const Prediction& p, const Extent& e, Window& window) {
  if (values.depth() == CV_8U)
    collect<unsigned char>(values, p, e, window);
  else
    collect<float>(values, p, e, window);
}

bool has_turned(const Vector& q, const Prediction& p) {
  return turn_between(q[turn1], std::atan2(p.along_columns.y, p.along_columns.x)) > largest_turn ||
         turn_between(q[turn2], std::atan2(p.along_rows.y, p.along_rows.x)) > largest_turn;
}

std::optional<Refined> refine_one(const cv::Mat& values, const Prediction& p, double clear_share,
                                  const DetectionOptions& options) {
  const double side = p.square_px();
  Extent extent = extent_of(p, clear_share, 0, options);
  const double margin = std::max(extent.reach_columns, extent.reach_rows) + 1;
  const auto inside = [&](const cv::Point2d& at) {
    return at.x >= margin && at.y >= margin && at.x <= values.cols - 1 - margin && at.y <= values.rows - 1 - margin;
  };
  if (!inside(p.pixel)) return {};
  const double rough = std::min({extent.reach_columns, extent.reach_rows, std::max(2.0, 0.9 * clear_share * side)});
  Window window{rough_place(values, p.pixel, rough), {}};
  if (cv::norm(window.middle - p.pixel) > largest_move * side) window.middle = p.pixel;
  if (!inside(window.middle)) return {};
  std::optional<Saddle> saddle;
  const auto fitted = [&] {
    collect_any(values, p, extent, window);
    return window.samples.size() >= 2 * parameters && saddle.emplace(window, p).fit();
  };
  if (!fitted()) return {};
  const double blur = std::max(saddle->parameters_found()[blur1], saddle->parameters_found()[blur2]);
  if (blur * band_blurs > largest_band_px && blur <= largest_blur * side) {  // out of focus: the edges are wider
    extent = extent_of(p, clear_share, blur, options);
    if (!fitted()) return {};
  }
  const Vector& q = saddle->parameters_found();
  const cv::Point2d at = window.middle + cv::Point2d(q[x], q[y]);
  if (saddle->misfit() > largest_misfit || cv::norm(at - p.pixel) > largest_move * side || has_turned(q, p) ||
      std::max(q[blur1], q[blur2]) > std::max(1.0, largest_blur * side))
    return {};
  return Refined{{p.id, {at.x, at.y}, saddle->sigma_px()}, saddle->misfit()};
}

}  // namespace

std::vector<Corner> refine(const cv::Mat& values, const std::vector<Prediction>& predictions, double clear_share,
                           const DetectionOptions& options) {
  std::vector<Refined> found;
  for (const Prediction& prediction : predictions) {
    if (const auto one = refine_one(values, prediction, clear_share, options)) found.push_back(*one);
  }
  std::vector<double> misfits;
  for (const Refined& one : found) misfits.push_back(one.misfit);
  std::ranges::sort(misfits);
  const double most = found.empty() ? 0 : std::max(doubtful_misfit, doubtful_times * misfits[misfits.size() / 2]);
  std::vector<Corner> corners;
  for (const Refined& one : found) {
    if (one.misfit <= most) corners.push_back(one.corner);
  }
  std::ranges::sort(corners, {}, &Corner::id);
  return corners;
}

}  // namespace gonio::camera
