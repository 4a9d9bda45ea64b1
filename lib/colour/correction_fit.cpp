// See correction_fit.h.
#include "colour/correction_fit.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "geom/mat3_inverse.h"
#include "linear/geom_matrices.h"
#include "linear/qr.h"
#include "linear/symmetric_eigen.h"
#include "optim/bfgs.h"

namespace gonio::colour {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linear::as_eigen;
using optics::Lab;

// Terms of degree 3 and 4 are as many as patches are: each is held to zero like a number that is usually as large as
// this, among patches that a model usually misses by so much.
constexpr double usual_misfit = 2, usual_bend = 1;
constexpr double just_noticed = 0.02;  // below it the kink of a difference at zero is rounded off

std::size_t free_terms(Model model) {
  return static_cast<std::size_t>(std::ranges::count_if(terms_of(model), [](Term t) { return t.r + t.g + t.b <= 2; }));
}

// One patch, ready: terms, what it should become, and CIEDE2000 about there as a metric: |whiten (found - wanted)|.
struct Row {
  VectorXd terms;
  Eigen::Vector3d wanted;
  Eigen::Matrix3d whiten;
  Lab lab;
  double weight = 1;
};

class Fitting {
 public:
  Fitting(std::span<const Sample> samples, const FitRequest& request)
      : request_(request),
        xyz_from_target_(as_eigen(inverse(from_xyz_d50(request.target)))),
        terms_(static_cast<Index>(terms_of(request.model).size())),
        free_(static_cast<Index>(free_terms(request.model))) {
    for (const Sample& sample : samples) rows_.push_back(row_of(sample));
    constrain();
  }

