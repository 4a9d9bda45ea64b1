// Sealed cases: recordings with a base model that lacks something, made by code that is not the code that explains,
// and, apart from them, the truth.
//
// A world (world.h) simulates what an instrument records; make_case() leaves an effect out of what the manifest says,
// adds the noise of a real sensor, and keeps what it knows. Nothing of a truth enters the case's folder: names of cases
// are hashes, names within them are the same for all, and a truth is computed again when it is judged.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gonio::sealed {

using Numbers = std::vector<double>;

enum class Kind {
  null,        // nothing left out
  distractor,  // nothing that matters: dust, misstated noise, a constant that is slightly wrong
  single,
  pair,
  alike,      // an effect which in these recordings another one imitates
  invisible,  // an effect which in these recordings the free parameters swallow
  outside,    // an effect of no mechanism in the library
};
std::string_view kind_name(Kind kind);

// What to make. Equal specs give equal cases, to the byte.
struct Spec {
  std::string domain;
  Kind kind = Kind::null;
  std::vector<std::string> effects;  // names in World::effects()
  std::string variant;               // of the recording's design; empty: the usual one
  double multiple = 0;               // size of the effect in detection limits; 0: drawn from what occurs in practice
  std::uint64_t seed = 0;
  bool quick = false;  // belongs to the share that ten minutes suffice for
};
std::string case_id(const Spec& spec);  // says nothing about the case

struct TrueValue {
  std::string mechanism, parameter;
  double value = 0;
  bool exact = true;    // false: another equation; the number is the nearest equivalent, and its interval is not asked
  bool is_size = true;  // false: a place or a period, which says nothing of how strong the effect is
};

// Whether another mechanism could explain the same recordings, by the maker's own count: what the best rival leaves of
// the effect, over the noise. At least 5 standard deviations: yes; at most 3: no.
enum class Apart { yes, no, unclear };

struct Truth {
  Kind kind = Kind::null;
  std::vector<std::string> mechanisms;          // canonical ids
  std::vector<TrueValue> values;                // only where the declaration's number means what the maker's does
  std::vector<std::string> stages, conditions;  // any of them is right
  Apart apart = Apart::yes;
  double strength = 0;  // length of the effect after the fair refit, in noise widths
  double limit = 3.42;  // length that a test at 1 % with as many free numbers finds in 80 % of cases
  double share = 0;     // of it in the signal (relative scores), or of the score it makes (pixels); pairs: the weaker's
  double floor = 0;     // score of the true model: noise alone, in the domain's unit
  bool floor_known = false;
  std::string world;  // what was made, for a person
};

struct Observed {                // of one observation: its value as written, and the effect on it after the fair refit
  double value = 0, effect = 0;  // effect in noise widths
};
struct Case {
  std::string id;
  Spec spec;
  Truth truth;
  std::map<std::string, std::string> files;  // name -> bytes; recording.json is what explain is given
  std::vector<Observed> observed;
  std::map<std::string, std::vector<float>> pixels;  // images: id -> effect in noise widths, row by row
};

}  // namespace gonio::sealed
