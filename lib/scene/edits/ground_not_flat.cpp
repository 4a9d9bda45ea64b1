// ground.not-flat: a plane becomes a mesh of small squares.
#include <memory>

#include "scene/edit.h"
#include "scene/mechanisms/bend.h"

namespace gonio::mechanism {
const Mechanism& ground_not_flat();
}

namespace gonio::scene::edits {
namespace {

constexpr std::uint32_t squares = 128;  // a side: of 1 m and 1/m they leave the bent plane by 8 um

bool is_plane(const Instance& instance) {
  return std::holds_alternative<Plane>(instance.shape);
}

void bend_plane(Instance& instance, std::span<const double> a) {
  const auto* plane = std::get_if<Plane>(&instance.shape);
  if (plane == nullptr) return;
  auto mesh = std::make_shared<mesh::Mesh>();
  for (std::uint32_t j = 0; j <= squares; ++j)
    for (std::uint32_t i = 0; i <= squares; ++i) {
      const double u = static_cast<double>(i) / squares, v = static_cast<double>(j) / squares;
      const Vec3 flat{(u - 0.5) * plane->size_x_m, (v - 0.5) * plane->size_y_m, 0};
      mesh->positions_m.push_back(equation::bent(flat, {}, a));
      const double by_x = a[0] * flat.x + a[2] * flat.y, by_y = a[2] * flat.x + a[1] * flat.y;
      mesh->normals.push_back(normalized(Vec3{-by_x, -by_y, 1}));
      mesh->texture.push_back({u, v});
    }
  for (std::uint32_t j = 0; j < squares; ++j)
    for (std::uint32_t i = 0; i < squares; ++i) {
      const std::uint32_t at = j * (squares + 1) + i, above = at + squares + 1;
      mesh->triangles.push_back({at, at + 1, above + 1});
      mesh->triangles.push_back({at, above + 1, above});
    }
  instance.shape = std::shared_ptr<const mesh::Mesh>(std::move(mesh));
}

}  // namespace

const Edit& ground_not_flat() {
  static const Edit edit{.mechanism = mechanism::ground_not_flat, .instance = bend_plane, .fits_instance = is_plane};
  return edit;
}

}  // namespace gonio::scene::edits
