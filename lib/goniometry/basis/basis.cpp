// Principal components of many tables, a block of rings at a time.
#include "goniometry/basis/basis.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::goniometry {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows = Eigen::Map<RowMatrix>;

constexpr std::size_t block_numbers = 24'000'000;  // of all samples together: 96 MB
constexpr std::size_t chunk_cells = 1024, lanes = 4;
// Of the mean eigenvalue: what keeps (Gram + lambda)^-1 finite, the mean having been taken out.
constexpr double relative_lambda = 1e-6;

Eigen::Index at(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

}  // namespace

class BasisBuilder {
 public:
  BasisBuilder(const Tables& tables, Basis& basis, const BasisOptions& options)
      : tables_(tables),
        basis_(basis),
        options_(options),
        cells_(tables.cells()),
        samples_(tables.materials() * tables.channels()),
        gram_(lanes, Eigen::MatrixXd::Zero(at(samples_), at(samples_))),
        bar_("basis", 2 * cells_.bins()[0]) {}

  void build() {
    basis_.log_reference_.resize(cells_.count());
    basis_.mean_.resize(cells_.count());
    each_block([this](std::size_t first, std::size_t last) { add_to_gram(first, last); });
    decompose();
    basis_.q_.resize(cells_.count() * basis_.components_);
    basis_.rest_.resize(cells_.count());
    if (!singly()) basis_.class_rest_.resize(cells_.count() * basis_.classes());
    each_block([this](std::size_t first, std::size_t last) { project(first, last); });
  }

 private:
  template <class Body>
  void each_block(const Body& body) {
    const std::size_t rings = cells_.bins()[0];
    for (std::size_t first = 0; first < rings;) {
      std::size_t last = first + 1;
      while (last < rings && (cells_.ring_begin(last + 1) - cells_.ring_begin(first)) * samples_ <= block_numbers)
        ++last;
      body(cells_.ring_begin(first), read(first, last));
      bar_.advance(last - first);
      first = last;
    }
  }

  // ln(f w + epsilon) of a block of rings into block_, sample by sample, the mean of every cell taken out.
  std::size_t read(std::size_t first_ring, std::size_t last_ring) {
    const std::size_t first = cells_.ring_begin(first_ring), count = cells_.ring_begin(last_ring) - first;
    block_.resize(samples_ * count);
    parallel_for(0, samples_, [&](std::size_t s) {
      const std::span<float> row(block_.data() + s * count, count);
      tables_.read(s / tables_.channels(), s % tables_.channels(), first_ring, last_ring, row);
      for (std::size_t c = 0; c < count; ++c)
        row[c] = static_cast<float>(log_level(static_cast<double>(row[c]), cells_.weight(first + c)));
    });
    parallel_for(
        0, count, [&](std::size_t c) { centre(first + c, c, count); }, 512);
    return first + count;
  }
  void centre(std::size_t cell, std::size_t column, std::size_t count) {
    thread_local std::vector<float> values;
    values.resize(samples_);
    double sum = 0;
    for (std::size_t s = 0; s < samples_; ++s) {
      values[s] = block_[s * count + column];
      sum += static_cast<double>(values[s]);
    }
    const auto mean = static_cast<float>(sum / static_cast<double>(samples_));
    for (std::size_t s = 0; s < samples_; ++s) block_[s * count + column] -= mean;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(samples_ / 2);
    std::nth_element(values.begin(), middle, values.end());
    basis_.log_reference_[cell] = *middle;
    basis_.mean_[cell] = mean - *middle;
  }

  // In double: what a material adds to the others is 1e-3 of it and less, 1e-6 of the products. One sum per lane,
  // whatever the threads.
  void add_to_gram(std::size_t first, std::size_t last) {
    const std::size_t count = last - first;
    const Rows rows(block_.data(), at(samples_), at(count));
    parallel_for(0, lanes, [&](std::size_t lane) {
      Eigen::MatrixXd part;
      for (std::size_t c = lane * chunk_cells; c < count; c += lanes * chunk_cells) {
        part = rows.middleCols(at(c), at(std::min(chunk_cells, count - c))).cast<double>();
        gram_[lane].selfadjointView<Eigen::Lower>().rankUpdate(part);
      }
    });
  }

