// Stacks of pictures that a manifest names: one camera in one pose, a scene that nothing moved in, and no geometry. A
// stack of exposures shows it under one light for different times, or through different apertures; a stack of lights
// shows it under one distant lamp after the other (photometric stereo).
//
// Readings are what the file holds, through its stated response: codes over full scale, or an EXR file's values. Of a
// stack of exposures whose files share a rising table as their response and state no noise, readings are the codes
// themselves and the table is a part of the model: their noise is even there, and nothing that is near a steep end of
// the table weighs more than it tells.
// Readings that say only "at least" or "at most" do not count: the highest and the lowest code of integer files, and
// what is no number.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "geom/vector.h"
#include "io/image.h"
#include "manifest/noise.h"
#include "manifest/sections/forward.h"
#include "photograph/response.h"

namespace gonio::explain::stacks {

struct StackImage {
  std::string id;
  std::size_t entry = 0;               // place in document.images
  io::Image picture;                   // Y, or R, G, B
  std::vector<std::uint8_t> counts;    // one per reading
  std::vector<std::uint8_t> at_least;  // one per pixel: some channel is clipped, and no mask hides it
  double exposure_s = 1, gain = 1;     // gain: factor on the light, 1 unless the manifest knows better
  double f_number = 0;                 // of the aperture; 0: not said
  std::optional<double> time_s, temperature_K;
  std::optional<Rigid<frame::World, frame::Camera>> world_from_camera;  // where it is stated
  std::string light;  // of a stack of lights: key in the manifest's lights
  manifest::Noise noise;
  bool noise_stated = false;
};

struct Stack {
  std::string name;                   // of the document's stacks: "camera", or "camera, light"
  std::string camera;                 // key in the manifest's cameras, or empty
  int step = 1;                       // pixels from one to the next of the same filter: 2 behind a Bayer mosaic
  std::vector<std::string> channels;  // {"Y"} or {"R", "G", "B"}
  bool integer = false;               // from 8 or 16-bit files
  double quantum = 0;                 // of a reading, where codes are taken as linear: 1 / 255, 1 / 65535; else 0
  double lowest = 0, highest = 1;     // readings of the lowest and the highest code
  double full_scale = 1;              // largest reading that counts, or 1 for integer files
  std::vector<photograph::Response> stated;  // by channel: of codes, where readings are codes; empty: they are linear
  std::vector<StackImage> images;
  // From readings to what a linear sensor would read, and back.
  double linear(int channel, double reading) const {
    return stated.empty() ? reading : stated[static_cast<std::size_t>(channel)].linear_of(reading);
  }
  double reading(int channel, double linear) const {
    return stated.empty() ? linear : stated[static_cast<std::size_t>(channel)].code_of(linear);
  }
  double linear_scale() const {  // of full_scale, the largest over the channels
    double most = stated.empty() ? full_scale : 0;
    for (const photograph::Response& response : stated) most = std::max(most, response.linear_of(full_scale));
    return most;
  }
  int width() const { return images[0].picture.width; }
  int height() const { return images[0].picture.height; }
};

enum class Kind { exposures, lights };

// Places in document.images, stack by stack. Exposures: at least three images with three exposures (times, or times and
// f-numbers) under the same lights. Lights: at least six, each under one distant lamp of its own, all with one exposure
// time.
std::vector<std::vector<std::size_t>> stacks_of(const manifest::Document& document, Kind kind);

// Reads the pictures and masks. Error(data) at the place in the manifest where sizes, channels or responses do not fit.
Stack read_stack(const manifest::Document& document, const std::vector<std::size_t>& entries, Kind kind);

}  // namespace gonio::explain::stacks
