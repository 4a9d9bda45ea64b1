// What is made: of every world nulls, distractors, single effects of the size met in practice and near the detection
// limit, pairs, what cannot be told apart, what cannot be seen, and what no library has.
#include <algorithm>
#include <map>

#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

const std::vector<WorldEntry>& entries() {
  static const std::vector<WorldEntry> list{
      {"boards",
       boards_world,
       {{Kind::alike, {"fisheye"}, ""}, {Kind::alike, {"bent board"}, "frontal"}},
       {.nulls = 16, .distractors = 8, .singles = 6, .pairs = 10, .specials = 4, .outside = 5},
       {.nulls = 4, .distractors = 2, .singles = 1, .pairs = 2, .specials = 1, .outside = 1}},
      {"exposures",
       exposures_world,
       {{Kind::invisible, {"glare"}, "usual"}},
       {.nulls = 6, .distractors = 3, .singles = 3, .pairs = 3, .specials = 2, .outside = 3},
       {.nulls = 2, .distractors = 1, .singles = 1, .pairs = 1, .specials = 1, .outside = 1}},
      {"photometric",
       photometric_world,
       {{Kind::invisible, {"vignetting"}, "usual"}},
       {.nulls = 6, .distractors = 3, .singles = 3, .pairs = 2, .specials = 2, .outside = 0},
       {.nulls = 2, .distractors = 1, .singles = 1, .pairs = 0, .specials = 1, .outside = 0}},
      {"robot",
       robot_world,
       {},
       {.nulls = 8, .distractors = 4, .singles = 3, .pairs = 3, .specials = 0, .outside = 2},
       {.nulls = 2, .distractors = 1, .singles = 1, .pairs = 0, .specials = 0, .outside = 1}},
      {"images",
       images_world,
       {{Kind::single, {"light between surfaces"}, "direct light only"},
        {Kind::invisible, {"lamp with a size"}, "table alone"}},
       {.nulls = 6, .distractors = 3, .singles = 2, .pairs = 6, .specials = 2, .outside = 2},
       {.nulls = 2, .distractors = 1, .singles = 1, .pairs = 0, .specials = 1, .outside = 0, .every = 4}},
      {"sensor",
       sensor_world,
       {{Kind::alike, {"black offset"}, "one exposure"},
        {Kind::alike, {"slow shutter"}, "exposures in order"},
        {Kind::invisible, {"black offset"}, "one exposure, unknown patches"},
        {Kind::single, {"ambient light"}, "known patches"}},
       {.nulls = 16, .distractors = 10, .singles = 6, .pairs = 8, .specials = 4, .outside = 5},
       {.nulls = 5, .distractors = 3, .singles = 3, .pairs = 4, .specials = 2, .outside = 2}},
      {"expression",
       expression_world,
       {{Kind::invisible, {"inverse square"}, "distance stands still"}},
       {.nulls = 14, .distractors = 8, .singles = 5, .pairs = 8, .specials = 3, .outside = 5},
       {.nulls = 5, .distractors = 3, .singles = 2, .pairs = 4, .specials = 1, .outside = 2}},
      {"surface",
       surface_world,
       {{Kind::alike, {"rough matte"}, "normal incidence"}},
       {.nulls = 12, .distractors = 6, .singles = 5, .pairs = 5, .specials = 3, .outside = 4},
       {.nulls = 4, .distractors = 2, .singles = 2, .pairs = 2, .specials = 1, .outside = 2}},
      {"light",
       light_world,
       {{Kind::single, {"diverging light"}, "believed parallel"}},
       {.nulls = 12, .distractors = 6, .singles = 5, .pairs = 6, .specials = 3, .outside = 4},
       {.nulls = 4, .distractors = 2, .singles = 2, .pairs = 3, .specials = 1, .outside = 2}},
      {"volume",
       volume_world,
       {},
       {.nulls = 12, .distractors = 6, .singles = 5, .pairs = 5, .specials = 0, .outside = 3},
       {.nulls = 4, .distractors = 2, .singles = 2, .pairs = 2, .specials = 0, .outside = 1}},
      {"tracks",
       tracks_world,
       {},
       {.nulls = 10, .distractors = 4, .singles = 5, .pairs = 3, .specials = 0, .outside = 4},
       {.nulls = 3, .distractors = 1, .singles = 2, .pairs = 1, .specials = 0, .outside = 1}}};
  return list;
}

