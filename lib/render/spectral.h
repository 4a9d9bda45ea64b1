// Spectral pictures: N wavelengths beside red, green and blue. The scene is built once more for every three wavelengths
// (Scene::bands); a path of the pixel is traced through each of these scenes with the same random numbers, so that the
// bins of a pixel share their noise.
//
// Channels are named as Fichet, Pacanowski & Wilkie 2021, "An OpenEXR Layout for Spectral Images" (JCGT 10(3)) have it:
// "S0.550,0nm", the comma because a point divides layers; S1 to S3 with --stokes.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "optics/bands.h"
#include "render/integrator.h"

namespace gonio::render {

// "400nm:700nm:31": centres of N bins, first and last included. Error(usage) at `place`.
std::vector<double> parse_wavelengths(const std::string& text, const std::string& place);

// Bands of each extra scene; the last repeats its last wavelength where three do not divide N.
std::vector<optics::Bands> spectral_bands(const std::vector<double>& wavelengths_m);

std::string spectral_channel(int stokes, double wavelength_m);
// Wavelengths of the channels "S0..." among those of these planes (film.h: plane_channels()); in their order.
std::vector<double> wavelengths_of(const std::vector<std::string>& planes);

// Traces `colour` and then each of `spectral`, one for each of spectral_bands(), with the same random numbers.
std::unique_ptr<Integrator> with_spectrum(std::unique_ptr<Integrator> colour,
                                          std::vector<std::unique_ptr<Integrator>> spectral,
                                          const std::vector<double>& wavelengths_m);

}  // namespace gonio::render
