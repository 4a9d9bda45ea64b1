// Layers of answers about glass (glass/net/answer.h, glass/refine/answer.h) for the eye and for a line of text.
#pragma once
#include <string>
#include <vector>

#include "io/image.h"

namespace gonio::glass {

// Of a channel where mask >= 1/2, ascending; none where there is no such channel.
std::vector<float> values_within(const io::Image& answer, const std::string& channel);
double middle_of(const std::vector<float>& sorted);  // 0: of none

// One channel: 1 where `channel` is as large as 99 % of its values within the mask are, or as 1 of a mask.
io::Image grey_layer(const io::Image& answer, const std::string& channel);

}  // namespace gonio::glass
