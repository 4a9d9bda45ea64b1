// Forms of a mechanism: a law that has been written in several ways. Each is searched with some of the parameters held
// where it has them; they are alternatives, of which explain names one. A declaration states them beside itself:
//   static const Forms forms(declaration, {{"by ...", {{"matte_form", 0}}}, ...});
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {

struct Form {
  std::string sentence;  // "by Oren & Nayar's full law"
  std::vector<std::pair<std::string, double>> held;
  bool finer = false;  // stands beside a plainer one that explains as much
};

struct Forms {
  Forms(const Mechanism& mechanism, std::vector<Form> forms);
};

// None: there is one, with all parameters searched.
std::span<const Form> forms_of(const Mechanism& mechanism);

}  // namespace gonio::mechanism
