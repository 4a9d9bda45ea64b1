// A frame of a GigE camera in a test: a machine that is busy drops datagrams, and that is no fault of what is tested.
#pragma once

#include "acquisition/device/devices.h"

namespace gonio::tests {

// As `acquire` does: a frame of which packets are missing is taken again.
inline acquisition::RawFrame whole_frame(acquisition::CameraDevice& camera, const acquisition::Shot& shot) {
  acquisition::RawFrame frame = camera.take(shot);
  for (int again = 0; again < 5 && frame.incomplete_packets > 0; ++again) frame = camera.take(shot);
  return frame;
}

}  // namespace gonio::tests
