// What tables name of the manifest: ids in their columns, and images with cameras and poses.
#pragma once
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "explain/tables/table_model.h"
#include "geom/rigid.h"

namespace gonio::explain::tables {

// The names in a column, in the order of their first rows. Ids that are numbers throughout have become numbers: they
// are looked for by value among `known`.
struct Names {
  std::vector<std::string> all;
  std::vector<std::size_t> of_row;
};
Names names_in(const Table& table, const std::string& column, const std::vector<std::string>& known);

struct ImageView {
  std::string image, sitting;  // sitting: the image's `group`
  std::string camera_name;
  camera::CameraModel camera;
  Rigid<frame::World, frame::Camera> world_from_camera;
  std::vector<double> sigma;  // rotation about, shift along the world's axes (six); empty: known exactly
};
// Error(data) for an image, or a camera of it, that the manifest does not have.
ImageView image_view(const manifest::Document& document, const std::string& id, const Table& table);

// Places of the groups whose rows a parameter reaches; empty: all of them.
template <class Reaches>
std::vector<std::size_t> groups_reached(const Table& table, const Reaches& reaches) {
  std::vector<std::size_t> groups;
  for (std::size_t g = 0; g < table.group.size(); ++g)
    for (std::size_t r = table.first[g]; r < table.first[g + 1]; ++r)
      if (reaches(r)) {
        groups.push_back(g);
        break;
      }
  if (groups.size() == table.group.size()) groups.clear();
  return groups;
}

}  // namespace gonio::explain::tables
