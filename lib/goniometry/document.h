// What brdf-fit found, as the manifest's "surfaces" and "surface_fits" have it, and in one sentence.
#pragma once
#include <string>

#include "base/error.h"
#include "goniometry/outputs.h"
#include "manifest/sections/forward.h"

namespace gonio::goniometry {

struct Verdict {
  std::string word;      // "good", "doubtful", "refused"
  std::string sentence;  // for the top of the page and the log
  Exit exit = Exit::done;
};
// doubtful (Exit::quality): the fit did not converge, the surface reflects more than it receives, errs more than
// a constant would, or errs on held-out directions by half as much again as on fitted ones. refused (Exit::negative):
// no model may be believed. A good one's sentence adds where its name claims more than its numbers tell
// (goniometry/fit/plausible.h).
Verdict verdict_of(const Outcome& outcome);

// Adds or replaces surfaces/NAME (not where all was refused, nor for a table that render(1) would refuse) and
// surface_fits/NAME. `table_file`: id of the file with the reconstruction's table.
void enter(manifest::Document& document, const Outcome& outcome, const std::string& table_file = {});

// "alpha", "albedo[550 nm]".
std::string number_name(const FittedNumber& number, const Samples& samples);

}  // namespace gonio::goniometry
