#include "mechanism/form.h"

#include <map>

namespace gonio::mechanism {
namespace {

std::map<std::string, std::vector<Form>>& stated() {
  static std::map<std::string, std::vector<Form>> all;
  return all;
}

}  // namespace

Forms::Forms(const Mechanism& mechanism, std::vector<Form> forms) {
  stated()[mechanism.id] = std::move(forms);
}

std::span<const Form> forms_of(const Mechanism& mechanism) {
  all_mechanisms();  // every declaration has been made
  const auto found = stated().find(mechanism.id);
  return found == stated().end() ? std::span<const Form>{} : std::span<const Form>(found->second);
}

}  // namespace gonio::mechanism
