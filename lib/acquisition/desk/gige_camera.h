// A camera of GigE Vision 1.2 on loopback: aravis's fake camera holds its registers and counts its frames, its fill
// function notes what is asked; control and pictures are served by threads of their own, because a picture takes longer
// to render than a client waits for an answer of the control channel. It has a software trigger, single frames and free
// running, exposure, gain, temperature, and chunks that say what each frame was taken with. Lost packets are not sent
// again.
//
// All cameras of GigE Vision answer at UDP port 3956: each one here has an address of its own, 127.0.0.N.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/desk/faults.h"
#include "acquisition/device/devices.h"
#include "acquisition/device/unpack.h"

namespace gonio::acquisition::desk {

struct GigeSettings {
  std::string name;  // its serial number
  int width_px = 0, height_px = 0;
  PixelFormat format;   // at the beginning; it can be set to all of this mosaic (gige_formats())
  std::string address;  // empty: the first of 127.0.0.2 ... that is free
};

class GigeCamera {
 public:
  // The picture of now. Called by one thread at a time.
  using Expose = std::function<RawFrame(const Shot& shot, const PixelFormat& format)>;
  // Error(unavailable) where the address is taken, Error(data) for a format that GigE Vision has no number for.
  GigeCamera(const GigeSettings& settings, Expose expose, Faults& faults);
  ~GigeCamera();
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;
  const std::string& address() const;

 private:
  struct Camera;
  std::unique_ptr<Camera> camera_;
};

// The names under which a camera of this mosaic can be set, and their numbers (GigE Vision 1.2, section 26; Pixel
// Format Naming Convention 2.4).
struct GigeFormat {
  std::string name;
  std::uint32_t number = 0;
};
std::vector<GigeFormat> gige_formats(const std::string& mosaic);
// Row by row, the bytes of these samples as a camera sends them: what unpack() takes apart.
std::string pack(const std::vector<std::uint16_t>& samples, const PixelFormat& format);
// Its description for clients.
std::string gige_description(const std::vector<GigeFormat>& formats);

}  // namespace gonio::acquisition::desk
