#include "robot/handeye/closed_forms.h"

#include <array>

#include "base/error.h"
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {

Solution ClosedForm::solve(std::span<const PoseSample> samples) const {
  return from_motions(motions_of(samples));
}

std::span<const ClosedForm> closed_forms() {
  static constexpr std::array<ClosedForm, 7> table{{
      {"tsai", "AX=XB", "R. Tsai, R. Lenz, IEEE Trans. Robotics and Automation 5(3), 1989", tsai},
      {"park", "AX=XB", "F. Park, B. Martin, IEEE Trans. Robotics and Automation 10(5), 1994", park},
      {"horaud", "AX=XB", "R. Horaud, F. Dornaika, Int. J. Robotics Research 14(3), 1995", horaud},
      {"andreff", "AX=XB", "N. Andreff, R. Horaud, B. Espiau, 3-D Digital Imaging and Modeling, 1999", andreff},
      {"daniilidis", "AX=XB", "K. Daniilidis, Int. J. Robotics Research 18(3), 1999", daniilidis},
      {"shah", "AX=ZB", "M. Shah, J. Mechanisms and Robotics 5(3), 2013", shah},
      {"li", "AX=ZB", "A. Li, L. Wang, D. Wu, Int. J. Physical Sciences 5(10), 2010", li},
  }};
  return table;
}

const ClosedForm& closed_form(const std::string& name, const std::string& place) {
  std::string known;
  for (const ClosedForm& form : closed_forms()) {
    if (form.name == name) return form;
    known += (known.empty() ? "" : ", ") + std::string(form.name);
  }
  throw Error(Exit::usage, place, "\"" + name + "\" is no closed form", "there are " + known);
}

}  // namespace gonio::robot::handeye
