// Laboratories to test with: the three instruments of the thesis, as far as it says where things stand. The world's
// origin is the middle of the object, on top of a pedestal; z is up.
#pragma once
#include <string>

#include "manifest/document.h"

namespace gonio::tests {

// Manifests as their owners would write them; every url is sim://.
//  - two UR5 on either side of a pedestal: "camera-arm" holds the camera "eye", "light-arm" the lamp "led"
//  - an ABB IRB 1600 ("arm") that holds a scanner of two cameras, "left" and "right", and an arc of 11 lamps, "lamp-1"
//    to "lamp-11"
//  - a UR3 ("arm") that holds the polarization camera "moving"; "standing" stands; an "lcd" and a "turntable"
std::string two_ur5_text();
std::string abb_and_arc_text();
std::string ur3_and_turntable_text();

manifest::Document laboratory_document(const std::string& text);

}  // namespace gonio::tests
