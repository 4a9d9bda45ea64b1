// See frame_loops.h. The loops and their closures are frame_graph.h's; here are the limits and the words.
#include "manifest/frame_loops.h"

#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "manifest/frame_graph.h"
#include "manifest/sections/frame_link.h"

namespace gonio::manifest {
namespace {

constexpr double most_deviations = 5.5;  // chi-square with three degrees exceeds its square in 1.2e-6 of cases

FrameEdge edge_of(const Link& link) {
  FrameEdge edge{link.to, link.from, {normalized(link.rotation), link.translation_m}, {}, {}};
  if (link.sigma) edge.covariance = covariance_of(*link.sigma);
  return edge;
}

struct Misfit {
  double shift_m = 0, turn_rad = 0;
  double shift_limit_m = 0, turn_limit_rad = 0;
  bool contradicts() const { return shift_m > shift_limit_m || turn_rad > turn_limit_rad; }
};

// Of nothing: between the axes, so that its variance is their mean.
Vec3 direction_of(Vec3 v) {
  return normalized(norm(v) > 0 ? v : Vec3{1, 1, 1});
}

double variance_along(const std::array<double, 36>& covariance, std::size_t first, Vec3 u) {
  const std::array<double, 3> along{u.x, u.y, u.z};
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) sum += along[a] * covariance[6 * (first + a) + first + b] * along[b];
  return sum;
}

Misfit misfit_of(std::span<const FrameEdge> edges, const FrameLoop& loop) {
  const Closure c = closure_of(edges, loop);
  return {norm(c.shift_m), norm(c.turn_rad),
          most_deviations * std::sqrt(variance_along(c.covariance, 3, direction_of(c.shift_m))),
          most_deviations * std::sqrt(variance_along(c.covariance, 0, direction_of(c.turn_rad)))};
}

std::string in_words(const Misfit& m) {
  constexpr double degrees = 180 / pi, mm = 1e3;
  const auto seen = [](double v) { return std::round(v * 1e6) * 1e-6; };  // the rest is arithmetic
  return format("off by %.4g mm and %.4g degrees (limits %.2g mm, %.2g degrees)", seen(mm * m.shift_m),
                seen(degrees * m.turn_rad), mm * m.shift_limit_m, degrees * m.turn_limit_rad);
}

std::string joined_by_comma(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

[[noreturn]] void refuse_loop(const Document& d, const FrameLoop& loop, const Misfit& misfit) {
  const std::size_t closing = loop.closing;
  const Link& link = d.frames[closing];
  std::vector<std::string> frames, places;
  for (const Stride& s : loop.way) {
    places.push_back("/frames/" + std::to_string(s.edge));
    frames.push_back(s.along ? d.frames[s.edge].from : d.frames[s.edge].to);
  }
  frames.pop_back();
  const std::string by = frames.empty() ? "what the other link says" : "the way by " + joined_by_comma(frames);
  throw Error(Exit::data, place(d, "/frames/" + std::to_string(closing)),
              "\"" + link.to + "\" from \"" + link.from + "\" contradicts " + by + " (" + joined_by_comma(places) +
                  "): " + in_words(misfit),
              "correct one of these links, or state their sigma");
}

// Two links of the same name and direction, whatever their sigmas: nobody could say which of the two holds.
void check_twice(const Document& d, std::size_t first, std::size_t again) {
  const Link& link = d.frames[again];
  std::array<FrameEdge, 2> both{edge_of(d.frames[first]), edge_of(link)};
  for (FrameEdge& edge : both) edge.covariance = {};
  const Misfit misfit = misfit_of(both, {1, {{0, true}}});
  if (misfit.contradicts())
    throw Error(Exit::data, place(d, "/frames/" + std::to_string(again)),
                "\"" + link.to + "\" from \"" + link.from + "\" stands twice with different values (/frames/" +
                    std::to_string(first) + "): " + in_words(misfit),
                "keep one of the two");
}

}  // namespace

void check_frames(const Document& d) {
  std::vector<FrameEdge> edges;
  std::map<std::pair<std::string, std::string>, std::size_t> seen;
  for (std::size_t i = 0; i < d.frames.size(); ++i) {
    const Link& link = d.frames[i];
    if (link.to == link.from)
      throw Error(Exit::data, place(d, "/frames/" + std::to_string(i)),
                  "is a link from \"" + link.from + "\" to itself", "name two frames, or leave it out");
    const auto [earlier, first] = seen.try_emplace({link.to, link.from}, i);
    if (!first) check_twice(d, earlier->second, i);
    edges.push_back(edge_of(link));
  }
  for (const FrameLoop& loop : fundamental_loops(edges))
    if (const Misfit misfit = misfit_of(edges, loop); misfit.contradicts()) refuse_loop(d, loop, misfit);
}

}  // namespace gonio::manifest
