// See system.h.
#include "inference/system.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "linear/blocks.h"
#include "stats/intervals.h"

namespace gonio::inference {

CurveBasis curve_basis(const Observations& observations, std::size_t condition, std::size_t knots) {
  std::vector<double> finite;
  for (const double v : observations.conditions[condition].values)
    if (std::isfinite(v)) finite.push_back(v);
  CurveBasis basis{condition, {}};
  if (finite.empty()) return basis;
  std::sort(finite.begin(), finite.end());
  const double spread = finite.back() - finite.front();
  for (std::size_t k = 0; k < knots; ++k) {
    const std::size_t place = k * (finite.size() - 1) / (knots - 1);
    if (basis.knots.empty() || finite[place] > basis.knots.back() + 1e-6 * spread) basis.knots.push_back(finite[place]);
  }
  return basis;
}

System::System(const Problem& problem, std::uint64_t seed) : problem_(problem) {
  const Observations& o = problem.observations();
  for (std::size_t g = 0; g < o.groups(); ++g)
    if (o.first[g + 1] > o.first[g]) groups.push_back(g);
  aside_.assign(o.rows(), 0);
  half_.resize(o.rows());
  for (std::size_t i = 0; i < o.rows(); ++i) half_[i] = static_cast<char>(split_mix(split_mix(seed) ^ o.block[i]) & 1);
  weight_.resize(o.rows());
  set_noise_factor(1);
}

void System::set_noise_factor(double factor) {
  factor_ = factor;
  const Observations& o = observations();
  for (std::size_t i = 0; i < o.rows(); ++i) weight_[i] = aside_[i] ? 0 : 1 / (factor * o.sigma[i]);
}

void System::set_aside(std::size_t block) {
  const Observations& o = observations();
  for (std::size_t i = 0; i < o.rows(); ++i)
    if (o.block[i] == block) aside_[i] = 1, weight_[i] = 0;
  std::erase_if(groups, [&](std::size_t g) { return used_rows(g) == 0; });
}

void System::set_bias(const Bias& bias) {
  bias_ = bias.value;
}

std::size_t System::used_rows(std::size_t group) const {
  const Observations& o = observations();
  return static_cast<std::size_t>(std::count_if(weight_.begin() + static_cast<std::ptrdiff_t>(o.first[group]),
                                                weight_.begin() + static_cast<std::ptrdiff_t>(o.first[group + 1]),
                                                [](double w) { return w > 0; }));
}

bool System::touches(std::size_t parameter, std::size_t group) const {
  const std::vector<std::size_t>& on = problem_.parameters()[parameter].groups;
  return on.empty() || std::find(on.begin(), on.end(), group) != on.end();
}

std::size_t System::only_group(const std::vector<std::size_t>& on) const {
  if (on.empty()) return groups.size() == 1 ? groups[0] : LinearColumn::everywhere;
  std::size_t found = LinearColumn::everywhere;
  for (const std::size_t g : on) {
    if (!std::binary_search(groups.begin(), groups.end(), g)) continue;
    if (found != LinearColumn::everywhere) return LinearColumn::everywhere;
    found = g;
  }
  return found;
}

System System::restricted(std::size_t group, int half) const {
  System part = *this;
  part.groups = {group};
  const Observations& o = observations();
  for (std::size_t i = o.first[group]; i < o.first[group + 1]; ++i)
    if (half_[i] != half) part.weight_[i] = 0;
  return part;
}

double System::clamped(std::size_t parameter, double value) const {
  const Parameter& p = problem_.parameters()[parameter];
  return std::clamp(value, p.lower, p.upper);
}

Eigen::VectorXd System::residual(std::span<const double> values, std::size_t group) const {
  const Observations& o = observations();
  const std::size_t first = o.first[group], rows = o.first[group + 1] - first;
  Eigen::VectorXd r(static_cast<Eigen::Index>(rows));
  problem_.predict(values, group, {r.data(), rows});
  for (std::size_t i = 0; i < rows; ++i) {
    const double w = weight_[first + i];
    double& entry = r[static_cast<Eigen::Index>(i)];
    if (!bias_.empty()) entry += bias_[first + i];
    entry = w > 0 ? (o.value[first + i] - entry) * w : 0;
  }
  return r;
}

Eigen::MatrixXd System::jacobian(std::span<const double> values, std::size_t group,
                                 std::span<const std::size_t> columns, const Slopes* kept) const {
  const Observations& o = observations();
  const std::size_t first = o.first[group], rows = o.first[group + 1] - first;
  const auto height = static_cast<Eigen::Index>(rows);
  Eigen::MatrixXd j(height, static_cast<Eigen::Index>(columns.size()));
  std::vector<std::size_t> fresh;
  std::vector<Eigen::Index> places;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    if (const double* known = kept == nullptr ? nullptr : kept->find(columns[k], group, height)) {
      j.col(column) = Eigen::Map<const Eigen::VectorXd>(known, height);
      continue;
    }
    fresh.push_back(columns[k]);
    places.push_back(column);
  }
  if (!fresh.empty()) {
    Eigen::MatrixXd taken(height, static_cast<Eigen::Index>(fresh.size()));
    problem_.jacobian(values, group, fresh, {taken.data(), rows * fresh.size()});
    const Eigen::Map<const Eigen::VectorXd> weight(weight_.data() + first, height);
    for (std::size_t k = 0; k < fresh.size(); ++k)
      j.col(places[k]) = weight.cwiseProduct(taken.col(static_cast<Eigen::Index>(k)));
  }
  for (std::size_t i = 0; i < rows; ++i)
    if (!(weight_[first + i] > 0)) j.row(static_cast<Eigen::Index>(i)).setZero();
  return j;
}

