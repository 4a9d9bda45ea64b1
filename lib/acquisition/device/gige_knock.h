// Is there a GigE Vision camera at an address? aravis takes a second and more to give up on one; this takes as long as
// is allowed.
#pragma once
#include <string>

namespace gonio::acquisition {

// GigE Vision 1.2, 14.3: DISCOVERY_CMD to UDP port 3956. `address`: four numbers; of other names nothing is known and
// nothing is asked: true. A datagram may be lost: asked four times and more within the timeout.
bool answers_as_gige_camera(const std::string& address, double timeout_s, int port = 3956);

}  // namespace gonio::acquisition
