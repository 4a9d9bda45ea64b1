// Readings that say only "at least" or "at most": the one rule of where they begin.
#pragma once
#include <optional>

namespace gonio::photograph {

double half_code(int code_bits);  // over full scale; `code_bits` 8 or 16
// From here on a code over full scale is saturated: half a code below the highest of a file of `code_bits` (8 or 16).
// 0, a file of floats, which has no highest code: infinity.
// `stated`: what the image says itself, of a sensor whose codes end below those of its file.
double saturated_from(int code_bits, std::optional<double> stated = {});
// Below here a code over full scale is the lowest, and the light was darker than it can say. 0 bits: minus infinity.
double dark_below(int code_bits);

// A linear value where full scale is known as a number (sensor.saturation, an option): pictures hold floats, which may
// lie a little below the number that they were cut off at. 0 or infinity: no limit.
bool at_full_scale(double value, double full_scale);

}  // namespace gonio::photograph
