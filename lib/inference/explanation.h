// What the engine found: numbers for the manifest's "explanations", for the report page and for the domain's upgrade of
// the scene. Filled by explain(); read by everybody else.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "inference/outliers.h"
#include "inference/problem.h"
#include "manifest/value.h"

namespace gonio::inference {

// null: no mismatch beyond noise, or none that matters. named: one set of mechanisms repairs it. ambiguous: several do,
// equally. unknown: there is a mismatch that matters and nothing in the library repairs it.
enum class Verdict { null, named, ambiguous, unknown };
std::string verdict_name(Verdict verdict);

struct Estimate {
  std::size_t parameter = 0;  // place in Problem::parameters
  double value = 0, sigma = 0;
  double lower_95 = 0, upper_95 = 0;
  bool at_bound = false;
};

// One hypothesis in the race: candidates switched on together, or a negative control, or a free curve over one
// condition
// ("unknown").
struct Hypothesis {
  enum class Kind { base, mechanisms, negative_control, free_curve };
  Kind kind = Kind::mechanisms;
  std::string name;
  std::vector<std::size_t> candidates;  // negative control: the one whose freedom it has
  double held_out = 0;                  // score on held-out groups, in the user's unit
  double gain = 0, gain_sigma = 0;  // fall of the held-out mean square in noise units against the model it extends, and
                                    // the standard error of that over groups
  double effect = 0;                // what --smallest-effect is held against
  double wald_p = 1;                // of "all its parameters are neutral"
  std::vector<Estimate> parameters;
  std::string refused;  // why it cannot be named; empty: it can
};

struct Isolability {
  std::size_t candidate = 0;
  double surviving_share = 0;           // of the signature's length, after free parameters are projected out
  std::vector<double> detection_limit;  // per parameter, the others at neutral: amplitude seen with 80 % power at the
                                        // test's level
  // The same whatever the mechanism's other numbers do: the most that this one can be in an effect that stays unseen. A
  // board stretched along one axis shows where the same stretch of both hides in the focal length.
  std::vector<double> limit_with_others;
  std::vector<std::pair<std::size_t, double>>
      look_alikes;      // other candidates with |cos| > 0.9 between the projected signatures
  bool visible = true;  // false: "these recordings cannot show it"
};

// Residuals against one condition in bins of equal counts: the mean along the condition's direction, in `value_unit`,
// and its standard error (over blocks).
struct Curve {
  std::string condition, unit, value_unit;
  std::vector<double> centre, before, after, sigma;  // after: empty where nobody knows it
};
struct LocatedCondition {
  std::string name, unit, stage;
  double share = 0;      // of the excess over noise that a smooth curve over this condition explains
  double of_effect = 0;  // of what the named mechanisms do, beyond one level, the share that steps over it describe
  double lower = 0, upper = 0;  // range that holds most of it
  double effect = 0;            // rms of the curve over that range, in `curve.value_unit`
  double period = 0;            // of a wave with a phase of its own in each group; 0: one smooth curve
  Curve curve;
};
struct LocatedGroup {
  std::string name;
  double share = 0;              // of the excess
  double before = 0, after = 0;  // score in the user's unit
};

struct Compensation {  // a free parameter that the missing physics had bent
  std::size_t parameter = 0;
  double before = 0, after = 0, sigma = 0;
  // What an independent calibration says of it, where the manifest has one (its sigma where that is stated), and
  // whether the parameter moved towards it.
  std::optional<double> calibrated{}, calibrated_sigma{};
  bool towards = false;
};

// Structure that no mechanism repairs, as a law: residual = direction * sum over terms of
// coefficient * product of condition^power * shape. Every coefficient has the unit that makes its term one of the
// residual over its direction.
struct LawTerm {
  double coefficient = 0, sigma = 0;
  std::string unit;                                    // of the coefficient
  std::vector<std::pair<std::string, double>> powers;  // condition -> power
  struct Reference {
    double value = 1;
    std::string unit{};  // empty: none, a plain number
  };
  std::vector<Reference> reference{};  // round size of each of these conditions, for words alone
  // A dimensionless function of shape_of / scale: "exp" (of minus that), "sin", "cos" (scale 1: of an angle).
  std::string shape{}, shape_of{}, scale_unit{};
  double scale = 1, scale_sigma = 0;
  std::string along{};  // condition whose direction the term has
};
struct Outside {
  std::string condition{}, stage{};                // that carries it most
  std::vector<LawTerm> terms{};                    // empty: none extrapolates
  std::string law{};                               // in words: "residual = 0.31 m^-1 * light.distance * prediction"
  double held_out_before = 0, held_out_after = 0;  // user's unit: the range that the fit never saw
  std::string extrapolated{};                      // "light.distance beyond 0.8 m"
  double share = 0;                                // of the excess over noise that the law takes away
  Curve curve{};                  // over `condition`: the mean residual before and after the law is taken away
  double split = 0;               // the law was fitted on one side of this value of `condition` and judged on the other
  std::vector<double> per_row{};  // what the law says of every row, in the residual's unit; empty without terms
};

// Recordings that are not what the document takes them for: the file of `group` fits what `shows` should show. `own`,
// `other`: its errors against the two predictions, 0 .. 1. Where there are any no physics is asked.
struct Misplaced {
  struct File {
    std::string group, shows;
    double own = 0, other = 0;
  };
  std::vector<File> files;
  std::string sentence;
};

struct PlannedMeasurement {
  std::string sentence;
  manifest::Value setup;                          // Proposal::setup
  std::vector<std::size_t> separates;             // two candidates
  double z = 0;                                   // by how many standard errors it would part them
  std::optional<report::FloorPlan> floor_plan{};  // Proposal::floor_plan
};

// What comes out where only a part of the groups had been recorded (stability.h).
struct Stability {
  std::size_t draws = 0, groups = 0;  // so many draws of so many groups
  struct Answer {
    Verdict verdict = Verdict::null;
    std::vector<std::size_t> named;  // candidates, ascending, one for all forms of a mechanism; empty: none
    std::size_t times = 0;
  };
  std::vector<Answer> answers;  // the most frequent first
  // Draws whose answer names what `named` holds, no more and no less, or names nothing, as `verdict` has it.
  std::size_t same(const Problem& problem, Verdict verdict, std::vector<std::size_t> named) const;
};

struct Explanation {
  Verdict verdict = Verdict::null;
  Misplaced misplaced;             // said before anything else; the verdict is then `unknown`
  std::vector<std::size_t> named;  // candidates, the most important first
  std::vector<std::vector<std::size_t>>
      not_told_apart;  // sets of candidates: the first is named, each of the others could stand in its place
  std::vector<std::vector<std::size_t>> instead;  // whole sets, each as good an explanation as all that is named
  // What was held against each other, the likeliest first (probability.h).
  struct Weighed {
    enum class Kind { nothing, outside, set };
    Kind kind = Kind::set;
    std::vector<std::size_t> candidates;
    double probability = 0;
    std::vector<std::pair<std::string, double>> statistics;  // those that are not zero
    std::vector<double> values{};                            // of all parameters, as a set's fit has them
  };
  std::vector<Weighed> weighed;
  double probability = 0, sure = 0.9;  // of the verdict: that it is what is named, or among what is listed
  double global_p = 1;                 // of the null test
  bool significant = false, important = false;
  double noise_factor = 1;
  std::size_t outlier_blocks = 0;
  std::optional<Outliers> outliers{};     // of the base model
  std::vector<std::size_t> odd_groups{};  // set aside, as they fit nothing that explains the others (odd_group.h)
  double odd_score = 0;                   // theirs, with numbers of their own fitted
  double smallest_effect = 0.01;
  // Names that other recordings of the same manifest speak against, and which are not named for that: a quantity of
  // theirs, which a true name makes smaller or leaves alone, without it and with it.
  struct Contradicted {
    std::string mechanism, by, quantity, unit;
    double before = 0, after = 0;
  };
  std::vector<Contradicted> contradicted{};
  std::optional<Stability> stability{};

