// What both peers share of PCL.
#pragma once
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "bench/registration/pcl_peers.h"

namespace gonio::bench {

inline pcl::PointCloud<pcl::PointXYZ>::Ptr cloud_of(const mesh::MeasuredPoints& points, std::uint32_t view) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t i = 0; i < points.view.size(); ++i) {
    const Vec3 p = points.positions_m[i];
    if (points.view[i] == view)
      cloud->push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  return cloud;
}

template <class Method, class Points>
mesh::ViewMotion registered(Method& method, const Points& source, const Points& target, double reach_m) {
  method.setInputSource(source);
  method.setInputTarget(target);
  method.setMaxCorrespondenceDistance(reach_m);
  method.setMaximumIterations(200);
  method.setTransformationEpsilon(1e-12);
  typename Points::element_type aligned;
  method.align(aligned);
  const Eigen::Matrix4d m = method.getFinalTransformation().template cast<double>();
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = m(i, j);
  return {normalized(quaternion_of(r)), {m(0, 3), m(1, 3), m(2, 3)}};
}

}  // namespace gonio::bench
