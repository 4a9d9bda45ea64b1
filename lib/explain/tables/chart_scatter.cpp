// See chart_scatter.h.
#include "explain/tables/chart_scatter.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "linear/solve.h"
#include "optics/colorimetry.h"

namespace gonio::explain::tables {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double usual_lightness = 0.4, usual_colours = 0.5, prior_freedom = 6;
constexpr double colour_share = 0.06, colour_floor = 0.008, darkest = 0.008856;
constexpr Index of_matrix = 9, of_offset = 3, of_shape = 4;  // v^2, v ln v, across, down
constexpr int rounds = 10;

// dv for a step of one in L*.
double lightness_step(double v, double white) {
  const double share = std::max(v / white, 0.0);
  return white * (share > darkest ? 3.0 / 116 * std::cbrt(share * share) : 1 / 903.3);
}

Channels grey_shape(const Channels& v, const Channels& white) {
  Channels shape{};
  for (std::size_t c = 0; c < 3; ++c) shape[c] = lightness_step(v[c], white[c]);
  return shape;
}
Channels colour_shape(const Channels& v, const Channels& white) {
  Channels shape{};
  for (std::size_t c = 0; c < 3; ++c) shape[c] = std::hypot(colour_share * v[c], colour_floor * white[c]);
  return shape;
}

class Scattering {
 public:
  explicit Scattering(std::span<const ChartPatch> patches) : patches_(patches) {
    for (const ChartPatch& p : patches) grey_.push_back(is_grey(p.xyz)), predicted_.push_back(p.read);
    white_of_readings();
  }

  ChartScatter estimate() {
    scatter_.lightness = usual_lightness, scatter_.colours = usual_colours;
    for (int round = 0; round < rounds; ++round) {
      shapes();
      fit(round > 0);
    }
    ChartScatter result = scatter_;
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      const double readings = 3 * static_cast<double>(patches_[p].pictures);
      result.sigma.push_back(sigma_[p]);
      for (double& s : result.sigma.back()) s *= std::sqrt(readings);
    }
    return result;
  }

 private:
  void white_of_readings() {
    for (std::size_t c = 0; c < 3; ++c) {
      double above = 0, below = 0;
      for (const ChartPatch& p : patches_) above += p.read[c] * p.xyz.y, below += p.xyz.y * p.xyz.y;
      scatter_.white[c] = above / below;
    }
  }

  // Of a patch's mean over channels, in each channel's unit.
  void shapes() {
    sigma_.clear();
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      Channels own = grey_shape(predicted_[p], scatter_.white);
      const Channels colour = colour_shape(predicted_[p], scatter_.white);
      for (std::size_t c = 0; c < 3; ++c) {
        own[c] *= scatter_.lightness;
        if (!grey_[p]) own[c] = std::max(own[c], colour[c] * scatter_.colours);
      }
      sigma_.push_back(own);
    }
  }

  VectorXd basis(std::size_t p, std::size_t channel, bool shaped) const {
    const auto c = static_cast<Index>(channel);
    VectorXd row = VectorXd::Zero(of_matrix + of_offset + of_shape);
    for (int j = 0; j < 3; ++j) row[3 * c + j] = patches_[p].xyz[j];
    row[of_matrix + c] = 1;
    const double v = predicted_[p][channel], share = std::max(v / scatter_.white[channel], 1e-4);
    if (shaped) row.tail(of_shape) << v * share, v * std::log(share), v * patches_[p].across, v * patches_[p].down;
    return row;
  }

  void fit(bool estimated) {
    const auto rows = static_cast<Index>(3 * patches_.size());
    MatrixXd design(rows, of_matrix + of_offset + of_shape);
    VectorXd read(rows), scale(rows);
    for (Index i = 0; i < rows; ++i) {
      const auto p = static_cast<std::size_t>(i / 3);
      const auto c = static_cast<std::size_t>(i % 3);
      scale[i] = sigma_[p][c];
      design.row(i) = basis(p, c, estimated) / scale[i];
      read[i] = patches_[p].read[c] / scale[i];
    }
    MatrixXd gram = design.transpose() * design;
    gram.diagonal().array() += 1e-9 * gram.diagonal().maxCoeff() / static_cast<double>(rows);  // places not known
    const MatrixXd solved = linear::solve_ldlt(gram, MatrixXd(design.transpose()));
    const VectorXd x = solved * read, left = read - design * x;
    const VectorXd leverage = (design.array() * solved.transpose().array()).rowwise().sum();
    predict(x);
    if (estimated) join(left, leverage);
  }

  void predict(const VectorXd& x) {
    const auto by_matrix = [&](Index c, Vec3 xyz) {
      return x[3 * c] * xyz.x + x[3 * c + 1] * xyz.y + x[3 * c + 2] * xyz.z;
    };
    for (std::size_t c = 0; c < 3; ++c) {
      const auto row = static_cast<Index>(c);
      for (std::size_t p = 0; p < patches_.size(); ++p) predicted_[p][c] = by_matrix(row, patches_[p].xyz);
      if (const double full = by_matrix(row, optics::white_d50); full > 0) scatter_.white[c] = full;
    }
  }

  void join(const VectorXd& left, const VectorXd& leverage) {
    std::array<double, 2> squares{}, freedom{};
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      const auto i = static_cast<Index>(3 * p);
      const double z = left.segment(i, 3).mean();
      squares[grey_[p] ? 0 : 1] += z * z;
      freedom[grey_[p] ? 0 : 1] += std::max(0.0, 1 - leverage.segment(i, 3).mean());
    }
    const auto joined = [&](std::size_t k, double now, double usual) {
      return std::sqrt((squares[k] * now * now + prior_freedom * usual * usual) / (freedom[k] + prior_freedom));
    };
    scatter_.lightness = joined(0, scatter_.lightness, usual_lightness);
    scatter_.colours = joined(1, scatter_.colours, usual_colours);
  }

  std::span<const ChartPatch> patches_;
  std::vector<bool> grey_;
  std::vector<Channels> predicted_, sigma_;
  ChartScatter scatter_;
};

}  // namespace

bool is_grey(Vec3 xyz) {
  const optics::Lab lab = optics::lab_from_xyz(xyz, optics::white_d50);
  return std::hypot(lab.y, lab.z) < 6;
}

ChartScatter chart_scatter(std::span<const ChartPatch> patches) {
  return Scattering(patches).estimate();
}

}  // namespace gonio::explain::tables
