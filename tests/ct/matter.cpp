#include "ct/matter.h"

#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace gonio::ct {
namespace {

constexpr std::size_t points = 12;
constexpr std::array<double, points> table_kev{10, 15, 20, 30, 40, 50, 60, 80, 100, 150, 200, 300};

const std::array<double, points>& table_of(Substance substance) {
  using Table = std::array<double, points>;
  static const Table oxygen{5.952,  1.836,  0.8651, 0.3779, 0.2585, 0.2132,
                            0.1907, 0.1678, 0.1551, 0.1361, 0.1237, 0.1070};
  static const Table aluminium{26.23,  7.955,  3.441,  1.128,  0.5685, 0.3681,
                               0.2778, 0.2018, 0.1704, 0.1378, 0.1223, 0.1042};
  static const Table silicon{33.89,  10.34,  4.464,  1.436,  0.7012, 0.4385,
                             0.3207, 0.2228, 0.1835, 0.1448, 0.1275, 0.1082};
  static const Table iron{170.6, 57.08, 25.68, 8.176, 3.629, 1.958, 1.205, 0.5952, 0.3717, 0.1964, 0.1460, 0.1099};
  static const Table copper{215.9, 74.05, 33.79, 10.92, 4.862, 2.613, 1.593, 0.7630, 0.4584, 0.2217, 0.1559, 0.1119};
  static const Table pyrex{17.05, 5.217, 2.297, 0.7987, 0.4341, 0.3022, 0.2417, 0.1890, 0.1657, 0.1389, 0.1246, 0.1069};
  static const Table pmma{3.357, 1.101, 0.5714, 0.3032, 0.2350, 0.2074, 0.1924, 0.1751, 0.1641, 0.1456, 0.1328, 0.1152};
  static const Table pvc{33.40, 10.45, 4.578, 1.491, 0.7300, 0.4559, 0.3325, 0.2298, 0.1887, 0.1486, 0.1308, 0.1110};
  static const Table teflon{6.805,  2.088,  0.9667, 0.4025, 0.2647, 0.2132,
                            0.1880, 0.1632, 0.1500, 0.1310, 0.1189, 0.1027};
  switch (substance) {
    case Substance::oxygen: return oxygen;
    case Substance::aluminium: return aluminium;
    case Substance::silicon: return silicon;
    case Substance::iron: return iron;
    case Substance::copper: return copper;
    case Substance::pyrex: return pyrex;
    case Substance::pmma: return pmma;
    case Substance::pvc: return pvc;
    case Substance::teflon: return teflon;
  }
  throw std::invalid_argument("no such substance");
}

}  // namespace

double mass_attenuation_cm2_per_g(Substance substance, double kev) {
  if (!(kev >= table_kev.front() && kev <= table_kev.back()))
    throw std::invalid_argument("energy outside 10 to 300 keV");
  const auto& table = table_of(substance);
  std::size_t k = 0;
  while (k + 2 < points && kev > table_kev[k + 1]) ++k;
  const double along = std::log(kev / table_kev[k]) / std::log(table_kev[k + 1] / table_kev[k]);
  return table[k] * std::pow(table[k + 1] / table[k], along);
}

double Material::attenuation_per_m(double kev) const {
  double sum = 0;
  for (const auto& [substance, share] : mass_shares) sum += share * mass_attenuation_cm2_per_g(substance, kev);
  return 100 * density_g_per_cm3 * sum;
}

Material glass() {
  return {"glass", 2.23, {{Substance::pyrex, 1}}};
}
Material quartz() {
  return {"quartz", 2.20, {{Substance::silicon, 0.4674}, {Substance::oxygen, 0.5326}}};
}
Material plastic() {
  return {"plastic", 1.19, {{Substance::pmma, 1}}};
}
Material filled_plastic() {
  return {"filled plastic", 1.80, {{Substance::pmma, 0.6}, {Substance::iron, 0.4}}};
}
Material aluminium() {
  return {"aluminium", 2.70, {{Substance::aluminium, 1}}};
}
Material ceramic() {
  return {"ceramic", 3.90, {{Substance::aluminium, 0.5293}, {Substance::oxygen, 0.4707}}};
}
Material iron() {
  return {"iron", 7.87, {{Substance::iron, 1}}};
}

double Spectrum::attenuation_per_m(const Material& material) const {
  double sum = 0;
  for (std::size_t e = 0; e < kev.size(); ++e) sum += share[e] * material.attenuation_per_m(kev[e]);
  return sum;
}

Spectrum mono(double kev) {
  return {{kev}, {1}};
}

Spectrum tube(double kilovolt, double aluminium_mm, double copper_mm, int bins) {
  if (!(kilovolt >= 30 && kilovolt <= 300) || bins < 1) throw std::invalid_argument("tube: 30 to 300 kV");
  constexpr double lowest = 12, edge = 69.525;
  Spectrum s;
  const double width = (kilovolt - lowest) / bins;
  for (int b = 0; b < bins; ++b) {
    const double e = lowest + (b + 0.5) * width;
    s.kev.push_back(e);
    s.share.push_back((kilovolt - e) / e);
  }
  const double continuum = std::accumulate(s.share.begin(), s.share.end(), 0.0);
  if (kilovolt > edge) {
    const double at_120 = std::pow(120 / edge - 1, 1.67), ratio = 0.09 / 0.91;
    const double lines = continuum * ratio * std::pow(kilovolt / edge - 1, 1.67) / at_120;
    // Relative intensities of K alpha 2, K alpha 1, K beta 1+3, K beta 2 (Storm & Israel 1970).
    for (const auto& [e, part] : {std::pair{57.98, 0.289}, {59.32, 0.502}, {67.2, 0.166}, {69.1, 0.043}}) {
      s.kev.push_back(e);
      s.share.push_back(lines * part);
    }
  }
  const Material copper{"copper", 8.96, {{Substance::copper, 1}}};
  double sum = 0;
  for (std::size_t k = 0; k < s.kev.size(); ++k) {
    s.share[k] *= std::exp(-1e-3 * (aluminium_mm * aluminium().attenuation_per_m(s.kev[k]) +
                                    copper_mm * copper.attenuation_per_m(s.kev[k])));
    sum += s.share[k];
  }
  for (double& v : s.share) v /= sum;
  return s;
}

}  // namespace gonio::ct
