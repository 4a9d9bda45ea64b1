// See alignment.h.
#include "nrsfm/evaluate/alignment.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "linear/svd.h"

namespace gonio::nrsfm {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// Sums of a frame over its points that are finite in both: all that Procrustes needs.
struct Moments {
  Eigen::Index points = 0;
  Eigen::Vector3d mean_x = Eigen::Vector3d::Zero(), mean_q = Eigen::Vector3d::Zero();
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();  // sum (q - mean)(x - mean)'
  double square_x = 0;                                // sum |x - mean|^2
};

template <class X, class Q>
Moments moments_of(const X& x, const Q& q, bool centred) {
  Moments m;
  std::vector<Eigen::Index> both;
  for (Eigen::Index p = 0; p < x.cols(); ++p)
    if (is_finite(x.col(p)) && is_finite(q.col(p))) both.push_back(p);
  m.points = static_cast<Eigen::Index>(both.size());
  if (both.empty()) return m;
  if (centred) {
    for (const Eigen::Index p : both) m.mean_x += x.col(p), m.mean_q += q.col(p);
    m.mean_x /= static_cast<double>(m.points), m.mean_q /= static_cast<double>(m.points);
  }
  for (const Eigen::Index p : both) {
    const Eigen::Vector3d a = x.col(p) - m.mean_x, b = q.col(p) - m.mean_q;
    m.product += b * a.transpose();
    m.square_x += a.squaredNorm();
  }
  return m;
}

// Orthogonal R that maximizes tr(R' product): U V', its last singular direction turned where only rotations may be.
struct Turn {
  Eigen::Matrix3d rotation;
  double trace = 0;
};
Turn turn_of(const Eigen::Matrix3d& product, bool reflection) {
  const linear::JacobiSvd<Eigen::Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (!reflection && svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign(2) = -1;
  return {svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose(), svd.singularValues().dot(sign)};
}

Similarity similarity_of(const Moments& m, const ProcrustesOptions& options) {
  const Turn turn = turn_of(m.product, options.reflection);
  Similarity s;
  s.rotation = turn.rotation;
  if (options.scale && m.square_x > 0) s.scale = turn.trace / m.square_x;
  if (options.translation) s.translation = m.mean_q - s.scale * s.rotation * m.mean_x;
  return s;
}

std::vector<Moments> moments_by_frame(const Shapes& x, const Shapes& truth) {
  std::vector<Moments> all;
  for (Eigen::Index f = 0; f < x.rows() / 3; ++f) all.push_back(moments_of(shape_of(x, f), shape_of(truth, f), true));
  return all;
}

// Rotation and scale of every frame, as the alignment lets them vary; translations follow from the means.
std::vector<Similarity> turns_of(const std::vector<Moments>& moments, Alignment alignment) {
  std::vector<Similarity> out(moments.size());
  if (alignment == Alignment::none) return out;
  if (alignment == Alignment::global_rotation) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Moments& m : moments) sum += m.product;
    for (Similarity& s : out) s.rotation = turn_of(sum, false).rotation;
    return out;
  }
  double trace = 0, square = 0;
  for (std::size_t f = 0; f < moments.size(); ++f) {
    const Turn turn = turn_of(moments[f].product, alignment == Alignment::frame_similarity);
    out[f].rotation = turn.rotation;
    if (alignment == Alignment::frame_similarity && moments[f].square_x > 0)
      out[f].scale = turn.trace / moments[f].square_x;
    trace += turn.trace, square += moments[f].square_x;
  }
  if (alignment == Alignment::frame_rotation_one_scale && square > 0)
    for (Similarity& s : out) s.scale = trace / square;
  return out;
}

Aligned laid(const Shapes& x, const Shapes& truth, const std::vector<Similarity>& similarities) {
  Aligned out{Shapes(x.rows(), x.cols()), truth, similarities, {}};
  for (std::size_t f = 0; f < similarities.size(); ++f) {
    const auto i = static_cast<Eigen::Index>(f);
    const Similarity& s = similarities[f];
    shape_of(out.shapes, i) = ((s.scale * s.rotation) * shape_of(x, i)).colwise() + s.translation;
    out.mirrored.push_back(s.mirrored() ? 1 : 0);
  }
  return out;
}

