// Variable projection of the grey values about an outline.
#include "reassembly/detect_fine.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "optim/damped.h"
#include "reassembly/detect_sums.h"

namespace gonio::reassembly {

namespace {

double wave(double turn, std::size_t term) {
  return term == 0 ? 1 : term == 1 ? std::cos(turn) : std::sin(turn);
}

// A sector's rows after its departures are eliminated: D columns of its own, the columns of the greys (now for what is
// common), the grey value.
template <std::size_t D>
class Reduced {
 public:
  Reduced() = default;
  // `rows`: D columns, greys, value. `part`: departures as they stand, already taken from the value; what holds them
  // back is in balance with the value's residual.
  Reduced(const RowSums<D + local_terms + 1>& rows, const std::array<double, local_terms>& ridge,
          const std::array<double, local_terms>& part) {
    constexpr std::size_t local = D + local_terms;
    const auto source = [](std::size_t i) { return i < local ? i : i - local_terms; };
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = i; j < size; ++j) sums_.sum[size * i + j] = rows(source(i), source(j));
    for (std::size_t i = 0; i < local_terms; ++i) sums_.sum[size * (local + i) + size - 1] -= ridge[i] * part[i];
    eliminate<local_terms>(sums_, local, ridge, solved_);
  }
  template <std::size_t N>
  void add_to(RowSums<N>& all, const FineSector& sector) const {
    static_assert(N == D + common_terms + 1);
    const auto source = [](std::size_t i) {
      return i < D ? i : i + 1 < N ? D + smooth_terms[(i - D) / waves] : size - 1;
    };
    const auto weight = [&](std::size_t i) { return i < D || i + 1 == N ? 1.0 : wave(sector.turn, (i - D) % waves); };
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = i; j < N; ++j)
        all.sum[N * i + j] += sums_(source(i), source(j)) * weight(i) * weight(j) / sector.variance;
  }
  // The departures where that is common.
  std::array<double, local_terms> parts(const std::array<double, local_terms>& mean) const {
    std::array<double, local_terms> part;
    for (std::size_t i = 0; i < local_terms; ++i) {
      part[i] = solved_[size * i + size - 1];
      for (std::size_t j = 0; j < local_terms; ++j) part[i] -= solved_[size * i + D + j] * mean[j];
    }
    return part;
  }

 private:
  static constexpr std::size_t size = D + 2 * local_terms + 1;
  RowSums<size> sums_;
  std::array<double, local_terms * size> solved_{};
};

std::array<double, local_terms> local_row(const FinePixel& p) {
  return {1, p.t, p.along, p.step.value, p.ramp.value, p.along * p.step.value, p.limb.value};
}

}  // namespace

FineFit::FineFit(const Pyramid& pyramid, const camera::CameraModel& camera, const Cone& cone, int level, double blur_px)
    : camera_(camera),
      level_(pyramid.levels[static_cast<std::size_t>(level)]),
      cone_(cone),
      blur_(std::clamp(blur_px, 0.5, 4.0)),
      noise_(pyramid.noise / level_.scale) {
  hold_ = {0, 1e-3, 1e-3, 0, 1e-3, 1e-3, 1e-3};  // loosely, of greys
  radius_ = outline_radius_px(camera, cone) / level_.scale;
  const auto centre = camera.project(cone.axis);
  if (!centre || !(radius_ > 1)) return;
  const Vec2 c = level_.from_full(*centre);
  const double reach = 1.5 * radius_ + 24;  // a sphere far off the axis shows an ellipse
  const cv::Rect wanted(static_cast<int>(c.x - reach), static_cast<int>(c.y - reach), static_cast<int>(2 * reach) + 2,
                        static_cast<int>(2 * reach) + 2);
  const cv::Rect part = wanted & cv::Rect({0, 0}, level_.bytes.size());
  if (part.empty()) return;
  x0_ = part.x, y0_ = part.y;
  const int s = static_cast<int>(level_.scale);
  const cv::Rect full(part.x * s, part.y * s, part.width * s, part.height * s);
  cv::Mat values;
  pyramid.values(full).convertTo(values, CV_32F);
  constexpr double clipped = 254.5;
  cv::Mat usable = values < clipped;
  if (!pyramid.usable.empty()) usable &= pyramid.usable(full);
  if (s == 1) {
    values_ = values, usable_ = usable;
  } else {
    cv::resize(values, values_, part.size(), 0, 0, cv::INTER_AREA);
    cv::resize(usable, usable_, part.size(), 0, 0, cv::INTER_AREA);
    usable_ = usable_ == 255;
  }
}

