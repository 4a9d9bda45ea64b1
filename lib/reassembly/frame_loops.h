// Loops of the frames of a reassembled scene: going round must come back to where one began, within the covariance of
// the way. Gathers what the manifest says of where things stand; the loops and what is wrong with one that does not
// close are manifest/frame_graph.h's.
//
// Frames: world, each image's camera, boards, objects, rigs at each shot, and those of the section `frames`.
#pragma once
#include <string>
#include <vector>

#include "manifest/document.h"
#include "manifest/frame_graph.h"

namespace gonio::reassembly {

// "frames", images' world_from_camera and camera_from_board, objects' world_from_object, cameras of a rig in images of
// one shot. Where no sigma is stated, one degree, a millimetre and one part in a hundred of the length stand for it: a
// calibration without a sigma is no contradiction, and the mistakes that have names are far larger. Images of weight 0,
// and links of a frame to itself, are left out.
std::vector<manifest::FrameEdge> frame_edges(const manifest::Document& document);

// Names the link and the mistake; empty: all loops close, or there is none (then `check` of these edges has a remark).
std::string frame_loop_complaint(const manifest::Document& document);

}  // namespace gonio::reassembly
