// Tests that a problem makes on its own before the engine's steps: of single observations, which no held-out group can
// speak for. What they find is named without a race, at the false-alarm rate that the problem states; the engine works
// on what is left.
#pragma once
#include <algorithm>
#include <vector>

#include "explain/explanation.h"

namespace gonio::explain {

class OwnTests {
 public:
  virtual ~OwnTests() = default;
  // Places in Problem::candidates of what is tested here; these do not run in the race.
  virtual std::vector<std::size_t> tested() const = 0;
  // Relative fall of the squares that ends a fit. Where the model is known to lack much, its last digits say nothing.
  virtual double tolerance() const { return 1e-9; }
  // Adds to a finished explanation what these tests have found; its sentence is written afterwards.
  virtual void conclude(Explanation& explanation) const = 0;
};

inline bool tested_apart(const Problem& problem, std::size_t candidate) {
  const auto* own = dynamic_cast<const OwnTests*>(&problem);
  if (own == nullptr) return false;
  const std::vector<std::size_t> tested = own->tested();
  return std::find(tested.begin(), tested.end(), candidate) != tested.end();
}

}  // namespace gonio::explain
