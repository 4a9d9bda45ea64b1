// Tables: Johnson & Christy, Phys. Rev. B 6, 4370 (1972) and 9, 5056 (1974); Rakic, Appl. Opt. 34, 4755 (1995), as
// refractiveindex.info has them (Polyanskiy 2024, CC0). Wavelength in micrometres, n, k.
#include "probe/metals.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "base/error.h"
#include "optics/colour.h"
#include "optics/refractive_index.h"
#include "surface/fresnel.h"

namespace gonio::probe {
namespace {

struct Table {
  std::string_view name, rows;
};
constexpr std::array<Table, 5> tables{{
    {"chromium", R"(
        0.368 1.87 2.69
        0.381 1.92 2.74
        0.397 2.00 2.83
        0.413 2.08 2.93
        0.431 2.19 3.04
        0.451 2.33 3.14
        0.471 2.51 3.24
        0.496 2.75 3.30
        0.521 2.94 3.33
        0.549 3.18 3.33
        0.582 3.22 3.30
        0.617 3.17 3.30
        0.659 3.09 3.34
        0.704 3.05 3.39
        0.756 3.08 3.42
        0.821 3.20 3.48
)"},
    {"nickel", R"(
        0.368 1.70 2.40
        0.381 1.72 2.48
        0.397 1.72 2.57
        0.413 1.70 2.69
        0.431 1.71 2.82
        0.451 1.73 2.95
        0.471 1.78 3.09
        0.496 1.82 3.25
        0.521 1.85 3.42
        0.549 1.92 3.61
        0.582 1.96 3.80
        0.617 1.99 4.02
        0.659 1.99 4.26
        0.704 2.06 4.50
        0.756 2.13 4.73
        0.821 2.26 4.97
)"},
    {"iron", R"(
        0.368 2.02 2.43
        0.381 2.12 2.50
        0.397 2.24 2.58
        0.413 2.35 2.65
        0.431 2.48 2.71
        0.451 2.59 2.77
        0.471 2.67 2.82
        0.496 2.74 2.88
        0.521 2.86 2.91
        0.549 2.95 2.93
        0.582 2.94 2.99
        0.617 2.88 3.05
        0.659 2.92 3.10
        0.704 2.86 3.19
        0.756 2.87 3.28
        0.821 2.94 3.39
)"},
    {"silver", R"(
        0.3679 0.07 1.657
        0.3815 0.05 1.864
        0.3974 0.05 2.070
        0.4133 0.05 2.275
        0.4305 0.04 2.462
        0.4509 0.04 2.657
        0.4714 0.05 2.869
        0.4959 0.05 3.093
        0.5209 0.05 3.324
        0.5486 0.06 3.586
        0.5821 0.05 3.858
        0.6168 0.06 4.152
        0.6595 0.05 4.483
        0.7045 0.04 4.838
        0.7560 0.03 5.242
        0.8211 0.04 5.727
)"},
    {"aluminium", R"(
        0.36466 0.39877 4.3957
        0.41328 0.52135 5.0008
        0.44280 0.60790 5.3676
        0.47687 0.72780 5.7781
        0.51660 0.87340 6.2418
        0.56357 1.07280 6.7839
        0.61993 1.36600 7.4052
        0.65225 1.57240 7.7354
        0.68881 1.83010 8.0601
        0.72932 2.16060 8.3565
        0.77491 2.61540 8.4914
        0.79478 2.76750 8.3866
)"},
}};

Metal reduced(const optics::RefractiveIndex& index, const std::string& place) {
  if (!index.states_n() || !index.states_k())
    throw Error(Exit::data, place, "does not state both n and k", "a metal's index is complex: name a file with both");
  Metal metal;
  metal.eta = optics::band_values([&](double l) { return index.n(l); }, index.range_n(), {}, place);
  metal.k = optics::band_values([&](double l) { return index.k(l); }, index.range_k(), {}, place);
  return metal;
}

}  // namespace

Rgb Metal::reflectance(double cosine) const {
  if (perfect) return {1, 1, 1};
  return {surface::fresnel_metal(cosine, eta.x, k.x), surface::fresnel_metal(cosine, eta.y, k.y),
          surface::fresnel_metal(cosine, eta.z, k.z)};
}

const std::vector<std::string>& metal_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Table& t : tables) all.emplace_back(t.name);
    all.emplace_back("none");
    return all;
  }();
  return names;
}

Metal metal_of(const std::string& name, const std::string& place) {
  if (name == "none") return {.perfect = true};
  for (const Table& t : tables)
    if (t.name == name)
      return reduced(optics::parse_refractive_index("DATA:\n  - type: tabulated nk\n    data: |" + std::string(t.rows),
                                                    std::string(t.name)),
                     place);
  if (std::filesystem::is_regular_file(name)) return reduced(optics::read_refractive_index(name), name);
  std::string known;
  for (const std::string& n : metal_names()) known += (known.empty() ? "" : ", ") + n;
  throw Error(Exit::usage, place, "\"" + name + "\" is neither a known metal nor a file",
              known + ", or a file of refractiveindex.info");
}

}  // namespace gonio::probe
