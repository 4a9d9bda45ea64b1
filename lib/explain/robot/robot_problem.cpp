// See robot_problem.h: the tables that the engine works on, whitened view by view.
#include "explain/robot/robot_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "explain/robot/robot_findings.h"
#include "explain/robot/robot_proposals.h"
#include "inference/estimable.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

constexpr std::size_t fewest_views = 6;
constexpr double estimable =
    0.02;  // share of a parameter's signature that must survive mounting and earlier parameters

class HandEyeProblem final : public RobotProblem {
 public:
  explicit HandEyeProblem(ChainInput input) : work_{std::move(input), {}, {}, {}, {}, {}, {}} {
    work_.parameters = robot_parameters(work_.input);
    settle(work_);
    if (work_.input.views.size() < fewest_views)
      throw Error(Exit::data, work_.input.mounting,
                  "has " + std::to_string(work_.input.views.size()) + " poses that fit each other (at least " +
                      std::to_string(fewest_views) + ")",
                  "record more poses");
    parameters_ = work_.parameters.parameters;
    base_ = work_.parameters.base;
    whiten();
    keep_estimable();
    observe();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    const ChainState state = state_of(work_.input, work_.parameters, values);
    const PoseChange whitened = whitener_[group] * pose_difference(work_, group, state);
    for (std::size_t i = 0; i < 6; ++i) prediction[i] = whitened[static_cast<Eigen::Index>(i)];
  }

  // Chain: central differences, cheap. Measured pose: its implicit derivatives, with the opposite sign.
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    const ChainState state = state_of(work_.input, work_.parameters, values);
    const Eigen::MatrixXd by_chain = chain_slopes(work_, group, {values.begin(), values.end()}, columns);
    const Eigen::MatrixXd by_measurement = pose_slopes(work_, group, state);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const RobotRole& role = work_.parameters.roles[columns[c]];
      PoseChange slope = by_chain.col(static_cast<Eigen::Index>(c));
      if (moves_camera_or_board(role.part)) slope = -by_measurement.col(slope_column(role));
      const PoseChange whitened = whitener_[group] * slope;
      for (std::size_t i = 0; i < 6; ++i) derivatives[6 * c + i] = whitened[static_cast<Eigen::Index>(i)];
    }
  }

  std::string domain() const override { return "robot"; }
  std::string unit() const override { return "m"; }
  std::string score_name() const override { return "error of the board's place"; }
  std::string group_noun() const override { return "pose"; }
  Importance importance() const override { return Importance::share_of_residual; }
  bool sets_outliers_aside() const override { return false; }  // those are left out before: settle()

  std::vector<Proposal> proposals() const override {
    std::vector<Proposal> told;
    for (const RobotProposal& p : proposed()) told.push_back(p.told);
    return told;
  }
  // Its noise is that of a recorded view.
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override {
    const RobotProposal& p = proposed()[proposal];
    const PoseChange whitened = whitener_[p.like] * pose_difference(work_, p.view, p.reference,
                                                                    state_of(work_.input, work_.parameters, values));
    return {{whitened.begin(), whitened.end()}, std::vector<double>(6, 1.0), {}};
  }

  RobotFindings findings(const Explanation& e) const override { return findings_of(work_, whitener_, e); }
  std::string remarks(const Explanation& e) const override { return findings(e).sentence; }
  void apply(const Explanation& e, manifest::Document& document) const override {
    upgrade_robot(work_, *this, findings(e), e, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_robot(findings(e));
  }

 private:
  void whiten() {
    for (const NoisyView& view : work_.noisy) {
      const PoseMatrix covariance = view.covariance(work_.noise.sizes);
      whitener_.push_back(covariance.llt().matrixL().solve(PoseMatrix::Identity()));
    }
  }

  // Parameters that the mounting, or parameters before them, imitate to 0.02 of their length are no hypotheses here:
  // rotations of the first and the last joint, offsets along parallel axes.
  void keep_estimable() {
    const auto columns_of = [&](const std::vector<std::size_t>& parameters) {
      std::vector<Estimable::Column> columns;
      for (const std::size_t p : parameters) {
        Eigen::VectorXd column(6 * static_cast<Eigen::Index>(work_.noisy.size()));
        for (std::size_t v = 0; v < work_.noisy.size(); ++v)
          column.segment<6>(6 * static_cast<Eigen::Index>(v)) =
              whitener_[v] * work_.noisy[v].jacobian.col(static_cast<Eigen::Index>(p));
        columns.emplace_back(column.begin(), column.end());
      }
      return columns;
    };
    const Estimable beside(columns_of(base_));
    for (Candidate& candidate : work_.parameters.candidates) {
      std::vector<std::size_t> kept;
      for (const std::size_t k : beside.kept(columns_of(candidate.parameters), estimable))
        kept.push_back(candidate.parameters[k]);
      candidate.parameters = kept;
      if (!kept.empty()) candidates_.push_back(candidate);
    }
  }

  void observe() {
    Observations& o = observations_;
    o.first.push_back(0);
    o.conditions = robot_conditions(work_);
    const double place2 = place_noise2(work_);
    for (std::size_t v = 0; v < work_.input.views.size(); ++v) {
      o.group.push_back(work_.input.views[v].image);
      for (int i = 0; i < 6; ++i) {
        o.value.push_back(0);
        o.sigma.push_back(1);
        o.norm.push_back(1 / place2);
        o.block.push_back(static_cast<std::uint32_t>(6 * v) + static_cast<std::uint32_t>(i));
      }
      append_robot_conditions(work_, v, whitener_[v], o.conditions);
      o.first.push_back(o.value.size());
    }
  }

  const std::vector<RobotProposal>& proposed() const {
    std::call_once(proposed_once_, [this] { proposals_ = robot_proposals(work_); });
    return proposals_;
  }

  RobotWork work_;
  std::vector<PoseMatrix> whitener_;
  mutable std::once_flag proposed_once_;
  mutable std::vector<RobotProposal> proposals_;  // of the aligned mountings
};

}  // namespace

std::unique_ptr<RobotProblem> robot_problem(ChainInput input) {
  return std::make_unique<HandEyeProblem>(std::move(input));
}

}  // namespace gonio::explain
