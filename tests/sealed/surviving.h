// What is left of an effect after a fair refit: least squares on the free parameters' derivatives, in noise widths.
// Effects are differences of noise-free simulations, so this is the arithmetic of what could be seen at best.
#pragma once
#include <memory>

#include "sealed/sealed_case.h"

namespace gonio::sealed {

class FreeParameters {
 public:
  // `columns`: derivatives of all rows with respect to each free parameter; `sigma`: noise of the rows.
  // `stratum`: rows of one stratum have free numbers of their own, with the derivatives `own`; empty: there are none.
  FreeParameters(const std::vector<Numbers>& columns, const Numbers& sigma,
                 const std::vector<std::size_t>& stratum = {}, const std::vector<Numbers>& own = {});
  ~FreeParameters();
  FreeParameters(FreeParameters&&) noexcept;
  Numbers surviving(const Numbers& effect) const;  // in noise widths

 private:
  struct Basis;
  std::unique_ptr<Basis> basis_;
};

double length(const Numbers& v);
// Length of what `v` keeps when the directions `others` (all in noise widths, already refitted) are taken away.
double left_beside(const Numbers& v, const std::vector<Numbers>& others);

}  // namespace gonio::sealed
