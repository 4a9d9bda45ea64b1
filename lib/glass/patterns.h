// What a screen behind glass shows.
#pragma once
#include <span>
#include <string>

#include "base/random.h"
#include "io/image.h"

namespace gonio::glass {

std::span<const char* const> pattern_names();
// 160 x 90 pixels, R, G, B between 0 and 1, linear. Error(internal) for another name.
io::Image screen_picture(const std::string& pattern, Random& random);

// Surroundings of a room, latitude and longitude (light/models/lat_long.cpp): walls, a ceiling with lamps, windows.
io::Image room(Random& random);

}  // namespace gonio::glass
