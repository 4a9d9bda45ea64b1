// Any six revolute joints: all solutions, up to 16, as eigenvalues. Raghavan & Roth 1993 (fourteen equations without
// joint 6, of which six without joints 1 and 2), Manocha & Canny 1994 (joints 4 and 5 eliminated dialytically; what is
// left, singular in the tangent of half of joint 3, is an eigenproblem of 24 rows).
//
// Instead of writing out the coefficients they are interpolated: every equation is linear in 1, cos q, sin q of each
// joint that it holds, so that its values at three angles of each determine it.
//
// Good to about 1e-8 before refinement. Where an arm's geometry is special in several ways at once (axes 1 and 2 meet,
// 2 and 3 are parallel, 4 and 5 meet) the six equations become dependent and roots are lost, for every seventh pose of
// such arms; read from the flange the same arms kept all, hence both are asked for. Parallel or meeting axes in threes
// have closed forms (closed_forms.h).
#pragma once
#include <memory>
#include <vector>

#include "robot/inverse/screws.h"

namespace gonio::robot::general {

class AllRoots {
 public:
  explicit AllRoots(const screws::Screws& screws);
  ~AllRoots();
  AllRoots(AllRoots&&) noexcept;
  AllRoots& operator=(AllRoots&&) noexcept;
  // Starts for Newton's method: roots that are real or nearly so; where there is none, the real parts of all others.
  std::vector<Joints> starts(const screws::Pose& wanted) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace gonio::robot::general
