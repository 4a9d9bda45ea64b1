// The sets of mechanisms that could be what was left out, each with the statistics that say how likely it is
// (probability.h): what forward selection came to and its parts, the runners-up, and what can stand in for one of them.
//
// What a set leaves is dear to know. It is looked into where the set is likely without knowing it, the likeliest first:
// what it leaves can only speak against it.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "inference/left_over.h"
#include "inference/probability.h"
#include "inference/race.h"

namespace gonio::inference {

struct Finalist {
  Model model;
  std::string refused;  // by a rule that no probability mends: at a bound, not significant, too small
  Statistics statistics;
  double probability = 0;
  std::size_t finer = 0;  // of its mechanisms, those that are a finer form of a plainer one
  double gained = 0;      // fall of the held-out mean square from the base model
  bool looked_into = false;
  std::shared_ptr<const ResidualStructure> after;  // of what was looked into whole
  LeftOver left;
  std::string curve;                      // over which a free one repairs more
  std::optional<std::size_t> with_minor;  // place of this set together with what is there and too small to matter
};

// Is it what may be named: refused by no rule, none of its mechanisms too small?
bool matters(const Finalist& f);

// The same mechanism on the same targets, or, of one family, on some of them.
bool is_within(const Candidate& part, const Candidate& whole);

class Finalists {
 public:
  Finalists(const Race& race, const Options& options, const Model& base, const ResidualStructure& before);

  // Once for every set; a better fit of a known one takes its place. `after`: what it leaves, where that is known.
  void add(Model model, std::shared_ptr<const ResidualStructure> after = nullptr);
  bool knows(const std::vector<std::size_t>& candidates) const;
  // Looks into what is likely and has not been looked into, no more than `most` of them; then weighs all.
  void weigh(std::size_t most);

  const std::vector<Finalist>& list() const { return list_; }
  const Finalist* likeliest() const;  // of the sets; null: there is none that could be
  double in_library() const;          // the probability that it is any of the sets
  // That these are among what was left out, in any form and whatever else is.
  double inclusion(const Finalist& some) const;
  bool holds(const Finalist& whole, const Finalist& part) const;  // whatever the forms
  double nothing() const { return nothing_; }
  double outside() const { return outside_; }
  // Nothing, outside, then those of list() that no rule refuses; `places`: theirs in list().
  std::vector<Member> members(std::vector<std::size_t>* places = nullptr) const;

 private:
  double largest_effect() const;  // of what was fitted or looked at, and of what stands beyond the noise
  std::set<std::string> physics_of(const Finalist& f) const;  // "sensor.non-linearity/camera", whatever the form
  bool is_form_of(const Finalist& f, const Finalist& of) const;
  const Finalist& plainest_form(const Finalist& of) const;
  std::map<std::string, double> inclusions() const;  // by physics_of
  // Where no few sets are likelier than not together: what all likely ones hold, if that is a set of its own.
  const Finalist* sure_part() const;
  void look_into(std::size_t place);
  void look_at_minor(std::size_t place);       // what stands beside it, and is too small to matter
  double finer_ones(const Finalist& f) const;  // Statistics::finer
  bool adds_what_matters(const Finalist& part, const Finalist& more) const;
  bool matters_beside_small(const Finalist& f) const;  // beside a mechanism that is there and too small to matter
  void refuse(Finalist& f) const;
  std::vector<Model> weaken(Finalist& f) const;  // weakest part and its effect, by leaving each out
  void compare();                                // what depends on the others
  void score();
  double sizes(const Model& model) const;
  double controls(const Finalist& f) const;

  const Race& race_;
  const Options& options_;
  const Model base_;
  const ResidualStructure before_;
  std::vector<Finalist> list_;
  double nothing_ = 1, outside_ = 0, rows_ = 0;
  double beyond_ = 0;  // the noise, what the base model leaves: a share of the signal
};

}  // namespace gonio::inference
