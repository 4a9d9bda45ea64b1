// A mechanism in the simulation of mosaic photographs: one file in terms/, called after it. It sets numbers of the
// simulation (polarization_state.h); the equation is the mechanism's own.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "explain/polarization/polarization_state.h"
#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::polarization {

// One hypothesis: parameters of the declaration that are fitted together; the others stay neutral.
struct Form {
  std::vector<std::string> parameters;
  bool finer = false;   // Candidate::finer
  std::string on = {};  // of several surfaces: which
  std::size_t place = 0;
  double upper = 0;  // of the first parameter, where not the declaration's; 0: that
  int side = 0;      // above neutral alone (1), below alone (-1); 0: on either side of it
};
struct Term {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  std::vector<Form> (*forms)(const Setup& setup) = nullptr;
  // `p`: all parameters of the declaration, in order.
  void (*set)(State& state, const Form& form, std::span<const double> p) = nullptr;
  // Into the section of what it changes; null: it becomes a mechanism in use, on the camera.
  void (*write)(manifest::Document& document, const Setup& setup, const Form& form, std::span<const double> p,
                std::span<const double> sigma) = nullptr;
};
std::span<const Term* const> all_terms();  // sorted by name; defined in a generated source

}  // namespace gonio::explain::polarization
