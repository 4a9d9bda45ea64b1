// What brdf-fit found about one sample, and the files that say it: a table in MERL's format, the samples with what the
// surface predicts, a sphere of that surface.
#pragma once
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "goniometry/fit/fit.h"
#include "goniometry/reconstruct/reconstruction.h"
#include "goniometry/tables/tables.h"
#include "io/image.h"
#include "io/merl.h"
#include "manifest/sections/forward.h"
#include "surface/merl_table.h"

namespace gonio::goniometry {

struct Outcome {
  std::string name;    // of the surface
  std::string source;  // file, table or goniometer sample
  ReadTable read{};
  std::filesystem::path file{};  // that alone says all that `read` holds; empty: options had a say, or there is none
  std::string table_name{};      // in the manifest's tables, where it came from there
  Fits fits{};
  std::optional<Reconstruction> reconstruction{};
  std::shared_ptr<const surface::MeasuredTable> table{};  // of the reconstruction, over table_scale
  double table_scale = 1;                                 // its largest reflectance where that is above 1
  std::string basis{};                                    // what it rests on
  std::map<std::string, std::string> files{};             // file ids of what was written beside it

  // Pictures can be made of what it reflects.
  bool renders() const { return table_scale <= surface::MeasuredTable::most_reflectance; }
  const Fit* chosen() const { return fits.chosen < fits.candidates.size() ? &fits.candidates[fits.chosen] : nullptr; }
};

// Bands that stand for red, green and blue: those named r, g, b; else the ones nearest to 610, 545 and 455 nm; else the
// first, the middle and the last.
std::array<std::size_t, 3> written_bands(const Samples& samples);
// What surfaces/NAME has for red, green and blue, in words: names of those bands, or averages over several in a
// reconstruction.
std::array<std::string, 3> written_names(const Outcome& outcome);
// log(1 + 100 f cos theta_i cos theta_o), the scale on which reflectances are compared.
double compared(double f, Vec3 wi, Vec3 wo);
// What the surface, or without one the reconstruction, predicts of a band of the samples; NaN where neither is there.
double predicted(const Outcome& outcome, Vec3 wi, Vec3 wo, std::size_t band);

// The fit in the cells of MERL's database: 90 x 90 x 180, red, green and blue as written_bands() says.
// Error(usage) at `place` for surfaces that change when they are turned about their normal, which the format cannot
// hold.
io::MerlTable merl_of(const Outcome& outcome, const std::string& place);
// One row per sample and band: directions in rad, the band's wavelength_m or channel, f, its sigma, the model, the
// residual on the scale above, series and place. Readable by brdf-fit and explain.
std::string samples_csv(const Outcome& outcome);

// As a field of such a table.
std::string quoted(const std::string& text);

// A sphere of the surface of `document` under a lamp and a dim sky, linear. Deterministic.
io::Image sphere_picture(const manifest::Document& document, const std::string& surface, int pixels = 240);

}  // namespace gonio::goniometry
