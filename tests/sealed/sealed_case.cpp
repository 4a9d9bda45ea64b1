// Words for kinds of cases.
#include "sealed/sealed_case.h"

namespace gonio::sealed {

std::string_view kind_name(Kind kind) {
  static constexpr std::string_view names[] = {"null", "distractor", "single", "pair", "alike", "invisible", "outside"};
  return names[static_cast<std::size_t>(kind)];
}

}  // namespace gonio::sealed
