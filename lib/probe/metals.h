// What a ball's metal reflects: Fresnel's reflectance of a complex index, in the working colour space.
//
// The index is reduced to the bands red, green and blue as every index is (optics/colour.h), and the reflectance
// follows per band (surface/fresnel.h), as `render` has it for its surface "conductor".
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "geom/vector.h"

namespace gonio::probe {

struct Metal {
  Rgb eta{1, 1, 1}, k{};
  bool perfect = false;                  // reflects all light
  Rgb reflectance(double cosine) const;  // of the angle of incidence
};

// "chromium", "nickel", "iron", "silver", "aluminium", and "none": a mirror that reflects all light.
const std::vector<std::string>& metal_names();
// By name, or by a file of refractiveindex.info (YAML). Error(usage) at `place` for neither.
Metal metal_of(const std::string& name_or_file, const std::string& place);

}  // namespace gonio::probe