  void decompose() {
    Eigen::MatrixXd gram = gram_[0];
    for (std::size_t lane = 1; lane < lanes; ++lane) gram += gram_[lane];
    gram = gram.selfadjointView<Eigen::Lower>();
    const linear::SymmetricEigen<Eigen::MatrixXd> eigen(gram);
    const Eigen::VectorXd falling = eigen.eigenvalues().reverse().cwiseMax(0);
    const double total = falling.sum(), freedom = static_cast<double>(samples_ - 1);
    double rest = total;
    std::size_t k = 0;
    const std::size_t most = std::min(options_.most_components, samples_ - 1);
    while (k < most && rest > options_.truncation * options_.truncation * total && falling[at(k)] > 1e-10 * falling[0])
      rest -= falling[at(k++)];
    basis_.components_ = std::max<std::size_t>(k, 1);
    basis_.singular_.resize(samples_);
    for (std::size_t i = 0; i < samples_; ++i) basis_.singular_[i] = std::sqrt(falling[at(i)]);
    Eigen::MatrixXd u = eigen.eigenvectors().rowwise().reverse().leftCols(at(basis_.components_));
    for (Eigen::Index i = 0; i < u.cols(); ++i) {  // the sign is free: the largest number is positive
      Eigen::Index largest = 0;
      u.col(i).cwiseAbs().maxCoeff(&largest);
      if (u(largest, i) < 0) u.col(i) *= -1;
    }
    basis_.scores_.resize(samples_ * basis_.components_);
    for (std::size_t s = 0; s < samples_; ++s)
      for (std::size_t i = 0; i < basis_.components_; ++i)
        basis_.scores_[s * basis_.components_ + i] = std::sqrt(freedom) * u(at(s), at(i));
    directions_ = (u / std::sqrt(freedom)).cast<float>();
    const double lambda = std::max(relative_lambda * total / freedom, 1e-12);
    left_out_ = remainders(eigen, lambda).cast<float>();
  }

  bool singly() const { return basis_.classes() == tables_.materials(); }
  std::vector<Eigen::Index> samples_of(std::size_t left_out) const {
    std::vector<Eigen::Index> rows;
    for (std::size_t s = 0; s < samples_; ++s)
      if (basis_.class_of(s) == left_out) rows.push_back(at(s));
    return rows;
  }

  // Rows P_JJ^-1 P_J: of every sample what the other classes do not give.
  template <class Solver>
  Eigen::MatrixXd remainders(const Solver& eigen, double lambda) const {
    const Eigen::VectorXd inverse = (eigen.eigenvalues().cwiseMax(0).array() + lambda).inverse();
    Eigen::MatrixXd p = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
    p.rowwise() -= p.colwise().mean().eval();
    p.colwise() -= p.rowwise().mean().eval();
    Eigen::MatrixXd rows(p.rows(), p.cols());
    for (std::size_t c = 0; c < basis_.classes(); ++c) {
      const std::vector<Eigen::Index> group = samples_of(c);
      const Eigen::MatrixXd own = p(group, group), all = p(group, Eigen::all), solved = linear::Llt(own).solve(all);
      rows(group, Eigen::all) = solved;
    }
    return rows;
  }

