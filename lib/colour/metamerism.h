// What no correction can mend: colours that differ to people and are the same to a sensor.
//
// Reflectances are taken as random and as smooth as a chart's inks: mean 0.28, standard deviation 0.226, correlation
// 1/4 + 3/4 exp(-(d / 66 nm)^2 / 2) at the distance d of wavelengths (of the 24 of the ColorChecker at 10 to 200 nm:
// within 0.1). What the sensor reads leaves of their XYZ under the light the covariance
//   C = A K A' - A K S' (S K S')^-1 S K A'       A observer, S sensor, each times the light; K as above
// which no estimate from the three numbers alone is better than, for normal reflectances. The bound is the root mean
// square CIEDE2000 of C about the mean grey. Sensors that are mixtures of the observer's functions have zero.
// A chart's inks vary in fewer ways than that: of six published sensors, with bounds from 0.8 to 2.4 and one of 16, a
// matrix misses the ColorChecker by 0.8 to 1.1, and 4.6. The bound is for all else that may lie before the camera.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "colour/chart.h"
#include "geom/vector.h"

namespace gonio::colour {

using Sensitivities = std::function<Rgb(double wavelength_m)>;  // any unit; zero where there is none

// Lines of wavelength in nm and three numbers, R, G, B, growing; lines that begin with # and one heading are passed
// over. Zero beyond what is stated. Error(data | no_input) at the file and line.
Sensitivities read_sensitivities(const std::filesystem::path& path);
Sensitivities parse_sensitivities(const std::string& text, const std::string& place);

// Error(data) at `place` where the three channels are mixtures of two.
double metamerism_de00(const Sensitivities& sensor, const std::function<double(double)>& light,
                       const std::string& place);

// What the sensor reads of every patch's reflectance under the light, over what it reads of a perfect white; empty
// where a patch has none. Error(data) at `place` where a channel sees nothing of the light.
std::vector<Rgb> sensed(const Chart& chart, const Sensitivities& sensor, const std::function<double(double)>& light,
                        const std::string& place);

// Covariance of reflectances at two wavelengths, as above.
double reflectance_covariance(double a_m, double b_m);
inline constexpr double mean_reflectance = 0.28;

}  // namespace gonio::colour
