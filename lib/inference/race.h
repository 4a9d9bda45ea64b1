// The race of hypotheses: every model is a set of candidates switched on together with the free parameters, fitted on
// the groups in play and scored on held-out groups; negative controls and free curves run against them.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "inference/engine.h"
#include "inference/fit.h"
#include "inference/folds.h"
#include "inference/interaction.h"
#include "inference/outliers.h"
#include "inference/serial_correlation.h"
#include "inference/signature.h"

namespace gonio::inference {

struct Model {
  std::vector<std::size_t> candidates;
  Fit fit;
  HeldOut held_out;
};

class Race {
 public:
  Race(const System& system, const Options& options);

  const System& system() const { return system_; }
  const Options& options() const { return options_; }
  const std::vector<std::size_t>& allowed() const { return allowed_; }  // candidates that may be named
  const std::vector<std::size_t>& free() const { return free_; }        // base parameters that are not protected

  Model base(const std::vector<double>& start) const;
  // `from` with other candidates; fitted from its values, new candidates from their starting points. `kept`: along the
  // chords of these slopes (inference/system.h), which is what most hypotheses are worth.
  Model changed(const Model& from, std::vector<std::size_t> candidates, const Slopes* kept = nullptr) const;
  // The same, the candidates' parameters beginning at `start` (all of them, in order). `promise`: fall of the sum of
  // squares that their linear form has; where the chords reach less than half of it, or of what they have reached and
  // tangents where they end still promise, the fit begins anew with tangents.
  Model started(const Model& from, std::vector<std::size_t> candidates, const std::vector<double>& start,
                const Slopes* kept, double promise = 0) const;
  // The cost that one step from there promises.
  double promised_cost(const Model& from, const std::vector<std::size_t>& candidates, const std::vector<double>& start,
                       const Slopes& kept) const;
  // Derivatives of the free parameters and of the model's candidates where the model stands.
  Slopes slopes_at(const Model& model) const;
  // Candidates that may join: allowed, not in the model, and none in it that they cannot stand beside.
  std::vector<std::size_t> open_to(const Model& model) const;
  bool relatives(std::size_t a, std::size_t b) const;       // of one family
  bool never_together(std::size_t a, std::size_t b) const;  // relatives, or of no common form: one of them is named

  // The step from `before` to `after` as one line of the scoreboard; `refused` says which condition of a name it fails.
  // `negative_controls`: what those achieved on the same model; more than a tenth of them better by its standard
  // error, and it is no better than chance.
  // `looks`: hypotheses tried beside it.
  Hypothesis judged(const Model& before, const Model& after, const std::vector<std::size_t>& added,
                    const std::vector<Hypothesis>& negative_controls, std::size_t looks,
                    const Slopes* kept = nullptr) const;
  double effect(const Model& before, const Model& after) const;
  std::string name_of(const std::vector<std::size_t>& candidates) const;

