#include "explain/stacks/stack_binding.h"

#include "explain/stacks/stack_manifest.h"
#include "manifest/document.h"

namespace gonio::explain::stacks {
namespace {

std::string target_of(const Stack& stack, const mechanism::Mechanism& m) {
  if (m.target == mechanism::Target::camera) return stack.camera;
  return m.target == mechanism::Target::light ? stack.images[0].light : "";
}

}  // namespace

StackEntry::StackEntry(const manifest::Document& document, const Stack& entered, const mechanism::Mechanism& mechanism,
                       std::vector<Parameter>& parameters, std::vector<std::size_t>& base,
                       std::vector<Candidate>& candidates)
    : stack(entered),
      first(parameters.size()),
      document_(document),
      mechanism_(mechanism),
      target_(target_of(entered, mechanism)),
      parameters_(parameters),
      base_(base),
      candidates_(candidates) {}

Parameter& StackEntry::add(const std::string& name, double size, const std::string& prefix) {
  const std::string& id = mechanism_.id;
  parameters_.push_back(
      declared(document_, id, name, prefix.empty() ? id + "." + name : prefix + "/" + name, target_, size));
  return parameters_.back();
}

Parameter& StackEntry::add_for(const std::string& target, const std::string& name, double size) {
  parameters_.push_back(declared(document_, mechanism_.id, name, target + "/" + name, target, size));
  return parameters_.back();
}

void StackEntry::add_base(Parameter parameter) {
  base_.push_back(parameters_.size());
  parameters_.push_back(std::move(parameter));
}

void StackEntry::propose(const std::vector<std::size_t>& numbers, std::vector<std::string> on, bool finer) {
  if (is_given(document_, mechanism_.id, target_)) return;
  Candidate candidate;
  candidate.mechanism = &mechanism_;
  for (const std::size_t number : numbers) candidate.parameters.push_back(first + number);
  candidate.family = mechanism_.id;
  candidate.on = std::move(on);
  candidate.finer = finer;
  candidates_.push_back(std::move(candidate));
}

bool StackEntry::is_stated() const {
  return document_.mechanisms.contains(mechanism_.id);
}

void StackEntry::propose_all(std::vector<std::string> on, bool gradual) {
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < count(); ++k) numbers.push_back(k);
  const std::size_t before = candidates_.size();
  propose(numbers, std::move(on));
  if (candidates_.size() > before) candidates_.back().gradual = gradual;
}

bool is_switched_on(Written written, bool bent) {
  return written == Written::as_mechanism || (written == Written::with_response && !bent);
}

std::vector<std::string> written_on(const Stack& stack, const Candidate& candidate) {
  if (!candidate.on.empty()) return candidate.on;
  const bool of_camera = candidate.mechanism->target == mechanism::Target::camera && !stack.camera.empty();
  return of_camera ? std::vector<std::string>{stack.camera} : std::vector<std::string>{};
}

}  // namespace gonio::explain::stacks
