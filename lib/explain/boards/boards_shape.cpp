// What a named board.shape means: how far from a plane, how far from the printed places.
#include <algorithm>
#include <cmath>

#include "camera/mechanisms/board_shape.h"
#include "explain/boards/boards_outcome.h"
#include "inference/wording.h"

namespace gonio::explain {
namespace {

constexpr int grid = 17;  // points along each side

}  // namespace

std::string shapes_in_words(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                            const Explanation& e) {
  constexpr std::size_t terms = equation::board_shape_terms.size(), first = camera::CornerColumn::shape;
  std::vector<std::array<double, terms>> shapes(input.boards.size());
  for (const std::size_t c : e.named)
    for (const std::size_t p : problem.candidates()[c].parameters)
      if (roles[p].board < shapes.size() && roles[p].column >= first && roles[p].column < first + terms)
        shapes[roles[p].board][roles[p].column - first] = e.values[p];
  std::string text;
  for (std::size_t b = 0; b < shapes.size(); ++b) {
    if (std::ranges::all_of(shapes[b], [](double v) { return v == 0; })) continue;
    double lowest = 0, highest = 0, aside = 0;
    for (int i = 0; i < grid; ++i)
      for (int j = 0; j < grid; ++j) {
        const Vec3 shift = equation::board_shape(shapes[b].data(), 2.0 * i / (grid - 1) - 1, 2.0 * j / (grid - 1) - 1);
        lowest = std::min(lowest, shift.z), highest = std::max(highest, shift.z);
        aside = std::max(aside, std::hypot(shift.x, shift.y));
      }
    text += (text.empty() ? "" : " ") + input.boards[b].name + " bends over " +
            inference::quantity(highest - lowest, "m") + ", and its corners stand up to " +
            inference::quantity(aside, "m") + " beside their printed places.";
  }
  return text;
}

std::string prints_in_words(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                            const Explanation& e) {
  std::string text;
  for (std::size_t b = 0; b < input.boards.size(); ++b) {
    std::vector<std::array<double, 3>> shift(input.boards[b].places.size());
    for (const std::size_t c : e.named)
      for (const std::size_t p : problem.candidates()[c].parameters)
        if (roles[p].corner < shift.size() && roles[p].board == b)
          shift[roles[p].corner][roles[p].column - camera::CornerColumn::print] = e.values[p];
    double aside = 0, out = 0, most = 0;
    for (const auto& [x, y, z] : input.boards[b].print.displaced(shift)) {
      aside += x * x + y * y, out += z * z;
      most = std::max(most, std::hypot(x, y));
    }
    if (aside == 0) continue;
    const auto n = static_cast<double>(shift.size());
    text += (text.empty() ? "" : " ") + std::string("The corners of ") + input.boards[b].name + " stand " +
            inference::quantity(std::sqrt(aside / n), "m") +
            " beside their printed places within the board (RMS; the furthest " + inference::quantity(most, "m") +
            "), and " + inference::quantity(std::sqrt(out / n), "m") + " before or behind its plane.";
  }
  return text;
}

}  // namespace gonio::explain
