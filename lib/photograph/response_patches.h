// Places of photographs that tell a camera's response: patches of 3 x 3 pixels in all exposures of a view, the
// smoothest of each brightness.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "photograph/response_fit.h"

namespace gonio::photograph {

struct ResponseView {
  std::string name;
  std::vector<std::filesystem::path> pictures;  // of 8 or 16 bits
  std::vector<double> exposures_s;
};

// Times that differ by less than 1e-6 are one. A reading in which a pixel has the lowest or the highest code is left
// out. Memory holds one picture at a time. Error(data) for pictures of floats, which are linear; of different sizes in
// a view; of other channels than the first one's; for an exposure that does not last longer than 0 s.
ResponseData response_data(const std::vector<ResponseView>& views);

}  // namespace gonio::photograph
