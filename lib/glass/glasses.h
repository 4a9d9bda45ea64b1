// Kinds of glass, and of what is clear like it, by their dispersion.
#pragma once
#include <span>
#include <string>

namespace gonio::glass {

struct Glass {
  const char* id;
  const char* sentence;
  const char* source;
  double (*index)(double wavelength_um);  // 0.38 to 0.78 um
};
std::span<const Glass> glasses();
const Glass* find_glass(const std::string& id);  // null pointer where there is none
inline constexpr double d_line_um = 0.58756;     // helium, by which an index is quoted

// As a file that a surface's `spectra` names: wavelength_nm,value.
std::string spectrum_csv(const Glass& glass);

}  // namespace gonio::glass
