// See place_adjust.h.
#include "reassembly/place_adjust.h"

#include <cmath>
#include <limits>

#include "linear/geom_matrices.h"
#include "linear/positive.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::reassembly {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using OwnBlock = Eigen::Matrix<double, Eigen::Dynamic, 4>;

struct Standing {  // where everything stands
  std::vector<Matrix3d> rotation;
  std::vector<Vector3d> place;
  std::vector<Vector6> z;        // of views
  std::vector<Vector4d> marker;  // y, radius
  double scale = 1;
};

// What one marker adds to the normal equations.
struct MarkerPart {
  MatrixXd h;  // of the shared numbers
  VectorXd g;  // downhill
  OwnBlock b;  // shared x own
  Matrix4d d;  // own
  Vector4d e;  // downhill
};

class EveryPlace final : public optim::Descent {
 public:
  EveryPlace(const Adjusted& all, const std::vector<Matrix6>& covariance) : all_(all) {
    for (const AdjustedPiece& p : all.pieces) {
      here_.rotation.push_back(p.rotation);
      here_.place.push_back(p.place);
    }
    size_ = 6 * static_cast<Index>(all.pieces.size());
    if (all.free_scale) scale_ = size_++;
    here_.scale = all.scale;
    for (const Matrix6& c : covariance) {
      const linear::SymmetricEigen<Matrix6> e(c);
      roots_.push_back(e.eigenvectors() * e.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal());
      camera_.push_back(c.isZero(0) ? -1 : size_);
      if (!c.isZero(0)) size_ += 6;
      here_.z.push_back(Vector6::Zero());
    }
    for (const AdjustedMarker& m : all.markers)
      here_.marker.push_back({0, 0, 0, m.radius ? *m.radius : m.start_radius});
  }

