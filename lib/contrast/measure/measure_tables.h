// What `contrast measure` writes: tables after RFC 4180 with units in the names, and entries of the manifest.
#pragma once
#include <string>

#include "contrast/measure/measure.h"

namespace gonio::contrast {

std::string views_csv(const Measured& measured);   // one row a view: signals, contrasts, sigmas, shares
std::string cells_csv(const Measured& measured);   // one row a cell: bit, contrast of the turn, distance, p
std::string series_csv(const Measured& measured);  // one row a cell and view: mean, sigma, pixels, ratio to its class

// `contrasts` of the pattern anew; in `patterns` the defects, what the code says, and poses that were fitted.
void enter(manifest::Document& document, const Measured& measured);

}  // namespace gonio::contrast
