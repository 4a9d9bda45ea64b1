// What a manifest states of the polarization of its lights: the parameters of these names, of models that have them.
#pragma once
#include <string>
#include <vector>

#include "manifest/sections/forward.h"

namespace gonio::explain::polarization {

inline constexpr const char *screen_angle_key = "polarization_rad", *screen_degree_key = "polarization_degree";

// Lights that are polarized.
std::vector<std::string> polarized_lights(const manifest::Document& document);
double screen_angle_rad(const manifest::Document& document, const std::string& light);
double screen_degree(const manifest::Document& document, const std::string& light);
// Angles are brought within half a turn. `sigma` 0: none is stated.
void set_screen(manifest::Document& document, const std::string& light, const char* key, double value, double sigma);

}  // namespace gonio::explain::polarization
