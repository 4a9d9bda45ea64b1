// What fills the three bands of a scene (optics/bands.h): spectra from files, and RGB numbers of manifests and pictures
// where the bands are wavelengths.
//
// A surface's `spectra` name a file per parameter. CSV (wavelength_nm,value): the parameter itself. YAML of
// refractiveindex.info, by the parameter's name: `eta...` is n; `k` is k; `f0` the reflectance at normal incidence from
// air, ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2); `sigma_a_per_m` is 4 pi k / wavelength. In RGB the spectrum is reduced by
// the normalised matching functions (optics/colour.h); a parameter of one component takes the value at 587.56 nm, the
// d line, in RGB and spectral renderings alike.
//
// RGB numbers become smooth spectra (optics::upsampled), kept within the parameter's bounds. Single numbers are grey.
#pragma once
#include <filesystem>

#include "io/image.h"
#include "manifest/model.h"
#include "optics/bands.h"
#include "scene/scene.h"

namespace gonio::scene {

inline constexpr double d_line_m = 587.5618e-9;

// What a file states of `parameter`: one number or three. Error(data | no_input) at the file, or at `place`: of the
// entry in the manifest.
std::vector<double> spectrum_in_bands(const std::filesystem::path& file, const manifest::ModelInfo& info,
                                      const std::string& parameter, const optics::Bands& bands,
                                      const std::string& place);

// As they are where the bands are RGB.
Rgb in_bands(Rgb value, const manifest::ParameterInfo& info, const optics::Bands& bands);
manifest::Parameters in_bands(manifest::Parameters parameters, const manifest::ModelInfo& info,
                              const optics::Bands& bands);
io::Image in_bands(io::Image picture, double lower, double upper, const optics::Bands& bands);
// Parameters that vary per vertex or label.
void in_bands(Surface& surface);

}  // namespace gonio::scene
