// A mechanism in the simulation of a print: one file in terms/, called after it. It changes what is simulated
// (printed_field.h); the equation is the mechanism's own.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "explain/prints/printed_field.h"
#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::prints {

// One hypothesis: parameters of the declaration that are fitted together; the others stay neutral, or where they are
// held.
struct Form {
  std::vector<std::string> parameters;
  bool finer = false;   // Candidate::finer
  std::string on = {};  // of several: which, in words
  double held = 0;      // what is not fitted: the layer
};
struct Bounds {  // of a parameter, for this printer
  double neutral = 0, lower = 0, upper = 0, start = 0;
};
struct Term {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  // Empty: one, with all parameters. Each form has numbers of its own.
  std::vector<Form> (*forms)(const Sent& sent) = nullptr;
  // Lengths go with the pixels and layers of the printer. Null: those of the declaration.
  std::vector<Bounds> (*bounds)(const Sent& sent) = nullptr;
  // `p`: all parameters of the declaration, in order.
  void (*set)(Setting& setting, const Sent& sent, const Form& form, std::span<const double> p) = nullptr;
  double step = 2e-2;    // of differences, of a parameter's size
  bool gradual = false;  // Candidate::gradual
  bool random = false;   // no simulation has it: it is asked apart (ground.h)
  // Into the printer's own section, which has a place for it; null: it becomes a mechanism in use. `covariance`: of p,
  // row by row.
  void (*write)(manifest::Print& print, const Sent& sent, std::span<const double> p,
                std::span<const double> covariance) = nullptr;
};
std::span<const Term* const> all_terms();  // sorted by name; defined in a generated source

}  // namespace gonio::explain::prints