  void project(std::size_t first, std::size_t last) {
    const std::size_t count = last - first, k = basis_.components_, chunks = (count + chunk_cells - 1) / chunk_cells;
    const Rows rows(block_.data(), at(samples_), at(count));
    const auto freedom = static_cast<float>(samples_ - 1);
    parallel_for(0, chunks, [&](std::size_t chunk) {
      const std::size_t begin = chunk * chunk_cells, width = std::min(chunk_cells, count - begin);
      const auto part = rows.middleCols(at(begin), at(width));
      Rows q(basis_.q_.data() + (first + begin) * k, at(width), at(k));
      q.noalias() = part.transpose() * directions_;
      const Eigen::RowVectorXf all = part.colwise().squaredNorm() / freedom;
      Eigen::MatrixXf remainder = (left_out_ * part).cwiseAbs();
      for (Eigen::Index c = 0; c < at(width); ++c) {
        const std::size_t cell = first + begin + static_cast<std::size_t>(c);
        const float dropped = std::max(0.0F, all[c] - q.row(c).squaredNorm());
        const float unexplained = singly() ? spread_of(remainder.col(c)) : by_classes(remainder.col(c), dropped, cell);
        basis_.rest_[cell] = std::sqrt(unexplained * unexplained + dropped);
      }
    });
  }
  // Root of the mean over classes of mean squares.
  float by_classes(const Eigen::Ref<const Eigen::VectorXf>& magnitudes, float dropped, std::size_t cell) {
    const std::size_t classes = basis_.classes();
    float* squares = basis_.class_rest_.data() + cell * classes;
    thread_local std::vector<float> counts;
    counts.assign(classes, 0);
    for (std::size_t s = 0; s < samples_; ++s) {
      squares[basis_.class_of(s)] += magnitudes[at(s)] * magnitudes[at(s)];
      ++counts[basis_.class_of(s)];
    }
    float sum = 0;
    for (std::size_t c = 0; c < classes; ++c) sum += squares[c] /= counts[c];
    for (std::size_t c = 0; c < classes; ++c) squares[c] += dropped;
    return std::sqrt(sum / static_cast<float>(classes));
  }
  static float spread_of(Eigen::Ref<Eigen::VectorXf> magnitudes) {
    const Eigen::Index place = magnitudes.size() * 95 / 100;
    std::nth_element(magnitudes.begin(), magnitudes.begin() + place, magnitudes.end());
    return magnitudes[place] / 1.96F;
  }

  const Tables& tables_;
  Basis& basis_;
  const BasisOptions& options_;
  const Cells& cells_;
  std::size_t samples_;
  std::vector<float> block_;
  std::vector<Eigen::MatrixXd> gram_;
  Eigen::MatrixXf directions_, left_out_;
  Progress bar_;
};

Basis::Basis(const Tables& tables, std::string description, const BasisOptions& options)
    : cells_(std::make_shared<const Cells>(tables.cells())), description_(std::move(description)) {
  if (tables.materials() < 3)
    throw Error(Exit::data, description_, "holds " + std::to_string(tables.materials()) + " materials",
                "a basis needs 3 or more");
  for (std::size_t m = 0; m < tables.materials(); ++m) {
    names_.push_back(tables.name(m));
    material_of_.insert(material_of_.end(), tables.channels(), static_cast<std::uint32_t>(m));
  }
  classify();
  BasisBuilder(tables, *this, options).build();
}

void Basis::classify() {
  std::vector<std::string> known;
  class_of_.clear();
  for (const std::string& name : names_) {
    const std::size_t end = name.find_last_not_of("0123456789");
    const bool numbered = end != std::string::npos && end + 1 < name.size() && name[end] == ' ';
    const std::string stem = numbered ? name.substr(0, end) : name;
    const auto found = std::ranges::find(known, stem);
    class_of_.push_back(static_cast<std::uint32_t>(found - known.begin()));
    if (found == known.end()) known.push_back(stem);
  }
  classes_ = known.size();
  if (classes_ >= 3) return;
  classes_ = names_.size();
  std::iota(class_of_.begin(), class_of_.end(), 0U);
}

double Basis::rest_without(std::size_t cell, std::uint32_t left_out) const {
  if (class_rest_.empty()) return static_cast<double>(rest_[cell]);
  double sum = 0;
  for (std::uint32_t c = 0; c < classes_; ++c)
    if (c != left_out) sum += static_cast<double>(class_rest_[cell * classes_ + c]);
  return std::sqrt(sum / static_cast<double>(classes_ - 1));
}

double Basis::kept_share() const {
  double all = 0, kept = 0;
  for (std::size_t i = 0; i < singular_.size(); ++i) {
    all += singular_[i] * singular_[i];
    if (i < components_) kept += singular_[i] * singular_[i];
  }
  return all > 0 ? kept / all : 1;
}

}  // namespace gonio::goniometry
