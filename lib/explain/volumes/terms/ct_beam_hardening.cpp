// ct.beam-hardening on all readings: what line integrals lack, reconstructed (observed.h).
#include "volume/mechanisms/ct_beam_hardening.h"

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_beam_hardening() {
  static const Term term{.mechanism = mechanism::ct_beam_hardening,
                         .order = 200,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return equation::ct_beam_hardening(value, p[0], row.hardening);
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
