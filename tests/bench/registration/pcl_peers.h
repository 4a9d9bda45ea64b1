// PCL's registrations of two views, each in a source of its own: they take long to compile. For cloud_register.cpp.
#pragma once
#include "mesh/register.h"

namespace gonio::bench {

// Refined from stated, of the second view's points; pairs reach `reach_m`.
mesh::ViewMotion by_gicp(const mesh::MeasuredPoints& points, double reach_m);
mesh::ViewMotion by_icp_with_normals(const mesh::MeasuredPoints& points, double reach_m);

}  // namespace gonio::bench
