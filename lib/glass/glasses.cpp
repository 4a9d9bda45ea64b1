// See glasses.h. Sellmeier: n^2 - 1 = sum B_i l^2 / (l^2 - C_i), l in um.
#include "glass/glasses.h"

#include <array>
#include <cmath>

#include "base/text.h"

namespace gonio::glass {
namespace {

double sellmeier(double um, const std::array<double, 3>& b, const std::array<double, 3>& c) {
  double sum = 1;
  for (std::size_t i = 0; i < 3; ++i) sum += b[i] * um * um / (um * um - c[i]);
  return std::sqrt(sum);
}

double soda_lime(double um) {
  return 1.5130 - 0.003169 * um * um + 0.003962 / (um * um);
}
double borosilicate(double um) {
  return sellmeier(um, {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653});
}
double flint(double um) {
  return sellmeier(um, {1.34533359, 0.209073176, 0.937357162}, {0.00997743871, 0.0470450767, 111.886764});
}
double silica(double um) {
  return sellmeier(um, {0.6961663, 0.4079426, 0.8974794},
                   {0.0684043 * 0.0684043, 0.1162414 * 0.1162414, 9.896161 * 9.896161});
}
double water(double um) {
  return 1.3199 + 6.878e-3 / (um * um) - 1.132e-3 / std::pow(um, 4) + 1.11e-4 / std::pow(um, 6);
}

constexpr Glass all[] = {
    {"soda-lime", "window and bottle glass", "Rubin, Solar Energy Materials 12, 1985", soda_lime},
    {"bk7", "borosilicate crown", "Schott, N-BK7", borosilicate},
    {"flint", "dense lead glass, as cut crystal", "Schott, F2", flint},
    {"silica", "fused silica", "Malitson, J. Opt. Soc. Am. 55, 1965", silica},
    {"water", "what stands in vessels", "Bashkatov & Genina, SPIE 5068, 2003", water},
};

}  // namespace

std::span<const Glass> glasses() {
  return all;
}

const Glass* find_glass(const std::string& id) {
  for (const Glass& glass : all)
    if (glass.id == id) return &glass;
  return nullptr;
}

std::string spectrum_csv(const Glass& glass) {
  std::string text = "wavelength_nm,value\n";
  for (int nm = 380; nm <= 780; nm += 20) text += format("%d,%.6f\n", nm, glass.index(nm * 1e-3));
  return text;
}

}  // namespace gonio::glass
