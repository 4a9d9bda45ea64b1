// The views of a projection among the manifest's images, and what their frames say. For this room.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "manifest/sections/forward.h"
#include "scan/decode.h"

namespace gonio::scan {

// Places in document.images, by frame of the projection.
using Frames = std::vector<std::size_t>;

struct ScanView {
  std::string name, group;      // its name where it has no group: the projection's
  std::vector<Frames> cameras;  // in the order that was asked for
};

// Error(data | no_input) where a frame is missing, or there twice.
std::vector<ScanView> views_of(const manifest::Document& document, const std::string& projection,
                               const std::vector<std::string>& cameras);

// Where the camera stood, if an image says so.
std::optional<Rigid<frame::World, frame::Camera>> world_from_camera(const manifest::Document& document,
                                                                    std::size_t image);

// Error(data) for a picture of another size.
CameraFrame read_frame(const manifest::Document& document, std::size_t image, int width, int height);

// `decoding`: the picture's size and limits; sequence, frames, mask, noise and what is known of the projector (its
// name, or empty: the only one that something is known of) are the manifest's.
Codes codes_of(const manifest::Document& document, const std::string& projection, const std::string& projector,
               const Frames& frames, DecodeRequest decoding);

// Pixel by pixel what the projector's white adds, linear red, green and blue; where it shows no white, the mean under
// the coarsest cosines. Nothing for grey pictures.
std::vector<std::array<float, 3>> colours_of(const manifest::Document& document, const Sequence& sequence,
                                             const Frames& frames, int width, int height);

}  // namespace gonio::scan
