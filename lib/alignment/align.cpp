// See align.h.
#include "alignment/align.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "alignment/symmetry.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::alignment {
namespace {

bool believed(const Fitted& f, const AlignWish& wish) {
  return f.explained >= wish.least_share && f.met >= wish.least_share && f.sigma_px <= wish.most_sigma_px;
}
// For choosing: what accounts for most.
double merit(const Fitted& f) {
  return f.explained * f.met / (0.5 + f.sigma_px);
}

// Sum of squares, bounded, of points at one standard deviation each, all starts measured alike.
double squares_of(const Setting& s, const RimCost& cost, double sigma_px) {
  const Stage judge{.reach_px = 10 * sigma_px + 2, .width_px = 3 * sigma_px};
  return cost.of(s, judge) / (sigma_px * sigma_px);
}

std::vector<std::size_t> lamps_of(const Question& q) {
  std::vector<std::size_t> lamps;
  for (const Sighting& s : q.sightings)
    if (s.subject.lamp && std::find(lamps.begin(), lamps.end(), *s.subject.lamp) == lamps.end())
      lamps.push_back(*s.subject.lamp);
  return lamps;
}
bool is_free(const Question& q, Block block, std::size_t which) {
  return std::any_of(q.freedoms.begin(), q.freedoms.end(),
                     [&](const Freedom& f) { return f.block == block && f.which == which; });
}

// All of it, from a start whose body is nearly right: lamps that are not, are searched.
Fitted finish(const Setting& start, const Question& q, const AlignWish& wish, bool search_lamps, double from_px) {
  Setting setting = start;
  if (search_lamps)
    for (const std::size_t lamp : lamps_of(q))
      if (is_free(q, Block::lamp_shift, lamp)) {
        const auto places = search_lamp(setting, q, lamp, wish.search);
        if (!places.empty()) setting = places.front().setting;
      }
  return fit_rims(setting, q, stages_from(from_px));
}

// Nothing else fits better, or: this does.
std::optional<Setting> find_rivals(const Question& q, std::size_t body, const std::vector<Fitted>& others, Aligned& a) {
  const Fitted& f = a.fitted;
  a.rivals.clear(), a.symmetries.clear();
  const RimCost cost(q);
  const double sigma = std::max(f.sigma_px, 0.02), best = squares_of(f.setting, cost, sigma);
  const double same = std::max(1.0, f.correlation_px);
  std::optional<Setting> better;
  double least = -4;
  const auto consider = [&](const Setting& setting) -> double {
    const Fitted other =
        fit_rims(setting, q,
                 {{.reach_px = 8, .width_px = 1.5, .both_ways = true, .every = 2, .most_steps = 12, .small_fall = 1e-4},
                  {.reach_px = 5, .most_steps = 12, .small_fall = 1e-6}});
    const double turn =
        norm(rotation_vector_of(normalized(other.setting.bodies[body].world_from_object.rotation *
                                           conjugate(f.setting.bodies[body].world_from_object.rotation))));
    if (turn < 0.02) return HUGE_VAL;  // the same one
    const double worse = (squares_of(other.setting, cost, sigma) - best) / same;
    if (worse < least) least = worse, better = other.setting;
    if (worse < 9) a.rivals.push_back({other.setting, worse, other.rms_px, other.explained});
    return worse;
  };
  for (const Fitted& other : others)
    if (merit(other) > 0.7 * merit(f)) consider(other.setting);
  std::vector<std::pair<Vec3, std::vector<double>>> about;  // axes, and by how much a turn looks alike
  for (const Turned& turned : turned_alike(f, q, body)) {
    if (!(consider(turned.setting) < 9)) continue;
    if (about.empty() || !(about.back().first == turned.axis)) about.push_back({turned.axis, {}});
    about.back().second.push_back(turned.angle_rad * 180 / pi);
  }
  for (const auto& [axis, angles] : about) {
    std::string by;
    if (angles.size() >= 6) {
      by = "any angle";
    } else {
      for (const double angle : angles) by += (by.empty() ? "" : ", ") + format("%.0f", angle);
      by += " degrees";
    }
    a.symmetries.push_back("turning about " + axis_words(axis) + " of the mesh by " + by);
  }
  return better;
}

// The same with the body's mesh reflected: does that explain what the body does not?
bool mirrored(const Setting& stated, const Question& q, std::size_t body, const AlignWish& wish) {
  const Shape& shape = *stated.bodies[body].shape;
  std::vector<Vec3> positions = shape.positions_m();
  const double middle = shape.centre_m().x;
  for (Vec3& p : positions) p.x = 2 * middle - p.x;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t t = 0; t < shape.triangles(); ++t) {
    const auto& c = shape.triangle(t);
    triangles.push_back({c[0], c[2], c[1]});
  }
  const Shape reflected(std::move(positions), triangles);
  Setting other = stated;
  other.bodies[body].shape = &reflected;
  AlignWish quick = wish;
  for (const Start& start : search_body(other, q, body, quick.search))
    if (believed(finish(start.setting, q, wish, true, 12), wish)) return true;
  return false;
}

