// What the bindings of both kinds of stacks share (exposure_binding.h, light_binding.h): how a mechanism enters its
// numbers into a problem, and how what was found of it is written back.
#pragma once
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/stacks/stack_input.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::stacks {

enum class Written {
  as_mechanism,   // switched on with the fitted values
  as_response,    // undone where the pictures are read: `response` of every image
  with_response,  // taken off there where a response is written, else switched on
  nowhere         // a stack without geometry cannot say it in the mechanism's unit
};

// One binding's way into a problem. Its numbers follow each other in `parameters`, from `first` on.
class StackEntry {
 public:
  StackEntry(const manifest::Document& document, const Stack& stack, const mechanism::Mechanism& mechanism,
             std::vector<Parameter>& parameters, std::vector<std::size_t>& base, std::vector<Candidate>& candidates);
  // A number as the mechanism declares it; neutral is what the manifest already says of `target`, by default the
  // stack's camera or its first lamp. It is called ID.NAME, or PREFIX/NAME.
  Parameter& add(const std::string& name, double size, const std::string& prefix = "");
  Parameter& add_for(const std::string& target, const std::string& name, double size);
  // One that belongs to the base model and to no mechanism.
  void add_base(Parameter parameter);
  // A candidate of these numbers, counted from `first`; nothing where the manifest has switched the mechanism on.
  // Several are alternatives of one family. `gradual`: Candidate::gradual.
  void propose(const std::vector<std::size_t>& numbers, std::vector<std::string> on = {}, bool finer = false);
  void propose_all(std::vector<std::string> on = {}, bool gradual = false);
  // Does the manifest say anything of the mechanism, of whatever target?
  bool is_stated() const;
  std::size_t count() const { return parameters_.size() - first; }

  const Stack& stack;
  const std::size_t first;

 private:
  const manifest::Document& document_;
  const mechanism::Mechanism& mechanism_;
  std::string target_;
  std::vector<Parameter>& parameters_;
  std::vector<std::size_t>& base_;
  std::vector<Candidate>& candidates_;
};

// The fitted mechanism into the manifest, as `written` says; `bent`: a response is among what is written.
bool is_switched_on(Written written, bool bent);
std::vector<std::string> written_on(const Stack& stack, const Candidate& candidate);

}  // namespace gonio::explain::stacks
