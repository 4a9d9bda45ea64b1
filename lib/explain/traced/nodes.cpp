// See nodes.h.
#include "explain/traced/nodes.h"

#include <algorithm>
#include <cstddef>

namespace gonio::explain::traced {

double between(const std::vector<double>& nodes, std::span<const double> y, double x) {
  const std::size_t n = nodes.size();
  if (n == 1) return y[0];
  const auto secant = [&](std::size_t k) { return (y[k + 1] - y[k]) / (nodes[k + 1] - nodes[k]); };
  const auto slope = [&](std::size_t k) {
    if (n == 2) return secant(0);
    const std::size_t m = std::clamp<std::size_t>(k, 1, n - 2);
    const double before = nodes[m] - nodes[m - 1], after = nodes[m + 1] - nodes[m];
    const double middle = (secant(m - 1) * after + secant(m) * before) / (before + after);
    return k == m ? middle : k < m ? 2 * secant(0) - middle : 2 * secant(n - 2) - middle;
  };
  if (x <= nodes.front()) return y[0] + slope(0) * (x - nodes.front());
  if (x >= nodes.back()) return y[n - 1] + slope(n - 1) * (x - nodes.back());
  const auto k = static_cast<std::size_t>(std::upper_bound(nodes.begin(), nodes.end(), x) - nodes.begin()) - 1;
  const double h = nodes[k + 1] - nodes[k], t = (x - nodes[k]) / h;
  const double a = slope(k) * h, b = slope(k + 1) * h, d = y[k + 1] - y[k];
  return y[k] + t * (a + t * (3 * d - 2 * a - b + t * (a + b - 2 * d)));
}

}  // namespace gonio::explain::traced
