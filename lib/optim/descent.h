// Damped descent to a minimum: the one place that chooses damping, accepts steps and decides when to stop.
//
// Levenberg's and Marquardt's method with the gain ratio as its guide (Madsen, Nielsen & Tingleff, "Methods for
// non-linear least squares problems", 2004, algorithm 3.16): a step that lowers the cost is taken, and the damping then
// follows from how well the quadratic model foretold the fall, but never rises; a step that does not is refused, and
// the damping grows twice as fast with every refusal in a row.
//
// Whoever minimises says how to linearise and how to solve for one damping: dense normal equations (damped.h), Schur
// complements, variable projection, Fisher scoring. Dense problems of some hundred parameters with bounds, priors,
// robust losses and a covariance need not do even that: least_squares.h. By Ceres: ceres_fit.h.
#pragma once
#include <cmath>
#include <limits>
#include <string>

namespace gonio::optim {

// Where one damping leads, before anything is evaluated there.
struct Proposal {
  // Fall of the cost by the quadratic model, in the cost's unit, for the step as it is taken, bounds and all; NaN where
  // nobody knows.
  double promised = 0;
  double length = std::numeric_limits<double>::infinity();  // of the step, in the unit of Limits::small_step
};

// What is minimised, and where it stands. After accept() it stands where the last propose() led.
class Descent {
 public:
  virtual void linearise() = 0;  // where it stands: once before all proposals from there
  virtual Proposal propose(double damping) = 0;
  virtual double evaluate() = 0;  // the cost where the proposal leads; not finite: no place to be
  virtual void accept() = 0;

 protected:
  ~Descent() = default;
};

// An amount of cost: `share` of where the descent stands, and beside it so much in the cost's own unit.
struct Amount {
  double share = 0, absolute = 0;
  double of(double cost) const { return share * std::abs(cost) + absolute; }
};

struct Limits {
  int most_steps = 100;    // linearisations
  int most_trials = 1000;  // evaluations
  int most_refusals = 60;  // in a row; so many refusals mean that nothing lower is near
  double first_damping = 1e-3, least_damping = 1e-12, most_damping = 1e12;
  double floor = -std::numeric_limits<double>::infinity();  // a cost that cannot be told from the least there is
  Amount small_fall{1e-12, 0};                              // an accepted step that gains no more ends the descent,
  double calm_damping = HUGE_VAL;                           // unless it was damped by more than this
  Amount small_promise;                                     // a step that promises no more is not tried
  Amount rounding{1e-13, 0};    // a refused step that promised no more: what is left is rounding,
  double rounding_damping = 0;  // if it was damped by more than this
  double small_step = 0;        // taken or refused, a shorter step is the last
};

enum class Stop {
  floor,     // the cost is as low as it can be
  promise,   // the quadratic model promises nothing worth a step
  fall,      // the last step gained too little to go on
  step,      // the last step was too short to matter
  rounding,  // what is left to gain drowns in rounding
  barren,    // no step, however short, leads down
  steps      // the limit on steps or trials was reached before any of these
};

struct Descended {
  double cost = 0;
  int steps = 0, trials = 0;
  double damping = 0;  // last
  Stop stop = Stop::steps;
  // At rest: nothing within the limits would change the result. False for `steps` and `barren`.
  bool settled() const { return stop != Stop::steps && stop != Stop::barren; }
};

// `cost`: where `descent` stands. Sums up in one thread and always in the same order: same input, same bytes.
Descended descend(Descent& descent, double cost, const Limits& limits);

// "stopped after 12 steps: the last one gained too little to go on"
std::string sentence(const Descended& descended);

}  // namespace gonio::optim