// Sizes in detection limits, in turn: 0 draws what occurs in practice.
constexpr double multiples[] = {0, 0, 4, 0, 8, 0};

class Planner {
 public:
  explicit Planner(const WorldEntry& entry) : entry_(entry), random_(0x706c616eu, hash_of(entry.domain)) {
    for (const EffectKind& kind : entry.make()->effects()) kinds_[kind.name] = kind;
  }
  std::vector<Spec> specs() {
    for (int k = 0; k < entry_.whole.nulls; ++k) add(Kind::null, {}, "", 0, k < entry_.quick.nulls);
    for (int k = 0; k < entry_.whole.distractors; ++k) add(Kind::distractor, {}, "", 0, k < entry_.quick.distractors);
    std::size_t place = 0;
    for (const auto& [name, kind] : kinds_) {
      if (!kind.variant.empty()) continue;
      const bool outside = kind.id.empty();
      const int most = outside ? entry_.whole.outside : entry_.whole.singles, few = outside ? entry_.quick.outside
                                                                                    : place++ % entry_.quick.every == 0
                                                                                        ? entry_.quick.singles
                                                                                        : 0;
      for (int k = 0; k < most; ++k)
        add(outside ? Kind::outside : Kind::single, {name}, "", outside ? 0 : multiples[k % 6], k < few);
    }
    for (const Special& s : entry_.specials)
      for (int k = 0; k < entry_.whole.specials; ++k) add(s.kind, s.effects, s.variant, 0, k < entry_.quick.specials);
    for (int k = 0; k < entry_.whole.pairs; ++k) add(Kind::pair, pair(), "", 0, k < entry_.quick.pairs);
    return std::move(specs_);
  }

 private:
  static std::uint64_t hash_of(const std::string& text) {
    std::uint64_t hash = 1;
    for (const char c : text) hash = split_mix(hash ^ static_cast<unsigned char>(c));
    return hash;
  }
  void add(Kind kind, std::vector<std::string> effects, const std::string& variant, double multiple, bool quick) {
    const std::uint64_t seed = hash_of(entry_.domain) + specs_.size();
    specs_.push_back({entry_.domain, kind, std::move(effects), variant, multiple, seed, quick});
  }
  std::vector<std::string> pair() {
    std::vector<const EffectKind*> usual;
    for (const auto& [name, kind] : kinds_)
      if (kind.variant.empty() && !kind.id.empty()) usual.push_back(&kind);
    if (usual.size() < 2) return {};
    for (;;) {
      const EffectKind* a = usual[random_.below(static_cast<std::uint32_t>(usual.size()))];
      const EffectKind* b = usual[random_.below(static_cast<std::uint32_t>(usual.size()))];
      if (a->id < b->id) return {a->name, b->name};
    }
  }
  const WorldEntry& entry_;
  Random random_;
  std::map<std::string, EffectKind> kinds_;
  std::vector<Spec> specs_;
};

}  // namespace

std::span<const WorldEntry> all_worlds() {
  return entries();
}

std::unique_ptr<World> make_world(const std::string& domain) {
  for (const WorldEntry& entry : entries())
    if (entry.domain == domain) return entry.make();
  return nullptr;
}

std::vector<Spec> all_specs() {
  std::vector<Spec> specs;
  for (const WorldEntry& entry : entries())
    for (Spec& spec : Planner(entry).specs()) specs.push_back(std::move(spec));
  std::sort(specs.begin(), specs.end(), [](const Spec& a, const Spec& b) { return case_id(a) < case_id(b); });
  return specs;
}

}  // namespace gonio::sealed
