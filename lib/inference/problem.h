// What the engine of `explain` works on: observations y with noise, grouped into units of validation, known conditions
// x, and a simulator f(x; parameters) whose optional terms (mechanisms) are parameters at their neutral values.
//
// A domain (boards, images) derives from Problem, fills the tables in its constructor and predicts; everything
// statistical is the engine's. ONE vector of parameters holds the free parameters of the base model, the nuisance
// parameters of single groups (a board's pose, a light's gain) and the parameters of all candidate mechanisms. A
// mechanism that is not in play keeps its neutral values, where the prediction is bit-identical to the base model's.
//
// Conventions: rows of one group are contiguous; groups, blocks and parameters are numbered from zero; SI units.
// predict() and jacobian() are called from several threads at once and for whole groups.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "inference/probability.h"
#include "manifest/sections/forward.h"
#include "manifest/value.h"
#include "mechanism/mechanism.h"
#include "report/floor_plan.h"

namespace gonio::inference {

// A quantity known for every row which may carry structure: "camera.image-radius", "surface.incidence".
// `direction` says how the structure enters a row: residual = direction * curve(value). Empty: 1. Corners use it for
// the radial (or out-of-board) direction in (u, v); images may use the prediction, so that the curve is a relative
// error. Neither values nor directions may be computed from the observations they are held against (predictions serve):
// their noise would explain itself.
struct Condition {
  std::string name, unit;
  std::string stage;              // of the simulator: lens, light, surface, transport, board, ...
  std::vector<double> values;     // one per row; NaN: does not apply to this row
  std::vector<double> direction;  // one per row, or empty
  std::string curve_unit = "";    // of the curve: residual's unit over direction's: "px", "mm", "1"
  bool within_groups = false;     // asked as well for waves with a phase of their own in each group (own_phase.h)
};

struct Observations {
  std::vector<double> value;  // y
  std::vector<double> sigma;  // its noise, one standard deviation, > 0
  std::vector<double> norm;   // the score in the user's unit is sqrt(sum (y - f)^2 / sum norm): 0.5 px^2 per coordinate
                              // gives the RMS in pixels, y^2 the relative RMSE
  std::vector<std::uint32_t> block;   // rows whose noise may be correlated share a block (a corner; a tile of pixels);
                                      // numbered over all groups, never straddling two groups
  std::vector<std::size_t> first;     // group g holds rows first[g] .. first[g + 1] - 1; size groups + 1
  std::vector<std::string> group;     // names, as the user knows them: "left03"
  std::vector<Condition> conditions;  // the most telling ones suffice: ten or so
  std::vector<double> place_error;  // what a row may be off by, >= 0, as its place is known no better (readings beside
                                    // an edge in a picture); empty: nothing. Outliers alone ask
  std::size_t rows() const { return value.size(); }
  std::size_t groups() const { return group.size(); }
};

struct Parameter {
  std::string name, unit;  // "cameras/c/fx_px", "left03/translation_x_m", "lens.radial.k1"
  double start = 0;        // where the fit begins. Mechanisms: start of the search when in play
  double neutral = 0;      // mechanisms: where the term vanishes; it stands here when not in play
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  double size = 1;  // typical size of a change, > 0: sets finite-difference steps (1e-4 size) and the damping's scale
  std::optional<double> prior_sigma;  // Gaussian prior about `start`
  std::vector<std::size_t> groups;    // on which groups it acts; empty: all. One group: a nuisance that is refitted on
                                      // one half of a held-out group's blocks and judged on the other half
};

struct Candidate {
  const mechanism::Mechanism* mechanism = nullptr;
  std::vector<std::string> on;          // targets: surfaces, lights, cameras, boards; empty: all there are
  std::vector<std::size_t> parameters;  // places in Problem::parameters
  // Candidates of one family are alternatives (one radius for all lights | one for each): at most one of them is named.
  std::string family;  // empty: the mechanism's id joined with `on`
  // Another form of what a plainer candidate says (an equidistant lens beside a radial polynomial): where both are as
  // good the plainer one is named, and this one stands beside it.
  bool finer = false;
  // Its slopes where its search begins stand for it everywhere else that a search can start from: no finite changes are
  // looked at, and chords that are stuck are not taken up anew by tangents.
  bool gradual = false;
  // Where predict() can tell only a part of what it does (which pixels of a sensor are the sensitive ones, from a few
  // pictures): the parameter whose distance from neutral is all of it, as a share of every reading.
  std::optional<std::size_t> share_of_readings{};
  // Where its numbers are draws of one law, the same for each of many things (corners of a print): how many of those.
  // Each number speaks of its own share of the recordings, and counts by it, as one of a single group does.
  double things = 1;
  const std::string& id() const { return mechanism->id; }
};

// What an independent measurement says of a parameter.
struct Calibration {
  double value = 0;
  std::optional<double> sigma;  // one standard deviation, where it is stated
};

// What `--smallest-effect` is a share of: the signal (rms of the effect over sqrt(sum norm), images) or the held-out
// score that the mechanism removes (boards, where pixels have no natural scale).
enum class Importance { share_of_signal, share_of_residual };

// A measurement that could be taken next: one more group under conditions that the user can set.
struct Proposal {
  std::string sentence;   // "the third image again at 0.1 s"
  manifest::Value setup;  // what to set, in the manifest's words: {"exposure_s": 0.1}, {"light_towards": [...]}
  std::optional<report::FloorPlan> floor_plan{};  // where something is moved
};
struct ProposedRows {
  std::vector<double> prediction, sigma;      // of the rows that it would give
  std::vector<std::vector<double>> nuisance;  // derivatives, one column for each number that only this group would have
};

// What an exact simulation says more than predict() does, row by row, and the variance of that by its random numbers.
struct Bias {
  std::vector<double> value, variance;
};

struct Explanation;  // explanation.h
struct Illustration;

class Problem {
 public:
  virtual ~Problem() = default;
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  const Observations& observations() const { return observations_; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<std::size_t>& base() const { return base_; }  // free in the base model: shared and nuisance
  const std::vector<Candidate>& candidates() const { return candidates_; }

  // f for all rows of `group`; `prediction` has first[group + 1] - first[group] places. `values`: one per parameter.
  virtual void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const = 0;
  // Derivatives with respect to the parameters `columns`, column after column (column-major). The default takes central
  // differences of predict() with step 1e-4 size, one-sided at a bound.
  virtual void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                        std::span<double> derivatives) const;

