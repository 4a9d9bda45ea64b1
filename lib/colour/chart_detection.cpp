// See chart_detection.h.
#include "colour/chart_detection.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "colour/chart_light.h"
#include "colour/correction_fit.h"
#include "colour/patch_candidates.h"

namespace gonio::colour {
namespace {

constexpr double sampled = 0.5;         // inner part of a patch that is looked at
constexpr int samples = 7;              // along each side
constexpr std::size_t looked_at = 8;    // ways to lay the chart, the best by a matrix alone, that are judged with light
constexpr double least_covered = 0.45;  // of the chart's patches by cells of a lattice

struct Laid {
  ChartPose pose;
  double misfit = HUGE_VAL;
};

// What the picture shows of each patch; empty where a patch reaches out of it.
std::vector<PatchReading> glimpse(const io::Image& picture, const Chart& chart, const ChartPose& pose) {
  std::vector<PatchReading> readings;
  for (const Patch& patch : chart.patches) {
    PatchReading reading{{}, {{0, 0, 0, 0, 0, 0, 0, 0, 0}}, 0, {}};
    for (int j = 0; j < samples; ++j)
      for (int i = 0; i < samples; ++i) {
        const double across = (i + 0.5) / samples - 0.5, down = (j + 0.5) / samples - 0.5;
        const Vec2 at =
            pose.at({patch.centre.x + across * sampled * patch.size.x, patch.centre.y + down * sampled * patch.size.y});
        if (!(at.x > -0.5 && at.y > -0.5 && at.x < picture.width - 0.5 && at.y < picture.height - 0.5)) return {};
        const int x = static_cast<int>(std::lround(at.x)), y = static_cast<int>(std::lround(at.y));
        const Rgb rgb{picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2)};
        if (is_finite(rgb)) reading.rgb += rgb, ++reading.pixels;
      }
    if (reading.pixels == 0) return {};
    reading.rgb = reading.rgb / static_cast<double>(reading.pixels);
    readings.push_back(reading);
  }
  return readings;
}

double misfit(const Chart& chart, const std::vector<PatchReading>& readings, bool with_light) {
  if (readings.empty()) return HUGE_VAL;
  try {
    const Rgb white = white_of(chart, readings, {});
    const ChartLight light = with_light ? chart_light(chart, readings, white, {false, true, false}) : ChartLight{};
    if (!(light.evenness() > 0.05)) return HUGE_VAL;  // light that no lamp gives
    std::vector<Sample> all;
    for (std::size_t p = 0; p < readings.size(); ++p)
      all.push_back(
          {light.evened(readings[p].rgb, chart.patches[p].centre), readings[p].covariance, chart.patches[p].lab});
    const Correction correction = fit_correction(all, {Model::linear, Target::cie_rgb, white, false}, {});
    double sum = 0;
    for (const Sample& sample : all) sum += optics::ciede2000(sample.lab, correction.lab(sample.rgb));
    return sum / static_cast<double>(all.size());
  } catch (const Error&) {
    return HUGE_VAL;  // no colours at all
  }
}

// The chart's cell that lies on a lattice's, turned by quarters.
std::pair<int, int> turned(int column, int row, int turn) {
  return turn == 0   ? std::pair{column, row}
         : turn == 1 ? std::pair{row, -column}
         : turn == 2 ? std::pair{-column, -row}
                     : std::pair{-row, column};
}

struct Match {
  Vec2 chart, image;
};

std::optional<ChartPose> pose_of(const std::vector<Match>& matches, double tolerance_px) {
  if (matches.size() < 4) return {};
  std::vector<cv::Point2d> from, to;
  for (const Match& m : matches) from.emplace_back(m.chart.x, m.chart.y), to.emplace_back(m.image.x, m.image.y);
  const cv::Mat h = cv::findHomography(from, to, cv::RANSAC, tolerance_px);
  if (h.empty()) return {};
  ChartPose pose;
  for (int i = 0; i < 9; ++i) pose.image_from_chart.m[static_cast<std::size_t>(i)] = h.at<double>(i / 3, i % 3);
  // Seen from its front, and all of it in front of the camera.
  const auto corners = corners_of(pose);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2 a = corners[(i + 1) % 4] - corners[i], b = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    if (!(a.x * b.y - a.y * b.x > 1)) return {};
  }
  return pose;
}

double side_of(const std::vector<Quad>& quads, const Lattice& lattice) {
  double sum = 0;
  for (const LatticeCell& cell : lattice) sum += quads[cell.quad].side;
  return sum / static_cast<double>(lattice.size());
}

class Laying {
 public:
  Laying(const io::Image& picture, const Chart& chart) : picture_(picture), chart_(chart) {}

  // All ways to lay the chart on lattices of a picture shrunk so.
  std::vector<Laid> ways(double shrink) const {
    std::vector<Quad> quads = patch_candidates(lightness_picture(picture_, shrink));
    for (Quad& quad : quads) {  // pixel centres lie at integers
      quad.centre = (quad.centre + Vec2{0.5, 0.5}) * shrink - Vec2{0.5, 0.5};
      quad.side *= shrink;
      for (Vec2& c : quad.corners) c = (c + Vec2{0.5, 0.5}) * shrink - Vec2{0.5, 0.5};
    }
    const double share = chart_.patches[0].size.x / (chart_.patches[1].centre.x - chart_.patches[0].centre.x);
    const auto least = static_cast<std::size_t>(std::ceil(least_covered * static_cast<double>(chart_.patches.size())));
    std::vector<Laid> laid;
    for (const Lattice& lattice : lattices(quads, share, least))
      for (int turn = 0; turn < 4; ++turn) lay(quads, lattice, turn, least, laid);
    std::ranges::stable_sort(laid, {}, &Laid::misfit);
    return laid;
  }

