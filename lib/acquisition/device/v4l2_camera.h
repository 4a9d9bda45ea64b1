// A camera of Video4Linux as this program works it: it runs freely, and a frame is believed to be the one that was
// asked for where its exposure began after the call and after what was set had time to take effect. Frames that the
// kernel marks as damaged, and gaps in their numbers, are met in the same way: what follows them has to settle again.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "acquisition/device/devices.h"

namespace gonio::acquisition {

// The kernel's calls that it takes, as they are: a seam for devices that the tests play.
class VideoCalls {
 public:
  virtual ~VideoCalls() = default;
  virtual int open(const std::string& path) = 0;                             // -1 and errno
  virtual int control(int file, unsigned long request, void* argument) = 0;  // ioctl(2)
  virtual void* map(int file, std::size_t length, std::int64_t offset) = 0;  // null and errno
  virtual void unmap(void* memory, std::size_t length) = 0;
  virtual int wait(int file, double seconds) = 0;  // 1: something has come; 0: nothing in time; -1 and errno
  virtual void close(int file) = 0;
  virtual double now_s() = 0;  // CLOCK_MONOTONIC, as time stamps count
};

struct V4l2Settings {
  std::string path;                  // "/dev/video0"
  std::string pixel_format, fourcc;  // empty: as it is
  int width_px = 0, height_px = 0;   // 0: as it is
  double exposure_step_s = 0;        // what one of V4L2_CID_EXPOSURE is; 0: not known
  double gain_step_db = 0;           // what one of its gain is; 0: not known
  int settle = 2;                    // frames after a change that may not show it yet
  double timeout_s = 3;              // beyond the frames that have to pass
};
std::unique_ptr<CameraDevice> make_v4l2_camera(V4l2Settings settings, std::shared_ptr<VideoCalls> calls,
                                               const std::string& place);

}  // namespace gonio::acquisition