  // Where predict() stands for a slower simulation: by how much it is off at `values`, with these candidates switched
  // on. Asked once or twice, of what is reported. The same random numbers serve all values.
  virtual std::optional<Bias> bias(std::span<const double> /*values*/,
                                   std::span<const std::size_t> /*candidates*/) const {
    return std::nullopt;
  }

  // Candidates that cannot be named together, beside those of one family: the simulation that is written has no form
  // for both.
  virtual bool excludes(std::size_t /*candidate*/, std::size_t /*other*/) const { return false; }

  virtual std::string domain() const = 0;      // "boards", "images"
  virtual std::string unit() const = 0;        // of the score: "px", "1" (a ratio)
  virtual std::string score_name() const = 0;  // "RMS reprojection error", "relative RMSE"
  virtual std::string group_noun() const = 0;  // "board view", "image"
  virtual Importance importance() const = 0;

  // Factor on the stated sigma, found from differences between neighbours that no smooth effect can reach. Nothing: the
  // stated noise stands. `residual`: y - f for all rows after the most flexible fit.
  virtual std::optional<double> noise_factor(std::span<const double> residual) const;
  // Does the stated noise hold whatever the residuals look like, with all that rows differ by? Then the null test asks
  // as well whether scores are larger than that noise makes them. An effect that few blocks show (the black of a chart)
  // is invisible to signs alone.
  virtual bool noise_is_known() const { return false; }
  // Is what rows scatter beyond that noise a mismatch, whether or not it follows any condition? A sensor's noise is of
  // single readings; corners and rows of tables may share more than is stated within a block.
  virtual bool scatter_is_mismatch() const { return false; }
  // Blocks beyond five noise widths under the most flexible fit are set aside and counted (mis-detected corners).
  virtual bool sets_outliers_aside() const { return false; }
  // Of images, whose light is sampled and cached, the simulator errs.
  virtual Simulator simulator() const { return Simulator::exact; }
  // Are readings far beyond the noise effects (outliers.h)? Images say yes: a highlight elsewhere is no mistake.
  virtual bool outliers_are_effects() const { return false; }

  // Measurements within the user's reach that could separate hypotheses: another range, exposure, light, turn, in an
  // order that does not depend on the data. `values`: the fit about which they are planned. The engine predicts each
  // under the competing hypotheses and recommends the one that separates them best for its cost (T-optimality, Atkinson
  // & Fedorov, Biometrika 62, 1975).
  virtual std::vector<Proposal> proposals() const { return {}; }
  virtual ProposedRows propose(std::span<const double> values, std::size_t proposal) const;

  // What calibrations that these recordings had no part in say of a parameter: the physics that was left out had bent
  // the fit away from it. By default the prior, where there is one.
  virtual std::optional<Calibration> calibration(std::size_t parameter) const;

  // Tests that a problem makes on its own, of single observations, which no held-out group can speak for: places in
  // candidates() of what it tests. These do not run in the race; what is found is named at the false-alarm rate that
  // the problem states, and the engine works on what is left.
  virtual std::vector<std::size_t> tested_apart() const { return {}; }
  // Adds to a finished explanation what these tests have found; its sentence is written afterwards.
  virtual void conclude(Explanation&) const {}
  // Relative fall of the squares that ends a fit. Where the model is known to lack much, its last digits say nothing.
  virtual double fit_tolerance() const { return 1e-9; }

  // What the domain has to say beside the verdict, in sentences; joins the explanation's own.
  virtual std::string remarks(const Explanation& explanation) const;

  // The upgraded sections: mechanisms, cameras, boards, surfaces, lights, images with the fitted values and their
  // sigmas. Called for every verdict; where nothing is named the fair refit of the base model is written.
  virtual void apply(const Explanation& explanation, manifest::Document& document) const = 0;
  // Pictures of where the mismatch is, before and after (PNG bytes for the page), and, where `out` is given, mask files
  // entered in the document; returns what the engine puts into "located".
  virtual Illustration illustrate(const Explanation& explanation, const std::filesystem::path& out,
                                  manifest::Document& document) const = 0;

 protected:
  Problem() = default;
  Observations observations_;
  std::vector<Parameter> parameters_;
  std::vector<std::size_t> base_;
  std::vector<Candidate> candidates_;
};

}  // namespace gonio::inference
