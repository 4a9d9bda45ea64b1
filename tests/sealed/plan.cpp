// What is made: of every world nulls, distractors, single effects of the size met in practice and near the detection
// limit, pairs, what cannot be told apart, what cannot be seen, and what no library has.
#include <algorithm>
#include <map>

#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

// Counts: nulls, distractors, singles (of each effect), pairs, specials (of each), effects outside the library (of
// each); in all, and in the ten minutes. Pictures take half a minute of a processor each, stacks and robots some
// seconds, tables less than half a second.
const std::vector<WorldEntry> entries{
    {"boards",
     boards_world,
     {{Kind::alike, {"fisheye"}, ""},
      {Kind::alike, {"bent board"}, "frontal"},
      {Kind::null, {}, "three colours"},
      {Kind::single, {"coloured lens"}, "three colours"},
      {Kind::pair, {"coloured lens", "radial"}, "three colours"},
      {Kind::null, {}, "two ranges"},
      {Kind::single, {"moving pupil"}, "two ranges"},
      {Kind::null, {}, "turned pictures"},
      {Kind::single, {"other pixel centre"}, "turned pictures"},
      {Kind::null, {}, "warm-up"},
      {Kind::single, {"cold start"}, "warm-up"}},
     {16, 8, 6, 12, 4, 5},
     {5, 3, 2, 4, 2, 2}},
    {"exposures", exposures_world, {{Kind::invisible, {"glare"}, ""}}, {10, 6, 5, 8, 3, 4}, {4, 2, 2, 3, 1, 2}},
    {"photometric", photometric_world, {{Kind::invisible, {"vignetting"}, ""}}, {8, 4, 4, 6, 3, 3}, {2, 1, 2, 2, 1, 1}},
    {"robot",
     robot_world,
     {{Kind::null, {}, "in motion", 3, 1}, {Kind::single, {"late poses"}, "in motion"}},
     {10, 4, 4, 6, 4, 3},
     {3, 1, 2, 3, 1, 1}},
    {"images",
     images_world,
     {{Kind::single, {"light between surfaces"}, "direct light only", 3, 1},
      {Kind::invisible, {"lamp with a size"}, "table alone", 2, 0},
      {Kind::null, {}, "varnished", 2, 0},
      {Kind::single, {"polarized lamps"}, "varnished", 3, 1},
      {Kind::single, {"brushed table"}, "varnished", 3, 1}},
     {6, 3, 2, 6, 2, 2},
     {1, 1, 1, 1, 0, 0, 4}},
    {"sensor",
     sensor_world,
     {{Kind::alike, {"black offset"}, "one exposure"},
      {Kind::alike, {"slow shutter"}, "exposures in order"},
      {Kind::invisible, {"black offset"}, "one exposure, unknown patches"},
      {Kind::single, {"ambient light"}, "known patches"}},
     {20, 12, 10, 12, 6, 6},
     {10, 6, 4, 8, 4, 4}},
    {"expression",
     expression_world,
     {{Kind::invisible, {"inverse square"}, "distance stands still"}},
     {20, 10, 8, 12, 3, 6},
     {10, 5, 4, 8, 2, 4}},
    {"surface",
     surface_world,
     {{Kind::alike, {"rough matte"}, "normal incidence"}},
     {14, 8, 8, 8, 4, 4},
     {7, 3, 4, 6, 2, 4}},
    {"gloss",
     gloss_world,
     {{Kind::null, {}, "bands", 4, 2},
      {Kind::single, {"iridescent film"}, "bands", 6, 3},
      {Kind::null, {}, "two lamps", 4, 2},
      {Kind::single, {"dye"}, "two lamps", 6, 3}},
     {8, 4, 8, 6, 4, 5},
     {4, 2, 4, 3, 2, 3}},
    {"heights", heights_world, {}, {10, 0, 6, 4, 0, 5}, {4, 0, 3, 2, 0, 2}},
    {"light",
     light_world,
     {{Kind::single, {"diverging light"}, "believed parallel"}},
     {16, 8, 8, 8, 4, 5},
     {8, 4, 4, 6, 2, 4}},
    {"volumes",
     tomograph_world,
     {{Kind::alike, {"threshold"}, "ball", 3, 1},
      {Kind::alike, {"scale"}, "ball", 3, 1},
      {Kind::null, {}, "ball", 2, 1},
      {Kind::null, {}, "thin", 4, 1},
      {Kind::single, {"threshold"}, "thin", 3, 1},
      {Kind::single, {"blur"}, "thin", 3, 1},
      {Kind::null, {}, "markers", 4, 1},
      {Kind::single, {"streaks"}, "markers", 4, 1}},
     {10, 3, 4, 6, 3, 3},
     {3, 1, 1, 2, 1, 1}},
    {"volume", volume_world, {}, {16, 8, 8, 8, 0, 5}, {8, 4, 4, 5, 0, 4}},
    {"tracks", tracks_world, {}, {14, 6, 8, 5, 0, 5}, {7, 3, 5, 3, 0, 4}},
    {"markers",
     markers_world,
     {{Kind::alike, {"glue"}, "ball"},
      {Kind::alike, {"wrong voxels"}, "ball"},
      {Kind::invisible, {"moved lid"}, "free lid"},
      {Kind::null, {}, "free lid"},
      {Kind::null, {}, "resting lid"},
      {Kind::single, {"sunk lid"}, "resting lid"}},
     {14, 8, 8, 6, 4, 4},
     {3, 2, 2, 2, 1, 1}},
    {"prints",
     prints_world,
     {{Kind::single, {"lamp"}, "no law", 3, 0},
      {Kind::null, {}, "two prints", 3, 0},
      {Kind::single, {"ground"}, "two prints", 5, 0},
      {Kind::pair, {"ground", "pressed membrane"}, "two prints", 2, 0}},
     {8, 3, 4, 4, 2, 3},
     {2, 0, 1, 0, 0, 0, 2}},
    {"polarization",
     polarization_world,
     {{Kind::alike, {"leaky polarizers"}, "even light", 4, 1},
      {Kind::alike, {"crosstalk"}, "even light", 4, 1},
      {Kind::alike, {"turned screen"}, "screen alone"}},
     {10, 4, 4, 6, 3, 3},
     {2, 1, 1, 2, 0, 1, 2}},
    {"polarimeter", polarimeter_world, {}, {14, 6, 8, 8, 0, 5}, {7, 3, 4, 5, 0, 4}}};

