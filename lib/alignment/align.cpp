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
// Lamps whose shadows this fit does not account for, be all else well: among many rims a few hardly count.
std::vector<std::size_t> unmet_lamps(const Fitted& f, const Question& q, const AlignWish& wish) {
  std::vector<std::size_t> unmet;
  for (const std::size_t lamp : lamps_of(q)) {
    double points = 0, met = 0, explained = 0;
    for (std::size_t i = 0; i < q.sightings.size(); ++i) {
      if (q.sightings[i].subject.lamp != lamp) continue;
      const auto n = static_cast<double>(q.sightings[i].points.size());
      points += n, met += n * f.sightings[i].met, explained += n * f.sightings[i].explained;
    }
    if (std::min(met, explained) < wish.least_share * points) unmet.push_back(lamp);
  }
  return unmet;
}
bool is_free(const Question& q, Block block, std::size_t which) {
  return std::any_of(q.freedoms.begin(), q.freedoms.end(),
                     [&](const Freedom& f) { return f.block == block && f.which == which; });
}

// A fit and the way to it.
struct End {
  Fitted fitted;
  Tried tried;
};

End fitted_from(const Setting& setting, const Question& q, const AlignWish& wish, double from_px, Tried tried) {
  FitPath path{.reach_px = std::max(60.0, wish.reach_px), .rms_px = std::move(tried.rms_px)};
  End end{fit_rims(setting, q, stages_from(from_px), wish.record ? &path : nullptr), std::move(tried)};
  end.tried.rms_px = std::move(path.rms_px), end.tried.explained = end.fitted.explained;
  return end;
}

// All of it, from a start whose body is nearly right: lamps that are not, are searched.
End finish(const Setting& start, const Question& q, const AlignWish& wish, const std::vector<std::size_t>& search_lamps,
           double from_px, Tried tried) {
  Setting setting = start;
  for (const std::size_t lamp : search_lamps)
    if (is_free(q, Block::lamp_shift, lamp)) {
      const auto places = search_lamp(setting, q, lamp, wish.search);
      if (!places.empty()) setting = places.front().setting;
    }
  return fitted_from(setting, q, wish, from_px, std::move(tried));
}

