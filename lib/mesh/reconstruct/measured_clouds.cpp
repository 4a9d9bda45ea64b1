#include "mesh/reconstruct/measured_clouds.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/cloud.h"
#include "mesh/reconstruct/cloud_points.h"
#include "mesh/reconstruct/viewpoints.h"

namespace gonio::mesh {

using manifest::Document;

std::vector<std::string> chosen_clouds(const Document& document, const std::vector<std::string>& wished,
                                       const std::map<std::string, Vec3>& viewpoints_m) {
  std::vector<std::string> names = wished;
  if (names.empty())
    for (const auto& [name, cloud] : document.clouds) names.push_back(name);
  if (names.empty())
    throw Error(Exit::no_input, manifest::place(document, "/clouds"), "has none", "structured-light measures them");
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!document.clouds.contains(names[k]))
      throw Error(Exit::usage, "--view", names[k] + " is none of the manifest's clouds",
                  "leave it out: all of them are taken");
    if (std::ranges::count(names, names[k]) > 1)
      throw Error(Exit::usage, "--view", names[k] + " is given twice", "name every cloud once");
  }
  for (const auto& [name, at] : viewpoints_m)
    if (std::ranges::find(names, name) == names.end())
      throw Error(Exit::usage, "--viewpoint", name + " is none of the clouds that are taken", "see --view");
  return names;
}

std::filesystem::path cloud_path(const Document& document, const std::string& cloud) {
  return manifest::resolve(document, document.clouds.at(cloud).file, "/clouds/" + cloud + "/file");
}

MeasuredPoints points_of_clouds(const Document& document, const std::vector<std::string>& names,
                                const std::map<std::string, Vec3>& viewpoints_m) {
  MeasuredPoints points;
  points.viewpoints_m = viewpoints_of(document, names, viewpoints_m);
  bool coloured = true;
  for (std::uint32_t v = 0; v < names.size(); ++v) {
    const std::filesystem::path path = cloud_path(document, names[v]);
    const std::size_t first = points.view.size();
    read_points(path, v, points);
    coloured = coloured && points.colour.size() == points.positions_m.size();
    for (std::size_t i = first; i < points.view.size(); ++i)
      for (const Vec3 from : points.viewpoints_m[v])
        if (!(norm(points.positions_m[i] - from) > 0))
          throw Error(Exit::data, path.string(), format("point %zu lies at a viewpoint of its cloud", i - first),
                      "--viewpoint states another one");
  }
  if (!coloured) points.colour.clear();
  return points;
}

}  // namespace gonio::mesh
