// Units of table columns: SI, spelled m, rad, s, px, W/sr, 1/sr, W/m^2/sr, ...
#pragma once
#include <string>

namespace gonio::manifest {

// Refuses units that are not SI (deg, mm, ...) and units at odds with the one that a column's name ends in (u_px in m).
void check_column_unit(const std::string& column, const std::string& unit, const std::string& place);

}  // namespace gonio::manifest