bool FineFit::gather() {
  if (values_.empty()) return false;
  radius_ = outline_radius_px(camera_, cone_) / level_.scale;
  if (!(radius_ > 1)) return false;
  if (sectors_.empty()) sectors_.resize(static_cast<std::size_t>(std::clamp(int(2 * pi * radius_ / 4), 10, 96)));
  window_out_ = 3 * blur_ + 1.5;
  window_in_ = std::min(0.85 * radius_, 4 * blur_ + 3);
  const ConeFrame frame(cone_.axis);
  const double half_turn = pi / static_cast<double>(sectors_.size());
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    FineSector& sector = sectors_[s];
    sector.pixels.clear();
    sector.turn = 2 * half_turn * static_cast<double>(s);
    const auto at = outline_point(camera_, frame, cone_.half_angle_rad, sector.turn);
    const auto before = outline_point(camera_, frame, cone_.half_angle_rad, sector.turn - half_turn);
    const auto after = outline_point(camera_, frame, cone_.half_angle_rad, sector.turn + half_turn);
    if (!at || !before || !after) continue;
    const Vec2 q = level_.from_full(at->pixel), a = level_.from_full(before->pixel) - q,
               b = level_.from_full(after->pixel) - q;
    sector.px_per_rad = at->px_per_rad / level_.scale;
    const double area = std::abs(a.x * b.y - a.y * b.x);  // circle through three points: abc / (4 area of triangle)
    sector.bend_px = std::max(norm(a) * norm(b) * norm(b - a) / (2 * area), 1.0);
    const double reach = std::hypot(std::max(window_in_, window_out_), std::max(norm(a), norm(b))) + 1;
    for (int y = std::max(y0_, int(q.y - reach)); y <= std::min(y0_ + values_.rows - 1, int(q.y + reach) + 1); ++y)
      for (int x = std::max(x0_, int(q.x - reach)); x <= std::min(x0_ + values_.cols - 1, int(q.x + reach) + 1); ++x) {
        if (usable_.at<unsigned char>(y - y0_, x - x0_) == 0) continue;
        const Vec2 p{double(x), double(y)};
        const double out = dot(p - q, at->normal);
        if (out > window_out_ + 1 || out < -window_in_ - 1 - reach * reach / (2 * sector.bend_px)) continue;
        FinePixel pixel;
        pixel.ray = camera_.ray(level_.to_full(p)).direction;
        const double turn = std::remainder(frame.turn(pixel.ray) - sector.turn, 2 * pi);
        const double t = (cone_.half_angle_rad - frame.angle(pixel.ray)) * sector.px_per_rad;
        if (turn < -half_turn || turn >= half_turn || t > window_in_ || t < -window_out_) continue;
        pixel.along = turn / half_turn;
        // With s the sine of the sphere's normal towards the viewer, shading is a + b s + c s^2 and a remainder, which
        // is about a tenth of s^3 for a lamp from the side. It counts as noise.
        const double s2 = std::clamp(t * (2 * radius_ - t) / (radius_ * radius_), 0.0, 1.0);
        const double left = 0.1 * contrast_ * s2 * std::sqrt(s2) / noise_;
        pixel.weight = 1 / (1 + left * left);
        pixel.value = values_.at<float>(y - y0_, x - x0_);
        sector.pixels.push_back(pixel);
      }
  }
  return true;
}

// Distances and bases of all pixels.
void FineFit::fill(const Cone& cone, double blur) {
  const ConeFrame frame(cone.axis);
  const BlurredLimb limb(radius_, blur, -window_out_ - 3, window_in_ + 3);
  for (FineSector& sector : sectors_)
    for (FinePixel& p : sector.pixels) {
      p.t = (cone.half_angle_rad - frame.angle(p.ray)) * sector.px_per_rad - blur * blur / (2 * sector.bend_px);
      p.step = blurred_step(p.t, blur);
      p.ramp = {p.t * p.step.value + blur * blur * p.step.slope, p.step.value, p.step.slope};
      p.limb = limb.at(p.t);
    }
}

double FineFit::grey(const FineSector& sector, const FinePixel& p) const {
  const auto row = local_row(p);
  double sum = 0;
  for (std::size_t i = 0; i < local_terms; ++i) sum += (sector.mean[i] + sector.part[i]) * row[i];
  return sum;
}

