// Lines of numbers as robots' controllers write them, split and checked before anything is read into them. Rules:
// pose_list.h.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::robot {

struct NumberLine {
  std::vector<double> numbers;  // all finite
  std::string name;             // first field, where it is no number
  std::string place;            // "poses.txt:12"
  std::string length{};         // of blocks: unit that the label states, "mm"; else empty
};

// Lines without any number (blank, comments) are passed over, and so is one header line before the first numbers.
// Error(data) for a field that is no finite number and for decimal commas.
std::vector<NumberLine> number_lines(std::string_view text, const std::string& file);
// The same for lists of poses, which may also be blocks under labels, "Rotation:" and "Translation:" (pose_blocks.cpp):
// then one line per pose, of a 3x3 matrix the sixteen numbers [R t; 0 0 0 1] row by row, of other rotations the
// translation and then the rotation.
std::vector<NumberLine> pose_lines(std::string_view text, const std::string& file);

// Without comment and brackets; fields between separators; the number that a field is, whole. For the two above.
std::string bare_line(std::string_view line);
std::vector<std::string> fields_of_line(const std::string& text, const std::string& place);
std::optional<double> number_of_field(const std::string& text);
double finite_number(const std::string& field, const std::string& place);

}  // namespace gonio::robot
