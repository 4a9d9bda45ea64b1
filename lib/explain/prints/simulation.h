// Surfaces of settings that were asked for lately, and the light that makes them: few numbers of a setting change the
// light, fewer its tails.
#pragma once
#include <memory>

#include "explain/prints/print_memo.h"
#include "explain/prints/printed_field.h"

namespace gonio::explain::prints {

class Simulation {
 public:
  explicit Simulation(const Sent& sent);  // which must outlive it
  // From several threads at once.
  std::shared_ptr<const Field> field(const Setting& setting) const;

 private:
  std::shared_ptr<const Field> grown_of(const Setting& setting) const;
  std::shared_ptr<const Lights> light_of(const Setting& setting) const;
  const Sent& sent_;
  Memo<Lights> tails_, lights_;
  Memo<Field> grown_, fields_;
};

}  // namespace gonio::explain::prints
