#include "acquisition/device/urscript.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace gonio::acquisition {
namespace {

std::string mark_line(const ProgramMark& mark, int value) {
  return format("    write_output_integer_register(%d, %d)\n", mark.output_register, value);
}

}  // namespace

LeadingAxis leading_axis(std::span<const double> from, std::span<const double> to, std::span<const double> speeds,
                         std::span<const double> accelerations) {
  double longest = 0;
  for (std::size_t i = 0; i < to.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]));
  if (longest == 0) return {};
  LeadingAxis leading{1e9, 1e9};
  for (std::size_t i = 0; i < to.size(); ++i) {
    const double turn = std::abs(to[i] - from[i]);
    if (turn == 0) continue;
    leading.speed_rad_per_s = std::min(leading.speed_rad_per_s, speeds[i] * longest / turn);
    leading.acceleration_rad_per_s2 = std::min(leading.acceleration_rad_per_s2, accelerations[i] * longest / turn);
  }
  return leading;
}

std::string motion_script(const ProgramMark& mark, std::span<const std::vector<double>> way,
                          std::span<const double> speeds, std::span<const double> accelerations) {
  std::string text = "def gonio_motion():\n";
  text += format("  if read_output_integer_register(%d) == %d:\n", mark.output_register, mark.before);
  text += mark_line(mark, mark.begun());
  for (std::size_t k = 1; k < way.size(); ++k) {
    const LeadingAxis leading = leading_axis(way[k - 1], way[k], speeds, accelerations);
    if (leading.speed_rad_per_s == 0) continue;
    text += "    movej([";
    for (std::size_t i = 0; i < way[k].size(); ++i) text += (i == 0 ? "" : ", ") + format("%.12f", way[k][i]);
    text += format("], a=%.9f, v=%.9f)\n", leading.acceleration_rad_per_s2, leading.speed_rad_per_s);
  }
  return text + mark_line(mark, mark.ended()) + "  end\nend\n";
}

std::string stop_script(const ProgramMark& mark, double acceleration_rad_per_s2) {
  return "def gonio_stop():\n" + mark_line(mark, mark.begun()) + format("    stopj(%.9f)\n", acceleration_rad_per_s2) +
         mark_line(mark, mark.ended()) + "end\n";
}

}  // namespace gonio::acquisition