// What is common by the active sectors, then how every sector departs from it; returns the weighted squares of the
// active ones.
double FineFit::solve_linear() {
  std::vector<Reduced<0>> reduced(sectors_.size());
  RowSums<common_terms + 1> all;
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    const FineSector& sector = sectors_[s];
    RowSums<local_terms + 1> rows;
    for (const FinePixel& p : sector.pixels) {
      const auto local = local_row(p);
      std::array<double, local_terms + 1> row;
      std::copy(local.begin(), local.end(), row.begin());
      row[local_terms] = p.value;
      rows.add(row, p.weight);
    }
    reduced[s] = Reduced<0>(rows, ridge(sector), {});
    if (sector.active) reduced[s].add_to(all, sector);
  }
  const auto held = common_ridge();
  std::array<double, common_terms*(common_terms + 1)> found;
  eliminate<common_terms>(all, 0, held, found);
  double cost = 0;
  for (std::size_t i = 0; i < common_terms; ++i) {
    common_[i] = found[(common_terms + 1) * i + common_terms];
    cost += held[i] * common_[i] * common_[i];
  }
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    FineSector& sector = sectors_[s];
    sector.mean.fill(0);
    for (std::size_t i = 0; i < common_terms; ++i)
      sector.mean[smooth_terms[i / waves]] += common_[i] * wave(sector.turn, i % waves);
    sector.part = reduced[s].parts(sector.mean);
    sector.squares = 0;
    for (const FinePixel& p : sector.pixels) sector.squares += p.weight * std::pow(p.value - grey(sector, p), 2);
    if (!sector.active) continue;
    cost += sector.squares / sector.variance;
    for (std::size_t i = 0; i < local_terms; ++i) cost += hold_[i] * sector.part[i] * sector.part[i];
  }
  return cost;
}

// Derivatives of a pixel's grey by the distance t and by the blur: heat equation, and the shift of a curved edge.
void FineFit::derivative(const FineSector& sector, const FinePixel& p, double& by_t, double& by_blur) const {
  const auto whole = [&](std::size_t i) { return sector.mean[i] + sector.part[i]; };
  const double inside = whole(3) + whole(5) * p.along;
  by_t = whole(1) + inside * p.step.slope + whole(4) * p.ramp.slope + whole(6) * p.limb.slope;
  const double bend = inside * p.step.bend + whole(4) * p.ramp.bend + whole(6) * p.limb.bend;
  by_blur = blur_ * bend - blur_ / sector.bend_px * by_t;
}

void FineFit::linearise() {
  constexpr std::size_t columns = cone_terms + local_terms + 1, few = cone_terms + common_terms + 1;
  RowSums<few> all;
  for (const FineSector& sector : sectors_) {
    if (!sector.active) continue;
    RowSums<columns> rows;
    const double c = std::cos(sector.turn), s = std::sin(sector.turn), m = sector.px_per_rad;
    for (const FinePixel& p : sector.pixels) {
      double by_t, by_blur;
      derivative(sector, p, by_t, by_blur);
      std::array<double, columns> row{by_t * m * c, by_t * m * s, by_t * m, by_blur};
      const auto local = local_row(p);
      std::copy(local.begin(), local.end(), row.begin() + cone_terms);
      row[columns - 1] = p.value - grey(sector, p);
      rows.add(row, p.weight);
    }
    Reduced<cone_terms>(rows, ridge(sector), sector.part).add_to(all, sector);
  }
  const auto held = common_ridge();
  for (std::size_t i = 0; i < common_terms; ++i) all.sum[few * (cone_terms + i) + few - 1] -= held[i] * common_[i];
  std::array<double, common_terms * few> ignored;
  eliminate<common_terms>(all, cone_terms, held, ignored);
  for (std::size_t i = 0; i < cone_terms; ++i) {
    for (std::size_t j = 0; j < cone_terms; ++j) normal_(static_cast<int>(i), static_cast<int>(j)) = all(i, j);
    downhill_(static_cast<int>(i)) = all(i, few - 1);
  }
}

optim::Proposal FineFit::propose(double damping) {
  auto step = optim::damped_step(normal_, downhill_, damping);
  // The model is good for about a blur's width.
  const double m = radius_ / cone_.half_angle_rad, far = step.change.head<3>().norm() * m;
  const double cut =
      std::min({1.0, blur_ / std::max(far, 1e-30), 0.4 * blur_ / std::max(std::abs(step.change[3]), 1e-30)});
  change_ = step.change * cut;
  next_cone_ = moved(cone_, change_[0], change_[1], change_[2]);
  next_blur_ = std::clamp(blur_ + change_[3], 0.3, 8.0);
  return {optim::promised_fall(normal_, downhill_, change_), cut * std::max(far, std::abs(step.change[3]))};
}

double FineFit::evaluate() {
  if (!(next_cone_.half_angle_rad > 0.2 * cone_.half_angle_rad)) return HUGE_VAL;
  fill(next_cone_, next_blur_);
  return solve_linear();
}

void FineFit::accept() {
  cone_ = next_cone_, blur_ = next_blur_;
}

