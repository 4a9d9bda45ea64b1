// Samples as an entry of "tables" of the model "surface": what brdf-fit hands on, and what explain(1) reads of files
// that are no columns of text.
#pragma once
#include <filesystem>
#include <string>

#include "goniometry/outputs.h"
#include "manifest/document.h"

namespace gonio::goniometry {

// .brdf of Cornell, .binary of MERL: read_table() knows what their numbers mean without being told.
bool describes_itself(const std::filesystem::path& path);

// One row for each sample and band: theta_i, phi_i, theta_o, phi_o in rad, wavelength_m or channel where there are
// bands, f and, where it is known, f_sigma in 1/sr. Bands of a row that were dropped have none.
manifest::Table sample_table(const Samples& samples);

// The outcome's samples as tables/NAME, held against surfaces/NAME; a table that was read from the manifest stays as it
// is and gets the surface's name. Colours of other than three bands stand in the table's parameters, band by band in
// the order of their wavelengths.
void enter_table(manifest::Document& document, const Outcome& outcome);

}  // namespace gonio::goniometry
