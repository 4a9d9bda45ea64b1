// Lines of numbers as robots' controllers write them, split and checked before anything is read into them. Rules:
// pose_list.h.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace gonio::robot {

struct NumberLine {
  std::vector<double> numbers;  // all finite
  std::string name;             // first field, where it is no number
  std::string place;            // "poses.txt:12"
};

// Lines without any number (blank, comments) are passed over, and so is one header line before the first numbers.
// Error(data) for a field that is no finite number and for decimal commas.
std::vector<NumberLine> number_lines(std::string_view text, const std::string& file);

}  // namespace gonio::robot