 private:
  // Values and free parameters of `from` with these candidates instead of its own.
  std::pair<std::vector<double>, std::vector<std::size_t>> beginning(const Model& from,
                                                                     const std::vector<std::size_t>& candidates,
                                                                     const std::vector<double>& start) const;
  // Numbers of the model's candidates that nothing holds (the turn of a bell about its axis) run to a bound, which
  // would speak against the rest. They go back to neutral, or to where a fit from there ends, where that is as good.
  void free_from_bounds(Model& m) const;
  struct AlongChords {
    Fit fit;
    std::optional<Slopes> turned;  // where they were taken anew
    double promised = 0;           // further fall of the cost, by tangents where the fit has ended
  };
  AlongChords along_chords(const Model& from, std::vector<double> values, const std::vector<std::size_t>& active,
                           const Slopes& kept) const;
  const System& system_;
  const Options& options_;
  std::vector<std::size_t> allowed_, free_;
};

// What the candidate's mechanism declares for a parameter of the problem; null: it is none of its own.
const mechanism::Parameter* declared(const Candidate& candidate, const Parameter& parameter);
// Hypothesis::refused of what is there and would be named if it mattered.
inline constexpr char smaller_than_what_matters[] = "smaller than what matters";
inline bool too_small(const Hypothesis& h) {
  return h.refused == smaller_than_what_matters;
}
// The usual size of a deviation that the candidate's mechanism declares for a parameter of the problem; 0: none.
double typical_size(const Candidate& candidate, const Parameter& parameter);
// The name of the first number of these candidates that a fit left at a limit of what is plausible; empty: there is
// none. A bound within a few usual sizes of neutral is one of the physics itself (a share of one, a mirror), and no
// objection.
std::string at_a_limit(const Problem& problem, const Fit& fit, const std::vector<std::size_t>& candidates);

// What the recordings say about one model, before anything else is fitted.
struct Evidence {
  Structures structures;
  Projection projection;
  BlockScores scores;
  std::unique_ptr<Folds> folds;
};
// A free curve over one condition: "unknown" competes too.
struct Competitor {
  Hypothesis hypothesis;
  std::size_t condition = 0;
  HeldOut held_out;  // linear
};

// What a linear form changes, in the unit of Options::smallest_effect: its foreign columns of the projection, and the
// held-out squares with them.
double linear_effect(const Race& race, const Evidence& evidence, const std::vector<Eigen::Index>& places,
                     const HeldOut& with);

// At curves alone where nothing but what a model leaves is asked.
enum class Looks { at_everything, at_curves };

// The state of knowledge about one model: what structure its residuals still hold, and what free curves and negative
// controls could repair.
struct ResidualStructure {
  Looks looks = Looks::at_everything;
  double global_p = 1;
  std::vector<LocatedCondition> conditions;  // the most telling first
  std::vector<Isolability> isolability;
  std::vector<double> inflation;                        // see signature.h
  std::vector<Competitor> curves;                       // largest gain first
  std::vector<Hypothesis> negative_controls;            // largest gain first
  double false_alarm = 0;                               // share of negative controls that would have been named
  std::optional<SerialCorrelation> serial_correlation;  // structure that no smooth curve follows
  std::optional<Interaction> interaction;  // structure in a product of conditions; asked where nothing else is found
  std::optional<Outliers> outliers;        // too few for any curve
  std::shared_ptr<const Evidence> evidence;
};
ResidualStructure residual_structure(const Race& race, const Model& model, const Options& options,
                                     Looks looks = Looks::at_everything);

// How much may be tried: a number of fits and of pairs, never a time.
struct Effort {
  std::size_t fits = 14;       // hypotheses fitted in a round
  std::size_t least = 4;       // of them whatever the screening says
  std::size_t pairs = 20000;   // screened in a round
  std::size_t effects = 5;     // at once
  std::size_t runners_up = 4;  // tried where the first choice does not suffice
  std::size_t looks = 8;       // at what finalists leave, at a time
  std::string shortened;       // what a budget has cost, in a sentence
};
Effort effort_for(const Race& race, const Options& options);

class Finalists;
struct Selection {
  Model base, model;
  ResidualStructure before, after;
  std::vector<Hypothesis> scoreboard;
  std::vector<std::size_t> minor;              // places in `scoreboard`
  std::shared_ptr<const Finalists> finalists;  // finalists.h; the model is the likeliest of them
  std::string shortened;
};
// Forward selection while effects pay, and, where what it comes to and its parts do not suffice together, the same from
// another choice of one round: first the one that falls least short of what was chosen, in whichever round, and a
// bounded number of them (limited discrepancy search, Harvey & Ginsberg, IJCAI 1995). All sets on the way are weighed
// against each other (finalists.h), and so is what could stand in for a member of the likeliest. `mismatch_p`: of the
// null test on the base model, where it was asked of more groups than these; above the level nothing is added to it.
Selection select(const Race& race, const Options& options, const std::vector<double>& start,
                 std::optional<double> mismatch_p);

// Adds what could stand in the place of each member of `model`; for two together also pairs that have neither.
void add_alternatives(const Race& race, const Effort& effort, const Selection& selection, const Model& model,
                      Finalists& finalists);
// Is `other` as good as `best`, both extending `before`? Within `errors` standard errors of the paired difference over
// groups, not beyond what the noise of single blocks could do, and with at least `share` of what the best one gained.
bool as_good(const Model& before, const Model& best, const Model& other, double errors, double share);
// Does `other` gain all but a hundredth of what `best` does? Two forms of one thing are not parted by what is left,
// however surely the noise would show it: neither need be the form of the thing itself.
bool nearly_all(const Model& before, const Model& best, const Model& other);

}  // namespace gonio::inference
