// Bending energy of a mesh, and its minimum under unilateral constraints: augmented Lagrangians (Rockafellar 1974,
// Nocedal & Wright 2006, 17.4) whose inner problem, piecewise quadratic, falls to Newton steps in few iterations: the
// set of broken rows is the active set (Hintermueller, Ito & Kunisch 2003).
#include "reassembly/contact_plate.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/sparse.h"

namespace gonio::reassembly::contact {
namespace {

constexpr std::uint32_t held = std::numeric_limits<std::uint32_t>::max();

// Cotangent of the angle at a; slivers count as needles of a degree, so that no weight rules all others.
double cotangent(Vec3 a, Vec3 b, Vec3 c) {
  constexpr double most = 57;
  const double across = norm(cross(b - a, c - a)), along = dot(b - a, c - a);
  return across > 0 ? std::clamp(along / across, -most, most) : 0;
}

// One square of the energy: scale / 2 (sum of weight u)^2 over free vertices.
struct Stencil {
  std::vector<std::pair<std::uint32_t, double>> weights;
  double scale = 0;
};

struct Weights {
  std::vector<std::vector<std::pair<std::uint32_t, double>>> to;  // per vertex: neighbour, (cot + cot) / 2
  std::vector<double> area;
  std::vector<std::uint8_t> border;
};

Weights weights_of(const Layered& shape) {
  Weights w{std::vector<std::vector<std::pair<std::uint32_t, double>>>(shape.at.size()),
            std::vector<double>(shape.at.size(), 0), std::vector<std::uint8_t>(shape.at.size(), 0)};
  struct Side {
    std::uint32_t a, b;
    double half;
  };
  std::vector<Side> sides;
  sides.reserve(3 * shape.faces.size());
  for (const auto& f : shape.faces) {
    const double area = norm(cross(shape.at[f[1]] - shape.at[f[0]], shape.at[f[2]] - shape.at[f[0]])) / 2;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = f[(k + 1) % 3], j = f[(k + 2) % 3];
      if (i == j) continue;
      sides.push_back({std::min(i, j), std::max(i, j), cotangent(shape.at[f[k]], shape.at[i], shape.at[j]) / 2});
      w.area[f[k]] += area / 3;
    }
  }
  std::ranges::stable_sort(sides, [](const Side& p, const Side& q) {
    return std::pair{p.a, p.b} < std::pair{q.a, q.b};
  });
  for (std::size_t k = 0; k < sides.size();) {
    std::size_t end = k;
    double sum = 0;
    for (; end < sides.size() && sides[end].a == sides[k].a && sides[end].b == sides[k].b; ++end)
      sum += sides[end].half;
    const auto [a, b] = std::pair{sides[k].a, sides[k].b};
    if (end - k != 2) w.border[a] = w.border[b] = 1;
    w.to[a].emplace_back(b, sum);
    w.to[b].emplace_back(a, sum);
    k = end;
  }
  return w;
}

// The Laplacian of a vertex on the border says its slope across the border, which costs nothing: no stencil there.
std::vector<Stencil> stencils_of(const Layered& shape, const std::vector<std::uint32_t>& number, double foundation) {
  const Weights w = weights_of(shape);
  double mean_area = 0;
  for (const double a : w.area) mean_area += a / static_cast<double>(w.area.size());
  std::vector<Stencil> out;
  for (std::uint32_t v = 0; v < shape.at.size(); ++v) {
    const double area = std::max(w.area[v], 1e-3 * mean_area);
    if (number[v] != held) out.push_back({{{number[v], 1.0}}, area / std::pow(foundation, 4)});
    if (w.border[v] != 0) continue;
    Stencil s;
    double own = 0;
    for (const auto& [to, weight] : w.to[v]) {
      own -= weight;
      if (number[to] != held) s.weights.emplace_back(number[to], weight);
    }
    if (number[v] != held) s.weights.emplace_back(number[v], own);
    s.scale = 1 / area;
    if (!s.weights.empty()) out.push_back(std::move(s));
  }
  return out;
}

void add_square(std::vector<linear::Summand>& lower, std::span<const std::pair<std::uint32_t, double>> weights,
                double scale) {
  for (const auto& [i, a] : weights)
    for (const auto& [j, b] : weights)
      if (i >= j) lower.push_back({i, j, scale * a * b});
}

struct FreeRow {
  std::vector<std::pair<std::uint32_t, double>> weights;
  double bound = 0;
  double short_by(const Eigen::VectorXd& u) const {
    double sum = bound;
    for (const auto& [i, a] : weights) sum -= a * u[i];
    return sum;
  }
};

class Lagrangian {
 public:
  Lagrangian(const std::vector<Stencil>& stencils, std::vector<FreeRow> rows, std::uint32_t size)
      : stencils_(stencils), rows_(std::move(rows)), multiplier_(rows_.size(), 0.0), solver_(size), u_(size) {
    u_.setZero();
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size);
    for (const Stencil& s : stencils_) {
      add_square(stiffness_, s.weights, s.scale);
      for (const auto& [i, a] : s.weights) diagonal[i] += s.scale * a * a;
    }
    stiff_ = 10 * diagonal.mean();
  }

