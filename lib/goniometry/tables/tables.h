// Tables of reflectances as samples: Cornell's .brdf, CSV after ASTM E1392 (lines of keywords, then VARS), any table of
// numbers with named columns (commas, semicolons, tabs or blanks; names in the first line or in the last comment above
// the numbers), MERL's .binary, and the manifest's "tables".
//
// Units of angles are stated, by the file's heading ("theta_i [deg]", "theta_i_deg"), by --columns or by --angles: they
// are not guessed. Angles that cannot be what they are said to be, degrees that are called radians, are refused. A
// negative zenith lies on the other side of the normal: (-theta, phi) is (theta, phi + pi).
//
// Left out, with the reason: rows below the horizon, rows beyond the grazing limit (where half a degree of pointing
// error changes cos theta by a tenth), values that are negative or no number.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "goniometry/sample/convention.h"
#include "goniometry/samples.h"
#include "manifest/sections/forward.h"

namespace gonio::goniometry {

// What a column of the file stands for: theta_i (zenith of the light), phi_i, theta_o (zenith of the eye), phi_o, f,
// sigma (of the f before it, or of the only one), wavelength, channel, series.
struct ColumnUse {
  std::string quantity, column, unit;  // unit empty: the heading's, else `angles`
  bool heading_first = false;          // where the heading states a unit, that one holds
};
// "theta_i=phi_in:deg,f=brdf:1/sr"; a column is its name or its number from 1, "#3". Error(usage) at `place`.
std::vector<ColumnUse> parse_columns(const std::string& text, const std::string& place);

struct TableOptions {
  std::vector<ColumnUse> columns{};
  std::string angles{};              // "deg" | "rad" where the file says nothing; empty: it has to
  std::vector<std::string> bands{};  // kept; empty: all
  Mirror mirror = Mirror::automatic;
  double grazing_rad = 85 * pi / 180;      // rows whose zeniths are larger are left out
  std::size_t most_rows = 4000;            // of MERL tables, which are thinned
  std::optional<double> relative_noise{};  // standard uncertainty over value, where the table has none
};
struct ReadTable {
  Samples samples;
  std::vector<Dropped> dropped;
  Convention convention;
  std::vector<std::string> notes;  // what a reader has to know: thinning, units, contradictions
  std::string units_doubt{};       // what speaks for another unit than the one stated; empty: nothing
};
// Error(data | no_input) at file, line and column. Error(negative) where one pair of directions is all there is.
ReadTable read_table(const std::filesystem::path& path, const TableOptions& options = {});
// An entry of "tables" as explain(1) takes it: columns theta_i, phi_i, theta_o, phi_o in rad, with or without a unit at
// the end of the name, and what is `observed`.
ReadTable read_table(const manifest::Document& document, const std::string& name, const TableOptions& options = {});

// Keeps these bands: names ("r", "550 nm", "550nm") or ranges of wavelengths ("450nm:650nm"). Error(usage) at `place`
// with what there is.
void keep_bands(Samples& samples, const std::vector<std::string>& bands, const std::string& place);

// A coated paint as a goniometer would measure it, 320 pairs of directions with 2 % of noise: CSV.
std::string example_table(std::uint64_t seed);

}  // namespace gonio::goniometry
