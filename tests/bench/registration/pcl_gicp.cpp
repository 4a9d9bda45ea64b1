// PCL's generalized ICP (Segal, Haehnel & Thrun 2009), as it comes.
#include <pcl/registration/gicp.h>

#include "bench/registration/pcl_clouds.h"

gonio::mesh::ViewMotion gonio::bench::by_gicp(const mesh::MeasuredPoints& points, double reach_m) {
  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> method;
  return registered(method, cloud_of(points, 1), cloud_of(points, 0), reach_m);
}
