// What single scattering at a rough interface fails to return: light that meets a second facet.
//   loss(w) = 1 - integral over the sphere of (reflected + transmitted power),   mean = integral of loss(w) wz / pi dw
// seen from the side that `eta` (index beyond over index here) belongs to; or for facets that reflect all (a mirror).
// Tabulated in blocks, each at first use (a millisecond; where roughness is anisotropic some twenty). Interpolation is
// linear in sqrt(wz), sqrt(alpha), sqrt(|eta - 1| / (eta + 1)), log(alpha_v / alpha_u) and the cosine of the azimuth,
// up to eta = 4 and 1 / 4, clamped beyond; `mean` is the exact integral of the interpolant, so that energy closes to
// the error of the table. That is, of mirrors, below 4e-3 (rms 1e-3), or 1e-2 where roughness is anisotropic; but for
// alpha < 0.04, where the loss is that of the last few alphas before the horizon, 0.02 there and, below 0.002, up to
// 0.08. Of dielectrics within 1e-2, near the horizon 3e-2 (tests: EverySurface.ReturnsAllLightWhereItClaimsTo).
#pragma once
#include <array>

#include "surface/slopes.h"

namespace gonio::surface {

struct LossTable;

class InterfaceLoss {
 public:
  InterfaceLoss(Slopes kind, const Roughness& roughness, double eta);
  // The same, remembered by each thread for the last few interfaces: paths meet them again and again.
  static InterfaceLoss of(Slopes kind, const Roughness& roughness, double eta);
  static InterfaceLoss mirror(Slopes kind, const Roughness& roughness) { return of(kind, roughness, 0); }
  // `w` in the frame of the facets' axes, on either side of the plane.
  double towards(Vec3 w) const;
  double mean() const { return mean_; }

 private:
  const LossTable* table_;
  struct Corner {  // the block at a node of (index, anisotropy, alpha), and its share
    const double* values = nullptr;
    double share = 0;
  };
  std::array<Corner, 8> corners_;
  std::size_t count_ = 0;  // of corners
  double mean_ = 0;
};

// What a mirror's facets lose, with the slopes of the interpolant, to the right at its nodes. `cosine`: of the azimuth
// in the frame of the facets' axes. Without anisotropy its table has no azimuths, and no slope by anisotropy.
struct LossSlopes {
  double value = 0, by_alpha = 0, by_anisotropy = 0, by_cosine = 0;
};
class InterfaceLossSlopes {
 public:
  InterfaceLossSlopes() = default;
  InterfaceLossSlopes(Slopes kind, double alpha, double anisotropy);
  static InterfaceLossSlopes of(Slopes kind, double alpha, double anisotropy);  // remembered, as above
  LossSlopes towards(Vec3 w) const;
  const LossSlopes& mean() const { return mean_; }

 private:
  const LossTable* table_ = nullptr;
  struct Corner {
    const double* values = nullptr;
    double share = 0, by_alpha = 0, by_anisotropy = 0;
  };
  std::array<Corner, 4> corners_;
  std::size_t count_ = 0;
  LossSlopes mean_;
};

}  // namespace gonio::surface
