// A world that an instrument records: a design (which conditions, how many rows), a noise-free simulation with and
// without effects, and the noise of a real sensor. Derived worlds hold the physics; make_case() holds the experiment.
#pragma once
#include <functional>
#include <memory>

#include "base/random.h"
#include "sealed/sealed_case.h"

namespace gonio::sealed {

// An effect that can be left out. Its size has one number or several (p1 and p2), each drawn from [least, most], on a
// logarithmic scale, with either sign where `either_sign`.
struct EffectKind {
  std::string name, id;                         // id: canonical, empty for an effect outside the library
  std::vector<std::string> stages, conditions;  // any of them is right
  double least = 0, most = 0;
  bool either_sign = false;
  std::size_t parts = 1;
  std::function<std::vector<TrueValue>(const Numbers& size)> values =
      {};                    // empty: the declaration's numbers mean others
  std::string variant = {};  // of the design that it needs; empty: the usual one
  double freedom = 0;        // numbers that a test for it has (one a view); 0: as many as it has parts
  bool scales = true;        // false: what it does is not in proportion to its size, so that it is never scaled

  EffectKind& of_either_sign();
  EffectKind& of_parts(std::size_t count, double numbers_of_a_test = 0);
  EffectKind& only_for(const std::string& design);
  EffectKind& as_drawn();  // never scaled
  // The declaration's parameters of this name are the parts of the size, times `scale`.
  EffectKind& means(const std::vector<std::string>& parameters, const Numbers& scale = {});
  EffectKind& nearly(const std::string& parameter);  // the same to first order: no interval is asked
};
using Sizes = std::map<std::string, Numbers>;  // effect's name -> size; left out: absent

class World {
 public:
  virtual ~World() = default;
  virtual std::vector<EffectKind> effects() const = 0;
  // Draws the conditions. Called once, before everything below.
  virtual void design(Random& random, const std::string& variant) = 0;
  virtual Numbers base() const = 0;        // true values of what the base model leaves free
  virtual Numbers base_steps() const = 0;  // for differences
  virtual Numbers simulate(const Numbers& base, const Sizes& sizes) const = 0;  // noise-free, all rows
  // What simulate() said, as exact as a recording must be: where simulating is integrating at random places, it may be
  // rough, for its errors cancel in differences.
  virtual Numbers exposed(const Sizes&, Numbers simulated) const { return simulated; }
  virtual Numbers sigma(const Numbers& clean) const = 0;  // the true noise
  virtual Numbers noisy(const Numbers& clean, Random& random) const = 0;
  // The score is sqrt(sum ((y - f) / reference)^2 / sum norm).
  virtual Numbers norm(const Numbers& observed) const = 0;
  virtual Numbers reference(const Numbers& clean, const Numbers&) const { return Numbers(clean.size(), 1.0); }
  virtual bool relative() const = 0;  // score is a share of the signal
  // Files of the case; `stated` is the noise as it is written.
  virtual void write(const Numbers& observed, const Numbers& stated, Case& into) const = 0;
  virtual std::vector<Numbers> base_columns() const;  // default: central differences
  // Rows with free numbers of their own (a pixel's radiance in all pictures) and the derivatives with respect to them.
  virtual std::vector<std::size_t> strata() const { return {}; }
  virtual std::vector<Numbers> own_columns() const { return {}; }
  // Where a row is seen in images; empty: rows are known by their values.
  virtual void locate(const Numbers& surviving, const Numbers& observed, Case& into) const;
  // Whether rivals are simulated to find out if effects can be told apart (dear for images).
  virtual bool asks_rivals() const { return true; }
  virtual bool knows_floor() const { return true; }  // false: the score is another than the noise of the rows
};

std::unique_ptr<World> make_world(const std::string& domain);  // null where there is none
Case make_case(const Spec& spec);

}  // namespace gonio::sealed