// Nothing else fits better, or: this does.
std::optional<Setting> find_rivals(const Question& q, std::size_t body, const std::vector<End>& others, Aligned& a) {
  const Fitted& f = a.fitted;
  a.rivals.clear(), a.symmetries.clear(), a.any_turn.clear();
  const RimCost cost(q);
  const double sigma = std::max(f.sigma_px, 0.02), best = squares_of(f.setting, cost, sigma);
  const double same = std::max(1.0, f.correlation_px);
  std::optional<Setting> better;
  double least = -4;
  struct Considered {
    double worse = HUGE_VAL;
    Vec3 turn;  // from the found pose, mesh frame
  };
  const auto consider = [&](const Setting& setting) -> Considered {
    const Fitted other =
        fit_rims(setting, q,
                 stages_from(0));  // as the found one was fitted: rims err unequally, and other weights end elsewhere
    const Vec3 turn = rotation_vector_of(normalized(conjugate(f.setting.bodies[body].world_from_object.rotation) *
                                                    other.setting.bodies[body].world_from_object.rotation));
    if (norm(turn) < 0.02) return {};  // the same one
    const double worse = (squares_of(other.setting, cost, sigma) - best) / same;
    if (worse < least) least = worse, better = other.setting;
    if (worse < 9) a.rivals.push_back({other.setting, worse, other.rms_px, other.explained});
    return {worse, turn};
  };
  for (const End& other : others)
    if (merit(other.fitted) > 0.7 * merit(f)) consider(other.fitted.setting);
  std::vector<std::pair<Vec3, std::vector<double>>> about;  // axes, and by how much a turn looks alike
  for (const Turned& turned : turned_alike(f, q, body)) {
    const Considered other = consider(turned.setting);
    if (!(other.worse < 9)) continue;
    // One that went back and ended turned about another axis says nothing of this one.
    if (norm(cross(other.turn, turned.axis)) > 0.1 * norm(other.turn)) continue;
    if (about.empty() || !(about.back().first == turned.axis)) about.push_back({turned.axis, {}});
    about.back().second.push_back(turned.angle_rad * 180 / pi);
  }
  for (const auto& [axis, angles] : about) {
    std::string by;
    if (angles.size() >= 6) {
      by = "any angle";
      a.any_turn.push_back(axis);
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
  quick.record = false;
  for (const Start& start : search_body(other, q, body, quick.search))
    if (believed(finish(start.setting, q, quick, lamps_of(q), 12, {}).fitted, wish)) return true;
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

namespace {

void sort_best_first(std::vector<End>& ends) {
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return merit(a.fitted) > merit(b.fitted); });
}

// From where the body is stated; where that leads nowhere, lamps are searched as well. None: there is no rim.
std::vector<End> ends_of_stated(const Setting& stated, const Question& q, const AlignWish& wish) {
  std::vector<End> ends;
  try {
    ends.push_back(finish(stated, q, wish, {}, wish.reach_px, {.from = "as stated"}));
    const std::vector<std::size_t> lamps =
        believed(ends.front().fitted, wish) ? unmet_lamps(ends.front().fitted, q, wish) : lamps_of(q);
    if (!wish.lamps_known && (!lamps.empty() || !believed(ends.front().fitted, wish))) {
      Tried on = ends.front().tried;
      on.from = "as stated, then lamps searched";
      ends.push_back(finish(ends.front().fitted.setting, q, wish, lamps, wish.reach_px, std::move(on)));
    }
  } catch (const Error&) {
    if (wish.from == AlignWish::From::stated) throw;
  }
  sort_best_first(ends);
  return ends;
}

// Adds ends of a search from nothing; `left`: starts that were left before all of it was fitted.
void add_searched(const Setting& stated, const Question& q, std::size_t body, const AlignWish& wish,
                  std::vector<End>& ends, std::vector<Tried>& left) {
  SearchWish search = wish.search;
  search.record = wish.record;
  const std::vector<Start> starts = search_body(stated, q, body, search);
  const std::vector<std::size_t> none;
  bool enough = false;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const auto& paths = starts[i].paths;
    Tried tried{.from = format("searched, %zu", i + 1), .rms_px = paths.empty() ? std::vector<double>{} : paths[0]};
    for (std::size_t k = 1; k < paths.size(); ++k)
      left.push_back({.fate = Tried::Fate::same_end, .from = tried.from + ", by another way", .rms_px = paths[k]});
    enough = enough || i >= 4 || (i > 0 && starts[i].cost > 3 * starts[0].cost && believed(ends.front().fitted, wish));
    if (enough) {
      tried.fate = Tried::Fate::left;
      if (wish.record) left.push_back(std::move(tried));
      continue;
    }
    ends.push_back(finish(starts[i].setting, q, wish, wish.lamps_known ? none : lamps_of(q), 12, std::move(tried)));
    sort_best_first(ends);
  }
}

// What is left to say of a fit that is believed.
void judge(const Question& question, std::size_t body, const AlignWish& wish, const std::vector<End>& others,
           Aligned& a) {
  // A body that is nearly alike from several sides has many ends, of which the search need not have met the best.
  for (int round = 0; round < 3; ++round) {
    const auto next = find_rivals(question, body, others, a);
    if (!next) break;
    End better = fitted_from(*next, question, wish, 8, {.from = "beside the one before"});
    a.fitted = std::move(better.fitted);
    a.tried.push_back(std::move(better.tried));
  }
  judge_open(question, body, wish, a);
}

}  // namespace

void judge_open(const Question& question, std::size_t body, const AlignWish& wish, Aligned& a) {
  a.open = open_directions(a.fitted, question, body, wish.open_share);
  a.verdict = a.rivals.empty() && a.open.empty() ? Verdict::found : Verdict::ambiguous;
  a.why.clear();
  if (!a.rivals.empty())
    a.why = a.symmetries.empty() ? format("%zu other poses fit as well", a.rivals.size())
                                 : a.symmetries.front() + " looks alike";
  else if (!a.open.empty())
    a.why = "no rim holds " + a.open.front();
}

Aligned align(const Setting& stated, const Question& question, std::size_t body, const AlignWish& wish) {
  std::vector<End> ends;
  Aligned a;
  if (wish.from != AlignWish::From::nothing) ends = ends_of_stated(stated, question, wish);
  if (wish.from == AlignWish::From::nothing ||
      (wish.from == AlignWish::From::either && (ends.empty() || !believed(ends.front().fitted, wish))))
    add_searched(stated, question, body, wish, ends, a.tried);
  if (ends.empty())
    throw Error(Exit::data, "start", "leads nowhere: the object is behind the camera or above its lamp");
  a.fitted = std::move(ends.front().fitted);
  for (std::size_t i = ends.size(); i-- > 0;) a.tried.push_back(std::move(ends[i].tried));
  ends.erase(ends.begin());
  if (believed(a.fitted, wish)) {
    judge(question, body, wish, ends, a);
  } else {
    a.why = why_lost(a.fitted, wish);
    if (mirrored(stated, question, body, wish)) {
      a.verdict = Verdict::mirrored;
      a.why = "the mesh's mirror image fits, and the mesh does not";
    }
  }
  a.tried.back().fate = Tried::Fate::taken;
  return a;
}

}  // namespace gonio::alignment
