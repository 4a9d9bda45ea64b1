// A model that moves, for the view of surfaces (mesh_view.h): its points, its triangles at a time, its data in the
// page. Private to mesh_view.cpp.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "io/moving_model.h"
#include "report/mesh_view.h"

namespace gonio::report {

// World points that the first picture has to hold: of every node that is no surroundings (of all, where there is no
// other), while the model moves.
std::vector<Vec3> points_in_view(const io::MovingModel& model);
// Of every node that shows something: the corners in the world, and the colour.
void each_triangle(const io::MovingModel& model, double time_s,
                   const std::function<void(const std::array<Vec3, 3>&, const std::array<float, 3>&)>& take);
// Shapes, nodes and keys as elements of script that hold data.
std::string data_of(const io::MovingModel& model);
std::string legend_of(const MeshView& view);
// Little endian, `count` bytes.
void append_bytes(std::string& bytes, std::uint32_t value, int count);

// The script that reads these data and keeps the time (moving_script.cpp).
extern const std::string_view moving_script;

}  // namespace gonio::report
