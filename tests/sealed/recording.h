// Manifests and tables as a user writes them: text, without the library that reads them.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "manifest/value.h"
#include "sealed/sealed_case.h"

namespace gonio::sealed {

using manifest::Value;

struct Column {
  std::string name, unit;
  Numbers values;
};
// A header line and one line a row; six significant digits of what an instrument gives, nine of what it sets.
std::string csv(const std::vector<Column>& columns);
// {"model": ..., "columns": {...}, "observed": [...], "sigma": [...]} for a CSV file with file id "table".
Value table_section(const std::string& model, const std::vector<Column>& columns,
                    const std::vector<std::string>& observed, const std::vector<std::string>& sigma);
Value pose(const std::vector<double>& rotation_3x3, double x, double y, double z);  // {"matrix": 4x4}
// recording.json with "gonio" and the files so far made (but itself).
void finish(Value manifest, Case& into);
Value free_parameter(double start);
// A profiler's file, rows from the top, metres, NaN where nothing was measured: Digital Surf, "Surface Data File
// Format" (1991), format 1, 512 bytes of head, then points of 32 bits.
std::string profile(int width, int height, double step_m, const Numbers& z);

}  // namespace gonio::sealed