bool FineFit::descend_all(int most_steps) {
  fill(cone_, blur_);
  const double cost = solve_linear();
  if (!std::isfinite(cost)) return false;
  optim::Limits limits;
  limits.most_steps = most_steps;
  limits.most_refusals = 4;
  limits.small_fall = {0, 0.02};
  limits.small_step = 5e-4;
  optim::descend(*this, cost, limits);
  fill(cone_, blur_);
  solve_linear();
  return is_finite(cone_.axis) && std::isfinite(cone_.half_angle_rad);
}

std::array<double, local_terms> FineFit::ridge(const FineSector& sector) const {
  std::array<double, local_terms> held{};
  for (std::size_t i = 0; i < local_terms; ++i) held[i] = hold_[i] * sector.variance;
  return held;
}

// Slopes of the size of the contrast over the radius are to be expected, and limbs of half the contrast: it matters for
// small and blurred outlines, where a limb, a slope, the blur and the radius can stand in for each other.
std::array<double, common_terms> FineFit::common_ridge() const {
  const double contrast = contrast_ > 0 ? contrast_ : 128, along = 2 * pi / static_cast<double>(sectors_.size());
  const double slope = contrast / radius_, turn = contrast * along, limb = 0.5 * contrast;
  const std::array<double, smooth_terms.size()> sigma{slope, turn, slope, turn, limb};
  std::array<double, common_terms> held;
  for (std::size_t i = 0; i < common_terms; ++i) held[i] = 1 / (sigma[i / waves] * sigma[i / waves]);
  return held;
}

// Maximum likelihood of the departures' variances by expectation and maximisation (Dempster, Laird & Rubin 1977): a
// departure's square is what was found and what it is still uncertain by.
void FineFit::learn_slopes() {
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    std::array<double, local_terms> square{}, uncertain{};
    double count = 0;
    for (const FineSector& sector : sectors_) {
      if (!sector.active) continue;
      RowSums<local_terms> rows;
      for (const FinePixel& p : sector.pixels) rows.add(local_row(p), p.weight);
      std::array<double, local_terms * local_terms> inverse{};
      if (!block_inverse(rows, 0, ridge(sector), inverse)) continue;
      for (std::size_t i = 0; i < local_terms; ++i) {
        square[i] += sector.part[i] * sector.part[i];
        uncertain[i] += inverse[local_terms * i + i] * sector.variance;
      }
      count += 1;
    }
    if (count < 5) return;
    // What is common has taken its share of the freedom.
    for (const std::size_t i : smooth_terms) hold_[i] = (count - waves) / (square[i] + uncertain[i] + 1e-9);
    solve_linear();
  }
}

void FineFit::judge_sectors() {
  for (FineSector& sector : sectors_) {
    RowSums<local_terms + 2> rows;
    for (const FinePixel& p : sector.pixels) {
      double by_t, by_blur;
      derivative(sector, p, by_t, by_blur);
      const auto local = local_row(p);
      std::array<double, local_terms + 2> row;
      std::copy(local.begin(), local.end(), row.begin());
      row[local_terms] = by_t, row[local_terms + 1] = p.value - grey(sector, p);
      rows.add(row, p.weight);
    }
    const auto held = ridge(sector);
    for (std::size_t i = 0; i < local_terms; ++i)
      rows.sum[(local_terms + 2) * i + local_terms + 1] -= held[i] * sector.part[i];
    std::array<double, local_terms*(local_terms + 2)> ignored;
    eliminate<local_terms>(rows, 0, held, ignored);
    const double information = rows(local_terms, local_terms);
    if (sector.pixels.size() < local_terms + 2 || !(information > 1e-9)) {
      sector.move_sigma_px = HUGE_VAL;
      continue;
    }
    sector.move_px = rows(local_terms, local_terms + 1) / information;
    sector.move_sigma_px = std::sqrt(sector.variance / information);
    const auto whole = [&](std::size_t i) { return sector.mean[i] + sector.part[i]; };
    const double in = std::min(2 * blur_, window_in_);
    sector.contrast = whole(3) + whole(4) * in + whole(6) * std::sqrt(std::max(0.0, 1 - std::pow(1 - in / radius_, 2)));
  }
}

bool FineFit::covariance(Mat3& rad2) {
  linearise();
  std::array<double, 16> h{}, inverse{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) h[static_cast<std::size_t>(4 * i + j)] = normal_(i, j);
  if (!linear::positive_inverse<4>(h, inverse, 1e-10)) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rad2(i, j) = inverse[static_cast<std::size_t>(4 * i + j)];
  return true;
}

}  // namespace gonio::reassembly