std::string why_lost(const Fitted& f, const AlignWish& wish) {
  if (f.met < wish.least_share)
    return format("only %.0f %% of the rims' points have the model's rim beside them (limit %.0f %%)", 100 * f.met,
                  100 * wish.least_share);
  if (f.explained < wish.least_share)
    return format("only %.0f %% of the model's rims were seen (limit %.0f %%)", 100 * f.explained,
                  100 * wish.least_share);
  return format("points lie %.2f px off the rims (limit %.2f px): another shape, or another size", f.sigma_px,
                wish.most_sigma_px);
}

}  // namespace

std::string word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::found: return "found";
    case Verdict::ambiguous: return "ambiguous";
    case Verdict::mirrored: return "mirrored";
    default: return "lost";
  }
}

Aligned align(const Setting& stated, const Question& question, std::size_t body, const AlignWish& wish) {
  std::vector<Fitted> tried;
  const auto better = [](const Fitted& a, const Fitted& b) { return merit(a) > merit(b); };
  if (wish.from != AlignWish::From::nothing) {
    try {
      tried.push_back(finish(stated, question, wish, false, wish.reach_px));
      if (!believed(tried.front(), wish) && !wish.lamps_known)
        tried.push_back(finish(tried.front().setting, question, wish, true, wish.reach_px));
    } catch (const Error&) {
      if (wish.from == AlignWish::From::stated) throw;
    }
    std::sort(tried.begin(), tried.end(), better);
  }
  const bool search = wish.from == AlignWish::From::nothing ||
                      (wish.from == AlignWish::From::either && (tried.empty() || !believed(tried.front(), wish)));
  if (search) {
    const std::vector<Start> starts = search_body(stated, question, body, wish.search);
    for (std::size_t i = 0; i < std::min<std::size_t>(starts.size(), 4); ++i) {
      if (i > 0 && starts[i].cost > 3 * starts[0].cost && believed(tried.front(), wish)) break;
      tried.push_back(finish(starts[i].setting, question, wish, !wish.lamps_known, 12));
      std::sort(tried.begin(), tried.end(), better);
    }
  }
  if (tried.empty())
    throw Error(Exit::data, "start", "leads nowhere: the object is behind the camera or above its lamp");
  Aligned a;
  a.fitted = std::move(tried.front());
  tried.erase(tried.begin());
  if (!believed(a.fitted, wish)) {
    a.why = why_lost(a.fitted, wish);
    if (mirrored(stated, question, body, wish)) {
      a.verdict = Verdict::mirrored;
      a.why = "the mesh's mirror image fits, and the mesh does not";
    }
    return a;
  }
  a.verdict = Verdict::found;
  // A body that is nearly alike from several sides has many ends, of which the search need not have met the best.
  for (int round = 0; round < 3; ++round) {
    const auto next = find_rivals(question, body, tried, a);
    if (!next) break;
    a.fitted = fit_rims(*next, question, stages_from(8));
  }
  a.open = open_directions(a.fitted, question, body, wish.open_share);
  if (!a.rivals.empty()) {
    a.verdict = Verdict::ambiguous;
    a.why = a.symmetries.empty() ? format("%zu other poses fit as well", a.rivals.size())
                                 : a.symmetries.front() + " looks alike";
  } else if (!a.open.empty()) {
    a.verdict = Verdict::ambiguous;
    a.why = "no rim holds " + a.open.front();
  }
  return a;
}

}  // namespace gonio::alignment
