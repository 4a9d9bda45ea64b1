// v4l2:///dev/video0: cameras of Video4Linux through the kernel's own interface.
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "acquisition/device/unpack.h"
#include "acquisition/device/url_query.h"
#include "acquisition/device/v4l2_camera.h"
#include "base/error.h"

namespace gonio::acquisition::drivers {
namespace {

class KernelVideoCalls : public VideoCalls {
 public:
  int open(const std::string& path) override { return ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC); }
  int control(int file, unsigned long request, void* argument) override {
    for (;;) {
      const int answer = ::ioctl(file, request, argument);
      if (answer >= 0 || errno != EINTR) return answer;
    }
  }
  void* map(int file, std::size_t length, std::int64_t offset) override {
    void* const memory = ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, file, offset);
    return memory == MAP_FAILED ? nullptr : memory;
  }
  void unmap(void* memory, std::size_t length) override { ::munmap(memory, length); }
  int wait(int file, double seconds) override {
    pollfd wanted{file, POLLIN, 0};
    const int ready = ::poll(&wanted, 1, static_cast<int>(std::ceil(1000 * std::clamp(seconds, 0.0, 1000.0))));
    return ready < 0 && errno == EINTR ? 0 : ready;
  }
  void close(int file) override { ::close(file); }
  double now_s() override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
};

std::unique_ptr<CameraDevice> v4l2_camera(const Url& url, const std::string& place) {
  if (!url.host.empty() || url.path.size() < 2)
    throw Error(Exit::usage, place, url.text + ": names no device", "write v4l2:///dev/video0, with three strokes");
  UrlQuery query(url, place);
  V4l2Settings settings;
  settings.path = url.path;
  settings.pixel_format = query.text("pixel_format");
  if (!settings.pixel_format.empty() && !parse_pixel_format(settings.pixel_format))
    throw Error(Exit::usage, place, url.text + ": pixel_format is '" + settings.pixel_format + "'",
                "Mono or BayerRG, BayerGR, BayerGB, BayerBG with 8 to 16 bits, as Mono12, BayerRG10");
  settings.fourcc = query.text("fourcc");
  settings.width_px = query.integer("width", 0, 1, 1 << 20);
  settings.height_px = query.integer("height", 0, 1, 1 << 20);
  settings.exposure_step_s = query.quantity("exposure-step", Dimension::time, 0, 1e-9, 1);
  settings.gain_step_db = query.quantity("gain-step", Dimension::none, 0, 0, 10);
  settings.settle = query.integer("settle", settings.settle, 0, 1000);
  settings.timeout_s = query.timeout(settings.timeout_s);
  query.end();
  return make_v4l2_camera(std::move(settings), std::make_shared<KernelVideoCalls>(), place);
}

}  // namespace

const Driver& v4l2() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "v4l2";
    driver.sentence =
        "v4l2:///dev/video0 is a camera of Linux's own drivers (pixel_format=BayerRG10, packed or not, or "
        "fourcc=pRAA; width= and height=; gain-step=0.1, the dB of one of its gain; exposure-step=14.8us where its "
        "exposure counts lines; settle=2, the frames after a change that may not show it yet; timeout=3s beyond the "
        "frames that have to pass); frames that were begun before the call are dropped, lost and damaged ones seen.";
    driver.camera = v4l2_camera;
    driver.camera_keys = {"pixel_format"};
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