  std::vector<std::size_t> at_limits{};  // free parameters of the base model that its fit leaves at a bound
  std::vector<double> base_values;       // fair refit of the base model, all groups
  std::vector<double> values;            // with the named mechanisms; equals base_values where nothing is named
  std::vector<std::size_t> active;       // parameters that were free in the final fit
  std::vector<double> sigma;             // one per parameter, zero where not free
  std::vector<double> covariance;        // of `active`, row-major: sandwich over blocks
  std::vector<Estimate> estimates;       // of the named mechanisms' parameters
  std::vector<double> residual_before, residual_after;  // y - f of all rows
  double left_beyond_noise = 0;  // of residual_after, as a share of the signal (beyond_noise() in left_over.h)

  double held_out_before = 0, held_out_after = 0;  // user's unit
  double fitted_before = 0, fitted_after = 0;      // the same score on the groups that were fitted
  bool converged = true;                           // of the final fit
  std::string shortened{};                         // what a budget left out, in a sentence; empty: nothing
  std::vector<std::size_t> test_groups;            // opened once at the end; empty: nested cross-validation over all
  double false_alarm = 0;                          // share of negative controls that would have passed for physics
  std::size_t negative_controls = 0;

  std::vector<Hypothesis> scoreboard;  // best first
  std::vector<Isolability> isolability;
  std::vector<LocatedCondition> conditions;  // the most telling first
  std::vector<LocatedGroup> groups;          // largest share first
  std::vector<Compensation> compensation;    // largest shift in sigmas first
  std::string stage;
  std::optional<Outside> outside;        // structure that no mechanism repairs
  std::vector<std::size_t> minor;        // hypotheses (places in `scoreboard`) that are there, but matter too little
  std::vector<PlannedMeasurement> plan;  // the most telling first
  std::string sentence, next_measurement;
};

struct Picture {
  std::string title{}, png{};  // bytes of a PNG, or
  std::string svg{};           // an inline drawing
  // A second picture of the same size: both lie under one movable divider, the first left of it, this one right.
  std::string over_title{}, over_png{};
  std::string caption{};
};
struct Box {  // part of a picture, px; (x, y) its top-left pixel
  std::string group;
  int x = 0, y = 0, width = 0, height = 0;
};
struct Illustration {
  std::vector<Picture> pictures;
  std::size_t seen_at_once = 2;    // of them, one below the other; the rest is folded
  std::vector<std::string> masks;  // file ids entered in the document: where the mismatch is
  std::vector<Box> boxes;          // the same as boxes
  std::string observations{};      // file id of the table of evidence (evidence.h); empty: none is written
};

}  // namespace gonio::inference