  void linearise() override {
    h_ = MatrixXd::Zero(size_, size_);
    g_ = VectorXd::Zero(size_);
    for (std::size_t v = 0; v < camera_.size(); ++v)
      if (camera_[v] >= 0) {
        h_.diagonal().segment<6>(camera_[v]).array() += 1;
        g_.segment<6>(camera_[v]) -= here_.z[v];
      }
    parts_.resize(all_.markers.size());
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      if (!all_.markers[k].used) continue;
      parts_[k] = part_of(k);
      h_ += parts_[k].h;
      g_ += parts_[k].g;
    }
  }

  optim::Proposal propose(double damping) override {
    MatrixXd s = h_;
    s.diagonal() *= 1 + damping;
    VectorXd g = g_;
    for (std::size_t k = 0; k < parts_.size(); ++k)
      if (all_.markers[k].used) eliminate(parts_[k], damping, s, g);
    const VectorXd x = linear::Ldlt(s).solve(g);
    there_ = here_;
    double promised = g_.dot(x) + damping * x.dot(h_.diagonal().cwiseProduct(x));
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      if (!all_.markers[k].used) continue;
      const MarkerPart& p = parts_[k];
      const Vector4d own = damped_inverse(p, damping) * (p.e - p.b.transpose() * x);
      promised += p.e.dot(own) + damping * own.dot(p.d.diagonal().cwiseProduct(own));
      there_.marker[k] += own;
    }
    step(x);
    return {promised, std::sqrt(x.cwiseAbs2().dot(h_.diagonal()))};
  }
  double evaluate() override { return cost_of(there_); }
  void accept() override { here_ = there_; }
  double cost() const { return cost_of(here_); }

  void write(Adjusted& out) {
    linearise();
    MatrixXd s = h_;
    VectorXd g = g_;
    for (std::size_t k = 0; k < parts_.size(); ++k)
      if (all_.markers[k].used) eliminate(parts_[k], 0, s, g);
    const MatrixXd c = linear::Ldlt(s).solve(MatrixXd(MatrixXd::Identity(size_, size_)));
    for (std::size_t p = 0; p < out.pieces.size(); ++p) {
      out.pieces[p].rotation = here_.rotation[p];
      out.pieces[p].place = here_.place[p];
      out.pieces[p].covariance = c.block<6, 6>(6 * static_cast<Index>(p), 6 * static_cast<Index>(p));
    }
    out.scale = here_.scale;
    if (scale_ >= 0) out.sigma_scale = here_.scale * std::sqrt(std::max(0.0, c(scale_, scale_)));
    out.cameras.clear();
    for (std::size_t v = 0; v < here_.z.size(); ++v) out.cameras.push_back(roots_[v] * here_.z[v]);
    for (std::size_t k = 0; k < out.markers.size(); ++k) write_marker(k, s, out.markers[k]);
  }

 private:
  static Matrix4d damped_inverse(const MarkerPart& p, double damping) {
    Matrix4d d = p.d;
    d.diagonal() *= 1 + damping;
    std::array<double, 16> a, inverse{};
    Eigen::Map<Matrix4d>(a.data()) = d;
    linear::positive_inverse<4>(a, inverse);  // the prior makes it so
    return Eigen::Map<const Matrix4d>(inverse.data());
  }
  static void eliminate(const MarkerPart& p, double damping, MatrixXd& s, VectorXd& g) {
    const OwnBlock w = p.b * damped_inverse(p, damping);
    s.noalias() -= w * p.b.transpose();
    g.noalias() -= w * p.e;
  }

  Vector3d centre_of(const Standing& at, std::size_t piece) const {
    return at.rotation[piece] * (at.scale * all_.pieces[piece].anchor) + at.place[piece];
  }
  Vector3d arm_of(const Standing& at, std::size_t k) const {  // from the piece's centre, along the world's axes
    const AdjustedMarker& m = all_.markers[k];
    const Vector3d in_piece = m.prior + m.root * at.marker[k].head<3>() - all_.pieces[m.piece].anchor;
    return at.rotation[m.piece] * (at.scale * in_piece);
  }

  void step(const VectorXd& x) {
    if (scale_ >= 0) there_.scale = here_.scale * std::exp(x[scale_]);
    for (std::size_t p = 0; p < here_.place.size(); ++p) {
      const Vector6 d = x.segment<6>(6 * static_cast<Index>(p));
      const Vector3d centre = centre_of(here_, p);
      const Matrix3d turn = linear::as_eigen(matrix_of(quaternion_of_rotation_vector({d[0], d[1], d[2]})));
      there_.rotation[p] = turn * here_.rotation[p];
      // The centre goes by the place alone, whatever the scale.
      there_.place[p] = centre + d.tail<3>() - there_.rotation[p] * (there_.scale * all_.pieces[p].anchor);
    }
    for (std::size_t v = 0; v < camera_.size(); ++v)
      if (camera_[v] >= 0) there_.z[v] += x.segment<6>(camera_[v]);
  }

  Sight sight_at(const Standing& at, const AdjustedSight& s) const {
    return camera_[s.view] < 0 ? s.sight : moved(s.sight, roots_[s.view] * at.z[s.view]);
  }

  MarkerPart part_of(std::size_t k) const {
    const AdjustedMarker& m = all_.markers[k];
    MarkerPart p{MatrixXd::Zero(size_, size_), VectorXd::Zero(size_), OwnBlock::Zero(size_, 4), Matrix4d::Zero(),
                 Vector4d::Zero()};
    p.d.diagonal().head<3>().setOnes();
    p.e.head<3>() = -here_.marker[k].head<3>();
    const Vector3d arm = arm_of(here_, k), point = centre_of(here_, m.piece) + arm;
    Eigen::Matrix<double, 3, 7> by_shared;  // of the point by rotation, place, log scale
    by_shared << -linear::cross_matrix(arm), Matrix3d::Identity(), arm;
    const Matrix3d by_y = here_.scale * here_.rotation[m.piece] * m.root;
    const auto add = [&](const Matrix3d& by_point, const Vector3d& by_radius, const Vector3d& r, const Vector3d& weight,
                         Index camera, const Matrix6& root, const Eigen::Matrix<double, 3, 6>& by_pose) {
      MatrixXd j = MatrixXd::Zero(3, 17);  // piece, scale, camera, own
      j.leftCols<7>() = by_point * by_shared;
      if (camera >= 0) j.middleCols<6>(7) = by_pose * root;
      j.middleCols<3>(13) = by_point * by_y;
      if (!m.radius) j.col(16) = by_radius;
      const MatrixXd wj = weight.asDiagonal() * j;
      const MatrixXd h = j.transpose() * wj;
      const VectorXd g = -(wj.transpose() * r);
      std::vector<std::array<Index, 3>> runs{{0, 6 * static_cast<Index>(m.piece), 6}};
      if (scale_ >= 0) runs.push_back({6, scale_, 1});
      if (camera >= 0) runs.push_back({7, camera, 6});
      for (const auto& [a, at, n] : runs) {
        for (const auto& [a2, at2, n2] : runs) p.h.block(at, at2, n, n2) += h.block(a, a2, n, n2);
        p.g.segment(at, n) += g.segment(a, n);
        p.b.middleRows(at, n) += h.block(a, 13, n, 4);
      }
      p.d += h.bottomRightCorner<4, 4>();
      p.e += g.tail<4>();
    };
    if (m.point)
      add(m.point_white, Vector3d::Zero(), m.point_white * (point - *m.point), Vector3d::Ones(), -1, Matrix6::Zero(),
          Eigen::Matrix<double, 3, 6>::Zero());
    for (const AdjustedSight& s : m.sights) {
      if (!s.used) continue;
      const Sight sight = sight_at(here_, s);
      Misfit f;
      if (!misfit(sight, point, here_.marker[k][3], f)) continue;
      const Matrix3d white = lower_inverse(lower_root(sight.covariance));
      const Vector3d r = white * f.r;
      add(white * f.by_point, white * f.by_radius, r, {1, 1, sight.sized ? size_weight(r[2]) : 0}, camera_[s.view],
          roots_[s.view], white * f.by_pose);
    }
    if (p.d(3, 3) <= 0) p.d(3, 3) = 1;
    return p;
  }

  // Sum of squares of one marker's residuals, its prior included; infinite where it has no value.
  double square_of(const Standing& at, std::size_t k) const {
    const AdjustedMarker& m = all_.markers[k];
    const Vector3d point = centre_of(at, m.piece) + arm_of(at, k);
    double sum = at.marker[k].head<3>().squaredNorm();
    if (m.point) sum += (m.point_white * (point - *m.point)).squaredNorm();
    if (!m.radius && at.marker[k][3] < 0) return std::numeric_limits<double>::infinity();
    for (const AdjustedSight& s : m.sights) {
      if (!s.used) continue;
      const Sight sight = sight_at(at, s);
      Misfit f;
      if (!misfit(sight, point, at.marker[k][3], f)) return std::numeric_limits<double>::infinity();
      const Vector3d r = lower_inverse(lower_root(sight.covariance)) * f.r;
      sum += r.head<2>().squaredNorm() + (sight.sized ? size_cost(r[2]) : 0);
    }
    return sum;
  }
  double cost_of(const Standing& at) const {
    double cost = 0;
    for (const Vector6& z : at.z) cost += z.squaredNorm();
    for (std::size_t k = 0; k < all_.markers.size(); ++k)
      if (all_.markers[k].used) cost += square_of(at, k);
    return cost;
  }

  void write_marker(std::size_t k, const MatrixXd& s, AdjustedMarker& out) const {
    out.y = here_.marker[k].head<3>();
    out.radius_now = here_.marker[k][3];
    if (!out.used) return;
    out.chi_square = square_of(here_, k);
    out.degrees = out.point ? 3 : 0;
    const Vector3d point = centre_of(here_, out.piece) + arm_of(here_, k);
    int sized = 0;
    for (AdjustedSight& seen : out.sights) {
      if (!seen.used) continue;
      const Sight sight = sight_at(here_, seen);
      Misfit f;
      if (!misfit(sight, point, out.radius_now, f)) continue;
      seen.square = (lower_inverse(lower_root(sight.covariance)) * f.r).head<2>().squaredNorm();
      seen.miss_px = f.r.head<2>().norm() * sight.px_per_rad;
      seen.seen_px = sight.px_per_rad > 0;
      out.degrees += sight.sized ? 3 : 2;
      sized += sight.sized;
    }
    if (!out.radius && sized > 0) --out.degrees;
    // The rest alone stands where its downhill is zero: at rest, the sum of all is, so that of the rest is -g_k.
    const MarkerPart& p = parts_[k];
    MatrixXd rest = s, own = p.h;
    VectorXd g = p.g;
    eliminate(p, 0, own, g);
    rest -= own;
    const linear::SymmetricEigen<MatrixXd> e(scaled(rest), Eigen::EigenvaluesOnly);
    out.needed = !(e.eigenvalues()[0] > 1e-9 * e.eigenvalues()[size_ - 1]);
    out.without = Vector6::Zero();
    if (!out.needed)
      out.without = VectorXd(linear::Ldlt(rest).solve(VectorXd(-g))).segment<6>(6 * static_cast<Index>(out.piece));
  }
  static MatrixXd scaled(const MatrixXd& a) {
    const VectorXd scale = a.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 0.0; });
    return scale.asDiagonal() * a * scale.asDiagonal();
  }

  const Adjusted& all_;
  Index size_ = 0, scale_ = -1;
  std::vector<Matrix6> roots_;
  std::vector<Index> camera_;
  Standing here_, there_;
  std::vector<MarkerPart> parts_;
  MatrixXd h_;
  VectorXd g_;
};

}  // namespace

void adjust(Adjusted& all, const std::vector<Matrix6>& camera_covariance) {
  const Adjusted given = all;
  EveryPlace everything(given, camera_covariance);
  optim::Limits limits;
  limits.most_steps = 50;
  limits.small_promise = {1e-10, 1e-7};
  all.descended = optim::descend(everything, everything.cost(), limits);
  all.chi_square = all.descended.cost;
  everything.write(all);
}

}  // namespace gonio::reassembly
