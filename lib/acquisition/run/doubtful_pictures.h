// Kept frames that look doubtful: each is what was asked for, and may still be of little use.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/run/frame_record.h"

namespace gonio::acquisition {

// Sentences. Saturated: more than 1 % of a picture that is no member of a bracket. Dark: its brightest percentile
// within ten times the noise of the lamps-off frame's (`dark`, by camera and exposure). Out of focus: less than a
// quarter of the median of that camera's views.
std::vector<std::string> doubtful_pictures(const std::map<std::string, FrameRecord>& records,
                                           const std::map<std::pair<std::string, double>, FrameFigures>& dark);

}  // namespace gonio::acquisition
