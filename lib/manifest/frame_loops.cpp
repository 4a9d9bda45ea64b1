// See frame_loops.h. Links that join two parts of the graph of frames make a forest; every other link closes one loop
// with the way through the forest. Uncertainties are taken as independent and carried to the loop's end to first order:
// a turn d of a link moves what lies at l behind it by d x l.
#include "manifest/frame_loops.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "geom/rigid.h"
#include "manifest/sections/frame_link.h"

namespace gonio::manifest {
namespace {

constexpr double most_deviations = 5.5;  // chi-square with three degrees exceeds its square in 1.2e-6 of cases
constexpr double rounding_rad = 2e-6, rounding_m = 1e-6, rounding_share = 1e-6;

struct AnyFrame {};
using Motion = Rigid<AnyFrame, AnyFrame>;

// A link walked along (p_to = motion * p_from) or against its direction.
struct Stride {
  std::size_t link = 0;
  bool along = true;
};
using Way = std::vector<Stride>;

Motion motion_of(const Link& link) {
  return {normalized(link.rotation), link.translation_m};
}

Vec3 three(const std::vector<double>& sigma) {
  if (sigma.empty()) return {};
  return sigma.size() < 3 ? Vec3{sigma[0], sigma[0], sigma[0]} : Vec3{sigma[0], sigma[1], sigma[2]};
}

// Variances about and along the axes of the frame `to`.
struct Spread {
  Vec3 rotation, translation;
};
Spread spread_of(const Link& link) {
  Spread s;
  if (link.sigma) s = {three(link.sigma->rotation_rad), three(link.sigma->translation_m)};
  const double turn = rounding_rad * rounding_rad;
  const double shift =
      rounding_m * rounding_m + dot(link.translation_m, link.translation_m) * rounding_share * rounding_share;
  return {s.rotation * s.rotation + Vec3{turn, turn, turn}, s.translation * s.translation + Vec3{shift, shift, shift}};
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

// The link's motion against that of the way from its `to` to its `from`.
Misfit misfit_of(const std::vector<Link>& links, const Link& link, const Way& way) {
  std::vector<Motion> behind(way.size() + 1);  // what follows each stride
  for (std::size_t k = way.size(); k-- > 0;) {
    const Motion step = motion_of(links[way[k].link]);
    behind[k] = (way[k].along ? step : inverse(step)) * behind[k + 1];
  }
  const Motion closing = motion_of(link);
  const Vec3 shift = closing.translation_m - behind[0].translation_m;
  const Vec3 turn = rotation_vector_of(normalized(closing.rotation * conjugate(behind[0].rotation)));
  const Vec3 u = direction_of(shift), v = direction_of(turn);
  const Spread own = spread_of(link);
  double shift_variance = dot(own.translation, u * u), turn_variance = dot(own.rotation, v * v);
  Motion before;  // what precedes each stride
  for (std::size_t k = 0; k < way.size(); ++k) {
    const Link& walked = links[way[k].link];
    const Motion step = motion_of(walked);
    const Motion until = before * (way[k].along ? step : inverse(step));
    // The link's uncertainty is about the axes of its `to`, and acts on what lies behind its `from`.
    const Motion& at = way[k].along ? before : until;
    const Vec3 lever =
        way[k].along ? step.rotate(behind[k + 1].translation_m) : behind[k + 1].translation_m - step.translation_m;
    const Spread s = spread_of(walked);
    const Vec3 along_shift = inverse(at).rotate(u), along_turn = inverse(at).rotate(v),
               moved = cross(lever, along_shift);
    shift_variance += dot(s.translation, along_shift * along_shift) + dot(s.rotation, moved * moved);
    turn_variance += dot(s.rotation, along_turn * along_turn);
    before = until;
  }
  return {norm(shift), norm(turn), most_deviations * std::sqrt(shift_variance),
          most_deviations * std::sqrt(turn_variance)};
}

std::string in_words(const Misfit& m) {
  constexpr double degrees = 180 / pi, mm = 1e3;
  const auto seen = [](double v) { return std::round(v * 1e6) * 1e-6; };  // the rest is arithmetic
  return format("off by %.4g mm and %.4g degrees (limits %.2g mm, %.2g degrees)", seen(mm * m.shift_m),
                seen(degrees * m.turn_rad), mm * m.shift_limit_m, degrees * m.turn_limit_rad);
}

// Frames, and the strides that lead out of each of them.
class Forest {
 public:
  explicit Forest(const std::vector<Link>& links) : links_(links) {}
  bool joined(const std::string& a, const std::string& b) { return root_of(a) == root_of(b); }
  void join(std::size_t link) {
    const auto [to, from] = std::pair{links_[link].to, links_[link].from};
    strides_[to].push_back({link, true});
    strides_[from].push_back({link, false});
    above_[root_of(to)] = root_of(from);
  }
  // Between frames that are joined.
  Way way(const std::string& to, const std::string& from) const {
    std::map<std::string, Stride> came_by;
    std::vector<std::string> reached{to};
    for (std::size_t k = 0; k < reached.size() && !came_by.contains(from); ++k)
      for (const Stride& s : strides_.at(reached[k]))
        if (end_of(s) != to && came_by.try_emplace(end_of(s), s).second) reached.push_back(end_of(s));
    Way taken;
    for (std::string at = from; at != to;) {
      const Stride& s = came_by.at(at);
      taken.push_back(s);
      at = s.along ? links_[s.link].to : links_[s.link].from;
    }
    std::ranges::reverse(taken);
    return taken;
  }

 private:
  const std::string& end_of(const Stride& s) const { return s.along ? links_[s.link].from : links_[s.link].to; }
  std::string root_of(std::string frame) {
    while (above_.try_emplace(frame, frame).first->second != frame) {
      std::string& next = above_[frame];
      next = above_[next];
      frame = next;
    }
    return frame;
  }
  const std::vector<Link>& links_;
  std::map<std::string, std::vector<Stride>> strides_;
  std::map<std::string, std::string> above_;  // towards the one that stands for all that are joined
};

std::string joined_by_comma(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

[[noreturn]] void refuse_loop(const Document& d, std::size_t closing, const Way& way, const Misfit& misfit) {
  const Link& link = d.frames[closing];
  std::vector<std::string> frames, places;
  for (const Stride& s : way) {
    places.push_back("/frames/" + std::to_string(s.link));
    frames.push_back(s.along ? d.frames[s.link].from : d.frames[s.link].to);
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
  Link link = d.frames[again];
  std::vector<Link> before{d.frames[first]};
  link.sigma.reset();
  before[0].sigma.reset();
  const Misfit misfit = misfit_of(before, link, {{0, true}});
  if (misfit.contradicts())
    throw Error(Exit::data, place(d, "/frames/" + std::to_string(again)),
                "\"" + link.to + "\" from \"" + link.from + "\" stands twice with different values (/frames/" +
                    std::to_string(first) + "): " + in_words(misfit),
                "keep one of the two");
}

}  // namespace

void check_frames(const Document& d) {
  Forest forest(d.frames);
  std::map<std::pair<std::string, std::string>, std::size_t> seen;
  for (std::size_t i = 0; i < d.frames.size(); ++i) {
    const Link& link = d.frames[i];
    if (link.to == link.from)
      throw Error(Exit::data, place(d, "/frames/" + std::to_string(i)),
                  "is a link from \"" + link.from + "\" to itself", "name two frames, or leave it out");
    const auto [earlier, first] = seen.try_emplace({link.to, link.from}, i);
    if (!first) check_twice(d, earlier->second, i);
    if (!forest.joined(link.to, link.from)) {
      forest.join(i);
      continue;
    }
    const Way way = forest.way(link.to, link.from);
    if (const Misfit misfit = misfit_of(d.frames, link, way); misfit.contradicts()) refuse_loop(d, i, way, misfit);
  }
}

}  // namespace gonio::manifest
