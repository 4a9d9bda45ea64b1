// light.spectrum: all lamps alike, by the time of each image.
#include "light/mechanisms/light_spectrum.h"

#include "scene/edit.h"

namespace gonio::scene::edits {

const Edit& light_spectrum() {
  static const Edit edit{
      .mechanism = mechanism::light_spectrum, .lamps = [](const Amounts& p, const Moment& at) {
        return Rgb{equation::light_spectrum(p[0], at.along), 1, equation::light_spectrum(p[1], at.along)};
      }};
  return edit;
}

}  // namespace gonio::scene::edits
