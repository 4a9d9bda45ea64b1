// A model that moves (io/moving_model.h) as glTF 2.0 in one file, for programs that know nothing of gonio.
//
// Metres. glTF has y up: a node "world" above all others turns our z up into it, by -90 degrees about x; below it every
// node's frame is ours. Node i of the file is node i of the model. Hinges are one animation of rotations, linear: slerp
// between two turns about one axis is the even turn between them, so that what other programs show at any time is what
// the model says. Cameras look along -z of a node of their own below their model's node. Lamps are points of
// KHR_lights_punctual in candela, at 683 lm/W. Colours that change, labels and words stay behind; where a reader would
// stop to look stands in the scene's `extras`.
#pragma once
#include <string>

#include "io/moving_model.h"

namespace gonio::scene {

// `binary`: as a .glb file, else JSON with its numbers in base64.
std::string gltf_of(const io::MovingModel& model, bool binary);

}  // namespace gonio::scene