Eigen::MatrixXd System::extra(std::span<const ExtraColumn* const> columns, std::size_t group) const {
  const Observations& o = observations();
  const std::size_t first = o.first[group], rows = o.first[group + 1] - first;
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (const ExtraColumn::Part& part : columns[c]->parts) {
      const std::vector<double>& knots = part.basis->knots;
      const Condition& condition = o.conditions[part.basis->condition];
      for (std::size_t i = first; i < first + rows; ++i) {
        const double x = condition.values[i];
        if (!(weight_[i] > 0) || !std::isfinite(x)) continue;
        const auto above =
            std::clamp(std::upper_bound(knots.begin(), knots.end(), x), knots.begin() + 1, knots.end() - 1);
        const auto k = static_cast<std::size_t>(above - knots.begin());
        const double t = std::clamp((x - knots[k - 1]) / (knots[k] - knots[k - 1]), 0.0, 1.0);
        const double curve = (1 - t) * part.coefficients[k - 1] + t * part.coefficients[k];
        result(static_cast<Eigen::Index>(i - first), static_cast<Eigen::Index>(c)) +=
            curve * (condition.direction.empty() ? 1 : condition.direction[i]) * weight_[i];
      }
    }
  }
  return result;
}

std::vector<double> System::raw_residual(std::span<const double> values) const {
  const Observations& o = observations();
  std::vector<double> r(o.rows());
  parallel_for(0, o.groups(), [&](std::size_t g) {
    problem_.predict(values, g, {r.data() + o.first[g], o.first[g + 1] - o.first[g]});
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) r[i] = o.value[i] - r[i];
  });
  return r;
}

const double* Slopes::find(std::size_t parameter, std::size_t group, Eigen::Index rows) const {
  const auto place = std::lower_bound(parameters.begin(), parameters.end(), parameter);
  if (place == parameters.end() || *place != parameter || of_group[group].rows() != rows) return nullptr;
  const std::vector<std::size_t>& touching = columns[group];
  const auto wanted = static_cast<std::size_t>(place - parameters.begin());
  const auto column = std::lower_bound(touching.begin(), touching.end(), wanted);
  if (column == touching.end() || *column != wanted) return nullptr;
  return of_group[group].data() + (column - touching.begin()) * rows;
}

Slopes slopes(const System& system, std::span<const double> values, std::vector<std::size_t> parameters,
              const Slopes* kept) {
  Slopes s{std::move(parameters), {}, {}};
  std::sort(s.parameters.begin(), s.parameters.end());
  s.of_group.resize(system.observations().groups());
  s.columns.resize(s.of_group.size());
  parallel_for(0, system.groups.size(), [&](std::size_t k) {
    const std::size_t group = system.groups[k];
    std::vector<std::size_t> touching;
    for (std::size_t p = 0; p < s.parameters.size(); ++p) {
      if (!system.touches(s.parameters[p], group)) continue;
      s.columns[group].push_back(p);
      touching.push_back(s.parameters[p]);
    }
    s.of_group[group] = system.jacobian(values, group, touching, kept);
  });
  return s;
}