Aligned aligned_globally(const Shapes& x, const Shapes& truth) {
  const Matched m = matched(x, truth);
  const Similarity s = procrustes(m.x, m.q);
  return laid(x, truth, std::vector<Similarity>(static_cast<std::size_t>(x.rows() / 3), s));
}

}  // namespace

const std::vector<std::string>& alignment_names() {
  static const std::vector<std::string> names = {"none",           "global-rotation",  "global-similarity",
                                                 "frame-rotation", "frame-similarity", "frame-rotation-one-scale"};
  return names;
}

Eigen::Matrix3Xd moved(const Similarity& s, const Eigen::Matrix3Xd& x) {
  return ((s.scale * s.rotation) * x).colwise() + s.translation;
}

Similarity procrustes(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& q, const ProcrustesOptions& options) {
  if (x.cols() != q.cols())
    throw Error(Exit::data, "procrustes",
                "has " + std::to_string(x.cols()) + " and " + std::to_string(q.cols()) + " points to compare");
  return similarity_of(moments_of(x, q, options.translation), options);
}

Matched matched(const Shapes& x, const Shapes& truth) {
  Matched m;
  m.x.resize(3, x.rows() / 3 * x.cols());
  m.q.resize(3, x.rows() / 3 * x.cols());
  Eigen::Index n = 0;
  for (Eigen::Index f = 0; f < x.rows() / 3; ++f)
    for (Eigen::Index p = 0; p < x.cols(); ++p) {
      const Eigen::Vector3d a = shape_of(x, f).col(p), b = shape_of(truth, f).col(p);
      if (!is_finite(a) || !is_finite(b)) continue;
      m.x.col(n) = a;
      m.q.col(n++) = b;
      m.frame.push_back(f);
    }
  m.x.conservativeResize(3, n);
  m.q.conservativeResize(3, n);
  return m;
}

void check_comparable(const Shapes& x, const Shapes& truth) {
  const auto size = [](const Shapes& s) {
    return s.rows() % 3 == 0 ? std::to_string(s.rows() / 3) + " frames x " + std::to_string(s.cols()) + " points"
                             : std::to_string(s.rows()) + " rows, not a multiple of 3";
  };
  if (x.rows() != truth.rows() || x.cols() != truth.cols() || x.rows() % 3 != 0)
    throw Error(Exit::data, "reconstruction", "has " + size(x) + ", the truth has " + size(truth),
                "give every frame and point of the sequence; NaN where nothing was estimated");
  Eigen::Index both = 0;
  for (Eigen::Index f = 0; f < x.rows() / 3; ++f)
    for (Eigen::Index p = 0; p < x.cols(); ++p)
      both += is_finite(shape_of(x, f).col(p)) && is_finite(shape_of(truth, f).col(p)) ? 1 : 0;
  if (both < 4)
    throw Error(Exit::data, "reconstruction",
                "has " + std::to_string(both) + " finite points where the truth is known, 4 is the least");
}

Aligned align(const Shapes& x, const Shapes& truth, Alignment alignment) {
  check_comparable(x, truth);
  if (alignment == Alignment::global_similarity) return aligned_globally(x, truth);
  const std::vector<Moments> moments = moments_by_frame(x, truth);
  std::vector<Similarity> similarities = turns_of(moments, alignment);
  for (std::size_t f = 0; f < moments.size(); ++f) {
    Similarity& s = similarities[f];
    s.translation = -(s.scale * s.rotation * moments[f].mean_x);
  }
  Aligned out = laid(x, truth, similarities);
  std::size_t poor = 0;
  for (std::size_t f = 0; f < moments.size(); ++f) {
    const auto i = static_cast<Eigen::Index>(f);
    shape_of(out.truth, i).colwise() -= moments[f].mean_q;
    if (moments[f].points >= 3) continue;
    ++poor;
    shape_of(out.shapes, i).setConstant(missing);
  }
  if (2 * poor > moments.size())
    throw Error(Exit::data, "reconstruction",
                "has fewer than 3 points to compare in " + std::to_string(poor) + " of " +
                    std::to_string(moments.size()) + " frames",
                "more than half of the frames are needed");
  return out;
}

}  // namespace gonio::nrsfm
