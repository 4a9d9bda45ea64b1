// What it costs to leave out what is named, or to take a rival that explains the corners as well: both put the board
// elsewhere, as a board in a tank looks nearer than it stands.
#include <algorithm>
#include <cmath>

#include "explain/boards/boards_outcome.h"
#include "inference/wording.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

constexpr double worth_telling = 0.02;  // of the distance
constexpr std::size_t most_numbers = 3;

double distance_m(const BoardsInput& input, const std::vector<BoardRole>& roles, std::span<const double> values,
                  std::size_t view) {
  const camera::BoardExtent& extent = input.boards[input.views[view].board].extent;
  const camera::BoardPose pose = board_scene(input, roles, values, view).model.pose;
  return norm(pose * Vec3{extent.middle_m.x, extent.middle_m.y, 0});
}

// " (relative 0.33)": numbers that all views share.
std::string numbers(const Problem& problem, std::size_t candidate, const std::vector<double>& values) {
  std::string text;
  std::size_t count = 0;
  for (const std::size_t p : problem.candidates()[candidate].parameters) {
    const Parameter& parameter = problem.parameters()[p];
    if (parameter.groups.size() == 1) continue;
    if (++count > most_numbers) break;
    const std::string name = parameter.name.substr(parameter.name.find_last_of("./") + 1);
    text += (text.empty() ? " (" : ", ") + name + " " + score_in_words(values[p], "1");
  }
  return text.empty() ? "" : text + ")";
}

// Relative change of the boards' distance from one set of values to another, the median over the views.
double farther(const BoardsInput& input, const std::vector<BoardRole>& roles, std::span<const double> from,
               std::span<const double> to) {
  std::vector<double> ratios;
  for (std::size_t v = 0; v < input.views.size(); ++v)
    ratios.push_back(distance_m(input, roles, to, v) / distance_m(input, roles, from, v));
  return stats::median(ratios) - 1;
}
std::string off_in_words(double off) {
  return share_in_words(std::abs(off)) + (off < 0 ? " nearer" : " farther");
}

}  // namespace

std::string rivals_cost(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                        const Explanation& e) {
  if (e.named.empty()) return "";
  std::string text;
  if (const double off = farther(input, roles, e.values, e.base_values); std::abs(off) >= worth_telling)
    text = std::string("Without ") + (e.named.size() == 1 ? "it" : "them") + " the board would be believed " +
           off_in_words(off) + ".";
  for (const std::vector<std::size_t>& set : e.not_told_apart)
    for (std::size_t k = 1; k < set.size(); ++k) {
      std::vector<std::size_t> other = e.named;
      std::replace(other.begin(), other.end(), set[0], set[k]);
      std::sort(other.begin(), other.end());
      const auto weighed = std::ranges::find_if(e.weighed, [&](const Explanation::Weighed& w) {
        std::vector<std::size_t> own = w.candidates;
        std::sort(own.begin(), own.end());
        return own == other && !w.values.empty();
      });
      if (weighed == e.weighed.end()) continue;
      const double off = farther(input, roles, e.values, weighed->values);
      if (std::abs(off) < worth_telling) continue;
      text += (text.empty() ? "" : " ") + problem.candidates()[set[k]].id() +
              numbers(problem, set[k], weighed->values) + " would imitate " + problem.candidates()[set[0]].id() +
              " and put the board " + off_in_words(off) + ".";
    }
  return text;
}

}  // namespace gonio::explain
