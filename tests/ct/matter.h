// What phantoms are made of, and the X-rays that go through them.
//
// Mass attenuation coefficients: NIST Standard Reference Database 126 (Hubbell & Seltzer, "Tables of X-Ray Mass
// Attenuation Coefficients", 2004), 10 to 300 keV, total attenuation with coherent scattering, interpolated log-log. No
// substance here has an absorption edge in that range.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace gonio::ct {

enum class Substance { oxygen, aluminium, silicon, iron, copper, pyrex, pmma, pvc, teflon };
double mass_attenuation_cm2_per_g(Substance substance, double kev);

struct Material {
  std::string name;
  double density_g_per_cm3 = 1;
  std::vector<std::pair<Substance, double>> mass_shares;
  double attenuation_per_m(double kev) const;
};
Material glass();           // borosilicate, 2.23 g/cm^3
Material quartz();          // SiO2, 2.20
Material plastic();         // PMMA, 1.19: lighter than glass
Material filled_plastic();  // PMMA with 40 % of iron by mass, 1.80: twice as opaque as glass at 60 keV
Material aluminium();       // 2.70
Material ceramic();         // Al2O3, 3.90
Material iron();            // 7.87

struct Spectrum {
  std::vector<double> kev, share;  // shares of the photons that a detector counts in the open beam: sum 1
  double attenuation_per_m(const Material& material) const;  // of an infinitely thin layer
};
Spectrum mono(double kev);
// A tungsten tube: Kramers' bremsstrahlung (photons per keV ~ (kV - E) / E) in `bins` bins from 12 keV to kV, and above
// 69.5 kV the K lines at 57.98, 59.32, 67.2 and 69.1 keV, 9 % of the photons before filtering at 120 kV, growing as
// (kV / 69.5 - 1)^1.67 (Green & Cosslett 1968); filtered by aluminium and copper. The detector counts every photon
// alike.
Spectrum tube(double kilovolt, double aluminium_mm = 2, double copper_mm = 0, int bins = 30);

}  // namespace gonio::ct