// Sizes in detection limits, in turn: 0 draws what occurs in practice.
constexpr double multiples[] = {0, 4, 0, 8, 0, 0};

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
      const bool hurried = !outside && place++ % entry_.quick.every == 0;
      const int most = outside ? entry_.whole.outside : entry_.whole.singles, few = outside   ? entry_.quick.outside
                                                                                    : hurried ? entry_.quick.singles
                                                                                              : 0;
      for (int k = 0; k < most; ++k)
        add(outside ? Kind::outside : Kind::single, {name}, "", outside ? 0 : multiples[k % 6], k < few);
    }
    for (const Special& s : entry_.specials) {
      const int most = s.whole < 0 ? entry_.whole.specials : s.whole,
                few = s.quick < 0 ? entry_.quick.specials : s.quick;
      for (int k = 0; k < most; ++k)
        add(s.kind, s.effects, s.variant, s.kind == Kind::single ? multiples[k % 6] : 0, k < few);
    }
    for (int k = 0; k < entry_.whole.pairs; ++k) add(Kind::pair, pair(), "", 0, k < entry_.quick.pairs);
    return std::move(specs_);
  }

 private:
  static std::uint64_t hash_of(const std::string& text) {
    std::uint64_t hash = 1;
    for (const char c : text) hash = split_mix(hash ^ static_cast<unsigned char>(c));
    return hash;
  }
  // The seed depends on what the case is, not on what else is made.
  void add(Kind kind, std::vector<std::string> effects, const std::string& variant, double multiple, bool quick) {
    std::string what = entry_.domain + "/" + variant + "/" + std::string(kind_name(kind));
    for (const std::string& e : effects) what += "/" + e;
    const std::uint64_t seed = hash_of(what + "/" + std::to_string(made_[what]++));
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
  std::map<std::string, int> made_;
  std::vector<Spec> specs_;
};

}  // namespace

std::span<const WorldEntry> all_worlds() {
  return entries;
}

std::unique_ptr<World> make_world(const std::string& domain) {
  for (const WorldEntry& entry : entries)
    if (entry.domain == domain) return entry.make();
  return nullptr;
}

std::vector<Spec> all_specs() {
  std::vector<Spec> specs;
  for (const WorldEntry& entry : entries)
    for (Spec& spec : Planner(entry).specs()) specs.push_back(std::move(spec));
  std::sort(specs.begin(), specs.end(), [](const Spec& a, const Spec& b) { return case_id(a) < case_id(b); });
  return specs;
}

}  // namespace gonio::sealed
