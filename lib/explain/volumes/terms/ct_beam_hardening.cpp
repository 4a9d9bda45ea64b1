// ct.beam-hardening on grey values: what line integrals lack, reconstructed (observed.h).
#include "volume/mechanisms/ct_beam_hardening.h"

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_beam_hardening() {
  static const Term term{.mechanism = mechanism::ct_beam_hardening,
                         .order = 200,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return is_grey(row.reading) ? equation::ct_beam_hardening(value, p[0], row.hardening)
                                                       : value;
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
