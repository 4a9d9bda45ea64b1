// PCL's ICP from points to planes, with normals of as many neighbours as ours takes.
#include <pcl/features/normal_3d.h>
#include <pcl/registration/icp.h>

#include "bench/registration/pcl_clouds.h"

namespace gonio::bench {
namespace {

using NormalCloud = pcl::PointCloud<pcl::PointNormal>;

NormalCloud::Ptr with_normals(const pcl::PointCloud<pcl::PointXYZ>::Ptr& cloud, Vec3 camera) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setKSearch(28);
  estimation.setViewPoint(static_cast<float>(camera.x), static_cast<float>(camera.y), static_cast<float>(camera.z));
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  NormalCloud::Ptr both(new NormalCloud);
  pcl::concatenateFields(*cloud, normals, *both);
  return both;
}

}  // namespace

mesh::ViewMotion by_icp_with_normals(const mesh::MeasuredPoints& points, double reach_m) {
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> method;
  return registered(method, with_normals(cloud_of(points, 1), points.viewpoints_m[1][0]),
                    with_normals(cloud_of(points, 0), points.viewpoints_m[0][0]), reach_m);
}

}  // namespace gonio::bench
