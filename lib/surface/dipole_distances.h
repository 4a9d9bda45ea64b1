// Distances between where light enters and leaves, drawn from sums of the flux that point sources at depths z_k send
// through a plane:
//   density(r) = sum of share_k z_k (1 + s d_k) exp(-s (d_k - z_k)) / (2 pi d_k^3),   d_k^2 = r^2 + z_k^2,   s =
//   sigma_tr
// Its tail beyond r is in closed form, sum of share_k (z_k / d_k) exp(-s (d_k - z_k)); one source's is inverted by
// Newton's method on ln y + y = M, y = s d (Lambert's function). For the standard dipole this is the profile itself.
// Cut off at `reach_m` and normalised there.
#pragma once
#include <array>

namespace gonio::surface {

class DipoleDistances {
 public:
  struct Source {
    double depth_m = 0, share = 0;
  };
  DipoleDistances() = default;
  DipoleDistances(std::array<Source, 2> sources, double sigma_tr_per_m) : sources_(sources), sigma_tr_(sigma_tr_per_m) {
    cut(cut_m_);
  }

  double tail(double distance_m) const;    // without cut-off
  double reach_m(double remaining) const;  // beyond which the tail is `remaining`
  void cut(double reach_m);
  double sample(double u) const;
  double density(double distance_m) const;

 private:
  double tail(const Source& source, double distance_m) const;
  std::array<Source, 2> sources_{};
  std::array<double, 2> strength_{};  // share_k z_k / (2 pi), normalised
  double sigma_tr_ = 0, cut_m_ = 1e300;
};

}  // namespace gonio::surface
