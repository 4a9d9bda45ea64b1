// A link of a serial arm after Denavit and Hartenberg, standard convention: T = Rz(theta) Tz(d) Tx(a) Rx(alpha).
#pragma once

namespace gonio {

struct DhRow {
  double a_m = 0, d_m = 0, alpha_rad = 0, theta_rad = 0;
};

}  // namespace gonio
