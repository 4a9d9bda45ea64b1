#include "mesh/reconstruct/screened_poisson_module.h"

#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>

#include <algorithm>
#include <memory>

void gonio_screened_poisson(const std::vector<float>& points, int depth, bool by_length, std::vector<float>& vertices,
                            std::vector<std::uint32_t>& polygons) {
  const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointNormal>>();
  cloud->reserve(points.size() / 6);
  for (std::size_t i = 0; i + 6 <= points.size(); i += 6) {
    pcl::PointNormal one;
    one.x = points[i], one.y = points[i + 1], one.z = points[i + 2];
    one.normal_x = points[i + 3], one.normal_y = points[i + 4], one.normal_z = points[i + 5];
    cloud->push_back(one);
  }
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(depth);
  poisson.setMinDepth(std::min(5, depth));
  poisson.setThreads(1);
  poisson.setConfidence(by_length);
  poisson.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointNormal> found;
  std::vector<pcl::Vertices> faces;
  poisson.performReconstruction(found, faces);
  for (const pcl::PointNormal& v : found) vertices.insert(vertices.end(), {v.x, v.y, v.z});
  for (const pcl::Vertices& face : faces) {
    polygons.push_back(static_cast<std::uint32_t>(face.vertices.size()));
    for (const auto corner : face.vertices) polygons.push_back(static_cast<std::uint32_t>(corner));
  }
}
