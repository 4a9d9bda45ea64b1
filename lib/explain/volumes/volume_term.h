// A mechanism on readings of a volume: one file in terms/, called after it.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "explain/volumes/observed.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::volumes {

struct Form {
  std::vector<std::string> parameters;  // of the declaration, which are fitted together; the others stay neutral
  bool finer = false;                   // Candidate::finer
};

struct Term {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  int order = 0;                                        // terms act in this order
  std::vector<Form> forms{};                            // each is a candidate of its own; empty: all parameters at once
  bool (*applies)(const Observed& observed) = nullptr;  // null: always
  // The value of a row with the mechanism, of the one without it. `p`: all parameters of the declaration, in order, and
  // behind them, where it asks for that, the spectrum's variance, which the base model holds.
  bool of_spectrum = false;
  double (*act)(double value, const Row& row, const Observed& observed, std::span<const double> p) = nullptr;
};
// What is known at some shares of an amount, at any share: linear in its logarithm between them, constant beyond.
inline double at_share(std::span<const double> known, std::span<const double> shares, double share) {
  if (!(share > shares.front())) return known.front();
  std::size_t k = 0;
  while (k + 2 < shares.size() && share > shares[k + 1]) ++k;
  const double t = std::log(share / shares[k]) / std::log(shares[k + 1] / shares[k]);
  return known[k] + std::min(t, 1.0) * (known[k + 1] - known[k]);
}

// A row's value with a blur of that spread (voxels), of the one without it; spectrum: the variance of its energies.
double blurred(double value, const Row& row, double spread, double spectrum);

std::span<const Term* const> all_terms();  // sorted by name; defined in a generated source

}  // namespace gonio::explain::volumes
