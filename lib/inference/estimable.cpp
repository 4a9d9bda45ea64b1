// See estimable.h.
#include "inference/estimable.h"

#include <cmath>
#include <numeric>

#include "inference/problem.h"

namespace gonio::inference {
namespace {

using Column = Estimable::Column;
constexpr double least_of_free = 1e-9;  // a free parameter that others imitate has no direction of its own

double dot_of(const Column& a, const Column& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

constexpr double least_of_noise = 1;  // of what is left of a change of usual size, over all rows

// Gram & Schmidt, twice: once leaves what rounding made of a long column.
bool join(const Column& column, double least_share, double usual, std::vector<Column>& basis) {
  Column rest = column;
  for (int twice = 0; twice < 2; ++twice)
    for (const Column& b : basis) {
      const double share = dot_of(b, rest);
      for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= share * b[i];
    }
  const double length = std::sqrt(dot_of(rest, rest));
  const double whole = std::sqrt(dot_of(column, column));
  if (!(length > least_of_free * whole)) return false;
  if (!(length > least_share * whole) && !(length * usual > least_of_noise)) return false;
  for (double& v : rest) v /= length;
  basis.push_back(std::move(rest));
  return true;
}

}  // namespace

Estimable::Estimable(const std::vector<Column>& free) {
  for (const Column& column : free) join(column, least_of_free, 0, basis_);
}

std::vector<std::size_t> Estimable::kept(const std::vector<Column>& own, double least_share,
                                         const std::vector<double>& usual) const {
  std::vector<Column> basis = basis_;
  std::vector<std::size_t> places;
  for (std::size_t p = 0; p < own.size(); ++p)
    if (join(own[p], least_share, usual.empty() ? 0 : usual[p], basis)) places.push_back(p);
  return places;
}

Estimable::Column whitened_slopes(const Problem& problem, std::size_t parameter, std::span<const double> values) {
  const Observations& o = problem.observations();
  Estimable::Column column(o.rows());
  const std::size_t one[] = {parameter};
  for (std::size_t g = 0; g < o.groups(); ++g)
    problem.jacobian(values, g, one, std::span(column).subspan(o.first[g], o.first[g + 1] - o.first[g]));
  for (std::size_t i = 0; i < column.size(); ++i) column[i] /= o.sigma[i];
  return column;
}

}  // namespace gonio::inference