  Eigen::VectorXd minimum(double tolerance) {
    for (int round = 0; round < 30; ++round) {
      newton();
      double worst = 0;
      for (std::size_t k = 0; k < rows_.size(); ++k) {
        const double lack = rows_[k].short_by(u_);
        worst = std::max(worst, lack);
        multiplier_[k] = std::max(0.0, multiplier_[k] + stiff_ * lack);
      }
      if (worst <= tolerance) break;
    }
    return u_;
  }

 private:
  double pull(std::size_t k, const Eigen::VectorXd& u) const {
    return std::max(0.0, multiplier_[k] + stiff_ * rows_[k].short_by(u));
  }
  double value(const Eigen::VectorXd& u) const {
    double sum = 0;
    for (const Stencil& s : stencils_) {
      double laplace = 0;
      for (const auto& [i, a] : s.weights) laplace += a * u[i];
      sum += s.scale * laplace * laplace / 2;
    }
    for (std::size_t k = 0; k < rows_.size(); ++k) sum += pull(k, u) * pull(k, u) / (2 * stiff_);
    return sum;
  }
  void newton() {
    std::vector<std::uint8_t> active, before;
    double now = value(u_);
    for (int step = 0; step < 40; ++step) {
      active.assign(rows_.size(), 0);
      for (std::size_t k = 0; k < rows_.size(); ++k) active[k] = pull(k, u_) > 0;
      if (active == before) return;
      std::vector<linear::Summand> lower = stiffness_;
      Eigen::VectorXd right = Eigen::VectorXd::Zero(u_.size());
      for (std::size_t k = 0; k < rows_.size(); ++k) {
        add_square(lower, rows_[k].weights, active[k] != 0 ? stiff_ : 0);  // zeros keep the pattern
        if (active[k] != 0)
          for (const auto& [i, a] : rows_[k].weights) right[i] += a * (multiplier_[k] + stiff_ * rows_[k].bound);
      }
      if (!solver_.factor(lower)) return;
      const Eigen::VectorXd way = solver_.solve(right) - u_;
      double share = 1, next = value(u_ + way);
      for (; next > now && share > 1e-3; next = value(u_ + share * way)) share /= 2;
      const bool still = !(next < now * (1 - 1e-12));
      u_ += share * way;
      now = next;
      before = share == 1 ? active : std::vector<std::uint8_t>{};
      if (still && step > 0) return;
    }
  }

  const std::vector<Stencil>& stencils_;
  std::vector<FreeRow> rows_;
  std::vector<double> multiplier_;
  linear::SparseLlt solver_;
  Eigen::VectorXd u_;
  std::vector<linear::Summand> stiffness_;
  double stiff_ = 1;
};

}  // namespace

std::vector<double> bent(const Layered& shape, const std::vector<std::uint8_t>& free, std::span<const Row> rows,
                         double foundation, double tolerance) {
  std::vector<std::uint32_t> number(shape.at.size(), held);
  std::uint32_t size = 0;
  for (std::size_t v = 0; v < number.size(); ++v)
    if (free[v] != 0) number[v] = size++;
  std::vector<double> u(shape.at.size(), 0);
  if (size == 0) return u;
  std::vector<FreeRow> among;
  for (const Row& row : rows) {
    FreeRow r{{}, row.bound};
    for (std::uint32_t k = 0; k < row.count; ++k)
      if (number[row.vertex[k]] != held) r.weights.emplace_back(number[row.vertex[k]], row.weight[k]);
    if (!r.weights.empty()) among.push_back(std::move(r));
  }
  const std::vector<Stencil> stencils = stencils_of(shape, number, foundation);
  const Eigen::VectorXd least = Lagrangian(stencils, std::move(among), size).minimum(tolerance);
  for (std::size_t v = 0; v < number.size(); ++v)
    if (number[v] != held) u[v] = least[number[v]];
  return u;
}

std::optional<std::vector<std::uint32_t>> press(std::vector<double>& u, const std::vector<std::uint8_t>& free,
                                                std::span<const Row> rows, double tolerance, int most_rounds) {
  constexpr double least_hold = 0.01;  // a row that hangs on less of itself is no way to push it
  for (int round = 0; round < most_rounds; ++round) {
    bool broken = false;
    std::vector<std::uint32_t> needed;
    for (const Row& row : rows) {
      const double lack = row.short_by(u);
      if (lack <= tolerance) continue;
      broken = true;
      double all = 0, pushed = 0;  // of the weights above zero
      for (std::uint32_t k = 0; k < row.count; ++k)
        if (row.weight[k] > 0) {
          all += row.weight[k];
          if (free[row.vertex[k]] != 0) pushed += row.weight[k];
        }
      const bool holds = pushed > least_hold * all;
      for (std::uint32_t k = 0; k < row.count; ++k)
        if (row.weight[k] > 0) {
          if (!holds && free[row.vertex[k]] == 0) needed.push_back(row.vertex[k]);
          if (holds && free[row.vertex[k]] != 0) u[row.vertex[k]] += lack / pushed;
        }
    }
    if (!broken || !needed.empty()) return needed;
  }
  return {};
}

}  // namespace gonio::reassembly::contact