  Correction solve(const std::string& place) {
    VectorXd free = start(place);
    if (request_.refine) free = refined(free);
    VectorXd all = fixed_ + span_ * free;
    if (request_.model == Model::homography) all *= brightness(all);
    std::vector<std::vector<double>> matrix(3, std::vector<double>(static_cast<std::size_t>(terms_)));
    for (Index i = 0; i < 3; ++i)
      for (Index k = 0; k < terms_; ++k)
        matrix[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = all[i * terms_ + k];
    return {request_.model, std::move(matrix), request_.white, request_.target, place};
  }

 private:
  Row row_of(const Sample& sample) const {
    Row row;
    const Rgb w = request_.white, c{sample.rgb.x / w.x, sample.rgb.y / w.y, sample.rgb.z / w.z};
    const auto values = values_of(request_.model, c);
    row.terms = Eigen::Map<const VectorXd>(values.data(), terms_);
    row.lab = sample.lab;
    const optics::Xyz xyz = optics::xyz_from_lab(sample.lab, optics::white_d50);
    row.wanted = as_eigen(from_xyz_d50(request_.target) * xyz);
    row.whiten = as_eigen(difference_root(sample.lab) * optics::lab_slopes(xyz, optics::white_d50)) * xyz_from_target_;
    // Noise over white is noise of the colour, as far as a matrix that keeps grey goes.
    const Eigen::Vector3d over(1 / w.x, 1 / w.y, 1 / w.z);
    const Eigen::Matrix3d noise = over.asDiagonal() * as_eigen(sample.covariance) * over.asDiagonal();
    row.weight = 1 / (1 + (row.whiten * noise * row.whiten.transpose()).trace());
    return row;
  }

  // The matrix, row by row, is fixed_ + span_ * what is fitted.
  void constrain() {
    const Index size = 3 * terms_;
    fixed_ = VectorXd::Zero(size);
    span_ = MatrixXd::Identity(size, size);
    if (request_.model != Model::white_preserving) return;
    const Eigen::Vector3d input(1, 1, 1), white = as_eigen(from_xyz_d50(request_.target) * optics::white_d50);
    Eigen::Matrix<double, 3, 2> across;  // at right angles to white
    across << 1, 1, -1, 1, 0, -2;
    span_ = MatrixXd::Zero(size, 6);
    for (Index i = 0; i < 3; ++i) {
      fixed_.segment<3>(3 * i) = input * (white[i] / 3);
      span_.block<3, 2>(3 * i, 2 * i) = across;
    }
  }

  // Rows of the linear problem, whitened: design * all - target.
  void equations(MatrixXd& design, VectorXd& target) const {
    const auto count = static_cast<Index>(rows_.size());
    const Index bent = 3 * (terms_ - free_);
    design.setZero(3 * count + bent, 3 * terms_), target.setZero(3 * count + bent);
    for (Index i = 0, k = 3 * count; i < 3; ++i)
      for (Index t = free_; t < terms_; ++t, ++k) design(k, i * terms_ + t) = usual_misfit / usual_bend;
    for (Index p = 0; p < count; ++p) {
      const Row& row = rows_[static_cast<std::size_t>(p)];
      const double root = std::sqrt(row.weight);
      for (Index i = 0; i < 3; ++i)
        design.block(3 * p, i * terms_, 3, terms_) = root * row.whiten.col(i) * row.terms.transpose();
      target.segment<3>(3 * p) = root * row.whiten * row.wanted;
    }
  }

  VectorXd start(const std::string& place) {
    MatrixXd design;
    VectorXd target;
    equations(design, target);
    const MatrixXd reduced = design * span_;
    const std::string remedy = "take a model of fewer terms, or a chart of more patches";
    if (reduced.rows() < reduced.cols())
      throw Error(Exit::data, place,
                  format("%zu patches do not determine %td terms", rows_.size(), static_cast<std::ptrdiff_t>(terms_)),
                  remedy);
    const linear::PivotedQr qr(reduced, 1e-11);
    if (qr.rank() < reduced.cols())
      throw Error(Exit::data, place, "the patches do not determine all terms of " + name_of(request_.model), remedy);
    // Along these the fall of the cost is even, which BFGS takes for granted.
    upper_ = linear::HouseholderQr(reduced).upper();
    VectorXd free = qr.solve(VectorXd(target - design * fixed_));
    return request_.model == Model::homography ? alternated(free) : free;
  }

  // Light and matrix in turns: D A H ~ B, patches in proportion (of length one each).
  VectorXd alternated(const VectorXd& first) const {
    const auto count = static_cast<Index>(rows_.size());
    MatrixXd read(count, 3), wanted(count, 3);
    for (Index p = 0; p < count; ++p) {
      const Row& row = rows_[static_cast<std::size_t>(p)];
      const double over = std::sqrt(row.weight) / row.wanted.norm();
      read.row(p) = over * row.terms.transpose(), wanted.row(p) = over * row.wanted.transpose();
    }
    Eigen::Matrix3d h = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(first.data()).transpose();
    for (int turn = 0; turn < 100; ++turn) {
      const MatrixXd found = read * h;
      const VectorXd light = found.cwiseProduct(wanted).rowwise().sum().cwiseQuotient(found.rowwise().squaredNorm());
      const Eigen::Matrix3d next = linear::PivotedQr(light.asDiagonal() * read).solve(wanted);
      const double change = (next / next.norm() - h / h.norm()).norm();
      h = next;
      if (change < 1e-10) break;
    }
    VectorXd all(9);
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(all.data()) = h.transpose();
    return all;
  }

  Eigen::Vector3d colour(const Row& row, const VectorXd& all) const {
    Eigen::Vector3d out;
    for (Index i = 0; i < 3; ++i) out[i] = all.segment(i * terms_, terms_).dot(row.terms);
    return out;
  }
  // Factor on the matrix that brings brightness to the references, in proportion.
  double brightness(const VectorXd& all) const {
    double above = 0, below = 0;
    for (const Row& row : rows_) {
      const double found = xyz_from_target_.row(1).dot(colour(row, all)),
                   wanted = xyz_from_target_.row(1).dot(row.wanted);
      above += row.weight * found / wanted, below += row.weight * found * found / (wanted * wanted);
    }
    return above / below;
  }

  // Difference of one patch and its slopes by the colour.
  double difference(const Row& row, Eigen::Vector3d found, Eigen::Vector3d* slopes) const {
    Eigen::Vector3d xyz = xyz_from_target_ * found;
    const Eigen::Vector3d free = xyz;
    const double wanted_y = xyz_from_target_.row(1).dot(row.wanted);
    if (request_.model == Model::homography) {
      if (!(free[1] > 0)) return HUGE_VAL;
      xyz *= wanted_y / free[1];
    }
    const optics::Xyz x{xyz[0], xyz[1], xyz[2]};
    const auto d = optics::ciede2000_sloped(row.lab, optics::lab_from_xyz(x, optics::white_d50));
    const double rounded = std::hypot(d.value, just_noticed);
    if (slopes != nullptr) {
      Eigen::RowVector3d by_xyz =
          d.value / rounded * as_eigen(d.slope).transpose() * as_eigen(optics::lab_slopes(x, optics::white_d50));
      if (request_.model == Model::homography) {
        const double scale = wanted_y / free[1], along = by_xyz.dot(free) * scale / free[1];
        by_xyz *= scale;
        by_xyz[1] -= along;
      }
      *slopes = (by_xyz * xyz_from_target_).transpose();
    }
    return rounded - just_noticed;
  }

  VectorXd refined(const VectorXd& first) const {
    double weights = 0;
    for (const Row& row : rows_) weights += row.weight;
    const auto triangle = upper_.triangularView<Eigen::Upper>();
    const auto place = [&](const VectorXd& z) { return VectorXd(first + triangle.solve(z)); };
    const optim::SlopedFunction mean = [&](const VectorXd& z, VectorXd* slopes) {
      const VectorXd all = fixed_ + span_ * place(z);
      VectorXd by_all = VectorXd::Zero(all.size());
      double sum = 0;
      for (const Row& row : rows_) {
        Eigen::Vector3d by_colour;
        sum += row.weight * difference(row, colour(row, all), slopes != nullptr ? &by_colour : nullptr);
        if (slopes != nullptr)
          for (Index i = 0; i < 3; ++i) by_all.segment(i * terms_, terms_) += row.weight * by_colour[i] * row.terms;
      }
      for (Index i = 0; i < 3; ++i) {
        const auto bent = all.segment(i * terms_ + free_, terms_ - free_);
        sum += bent.squaredNorm() * usual_misfit / (2 * usual_bend * usual_bend);
        by_all.segment(i * terms_ + free_, terms_ - free_) += bent * (usual_misfit / (usual_bend * usual_bend));
      }
      if (slopes != nullptr) *slopes = triangle.transpose().solve(VectorXd(span_.transpose() * by_all)) / weights;
      return sum / weights;
    };
    optim::Limits limits;
    limits.most_steps = 200;
    limits.small_fall.share = 1e-8;
    return place(optim::minimise_by_bfgs(mean, VectorXd::Zero(first.size()), limits).x);
  }

  const FitRequest& request_;
  Eigen::Matrix3d xyz_from_target_;
  Index terms_, free_;  // of all terms the first are free, the others restrained
  std::vector<Row> rows_;
  VectorXd fixed_;
  MatrixXd span_, upper_;
};

}  // namespace

Mat3 difference_root(optics::Lab at) {
  constexpr double step = 0.1;
  const auto moved = [&](int i, int j) {
    std::array<double, 3> s{at.x, at.y, at.z};
    s[static_cast<std::size_t>(i)] += step;
    if (j != i) s[static_cast<std::size_t>(j)] += step;
    const double d = optics::ciede2000(at, {s[0], s[1], s[2]});
    return d * d / (step * step);
  };
  Eigen::Matrix3d g;
  for (int i = 0; i < 3; ++i) g(i, i) = moved(i, i);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j) g(i, j) = g(j, i) = (moved(i, j) - g(i, i) - g(j, j)) / 2;
  const linear::SymmetricEigen<Eigen::Matrix3d> eigen(g);
  return linear::mat3_of(eigen.eigenvalues().cwiseMax(1e-6).cwiseSqrt().asDiagonal() *
                         eigen.eigenvectors().transpose());
}

std::size_t patches_needed(Model model) {
  return free_terms(model) + 1;
}

Correction fit_correction(std::span<const Sample> samples, const FitRequest& request, const std::string& place) {
  return Fitting(samples, request).solve(place);
}

}  // namespace gonio::colour