Eigen::MatrixXd group_columns(const System& system, const Linearisation& l, std::span<const ExtraColumn> extras,
                              std::span<const Signature> signatures, std::size_t group,
                              std::vector<std::size_t>& columns, const Slopes* kept) {
  std::vector<std::size_t> own;
  std::vector<std::vector<std::size_t>> shifted(signatures.size());
  std::vector<std::size_t> here;  // of signatures whose slopes are taken where the model stands, in one go
  std::vector<const ExtraColumn*> extra_columns;
  columns.clear();
  for (std::size_t c = 0; c < l.columns.size(); ++c) {
    const LinearColumn& column = l.columns[c];
    if (column.extra != LinearColumn::everywhere) {
      const std::vector<std::size_t>& on = extras[column.extra].groups;
      if (!on.empty() && std::find(on.begin(), on.end(), group) == on.end()) continue;
      extra_columns.push_back(&extras[column.extra]);
    } else if (column.parameter != LinearColumn::everywhere) {
      if (!system.touches(column.parameter, group)) continue;
      (column.signature == LinearColumn::everywhere ? own : shifted[column.signature]).push_back(column.parameter);
    }
    columns.push_back(c);
  }
  const Eigen::VectorXd r = system.residual(l.values, group);
  Eigen::MatrixXd a(r.size(), static_cast<Eigen::Index>(columns.size()) + 1);
  Eigen::Index filled = 0;
  const auto append = [&](const Eigen::MatrixXd& part) {
    a.middleCols(filled, part.cols()) = part;
    filled += part.cols();
  };
  std::vector<char> unmoved(signatures.size(), 0);
  for (std::size_t s = 0; s < signatures.size(); ++s) {
    unmoved[s] = !signatures[s].parameters.empty() && signatures[s].values == l.values;
    if (unmoved[s] != 0) here.insert(here.end(), shifted[s].begin(), shifted[s].end());
  }
  append(system.jacobian(l.values, group, own, kept));
  const Eigen::MatrixXd at_once = system.jacobian(l.values, group, here);
  Eigen::Index taken = 0;
  for (std::size_t s = 0; s < signatures.size(); ++s) {
    if (unmoved[s] != 0) {
      const auto count = static_cast<Eigen::Index>(shifted[s].size());
      append(at_once.middleCols(taken, count));
      taken += count;
    } else if (signatures[s].parameters.empty()) {
      append(r - system.residual(signatures[s].values, group));
    } else if (!shifted[s].empty()) {
      append(system.jacobian(signatures[s].values, group, shifted[s]));
    }
  }
  append(system.extra(extra_columns, group));
  append(r);
  return a;
}

namespace {

// Curves that free parameters imitate to better than a hundredth of their length get no say: a weak pull to zero on
// extra columns, this share of their squared length.
constexpr double least_survivor = 1e-4;
constexpr double most_entries = 5e7;  // of columns that are kept, 400 MB

GroupGram group_gram(const System& system, const Linearisation& l, std::span<const ExtraColumn> extras,
                     std::span<const Signature> signatures, std::size_t group, const Slopes* kept,
                     Eigen::MatrixXd* columns) {
  GroupGram gram;
  gram.group = group;
  Eigen::MatrixXd a = group_columns(system, l, extras, signatures, group, gram.columns, kept);
  const std::size_t first = system.observations().first[group];
  std::vector<Eigen::Index> rows[2];
  for (Eigen::Index i = 0; i < a.rows(); ++i) rows[system.half(first + static_cast<std::size_t>(i))].push_back(i);
  for (std::size_t h = 0; h < 2; ++h) {
    gram.half[h] = linear::gram_of(a(rows[h], Eigen::all));  // a group of one block has but one half
  }
  if (columns != nullptr) *columns = std::move(a);
  return gram;
}

LinearColumn parameter_column(const System& system, std::size_t p, double value) {
  const Parameter& parameter = system.problem().parameters()[p];
  LinearColumn column;
  column.parameter = p;
  column.local = system.only_group(parameter.groups);
  if (parameter.prior_sigma) {
    column.prior_precision = 1 / (*parameter.prior_sigma * *parameter.prior_sigma);
    column.prior_pull = (parameter.start - value) * column.prior_precision;
  }
  return column;
}

}  // namespace

Linearisation linearise(const System& system, std::span<const double> values, std::span<const std::size_t> parameters,
                        std::span<const ExtraColumn> extras, std::span<const Signature> signatures, const Slopes* kept,
                        std::vector<Eigen::MatrixXd>* of_groups) {
  Linearisation l;
  l.values.assign(values.begin(), values.end());
  l.own = parameters.size();
  for (const std::size_t p : parameters) l.columns.push_back(parameter_column(system, p, values[p]));
  for (std::size_t s = 0; s < signatures.size(); ++s) {
    for (const std::size_t p : signatures[s].parameters) {
      l.columns.push_back(parameter_column(system, p, values[p]));
      l.columns.back().signature = s;
    }
    if (!signatures[s].parameters.empty()) continue;
    l.columns.emplace_back();
    l.columns.back().signature = s;
    if (system.groups.size() == 1) l.columns.back().local = system.groups[0];
  }
  for (std::size_t e = 0; e < extras.size(); ++e) {
    LinearColumn column;
    column.extra = e;
    column.local = system.only_group(extras[e].groups);
    l.columns.push_back(column);
  }
  l.grams.resize(system.groups.size());
  const double entries = static_cast<double>(system.observations().rows()) * static_cast<double>(l.columns.size());
  if (of_groups != nullptr) of_groups->resize(entries < most_entries ? system.groups.size() : 0);
  parallel_for(0, system.groups.size(), [&](std::size_t k) {
    l.grams[k] = group_gram(system, l, extras, signatures, system.groups[k], kept,
                            of_groups == nullptr || of_groups->empty() ? nullptr : &(*of_groups)[k]);
  });
  for (const GroupGram& gram : l.grams)
    for (std::size_t k = 0; k < gram.columns.size(); ++k) {
      const auto place = static_cast<Eigen::Index>(k);
      LinearColumn& column = l.columns[gram.columns[k]];
      if (column.extra != LinearColumn::everywhere)
        column.prior_precision += least_survivor * (gram.half[0](place, place) + gram.half[1](place, place));
    }
  return l;
}

}  // namespace gonio::inference
