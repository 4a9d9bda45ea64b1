// The roughness of a surface in question, where it is seen first, and how it may vary (surface/law.h):
//   rougher all over   a = sqrt(alpha^2 + more^2): variances of slopes add
//   print-slopes       a + (1 - a) share |sin(2 t)|^(1 / share), t the angle to the print direction    law print-normal
//   print-layers       a in even layers, a + rougher in odd ones                                       law print-layers
//   polish             a + (1 - a) / (1 + exp(s (1 - |H| reach)))                                      law
//   polish-curvature
// A law whose first number is neutral (0) leaves `a` as it is, to the last bit.
#pragma once
#include <array>
#include <string>

#include "manifest/sections/forward.h"
#include "surface/law.h"

namespace gonio::explain::traced {

struct Roughness {
  double alpha = 0, more = 0;
  double slopes = 0;                                       // share: 1 / s of the law
  double layers = 0, layer_m = 0.001, layer_offset_m = 0;  // layers: by how much odd ones are rougher
  double reach_m = 0, polish = 4;                          // 1 / curvature_per_m, s
  double lower = 0, upper = 1;                             // of the surface's model

  double even() const;  // a
  double at(const surface::LocalGeometry& here) const;
  // As the surface's own parameter "alpha", or the law that it follows.
  void write(manifest::Document& document, const std::string& surface) const;
};

}  // namespace gonio::explain::traced
