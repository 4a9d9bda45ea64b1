// Columns and rows of a board that its printer set unevenly: in each view, the mean displacement of a line of corners
// in the board's plane, from what the final model leaves; over the views, mean and standard error. Shift, turn, tilt
// and stretch of the whole board are in the fit: what is left is the line's own. Words for what board.print would give
// numbers, where it is not what is named.
#include <algorithm>
#include <cmath>
#include <map>

#include "explain/boards/boards_outcome.h"
#include "inference/sentence.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

constexpr std::size_t fewest_views = 6;
constexpr double beyond = 7;       // standard errors: under 1e-4 by chance for six views and twenty lines
constexpr double least_mm = 0.02;  // what a caliper shows

struct Line {
  std::vector<double> mm;  // one for each view
  double mean() const {
    double sum = 0;
    for (const double d : mm) sum += d;
    return sum / static_cast<double>(mm.size());
  }
  double sigma() const {
    const double m = mean();
    double sum = 0;
    for (const double d : mm) sum += (d - m) * (d - m);
    const auto n = static_cast<double>(mm.size());
    return std::sqrt(sum / (n * (n - 1)));
  }
};

// By the line's place in whole squares. The median of a line's corners: single ones are misplaced.
std::map<long, Line> lines_of(const BoardsInput& input, std::size_t board, const Explanation& e, bool columns) {
  std::map<long, Line> lines;
  std::size_t row = 0;
  for (const BoardsInput::View& view : input.views) {
    std::map<long, std::vector<double>> own;
    for (const BoardsInput::Corner& c : view.corners) {
      const Vec2 way = by_millimetre(input, view, c, columns ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
      const Vec2 left{e.residual_after[row], e.residual_after[row + 1]};
      const double at = (columns ? c.board_m.x : c.board_m.y) / input.boards[board].square_m;
      own[std::lround(at)].push_back(dot(left, way) / dot(way, way));
      row += 2;
    }
    if (view.board != board) continue;
    for (const auto& [place, mm] : own) lines[place].mm.push_back(stats::median(mm));
  }
  return lines;
}

}  // namespace

std::string uneven_print(const BoardsInput& input, const Explanation& e) {
  std::string text;
  for (std::size_t b = 0; b < input.boards.size(); ++b)
    for (const bool columns : {true, false}) {
      double worst_mm = 0, sigma_mm = 0;
      long place = 0, uneven = 0;
      for (const auto& [at, line] : lines_of(input, b, e, columns)) {
        if (line.mm.size() < fewest_views) continue;
        const double mean = line.mean(), sigma = line.sigma();
        if (std::abs(mean) < std::max(least_mm, beyond * sigma)) continue;
        ++uneven;
        if (std::abs(mean) > std::abs(worst_mm)) worst_mm = mean, sigma_mm = sigma, place = at;
      }
      if (uneven < 2) continue;
      const std::string what = columns ? "columns" : "rows", axis = columns ? "x" : "y";
      text += (text.empty() ? "" : " ") + std::to_string(uneven) + " " + what + " of " + input.boards[b].name +
              " stand aside in all views, the one at " + axis + " = " +
              printed(1e3 * static_cast<double>(place) * input.boards[b].square_m, 3) + " mm by " +
              printed(worst_mm, 2) + " mm along " + axis + " (standard error " + printed(sigma_mm, 1) +
              " mm): the print is uneven.";
    }
  return text;
}

}  // namespace gonio::explain