 private:
  void lay(const std::vector<Quad>& quads, const Lattice& lattice, int turn, std::size_t least,
           std::vector<Laid>& laid) const {
    int left = INT_MAX, right = INT_MIN, top = INT_MAX, bottom = INT_MIN;
    for (const LatticeCell& cell : lattice) {
      const auto [column, row] = turned(cell.column, cell.row, turn);
      left = std::min(left, column), right = std::max(right, column);
      top = std::min(top, row), bottom = std::max(bottom, row);
    }
    // The chart's first cell lies at (x, y) of the lattice.
    for (int y = top - chart_.rows + 1; y <= bottom; ++y)
      for (int x = left - chart_.columns + 1; x <= right; ++x) {
        std::vector<Match> matches;
        for (const LatticeCell& cell : lattice) {
          const auto [column, row] = turned(cell.column, cell.row, turn);
          if (column < x || row < y || column >= x + chart_.columns || row >= y + chart_.rows) continue;
          const auto patch = static_cast<std::size_t>((row - y) * chart_.columns + column - x);
          matches.push_back({chart_.patches[patch].centre, quads[cell.quad].centre});
        }
        if (matches.size() < least) continue;
        const double tolerance = 0.12 * side_of(quads, lattice);
        std::optional<ChartPose> pose = pose_of(matches, tolerance);
        if (pose) pose = snapped(*pose, quads, tolerance);
        if (pose) laid.push_back({*pose, misfit(chart_, glimpse(picture_, chart_, *pose), false)});
      }
  }

  // Once more with all quads that lie where the pose has patches.
  std::optional<ChartPose> snapped(const ChartPose& pose, const std::vector<Quad>& quads, double tolerance) const {
    std::vector<Match> matches;
    for (const Patch& patch : chart_.patches) {
      const Vec2 at = pose.at(patch.centre);
      const auto near = std::ranges::min_element(quads, {}, [&](const Quad& q) { return norm(q.centre - at); });
      if (norm(near->centre - at) < 2 * tolerance) matches.push_back({patch.centre, near->centre});
    }
    return pose_of(matches, tolerance);
  }

  const io::Image& picture_;
  const Chart& chart_;
};

}  // namespace

double colour_misfit(const io::Image& picture, const Chart& chart, const ChartPose& pose) {
  return misfit(chart, glimpse(picture, chart, pose), true);
}

FoundChart find_chart(const io::Image& picture, const Chart& chart, const std::string& place) {
  const std::string remedy = "give its corners (--corners), or show it larger, sharper and in more even light";
  if (chart.columns == 0)
    throw Error(Exit::data, place, "the chart has no grid, and is not searched for", "give its corners (--corners)");
  const Laying laying(picture, chart);
  const double longer = std::max(picture.width, picture.height);
  FoundChart nearest{{}, HUGE_VAL, HUGE_VAL};
  for (const double size : {1000.0, 2000.0, 500.0}) {
    if (size == 2000 && longer <= 1200) continue;
    auto ways = laying.ways(std::max(1.0, longer / size));
    if (ways.size() > looked_at) ways.resize(looked_at);
    for (Laid& way : ways) way.misfit = std::min(way.misfit, colour_misfit(picture, chart, way.pose));
    std::ranges::stable_sort(ways, {}, &Laid::misfit);
    if (ways.empty()) continue;
    FoundChart found{ways[0].pose, ways[0].misfit, HUGE_VAL};
    const Vec2 centre = found.pose.at({0.5, 0.5}), first = found.pose.at(chart.patches[0].centre);
    const double pitch = norm(found.pose.at(chart.patches[1].centre) - first);
    for (std::size_t i = 1; i < ways.size(); ++i)  // the same way again, from another lattice, is no rival
      if (norm(ways[i].pose.at({0.5, 0.5}) - centre) > pitch / 4 ||
          norm(ways[i].pose.at(chart.patches[0].centre) - first) > pitch / 4) {
        found.next_de00 = ways[i].misfit;
        break;
      }
    if (found.misfit_de00 < nearest.misfit_de00) nearest = found;
    if (found.misfit_de00 < most_misfit_de00 && found.next_de00 > least_lead * found.misfit_de00) return found;
  }
  if (!std::isfinite(nearest.misfit_de00))
    throw Error(Exit::data, place, "shows no grid of patches like " + chart.name, remedy);
  if (nearest.misfit_de00 < most_misfit_de00)
    throw Error(Exit::data, place,
                format("shows %s in two ways: colours differ by %.1f and %.1f dE00", chart.name.c_str(),
                       nearest.misfit_de00, nearest.next_de00),
                remedy);
  throw Error(Exit::data, place,
              format("shows no %s: the best grid differs by %.1f dE00 from its colours, limit %.0f", chart.name.c_str(),
                     nearest.misfit_de00, most_misfit_de00),
              remedy);
}

}  // namespace gonio::colour
